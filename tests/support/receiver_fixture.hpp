// SPDX-License-Identifier: Apache-2.0
// A board's samples and a receiver that hears them: tests put a fault into the samples first.
#pragma once

#include <gtest/gtest.h>

#include "firmware_if/protocol/e2e.hpp"
#include "tests/support/can_board.hpp"

namespace axg::test {

using Samples = std::vector<std::vector<CanFrame>>;

// Places of frames in a classical sample.
inline constexpr std::size_t kSync = 0, kFirst = 1, kSecond = 2, kThird = 3;

/// A classical board of 40 samples and its receiver; `hear` plays all of them.
struct Fixture {
    Machine machine;
    Samples samples;
    AxisReceiver receiver;
    Heard heard;

    explicit Fixture(CanFormat format = CanFormat::classical, std::uint64_t count = 40)
        : machine(five_axis_machine(format)),
          samples(board_frames(machine, count)),
          receiver(machine) {}

    void hear() {
        for (const auto& sample : samples) {
            listen(receiver, sample, heard);
        }
    }
    [[nodiscard]] std::uint64_t count(ReceiverFault fault) const {
        return receiver.counters().of(fault);
    }
    void expect_stop(ReceiverFault cause) {
        EXPECT_EQ(receiver.state(), ReceiverState::invalid);
        EXPECT_STREQ(fault_row(receiver.stop_cause()).name, fault_row(cause).name);
        ASSERT_FALSE(heard.faults.empty());
        EXPECT_EQ(heard.faults.back().severity, Severity::stop);
    }
    void expect_running_without(std::size_t lost) {
        EXPECT_EQ(receiver.state(), ReceiverState::valid) << fault_row(receiver.stop_cause()).name;
        EXPECT_EQ(heard.snapshots.size(), samples.size() - lost);
    }
};

inline void seal(CanFrame& frame, std::uint16_t data_id) {
    frame.data[0] = classical_crc(std::span<const std::uint8_t, 8>(frame.data.data(), 8), data_id);
}

/// Puts one changed snapshot at sample 20 of a board that otherwise runs on.
template <class Change>
void replace_sample_20(Fixture& fixture, Change change) {
    AxisEncoder encoder(fixture.machine);
    for (std::size_t k = 0; k < fixture.samples.size(); ++k) {
        AxisSnapshot snapshot = snapshot_at(fixture.machine, k);
        if (k == 20) {
            change(snapshot);
        }
        fixture.samples[k] = frames_of(encoder, snapshot);
    }
}

}  // namespace axg::test
