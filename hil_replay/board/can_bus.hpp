// SPDX-License-Identifier: Apache-2.0
// One bus in memory: carries one frame at a time, the lowest id first among those that are ready,
// each for the time of its bits. Injects faults, drawn from a seed.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "firmware_if/can/can_frame.hpp"

namespace axg {

enum class BusNode : std::uint8_t { board, guard };

/// Faults on the bus. Shares are of frames, drawn independently for each frame.
struct BusFaults {
    double lost = 0;         // of all frames
    double late = 0;         // of the guard's: a period late
    double corrupted = 0;    // of plain permit frames: up to three bits, past the wire's checksum
    double permit_lost = 0;  // of the guard's permit frames, in addition to `lost`
    std::int64_t silent_from_us = INT64_MAX;  // the wire is cut
    std::int64_t killed_from_us = INT64_MAX;  // the guard sends no more
    std::int64_t stuck_from_us = INT64_MAX;   // its engine hangs: it sends only heartbeats
    std::int64_t late_from_us = INT64_MAX;    // all it sends is a period late
};

struct BusOptions {
    std::uint32_t bit_rate = 1'000'000;
    std::uint32_t permit_id = 0x103;  // `permit_lost` hits this id and its twin, the next id
    std::uint32_t heartbeat_id = 0x702;
    std::uint32_t guard_sync_id = 0;  // if the guard sends SYNC; 0: the board does
    std::int64_t period_us = 1000;
    BusFaults faults;
    std::uint64_t seed = 1;
};

class CanBus {
  public:
    explicit CanBus(const BusOptions& options);

    /// `frame.time_us`: when the sender has it ready.
    void post(BusNode sender, const CanFrame& frame);

    struct Delivery {
        BusNode sender = BusNode::board;
        CanFrame frame;        // as the other node receives it; time_us: its end on the wire
        CanFrame sent;         // as its sender receives it back
        bool is_lost = false;  // the other node does not receive it
    };
    /// The next frame that ends at or before `until_us`. False: none. Frames posted later must not
    /// be ready before the end of the last one delivered.
    [[nodiscard]] bool next(std::int64_t until_us, Delivery& out);

    [[nodiscard]] std::uint64_t lost() const noexcept { return lost_; }
    [[nodiscard]] std::uint64_t busy_us() const noexcept { return busy_us_; }

  private:
    struct Waiting {
        std::int64_t ready_us = 0;
        std::uint32_t id = 0;
        std::uint32_t slot = 0;  // of frames_
        BusNode sender = BusNode::board;
    };

    [[nodiscard]] bool chance(double share);
    enum class Fate : std::uint8_t { sent, lost, unsent };
    /// Applies the faults to a frame. Lost: the other node does not receive it. Unsent: its sender
    /// is dead or stuck, or the wire is cut.
    [[nodiscard]] Fate spoil(BusNode sender, CanFrame& frame);

    BusOptions options_;
    std::mt19937_64 random_;
    std::vector<Waiting> waiting_;
    std::vector<Delivery> frames_;
    std::vector<std::uint32_t> free_slots_;
    std::int64_t free_us_ = INT64_MIN;
    std::uint64_t lost_ = 0, busy_us_ = 0;
};

}  // namespace axg
