// SPDX-License-Identifier: Apache-2.0
// Drives number nothing, so what belongs together is told by time. Frames are lost, doubled, and
// late by up to a period, SYNC among them: every snapshot must be one that the drives latched at
// one SYNC.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <random>

#include "core/base/sincos.hpp"
#include "tests/support/can_board.hpp"
#include "tests/support/count.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

using namespace test;

std::uint32_t below(std::mt19937_64& random, std::uint32_t end) {
    return static_cast<std::uint32_t>(random() % end);
}

void damage(std::vector<CanFrame>& frames, std::uint32_t late_us_max, std::mt19937_64& random) {
    if (frames.empty()) {
        return;
    }
    const std::uint32_t which = below(random, static_cast<std::uint32_t>(frames.size()));
    const auto at = frames.begin() + which;
    switch (below(random, 4)) {
        case 0:
            frames.erase(at);
            break;
        case 1:
            frames.insert(at + 1, *at);
            break;
        case 2:  // SYNC excepted: nothing is late here that gives the time
            at->time_us += at->id == 0x080 ? 0 : below(random, late_us_max + 1);
            break;
        default:
            frames.resize(which);
    }
}

/// Which drive answers first is the drives' business; the instants stay.
void answer_in_any_order(std::vector<CanFrame>& frames, std::mt19937_64& random) {
    std::vector<std::int64_t> times_us;
    for (const CanFrame& frame : frames) {
        times_us.push_back(frame.time_us);
    }
    std::shuffle(frames.begin() + 1, frames.end(), random);
    for (std::size_t i = 0; i < frames.size(); ++i) {
        frames[i].time_us = times_us[i];
    }
}

bool was_sent(const Machine& machine, const AxisSnapshot& snapshot) {
    const AxisSnapshot sent = snapshot_at(machine, snapshot.sample);
    for (std::uint32_t i = 0; i < 5; ++i) {
        double off = snapshot.position[i] - sent.position[i];
        off -= machine.axes[i].unlimited ? 2 * kPi * std::round(off / (2 * kPi)) : 0;
        const double count = i < 3 ? 5.0 / 65536 : 2 * kPi / (1 << 20);
        if (!(std::abs(off) <= 0.501 * count + 1e-12)) {
            return false;
        }
    }
    return snapshot.latched_us <= sent.latched_us + machine.can.sample_us / 5 &&
           snapshot.latched_us > sent.latched_us - machine.can.sample_us / 2;
}

TEST(DriveFramesProperty, EverySnapshotWasLatchedAtOneSync) {
    std::mt19937_64 random(printed_seed(402));
    const std::uint64_t runs = count_from_environment(400);
    std::uint64_t snapshots = 0;
    std::uint64_t sent = 0;
    for (std::uint64_t run = 0; run < runs; ++run) {
        Machine machine = five_axis_machine(CanFormat::cia402);
        machine.can.sync_counter_max = static_cast<std::uint8_t>(run % 2 == 0 ? 0 : 240);
        machine.can.stale_after_us = 100'000;  // it is the mixing that is looked for
        std::vector<CanFrame> frames;
        for (auto& sample : board_frames(machine, 300)) {
            answer_in_any_order(sample, random);
            if (sent++ % 3 == 2 && below(random, 3) == 0) {
                damage(sample, machine.can.sample_us, random);
                if (below(random, 4) == 0) {
                    damage(sample, 0, random);  // SYNC lost and an answer late, say
                }
            }
            frames.insert(frames.end(), sample.begin(), sample.end());
        }
        std::stable_sort(frames.begin(), frames.end(), [](const CanFrame& a, const CanFrame& b) {
            return a.time_us < b.time_us;
        });
        AxisReceiver receiver(machine);
        Heard heard;
        listen(receiver, frames, heard);
        // A receiver that stopped is an answer as well; the next run begins anew.
        snapshots += heard.snapshots.size();
        for (const AxisSnapshot& snapshot : heard.snapshots) {
            ASSERT_TRUE(was_sent(machine, snapshot))
                << "run " << run << " sample " << snapshot.sample;
        }
    }
    std::cout << snapshots << " pictures of " << sent << " samples\n";
    EXPECT_GT(snapshots, sent / 20) << "too few to tell anything";
}

}  // namespace
}  // namespace axg
