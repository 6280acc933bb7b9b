// SPDX-License-Identifier: Apache-2.0
// Ring of fixed size with the records of the last seconds, reserved at the start. Only the logger
// writes it. New records replace the oldest.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/machine/machine.hpp"
#include "firmware_if/guard/black_box_record.hpp"

namespace axg {

inline constexpr std::int64_t kBlackBoxUs =
    10'000'000;  // time that the ring has to cover on a healthy bus

/// Bytes for kBlackBoxUs, and a quarter more.
[[nodiscard]] std::size_t black_box_bytes(const Machine& machine) noexcept;

class BlackBox {
  public:
    explicit BlackBox(std::size_t size_bytes) : bytes_(size_bytes) {}

    void add(const BlackBoxEntry& entry) noexcept;
    /// All records, oldest first, in two parts.
    [[nodiscard]] std::array<std::span<const std::uint8_t>, 2> records() const noexcept;
    /// Sequence number of the next record.
    [[nodiscard]] std::uint32_t sequence() const noexcept { return sequence_; }

  private:
    void drop_oldest() noexcept;

    std::vector<std::uint8_t> bytes_;
    std::size_t begin_ = 0, used_ = 0;
    std::uint32_t sequence_ = 0;
};

}  // namespace axg
