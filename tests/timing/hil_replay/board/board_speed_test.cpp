// SPDX-License-Identifier: Apache-2.0
// A million cycles of the simulated board a second on one core, frames encoded, arbitrated and read
// back by the board; beside it the same with the guard's receiver listening. Least of five passes.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "core/guard/monitor.hpp"
#include "firmware_if/protocol/permit_frames.hpp"
#include "hil_replay/board/approach_driver.hpp"
#include "tests/support/motion_machine.hpp"
#include "tests/support/permit_guard.hpp"

namespace axg::test {
namespace {

constexpr int kCycles = 1'000'000, kPasses = 5;

/// Answers the last axis frame of each sample with a permit: no receiver, no query.
LoopGuard echo_guard(const CanLayout& layout) {
    return {[&layout, sync = std::uint8_t{0}, live = std::uint8_t{0}, session = Session{}](
                const CanFrame& frame, std::vector<CanFrame>& sent) mutable {
                if (frame.id == layout.sync_id) {
                    session.lap = static_cast<std::uint16_t>(session.lap + (frame.data[0] < sync));
                    sync = frame.data[0];
                }
                if (frame.id == layout.session_in_id) {
                    (void)decode_session(frame.id, frame, session);
                }
                if (frame.id == layout.axis_ids.back() && session.nonce != 0) {
                    const Permit permit{.word = PermitWord::run,
                                        .sync_counter = sync,
                                        .live_counter = ++live,
                                        .known_answer_signature = kKnownAnswerSignature,
                                        .samples = layout.permit_samples.most,
                                        .nonce = session.nonce,
                                        .lap = session.lap};
                    const auto pair = encode_permit(layout, permit, frame.time_us + 600);
                    sent.insert(sent.end(), pair.begin(), pair.end());
                }
            },
            nullptr};
}

double least_us_a_cycle(const Machine& machine, bool has_receiver) {
    double least_s = HUGE_VAL;
    for (int pass = 0; pass < kPasses; ++pass) {
        Approach approach;
        approach.target = {250, -200, -300, -1, 5000};
        approach.speed_share.fill(1);
        const double start[5] = {};
        MotionBoard board(machine, start, make_approach(machine, approach), {});
        ClosedLoop loop(board, {},
                        has_receiver ? make_permit_guard(machine, 600) : echo_guard(machine.can));
        const auto begun = std::chrono::steady_clock::now();
        for (int i = 0; i < kCycles; ++i) {
            EXPECT_TRUE(loop.cycle());
        }
        const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begun;
        least_s = std::min(least_s, spent.count());
        EXPECT_EQ(board.state(), BoardState::moving);
        EXPECT_NEAR(board.axes()[0].position, 250, 0.01);
    }
    return least_s * 1e6 / kCycles;
}

TEST(BoardSpeed, AMillionCyclesASecond) {
    const Machine machine = motion_test_machine();
    const double alone_us = least_us_a_cycle(machine, false);
    const double heard_us = least_us_a_cycle(machine, true);
    std::printf(
        "board and wire %.3f us a cycle, %.2f million a second; with the receiver %.3f us\n",
        alone_us, 1 / alone_us, heard_us);
    EXPECT_LE(alone_us, 1.0);
}

}  // namespace
}  // namespace axg::test
