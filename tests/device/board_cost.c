// SPDX-License-Identifier: Apache-2.0
// Bare metal for a Cortex-M4 under qemu (mps2-an386): the calls of the board library, each between
// two marks that board_cost.py looks for in the trace of executed instructions.
#include "firmware_if/board/axguard_board.h"

int main(void);
void axg_mark_begin(uint32_t what);
void axg_mark_end(void);
void reset(void);

static axg_board board;
static axg_board_can_frame frames[AXG_BOARD_CLASSICAL_FRAMES_MAX];
static uint32_t live;
extern uint32_t axg_stack_top;

__attribute__((section(".vectors"), used)) static const void* const vectors[2] = {
    &axg_stack_top, (const void*)&reset};

// gcc calls these for structs.
void* memset(void* to, int value, unsigned size) {
    unsigned char* at = to;
    while (size-- != 0U) {
        *at++ = (unsigned char)value;
    }
    return to;
}
void* memcpy(void* to, const void* from, unsigned size) {
    unsigned char* at = to;
    const unsigned char* source = from;
    while (size-- != 0U) {
        *at++ = *source++;
    }
    return to;
}

__attribute__((noinline)) void axg_mark_begin(uint32_t what) {
    __asm volatile("" ::"r"(what));
}
__attribute__((noinline)) void axg_mark_end(void) {
    __asm volatile("");
}

static uint32_t crc16(const uint8_t bytes[], uint32_t count) {
    uint32_t crc = 0xFFFFU;
    for (uint32_t i = 0U; i < count * 8U; ++i) {
        const uint32_t bit = ((crc >> 15U) ^ ((uint32_t)bytes[i / 8U] >> (7U - i % 8U))) & 1U;
        crc = ((crc << 1U) & 0xFFFFU) ^ (bit * 0x1021U);
    }
    return crc;
}

// The pair of a permit for the newest sample; `wrong` spoils the answer.
static void make_pair(uint8_t cap, uint32_t wrong) {
    const uint8_t echo = board.newest.sync;
    ++live;
    const uint8_t covered[11] = {0xA5,
                                 echo,
                                 (uint8_t)live,
                                 cap,
                                 0xFF,
                                 0xA0,
                                 (uint8_t)board.nonce,
                                 (uint8_t)(board.nonce >> 8U),
                                 (uint8_t)(board.nonce >> 16U),
                                 (uint8_t)board.newest.lap,
                                 (uint8_t)(board.newest.lap >> 8U)};
    const uint32_t answer = crc16(covered, 11U) ^ 0xC5A3U ^ wrong;
    const uint8_t plain[8] = {0xA5, echo, (uint8_t)live, (uint8_t)answer, (uint8_t)(answer >> 8U),
                              cap,  0xFF, 0xA0};
    for (uint32_t i = 0U; i < 8U; ++i) {
        frames[0].data[i] = plain[i];
        frames[1].data[i] = (uint8_t)~plain[i];
    }
    frames[0].id = 0x103U;
    frames[1].id = 0x104U;
    frames[0].length = frames[1].length = 8U;
    frames[0].is_fd = frames[1].is_fd = false;
}

static void hear(uint32_t what, uint8_t cap, uint32_t wrong, uint64_t now_us) {
    make_pair(cap, wrong);
    axg_mark_begin(what);
    (void)axg_board_frame(&board, &frames[0], now_us);
    axg_mark_end();
    axg_mark_begin(what + 1U);
    (void)axg_board_frame(&board, &frames[1], now_us);
    axg_mark_end();
}

int main(void) {
    static const axg_board_axis_ids ids[3] = {{0x181, 0x181}, {0x281, 0x281}, {0x381, 0x381}};
    static const int32_t positions[5] = {100000, -50500, 0, -300000, 2712500};
    const axg_board_says says = {.mode = 1, .tool = 1, .is_homed = true};
    const axg_board_options options = {.period_us = 1000,
                                       .permit_samples_max = 15,
                                       .axis_count = 5,
                                       .endless_axes = 16,
                                       .cap_kind = AXG_BOARD_CAP_ENFORCED,
                                       .permit_id = 0x103,
                                       .stop_id = 1};
    axg_board_caps caps;
    axg_board_sample sample = {.latched_us = 100000, .lap = 3, .sync = 1};
    for (uint32_t i = 0U; i < AXG_BOARD_CAP_GROUPS; ++i) {
        caps.of[i] = 250U;
    }
    (void)axg_board_power_up(&board, &options, 1U, 0U);
    (void)axg_board_arm(&board, 0xC0FFEEU, 50000U);
    for (uint32_t i = 0U; i < 20U; ++i) {
        sample.latched_us += 1000U;
        ++sample.sync;
        axg_mark_begin(2U);
        (void)axg_board_latch(&board, &sample);
        axg_mark_end();
        hear(4U, 250U, 0U, sample.latched_us + 400U);
        hear(6U, 250U, 1U, sample.latched_us + 500U);
        --live;
        axg_mark_begin(8U);
        (void)axg_board_may_move(&board, sample.latched_us + 500U);
        axg_mark_end();
    }
    axg_mark_begin(1U);
    axg_mark_end();
    board.options.axis_count = 8U;
    axg_mark_begin(9U);  // all eight bounds rise, in all records
    caps = axg_board_keeps(&board, &caps, sample.latched_us + 600U);
    axg_mark_end();
    board.options.axis_count = 5U;
    axg_mark_begin(10U);
    (void)axg_board_encode_classical(&board, &says, positions, ids, frames);
    axg_mark_end();
    axg_mark_begin(11U);
    (void)axg_board_encode_fd(&board, &says, positions, ids[0], frames);
    axg_mark_end();
    axg_mark_begin(12U);
    (void)axg_board_encode_session(&board, ids[0], sample.latched_us, frames);
    axg_mark_end();
    frames[0].id = 1U;
    axg_mark_begin(13U);
    (void)axg_board_frame(&board, &frames[0], sample.latched_us + 700U);
    axg_mark_end();
    // 0: nothing went wrong; the trace ends with it.
    axg_mark_begin(((caps.of[7] == 250U) && (board.permits == 19U) &&
                    (board.refused[AXG_BOARD_REFUSED_ANSWER] == 20U))
                       ? 0U
                       : 99U);
    return 0;
}

void reset(void) {
    (void)main();
    for (;;) {
        register uint32_t call __asm("r0") = 0x18U;  // semihosting: exit
        register uint32_t why __asm("r1") = 0x20026U;
        __asm volatile("bkpt 0xAB" ::"r"(call), "r"(why) : "memory");
    }
}
