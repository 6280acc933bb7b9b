// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/trace/candump_log.hpp"

#include <charconv>
#include <utility>

namespace axg {
namespace {

constexpr std::size_t kFlushBytes = std::size_t{1} << 18U;
constexpr char kHex[] = "0123456789ABCDEF";

void append_hex(std::string& text, std::uint32_t value, unsigned digits) {
    for (unsigned i = digits; i-- > 0;) {
        text.push_back(kHex[(value >> (4U * i)) & 15U]);
    }
}

void append_padded(std::string& text, std::int64_t value, std::size_t width) {
    char digits[24];
    const char* end = std::to_chars(digits, digits + sizeof digits, value).ptr;
    const auto length = static_cast<std::size_t>(end - digits);
    text.append(length < width ? width - length : 0, '0');
    text.append(digits, length);
}

}  // namespace

void append_candump(std::string& text, const CanFrame& frame, std::string_view device,
                    bool directions) {
    const std::int64_t time_us = frame.time_us < 0 ? 0 : frame.time_us;
    text.push_back('(');
    append_padded(text, time_us / 1'000'000, 10);
    text.push_back('.');
    append_padded(text, time_us % 1'000'000, 6);
    text.append(") ").append(device).push_back(' ');
    if (frame.error) {
        append_hex(text, (frame.id & 0x1FFFFFFFU) | 0x20000000U, 8);
    } else {
        append_hex(text, frame.id, frame.extended ? 8 : 3);
    }
    text.push_back('#');
    if (frame.remote) {
        text.push_back('R');
        if (frame.length_bytes != 0) {
            text.push_back(static_cast<char>('0' + (frame.length_bytes & 15U)));
        }
    } else {
        if (frame.fd) {
            text.push_back('#');
            append_hex(text, (frame.bit_rate_switch ? 1U : 0U) | (frame.error_state ? 2U : 0U), 1);
        }
        for (std::size_t i = 0; i < frame.length_bytes && i < frame.data.size(); ++i) {
            append_hex(text, frame.data[i], 2);
        }
    }
    if (directions) {
        text.append(frame.sent_by_host ? " T" : " R");
    }
    text.push_back('\n');
}

CandumpWriter::CandumpWriter(const std::string& path, std::string device, bool directions)
    : device_(std::move(device)), directions_(directions), is_open_(file_.open(path)) {
    buffer_.reserve(kFlushBytes + 256);
}

bool CandumpWriter::write(const CanFrame& frame) {
    if (!is_open_) {
        return file_.write({});  // which has the reason
    }
    append_candump(buffer_, frame, device_, directions_);
    ++frame_count_;
    if (buffer_.size() >= kFlushBytes) {
        is_open_ = file_.write(buffer_);
        buffer_.clear();
    }
    return is_open_;
}

bool CandumpWriter::finish() {
    const bool was_open = std::exchange(is_open_, false);
    return was_open && file_.write(buffer_) && file_.finish();
}

}  // namespace axg
