// SPDX-License-Identifier: Apache-2.0
// The last seconds as records, in a ring of fixed size that is reserved at the start. Written by
// the logger alone. The oldest records make room for the newest.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/machine/machine.hpp"
#include "firmware_if/guard/black_box_record.hpp"

namespace axg {

inline constexpr std::int64_t kBlackBoxUs =
    10'000'000;  // what the ring has to hold on a healthy bus

/// Bytes for that, and a quarter more.
[[nodiscard]] std::size_t black_box_bytes(const Machine& machine) noexcept;

class BlackBox {
  public:
    explicit BlackBox(std::size_t size_bytes) : bytes_(size_bytes) {}

    void add(const BlackBoxEntry& entry) noexcept;
    /// What is there, oldest first, in two parts.
    [[nodiscard]] std::array<std::span<const std::uint8_t>, 2> records() const noexcept;
    /// Of the next record.
    [[nodiscard]] std::uint32_t sequence() const noexcept { return sequence_; }

  private:
    void drop_oldest() noexcept;

    std::vector<std::uint8_t> bytes_;
    std::size_t begin_ = 0, used_ = 0;
    std::uint32_t sequence_ = 0;
};

}  // namespace axg
