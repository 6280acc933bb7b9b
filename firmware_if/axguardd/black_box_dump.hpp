// SPDX-License-Identifier: Apache-2.0
// Writes the black box to disk after a stop: whole or not at all, and no more files than the limit
// allows. Called only by the logger; slow.
#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include "firmware_if/guard/black_box.hpp"

namespace axg {

struct BlackBoxFolder {
    std::string folder, bus;
    std::uint32_t dumps_max = 8;  // the oldest are removed; 0: none is written
};

/// The records of `box`, to DIR/BUS-YYYYMMDDTHHMMSSZ.axgbox. Empty: the reason is in `fault`.
[[nodiscard]] std::string write_black_box(const BlackBox& black_box, const BlackBoxHeader& header,
                                          const BlackBoxFolder& folder, std::string& fault);

/// When to do that: half a second after a stop, so that what the board did then is in it.
class BlackBoxDump {
  public:
    BlackBoxDump(const BlackBox& black_box, const BlackBoxHeader& header, BlackBoxFolder folder)
        : black_box_(black_box), header_(header), folder_(std::move(folder)) {}

    void on_note(const LiveNote& note) noexcept;
    /// Writes what is due. Says on stderr what came of it.
    void serve(std::int64_t now_us);
    /// The process ends: what is not due yet is written as well.
    void finish(std::int64_t now_us);
    /// The newest; empty: none was written.
    [[nodiscard]] const std::string& path() const noexcept { return path_; }

  private:
    const BlackBox& black_box_;
    BlackBoxHeader header_;
    BlackBoxFolder folder_;
    std::string path_;
    bool is_due_ = false;
    std::int64_t due_us_ = 0;
};

}  // namespace axg
