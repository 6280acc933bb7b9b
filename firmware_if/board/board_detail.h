// SPDX-License-Identifier: Apache-2.0
// Shared by the files of this folder. No other code includes it.
#ifndef AXG_BOARD_DETAIL_H
#define AXG_BOARD_DETAIL_H

#include "firmware_if/board/axguard_board.h"

#define AXG_BOARD_ANSWER 0xC5A3U  // signature of the engine's known-answer test
#define AXG_BOARD_CRC16_START 0xFFFFU
#define AXG_BOARD_CRC8_START 0xFFU
#define AXG_BOARD_MODE_JOG 3U

// CRC-16/CCITT-FALSE and CRC-8H2F without its final xor, fed in pieces.
uint16_t axg_board_crc16(uint16_t crc, const uint8_t bytes[], uint32_t count);
uint8_t axg_board_crc8(uint8_t crc, const uint8_t bytes[], uint32_t count);

// Over bytes 1 to 7 of a frame of 8, then the Data ID, low byte first.
uint8_t axg_board_data_crc8(const axg_board_can_frame* frame, uint16_t data_id);

void axg_board_put_little(uint8_t to[], uint32_t value, uint8_t bytes);
uint32_t axg_board_get_little(const uint8_t from[], uint8_t bytes);

// The number of a sample, 0 to AXG_BOARD_SAMPLE_NUMBERS - 1, and then again.
#define AXG_BOARD_SAMPLE_NUMBERS (65536U * AXG_BOARD_SYNC_MAX)
uint32_t axg_board_number_of(const axg_board_sample* sample);
// How many samples `to` is after `from`; more than half of all numbers: it is before.
uint32_t axg_board_samples_from(uint32_t from, uint32_t to);

// Notes the time, and E passed. First in every call with a time.
void axg_board_observe(axg_board* board, uint64_t now_us);
void axg_board_halt(axg_board* board, axg_board_cause cause);
void axg_board_forget(axg_board* board);
axg_board_heard axg_board_refuse(axg_board* board, axg_board_refusal why);

// Two frames of a pair, one after the other.
axg_board_heard axg_board_plain(axg_board* board, const axg_board_can_frame* frame,
                                uint64_t now_us);
axg_board_heard axg_board_twin(axg_board* board, const axg_board_can_frame* frame, uint64_t now_us);

// Caps: section 3 of the rules on docs/reference/board.md.
axg_board_caps axg_board_equal_caps(uint8_t cap);
axg_board_caps axg_board_caps_of(uint8_t cap, uint8_t mask);
bool axg_board_is_below(const axg_board_caps* lower, const axg_board_caps* upper);
void axg_board_open_record(axg_board* board, axg_board_record* record);
// Whether the proof of a permit for this record holds for the speeds since its latch.
bool axg_board_is_covered(const axg_board_record* record, const axg_board_caps* caps);
// Lets the samples name the ordered permit if all bounds are within its caps.
void axg_board_acknowledge(axg_board* board);

#endif
