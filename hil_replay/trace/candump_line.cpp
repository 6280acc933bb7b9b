// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/trace/candump_line.hpp"

#include "hil_replay/trace/hex.hpp"

namespace axg {
namespace {

using detail::nibble;

constexpr std::uint32_t kErrorBit = 0x20000000, kExtendedMax = 0x1FFFFFFF, kStandardMax = 0x7FF;
constexpr std::size_t kErrorBytes = 8;

std::string_view rest(const char* at, const char* end) noexcept {
    return {at, static_cast<std::size_t>(end - at)};
}

bool is_digit(char c) noexcept {
    return c >= '0' && c <= '9';
}

void skip_spaces(const char*& at, const char* end) noexcept {
    while (at != end && *at == ' ') {
        ++at;
    }
}

std::string_view word(const char*& at, const char* end) noexcept {
    const char* begin = at;
    while (at != end && *at != ' ') {
        ++at;
    }
    return rest(begin, at);
}

/// `(seconds.fraction)`; six digits are microseconds, nine are nanoseconds and rounded down.
LineFault parse_time(const char*& at, const char* end, std::int64_t& time_us) noexcept {
    const char* begin = at;
    const auto fault = [&](std::string_view wanted) {
        const char* stop = begin;
        while (stop != end && *stop != ')' && *stop != ' ') {
            ++stop;
        }
        return LineFault{"time", rest(begin, stop == end ? end : stop + 1), wanted};
    };
    if (at == end || *at != '(') {
        LineFault foreign = fault("a line that begins with (seconds.fraction)");
        foreign.is_skippable = true;
        return foreign;
    }
    const char* first = ++at;
    std::int64_t seconds = 0;
    for (; at != end && is_digit(*at); ++at) {
        seconds = seconds * 10 + (*at - '0');
        if (at - first >= 12) {
            return fault("at most 12 digits of seconds");
        }
    }
    if (at == first || at == end || *at != '.') {
        return fault("(seconds.fraction): record with candump -ta, -tz or -L");
    }
    const char* point = at++;
    std::int64_t fraction = 0;
    for (; at != end && is_digit(*at) && at - point <= 9; ++at) {
        fraction = fraction * 10 + (*at - '0');
    }
    const auto digits = at - point - 1;
    if (at == end || *at != ')' || (digits != 6 && digits != 9)) {
        return fault("6 or 9 digits after the point, then a parenthesis");
    }
    ++at;
    time_us = seconds * 1'000'000 + (digits == 9 ? fraction / 1000 : fraction);
    return {};
}

/// 3 digits: standard; 8 digits: extended, or an error frame.
LineFault parse_id(std::string_view text, CanFrame& frame) noexcept {
    const LineFault fault{"id", text, "3 hexadecimal digits up to 7FF, or 8 up to 1FFFFFFF"};
    if (text.size() != 3 && text.size() != 8) {
        return fault;
    }
    std::uint32_t id = 0;
    for (const char c : text) {
        const int digit = nibble(c);
        if (digit < 0) {
            return fault;
        }
        id = (id << 4U) | static_cast<std::uint32_t>(digit);
    }
    if (text.size() == 3) {
        frame.id = id;
        return id <= kStandardMax ? LineFault{} : fault;
    }
    frame.error = (id & ~kExtendedMax) == kErrorBit;
    frame.extended = !frame.error;
    frame.id = id & kExtendedMax;
    return frame.error || id <= kExtendedMax ? LineFault{} : fault;
}

/// Bytes with an optional dot before each; stops at the first character that is neither.
LineFault parse_bytes(const char*& at, const char* end, std::size_t bytes_max,
                      CanFrame& frame) noexcept {
    std::size_t count = 0;
    while (at != end && (*at == '.' || nibble(*at) >= 0)) {
        const char* begin = at;
        at += *at == '.' ? 1 : 0;
        const int high = at != end ? nibble(*at) : -1;
        const int low = end - at > 1 ? nibble(at[1]) : -1;
        if (high < 0 || low < 0) {
            return {"data", rest(begin, end), "two hexadecimal digits a byte"};
        }
        if (count == bytes_max) {
            return {"data", rest(begin, end),
                    bytes_max == 8 ? "at most 8 bytes" : "at most 64 bytes"};
        }
        frame.data[count++] = static_cast<std::uint8_t>(high * 16 + low);
        at += 2;
    }
    frame.length_bytes = static_cast<std::uint8_t>(count);
    return {};
}

/// `_9` to `_F` after eight bytes: the length code that was on the wire.
LineFault parse_raw_dlc(const char*& at, const char* end, CanFrame& frame) noexcept {
    if (at == end || *at != '_') {
        return {};
    }
    const char* begin = at++;
    const int dlc = at != end ? nibble(*at) : -1;
    if (dlc < 9 || frame.length_bytes != 8) {
        return {"raw DLC", rest(begin, end), "_9 to _F after a length of 8"};
    }
    ++at;
    frame.raw_dlc = static_cast<std::uint8_t>(dlc);
    return {};
}

LineFault parse_flexible(const char*& at, const char* end, CanFrame& frame) noexcept {
    const int flags = at != end ? nibble(*at) : -1;
    if (flags < 0) {
        return {"flags", rest(at, end), "one hexadecimal digit after ##"};
    }
    ++at;
    frame.fd = true;
    frame.bit_rate_switch = (flags & 1) != 0;
    frame.error_state = (flags & 2) != 0;  // bit 4 repeats "FD", bit 8 has no meaning
    const char* begin = at;
    const LineFault fault = parse_bytes(at, end, 64, frame);
    if (!fault && !is_fd_length(frame.length_bytes)) {
        return {"data", rest(begin, at), "0 to 8, 12, 16, 20, 24, 32, 48 or 64 bytes"};
    }
    return fault;
}

LineFault parse_classical(const char*& at, const char* end, CanFrame& frame) noexcept {
    if (at != end && (*at == 'R' || *at == 'r')) {
        frame.remote = true;
        ++at;
        if (at == end || *at == ' ') {
            return {};
        }
        if (!(*at >= '0' && *at <= '8')) {
            return {"remote frame", rest(at - 1, end), "R, then a length from 0 to 8"};
        }
        frame.length_bytes = static_cast<std::uint8_t>(*at++ - '0');
        return parse_raw_dlc(at, end, frame);
    }
    const LineFault fault = parse_bytes(at, end, 8, frame);
    return fault ? fault : parse_raw_dlc(at, end, frame);
}

/// After the frame: an optional R or T, spaces, nothing else.
LineFault parse_direction(const char* at, const char* end, CanFrame& frame) noexcept {
    const char* begin = at;
    skip_spaces(at, end);
    if (at == end) {
        return {};
    }
    if (at != begin && (*at == 'R' || *at == 'T')) {
        frame.sent_by_host = *at == 'T';
        ++at;
        skip_spaces(at, end);
        if (at == end) {
            return {};
        }
    }
    return {"end of line", rest(begin, end), "nothing after the frame but R or T"};
}

/// python-can writes error frames without their details: 0 bytes.
LineFault check_kind(const CanFrame& frame, std::string_view text) noexcept {
    const bool has_length = frame.length_bytes == kErrorBytes || frame.length_bytes == 0;
    if (frame.error && (frame.fd || frame.remote || !has_length)) {
        return {"error frame", text, "an error frame of 8 bytes, or of none"};
    }
    return {};
}

LineFault parse_compact(const char* at, const char* hash, const char* end,
                        CanFrame& frame) noexcept {
    const char* begin = at;
    const std::string_view id = rest(at, hash);
    if (id.size() == 5) {
        return {"frame", rest(begin, end), "classical or FD frames (CAN XL is not supported)"};
    }
    if (const LineFault fault = parse_id(id, frame)) {
        return fault;
    }
    at = hash + 1;
    const bool is_flexible = at != end && *at == '#';
    at += is_flexible ? 1 : 0;
    const LineFault fault =
        is_flexible ? parse_flexible(at, end, frame) : parse_classical(at, end, frame);
    if (fault) {
        return fault;
    }
    if (at != end && *at != ' ') {
        return {"data", rest(hash + 1, end), "two hexadecimal digits a byte, then a space"};
    }
    if (const LineFault wrong = check_kind(frame, rest(begin, at))) {
        return wrong;
    }
    return parse_direction(at, end, frame);
}

/// `[8]` for classical, `[08]` for FD, `{9}` for a raw DLC.
LineFault parse_length(std::string_view text, CanFrame& frame) noexcept {
    const LineFault fault{"length", text, "[n] or [nn] with a CAN length, or {X} from 9 to F"};
    if (text.size() == 3 && text[0] == '{' && text[2] == '}') {
        const int dlc = nibble(text[1]);
        frame.raw_dlc = static_cast<std::uint8_t>(dlc);
        frame.length_bytes = 8;
        return dlc >= 9 ? LineFault{} : fault;
    }
    const bool is_flexible = text.size() == 4;
    if ((!is_flexible && text.size() != 3) || text.front() != '[' || text.back() != ']') {
        return fault;
    }
    unsigned length = 0;
    for (const char c : text.substr(1, text.size() - 2)) {
        if (!is_digit(c)) {
            return fault;
        }
        length = length * 10 + static_cast<unsigned>(c - '0');
    }
    frame.fd = is_flexible;
    frame.length_bytes = static_cast<std::uint8_t>(length);
    return is_flexible ? (is_fd_length(length) ? LineFault{} : fault)
                       : (length <= 8 ? LineFault{} : fault);
}

LineFault parse_console(const char* at, const char* end, CanFrame& frame) noexcept {
    std::string_view text = word(at, end);
    if (text == "RX" || text == "TX") {  // with -x: direction, bit rate switch, error state
        frame.sent_by_host = text == "TX";
        for (bool* flag : {&frame.bit_rate_switch, &frame.error_state}) {
            skip_spaces(at, end);
            text = word(at, end);
            if (text != "-" && text != "B" && text != "E") {
                return {"flags", text, "-, B or E after RX or TX"};
            }
            *flag = text != "-";
        }
        skip_spaces(at, end);
        text = word(at, end);
    }
    if (const LineFault fault = parse_id(text, frame)) {
        return fault;
    }
    skip_spaces(at, end);
    if (const LineFault fault = parse_length(word(at, end), frame)) {
        return fault;
    }
    skip_spaces(at, end);
    const char* begin = at;
    if (rest(at, end).starts_with("remote request")) {
        frame.remote = true;
        return frame.fd ? LineFault{"remote frame", rest(begin, end),
                                    "a length of one digit, [n]; FD frames cannot be remote"}
                        : check_kind(frame, rest(begin, end));
    }
    for (std::size_t i = 0; i < frame.length_bytes; ++i) {
        const std::string_view byte = word(at, end);
        if (byte.size() != 2 || nibble(byte[0]) < 0 || nibble(byte[1]) < 0) {
            return {"data", rest(begin, end), "as many bytes as the length states"};
        }
        frame.data[i] = static_cast<std::uint8_t>(nibble(byte[0]) * 16 + nibble(byte[1]));
        skip_spaces(at, end);
    }
    if (frame.error && rest(at, end).starts_with("ERRORFRAME")) {
        return check_kind(frame, rest(begin, end));
    }
    const bool is_end = at == end || *at == '\'';  // with -a the bytes follow as text
    return is_end ? check_kind(frame, rest(begin, end))
                  : LineFault{"end of line", rest(at, end), "nothing after the bytes"};
}

}  // namespace

LineFault parse_candump_line(std::string_view line, CanFrame& frame,
                             std::string_view& device) noexcept {
    const char* at = line.data();
    const char* end = at + line.size();
    frame = CanFrame{};
    skip_spaces(at, end);
    if (const LineFault fault = parse_time(at, end, frame.time_us)) {
        return fault;
    }
    const char* gap = at;
    skip_spaces(at, end);
    device = word(at, end);
    if (gap == device.data() || device.empty() || device.size() > 15) {
        return {"interface", device, "a space, then a name of 1 to 15 characters"};
    }
    for (const char c : device) {
        if (c < '!' || c > '~') {
            return {"interface", device, "printable characters"};
        }
    }
    skip_spaces(at, end);
    const char* hash = at;
    while (hash != end && *hash != '#' && *hash != ' ') {
        ++hash;
    }
    if (hash != end && *hash == '#') {
        return parse_compact(at, hash, end, frame);
    }
    return parse_console(at, end, frame);
}

}  // namespace axg
