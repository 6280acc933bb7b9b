// SPDX-License-Identifier: Apache-2.0
// Any bytes as a dump of the black box: it ends; what is handed out is plain data within its
// bounds, and is written again as the bytes it was read from. Checksums are made right first for
// every other input, so that the fuzzer reaches what lies behind them.
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "firmware_if/protocol/wire.hpp"
#include "hil_replay/replay/black_box_file.hpp"
#include "tests/fuzz/targets.hpp"

namespace {

void seal(std::span<std::uint8_t> bytes) {
    if (bytes.size() < 4) {
        return;
    }
    const std::size_t end = bytes.size() - 4;
    axg::detail::put_little(bytes.data() + end, axg::crc32(bytes.first(end)), 4);
}

/// Every record that says where it ends gets its checksum, and its place in the sequence.
void seal_all(std::vector<std::uint8_t>& dump) {
    if (dump.size() < axg::kBlackBoxHeaderBytes) {
        return;
    }
    std::copy(axg::kBlackBoxMagic.begin(), axg::kBlackBoxMagic.end(), dump.begin());
    dump[axg::kBlackBoxMagic.size()] = axg::kBlackBoxVersion;
    seal(std::span(dump).first(axg::kBlackBoxHeaderBytes));
    std::span<std::uint8_t> rest = std::span(dump).subspan(axg::kBlackBoxHeaderBytes);
    for (std::uint32_t sequence = 0; rest.size() >= axg::kBlackBoxRecordBytesMin; ++sequence) {
        const std::size_t size = axg::detail::get_little(rest.data(), 2);
        if (size < axg::kBlackBoxRecordBytesMin || size > rest.size()) {
            return;
        }
        axg::detail::put_little(rest.data() + 4, sequence, 4);
        seal(rest.first(size));
        rest = rest.subspan(size);
    }
}

void expect_bounds(const axg::BlackBoxContent& content) {
    if (const auto* arrival = std::get_if<axg::CanArrival>(&content)) {
        if (arrival->frame.length_bytes > (arrival->frame.fd ? 64 : 8)) {
            std::abort();
        }
    } else if (const auto* query = std::get_if<axg::LiveQuery>(&content)) {
        if (query->event.snapshot.axis_count > axg::kAxesMax) {
            std::abort();
        }
    } else if (const auto* note = std::get_if<axg::LiveNote>(&content)) {
        if (std::strlen(note->words) > axg::kBlackBoxRecordBytesMax) {
            std::abort();
        }
    }
}

}  // namespace

int axg::fuzz::black_box(const std::uint8_t* data, std::size_t size) {
    std::vector<std::uint8_t> dump(data, data + size);
    if (size != 0 && data[size - 1] % 2 == 0) {
        seal_all(dump);
    }
    axg::BlackBoxFile file("fuzz", dump);
    axg::BlackBoxRecord record;
    std::size_t at = axg::kBlackBoxHeaderBytes;
    while (file.next(record)) {
        expect_bounds(record.entry.content);
        std::array<std::uint8_t, axg::kBlackBoxRecordBytesMax> again;
        const std::size_t length = encode_black_box_record(record.entry, record.sequence, again);
        if (length != record.size_bytes || at + length > dump.size() ||
            std::memcmp(again.data(), dump.data() + at, length) != 0) {
            std::abort();
        }
        at += length;
    }
    return 0;
}
