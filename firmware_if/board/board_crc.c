// SPDX-License-Identifier: Apache-2.0
// Both checksums, four bits at a time: 48 bytes of tables, and no loop over bits. Row i of a table:
// what remains of i shifted through the polynomial.
#include "firmware_if/board/board_detail.h"

uint16_t axg_board_crc16(uint16_t crc, const uint8_t bytes[], uint32_t count) {
    static const uint16_t rows[16] = {0x0000U, 0x1021U, 0x2042U, 0x3063U, 0x4084U, 0x50A5U,
                                      0x60C6U, 0x70E7U, 0x8108U, 0x9129U, 0xA14AU, 0xB16BU,
                                      0xC18CU, 0xD1ADU, 0xE1CEU, 0xF1EFU};
    uint32_t sum = crc;
    for (uint32_t i = 0U; i < count; ++i) {
        const uint32_t byte = bytes[i];
        sum = ((sum << 4U) & 0xFFF0U) ^ rows[(sum >> 12U) ^ (byte >> 4U)];
        sum = ((sum << 4U) & 0xFFF0U) ^ rows[(sum >> 12U) ^ (byte & 15U)];
    }
    return (uint16_t)sum;
}

uint8_t axg_board_crc8(uint8_t crc, const uint8_t bytes[], uint32_t count) {
    static const uint8_t rows[16] = {0x00U, 0x2FU, 0x5EU, 0x71U, 0xBCU, 0x93U, 0xE2U, 0xCDU,
                                     0x57U, 0x78U, 0x09U, 0x26U, 0xEBU, 0xC4U, 0xB5U, 0x9AU};
    uint32_t sum = crc;
    for (uint32_t i = 0U; i < count; ++i) {
        const uint32_t byte = bytes[i];
        sum = ((sum << 4U) & 0xF0U) ^ rows[(sum >> 4U) ^ (byte >> 4U)];
        sum = ((sum << 4U) & 0xF0U) ^ rows[(sum >> 4U) ^ (byte & 15U)];
    }
    return (uint8_t)sum;
}

void axg_board_put_little(uint8_t to[], uint32_t value, uint8_t bytes) {
    uint32_t rest = value;
    for (uint32_t i = 0U; i < bytes; ++i) {
        to[i] = (uint8_t)(rest & 0xFFU);
        rest >>= 8U;
    }
}

uint32_t axg_board_get_little(const uint8_t from[], uint8_t bytes) {
    uint32_t value = 0U;
    for (uint32_t i = bytes; i > 0U; --i) {
        value = (value << 8U) | from[i - 1U];
    }
    return value;
}
