// SPDX-License-Identifier: Apache-2.0
// Whether board and guard were configured from the same machine: each sends its four hashes, and
// the guard issues no permit until all are equal. It requests them by sending its own, one part at
// a time, until the board has replied. No clock, no allocation. Bytes: docs/reference/protocol.md,
// "Hashes".
#pragma once

#include <cstdint>

#include "core/machine/can_layout.hpp"
#include "core/machine/configuration_hashes.hpp"
#include "firmware_if/can/can_frame.hpp"

namespace axg {

/// One part, as either side sends it.
struct HashFrame {
    std::uint8_t part = 0;
    std::uint32_t hash = 0;
};
[[nodiscard]] CanFrame encode_hash(std::uint32_t id, HashFrame content,
                                   std::int64_t time_us) noexcept;
/// False: not exactly such a frame. The caller checks its id.
[[nodiscard]] bool decode_hash(const CanFrame& frame, HashFrame& out) noexcept;

class Handshake {
  public:
    static constexpr std::int64_t kRepeatUs = 10'000;   // until the board replies
    static constexpr std::int64_t kWaitUs = 1'000'000;  // then a person is notified

    /// A layout without the two ids: no requests, and everything agrees.
    Handshake(const CanLayout& layout, const ConfigurationHashes& hashes) noexcept
        : in_id_(layout.hashes_in_id),
          out_id_(layout.hashes_out_id),
          hashes_(hashes),
          agreed_(is_wanted() ? 0U : kAll) {}

    [[nodiscard]] bool is_wanted() const noexcept { return in_id_ != 0 && out_id_ != 0; }
    [[nodiscard]] bool has_agreed() const noexcept { return agreed_ == kAll; }
    /// Requests all hashes again.
    void begin(std::int64_t now_us) noexcept;

    /// When `next` has a frame; INT64_MAX: no more requests.
    [[nodiscard]] std::int64_t next_due_us() const noexcept {
        return is_asking_ && !has_agreed() ? next_us_ : INT64_MAX;
    }
    /// The next request. Precondition: it is due.
    [[nodiscard]] CanFrame next(std::int64_t now_us) noexcept;
    /// True once, when the board has not sent all its hashes for kWaitUs.
    [[nodiscard]] bool is_overdue(std::int64_t now_us) noexcept;

    enum class Heard : std::uint8_t { nothing, equal, different };
    /// A frame of another node. `different`, which is possible at any time, voids the agreement.
    [[nodiscard]] Heard on_frame(const CanFrame& frame) noexcept;
    /// The board's hash in the last frame that differed.
    [[nodiscard]] HashFrame theirs() const noexcept { return theirs_; }
    [[nodiscard]] std::uint32_t ours(std::uint8_t part) const noexcept { return hashes_.of[part]; }

  private:
    static constexpr std::uint32_t kAll = (1U << kHashParts) - 1U;

    std::uint32_t in_id_, out_id_;
    ConfigurationHashes hashes_;
    std::uint32_t agreed_;  // a bit a part
    std::uint8_t part_ = 0;
    bool is_asking_ = false, has_told_ = false;
    std::int64_t begun_us_ = 0, next_us_ = 0;
    HashFrame theirs_;
};

}  // namespace axg
