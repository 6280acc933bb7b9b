// SPDX-License-Identifier: Apache-2.0
// What candump saw of axguardd and canplayer on vcan, half a second before a stop and a tenth after
// it (golden/live-exchange.log; docs/measurements/live-guest.md says how it was made): the program
// that replays it stops at the same sample, for the same pair, and permits what was permitted live.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "firmware_if/protocol/guard_frames.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/machine_text.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kAxes = 0x181, kPermit = 0x103, kStop = 0x001, kEmergency = 0x082;

/// What a guard said, from its own frames.
struct Said {
    std::set<std::uint8_t> permitted;  // SYNC counters; ten of 250 samples share theirs
    std::int64_t sample_us = 0;        // arrival of the axes to which the stop was the reaction
    std::vector<std::uint8_t> emergency;
    std::size_t permits = 0, permits_after_stop = 0;
};

Said said_in(const std::vector<CanFrame>& frames) {
    Said out;
    bool has_stopped = false;
    for (const CanFrame& frame : frames) {
        if (frame.id == kAxes && !has_stopped) {
            out.sample_us = frame.time_us;
        }
        if (frame.id == kPermit && frame.data[0] == 0xA5) {
            out.permitted.insert(frame.data[1]);
            ++out.permits;
            out.permits_after_stop += has_stopped ? 1U : 0U;
        }
        has_stopped = has_stopped || frame.id == kStop;
        if (frame.id == kEmergency && out.emergency.empty()) {
            out.emergency.assign(frame.data.begin(), frame.data.begin() + 4);  // code, pair
        }
    }
    return out;
}

TEST(LiveExchange, IsReplayedToTheSamePermitsAndTheSameStopOrALaterOne) {
    if (!std::filesystem::exists(AXG_PROGRAM)) {
        GTEST_SKIP() << AXG_PROGRAM << " is not built";
    }
    test::Workshop shop;
    const std::string log = test::source_file("tests/replay/golden/live-exchange.log");
    const Said live = said_in(test::read_trace(log));
    EXPECT_GT(live.permits, 200U) << "this shows nothing";
    EXPECT_EQ(live.permits_after_stop, 0U);

    const std::string machine =
        shop.write("m.yaml", test::with_can(test::content_of(test::kPaperMachine),
                                            "  format: fd\n  sample_us: 2000\n"
                                            "  permit_samples: 10\n  stale_after_us: 20000\n") +
                                 "deadline_us: 1000\n");
    ASSERT_EQ(shop.run("replay " + machine + " " + log + " --mesh-root '" +
                       test::source_file("config/machines") +
                       "' --engine cpu --deadline-us 10000000 --json=stops.json"
                       " --frames-out out.log"),
              10)
        << shop.err;
    const auto stop = test::Json::parse(test::content_of(shop.file("stops.json")))["stops"].at(0);
    // The guard that recorded it proved less, so it stopped some samples earlier.
    EXPECT_GE(stop["time_us"], live.sample_us);
    EXPECT_LE(stop["time_us"], live.sample_us + 8 * 2000);
    EXPECT_EQ(stop["reason"], "predicted");
    EXPECT_EQ(stop["pair"], "cutter-c");

    const Said again = said_in(test::read_trace(shop.file("out.log")));
    EXPECT_EQ(again.emergency, live.emergency);
    // The guard had no result in time for a few samples; replay has one for each.
    std::vector<std::uint8_t> missing;
    std::set_difference(live.permitted.begin(), live.permitted.end(), again.permitted.begin(),
                        again.permitted.end(), std::back_inserter(missing));
    EXPECT_LE(missing.size(), GuardLimits{}.snapshots_min) << "but for the first: it is not armed";
}

}  // namespace
}  // namespace axg
