// SPDX-License-Identifier: Apache-2.0
// Calls of a board library in any order, with pairs that are damaged as the input says and answered
// rightly, so that the fuzzer reaches what lies behind the answer: no motion before arming or at an
// end, bounds that are granted only up to what a permit orders.
#include <cstdint>
#include <cstdlib>

#include "tests/fuzz/targets.hpp"
#include "tests/support/board_fixture.hpp"

namespace {

void require(bool holds) {
    if (!holds) {
        std::abort();
    }
}

void step(axg::test::BoardFixture& fixture, std::uint32_t& number, std::uint64_t& now_us,
          const std::uint8_t* input) {
    axg_board& board = fixture.board;
    now_us += input[1];
    axg_board_caps bound{};
    switch (input[0] % 8U) {
        case 0:
            ++number;
            now_us += 1000;
            (void)fixture.latch_at(number, now_us);
            break;
        case 1:
            (void)fixture.hear({.word = input[2] % 2U == 0 ? std::uint8_t{0xA5} : input[3],
                                .number = number - std::min<std::uint32_t>(number, input[2] % 18U),
                                .live = static_cast<std::uint8_t>(board.live + input[3] % 17U),
                                .cap = input[4],
                                .mask = input[5],
                                .samples = static_cast<std::uint8_t>(input[6] % 16U),
                                .nonce = board.nonce},
                               now_us);
            break;
        case 2: {
            axg_board_can_frame frame{};
            frame.id = 0x100U + input[2] % 6U;
            frame.length = input[3] % 65U;
            frame.data[input[4] % 64U] = input[5];
            (void)axg_board_frame(&board, &frame, now_us);
            break;
        }
        case 3:
            axg_board_moves(&board, input[2] % 2U != 0, now_us);
            break;
        case 4:
            for (std::uint8_t& one : bound.of) {
                one = input[2];
            }
            bound.of[input[3] % 8U] = input[4];
            bound = axg_board_keeps(&board, &bound, now_us);
            for (const std::uint8_t one : bound.of) {
                require(one <= AXG_BOARD_CAP_NONE);
            }
            break;
        case 5:
            now_us += 20'000;
            (void)axg_board_arm(&board, input[2] * 65'537U, now_us);
            break;
        case 6:
            axg_board_change(&board, input[2] % 2U != 0, now_us);
            break;
        case 7:
            (void)axg_board_announce_tool(&board);
            (void)axg_board_may_change_tool(&board, now_us);
            break;
    }
    const axg_board_motion motion = axg_board_may_move(&board, now_us);
    require(!motion.may_move || (board.phase == AXG_BOARD_ARMED && motion.end_us > now_us &&
                                 motion.end_us <= now_us + 15'000));
}

}  // namespace

int axg::fuzz::board(const std::uint8_t* data, std::size_t size_bytes) {
    constexpr std::size_t kStepBytes = 7;
    axg::test::BoardFixture fixture(size_bytes != 0 && data[0] % 2U != 0 ? AXG_BOARD_CAP_ENFORCED
                                                                         : AXG_BOARD_CAP_IGNORED);
    fixture.arm();
    std::uint32_t number = 0;
    std::uint64_t now_us = 100'000;
    for (std::size_t i = 1; i + kStepBytes <= size_bytes; i += kStepBytes) {
        step(fixture, number, now_us, data + i);
    }
    return 0;
}
