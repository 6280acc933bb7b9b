// SPDX-License-Identifier: Apache-2.0
// Garbage on the bus: frames of any content under any identifier between those of a board and a
// guard. The page's state always becomes JSON, and no permit is in force beyond the n of the
// newest ones. AXG_COUNT: frames.
#include "hil_replay/watch/bus_view.hpp"

#include <gtest/gtest.h>

#include <random>

#include "firmware_if/guard/live_ids.hpp"
#include "hil_replay/watch/watch_state.hpp"
#include "tests/support/count.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/watched_frames.hpp"

namespace axg {
namespace {

CanFrame any_frame(std::mt19937_64& random, std::span<const std::uint32_t> ids) {
    CanFrame frame;
    frame.id = random() % 8 == 0 ? static_cast<std::uint32_t>(random() % 0x800)
                                 : ids[random() % ids.size()];
    frame.length_bytes = static_cast<std::uint8_t>(random() % 10 == 0 ? random() % 65 : 8);
    frame.fd = frame.length_bytes > 8 || random() % 16 == 0;
    frame.extended = random() % 16 == 0;
    frame.remote = random() % 16 == 0;
    frame.error = random() % 16 == 0;
    for (std::size_t i = 0; i < frame.length_bytes; ++i) {
        frame.data[i] = static_cast<std::uint8_t>(random());
    }
    return frame;
}

TEST(BusViewProperty, GarbageIsCountedAndTheStateStaysSound) {
    const Machine machine = test::watched_machine();
    BusView view(machine, {});
    std::array<std::uint32_t, kLiveIdsMax> known{};
    const std::span ids(known.data(), live_ids(machine, known));
    std::mt19937_64 random(test::printed_seed(20261127));
    const std::uint64_t count = test::count_from_environment(100'000);
    const std::vector<CanFrame> good = test::watched_frames(machine, 2000);
    std::uint64_t at = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
        CanFrame frame =
            random() % 4 == 0 && at < good.size() ? good[at++] : any_frame(random, ids);
        const std::int64_t now_us = good[std::min<std::uint64_t>(at, good.size() - 1)].time_us;
        frame.time_us = now_us;
        view.on_frame(frame);
        if (i % 50 == 0) {
            view.on_time(now_us);
        }
        const BusState& state = view.state();
        const std::int64_t longest_us = 15 * std::int64_t{machine.can.sample_us};
        ASSERT_TRUE(state.permit_end_us == kNeverSeen ||
                    state.permit_end_us <= now_us + longest_us);
        ASSERT_TRUE(!state.hints || state.hints->pair == kHintNone || state.hints->pair < 2);
        if (i % 1000 == 0) {
            const WatchInput input{.machine = machine,
                                   .configuration = "x",
                                   .bus = &state,
                                   .bus_name = "can0",
                                   .now_us = now_us};
            ASSERT_TRUE(test::Json::accept(watch_json(input)));
        }
    }
    EXPECT_GT(view.state().bad, count / 20);
}

}  // namespace
}  // namespace axg
