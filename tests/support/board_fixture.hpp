// SPDX-License-Identifier: Apache-2.0
// A board of firmware_if/board as tests drive it: permits made with the guard's checksums, and a
// machine that is armed and moves.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "firmware_if/board/axguard_board.h"
#include "firmware_if/protocol/e2e.hpp"

namespace axg::test {

struct BoardPermit {
    std::uint8_t word = AXG_BOARD_WORD_RUN;
    std::uint32_t number = 0;  // of the sample, from lap 0 on
    std::uint8_t live = 0;
    std::uint8_t cap = 250, mask = 0, samples = 10, level = 0;
    std::uint32_t nonce = 0xC0FFEE;
};

inline axg_board_can_frame classical_frame(std::uint32_t id,
                                           const std::array<std::uint8_t, 8>& data) {
    axg_board_can_frame frame{};
    frame.id = id;
    frame.length = 8;
    std::copy(data.begin(), data.end(), frame.data);
    return frame;
}

/// The plain frame and its inverted twin.
inline std::array<axg_board_can_frame, 2> board_pair(const BoardPermit& permit) {
    const auto echo = static_cast<std::uint8_t>(permit.number % AXG_BOARD_SYNC_MAX + 1);
    const std::uint32_t lap = permit.number / AXG_BOARD_SYNC_MAX;
    const auto last = static_cast<std::uint8_t>(permit.samples << 4U | permit.level);
    const auto byte = [](std::uint32_t value, unsigned index) {
        return static_cast<std::uint8_t>(value >> 8U * index);
    };
    const std::array covered{
        permit.word,           echo,         permit.live,           permit.cap,
        permit.mask,           last,         byte(permit.nonce, 0), byte(permit.nonce, 1),
        byte(permit.nonce, 2), byte(lap, 0), byte(lap, 1)};
    const std::uint32_t answer = crc16_ccitt(covered) ^ 0xC5A3U;
    const std::array<std::uint8_t, 8> plain{
        permit.word,     echo,       permit.live, byte(answer, 0),
        byte(answer, 1), permit.cap, permit.mask, last};
    std::array<std::uint8_t, 8> twin{};
    for (std::size_t i = 0; i < 8; ++i) {
        twin[i] = static_cast<std::uint8_t>(~plain[i]);
    }
    return {classical_frame(0x103, plain), classical_frame(0x104, twin)};
}

/// One board with a period of 1 ms; sample `number` is latched at instant_of(number).
struct BoardFixture {
    explicit BoardFixture(axg_board_cap_kind cap_kind = AXG_BOARD_CAP_IGNORED) {
        options.period_us = 1000;
        options.jitter_us = 20;
        options.reaction_us = 2000;
        options.permit_samples_max = 15;
        options.axis_count = 5;
        options.endless_axes = 0x10;
        options.cap_kind = cap_kind;
        options.permit_id = 0x103;
        options.stop_id = 0x001;
    }

    static constexpr std::uint64_t instant_of(std::uint32_t number) {
        return 100'000 + std::uint64_t{1000} * number;
    }
    bool latch(std::uint32_t number) { return latch_at(number, instant_of(number)); }
    bool latch_at(std::uint32_t number, std::uint64_t at_us) {
        const axg_board_sample sample{
            .latched_us = at_us,
            .lap = static_cast<std::uint16_t>(number / AXG_BOARD_SYNC_MAX),
            .sync = static_cast<std::uint8_t>(number % AXG_BOARD_SYNC_MAX + 1)};
        return axg_board_latch(&board, &sample);
    }
    axg_board_heard hear(const BoardPermit& permit, std::uint64_t at_us) {
        const auto pair = board_pair(permit);
        (void)axg_board_frame(&board, &pair[0], at_us);
        return axg_board_frame(&board, &pair[1], at_us);
    }
    void arm() {
        (void)axg_board_power_up(&board, &options, 0x123456, 0);
        (void)axg_board_arm(&board, 0xC0FFEE, 50'000);
    }
    /// Armed, four samples with a permit each, in motion: the newest is sample 3 with live 4.
    void begin() {
        arm();
        for (std::uint32_t number = 0; number < 4; ++number) {
            (void)latch(number);
            (void)hear({.number = number, .live = static_cast<std::uint8_t>(number + 1)},
                       instant_of(number) + 400);
        }
        axg_board_moves(&board, true, instant_of(3) + 500);
    }
    bool may_move(std::uint64_t at_us) { return axg_board_may_move(&board, at_us).may_move; }

    axg_board_options options{};
    axg_board board{};
};

}  // namespace axg::test
