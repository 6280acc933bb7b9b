// SPDX-License-Identifier: Apache-2.0
// One axis whose frames repeat its count from some instant on, with good counters and checksums,
// while the axis itself goes on.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "core/reach/limit_evidence.hpp"
#include "firmware_if/protocol/axis_frames.hpp"
#include "firmware_if/protocol/e2e.hpp"
#include "hil_replay/board/axis_motion.hpp"
#include "tests/support/dice.hpp"

namespace axg::test {

class FrozenAxis {
  public:
    /// Freezes at a random one of the first samples at which an axis is fast enough.
    FrozenAxis(const Machine& machine, std::uint64_t seed) : machine_(machine), dice_(seed) {
        const LimitRules rules = limit_rules(machine, axis_units(machine));
        for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
            fast_[i] = 1.05 * blind_speed(rules, i);
        }
        waits_ = static_cast<int>(dice_.in(0, 120));
    }

    /// After each cycle in motion.
    void look(std::span<const AxisMotion> axes) {
        if (is_frozen() || --waits_ > 0) {
            return;
        }
        std::uint32_t drawn = kNoIndex, fast = 0;
        for (std::uint32_t i = 0; i < axes.size(); ++i) {
            if (std::fabs(axes[i].speed) > fast_[i] && dice_.chance(1.0 / ++fast)) {
                drawn = i;
            }
        }
        axis_ = drawn;
    }
    [[nodiscard]] bool is_frozen() const { return axis_ != kNoIndex; }

    void of_board(CanFrame& frame) {
        const CanLayout& can = machine_.can;
        const bool is_fd = can.format == CanFormat::fd;
        for (std::uint32_t i = 0; i < machine_.axes.size(); ++i) {
            const std::uint32_t place = is_fd ? 0 : i / 2;
            if (frame.id != can.axis_ids[place]) {
                continue;
            }
            const auto begin = frame.data.begin() + (is_fd ? 4 + 4 * i : 2 + 3 * (i % 2));
            if (i != axis_) {
                std::copy_n(begin, is_fd ? 4 : 3, bytes_[i].begin());
                continue;
            }
            std::copy_n(bytes_[i].begin(), is_fd ? 4 : 3, begin);
            if (is_fd) {
                p05_protect({frame.data.data(), frame.length_bytes}, can.data_ids[0],
                            frame.data[2]);
            } else {
                frame.data[0] = classical_crc(
                    std::span<const std::uint8_t, 8>(frame.data.data(), 8), can.data_ids[place]);
            }
        }
    }

  private:
    const Machine& machine_;
    Dice dice_;
    std::array<double, kAxesMax> fast_{};
    std::array<std::array<std::uint8_t, 4>, kAxesMax> bytes_{};
    std::uint32_t axis_ = kNoIndex;
    int waits_ = 0;
};

}  // namespace axg::test
