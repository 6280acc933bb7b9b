// SPDX-License-Identifier: Apache-2.0
// The permits in a stream of frames. A pair that no guard sends, and a frame without its twin, are
// failures of the test.
#pragma once

#include <gtest/gtest.h>

#include <optional>

#include "firmware_if/protocol/seen_frames.hpp"

namespace axg::test {

class PermitReader {
  public:
    explicit PermitReader(const CanLayout& layout) : layout_(layout) {}

    /// The permit whose twin this frame is.
    std::optional<Permit> on_frame(const CanFrame& frame) {
        if (frame.id == layout_.permit_id) {
            EXPECT_FALSE(plain_) << "a permit without its twin";
            plain_ = frame;
        }
        if (frame.id != layout_.permit_id + 1) {
            return std::nullopt;
        }
        const auto seen = plain_ ? read_permit(layout_, *plain_, frame) : std::nullopt;
        plain_.reset();
        EXPECT_TRUE(seen) << "a pair that no guard sends, at " << frame.time_us << " us";
        return seen ? std::optional(seen->permit) : std::nullopt;
    }

  private:
    CanLayout layout_;
    std::optional<CanFrame> plain_;
};

}  // namespace axg::test
