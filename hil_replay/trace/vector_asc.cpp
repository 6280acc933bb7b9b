// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/trace/vector_asc.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "hil_replay/trace/asc_date.hpp"
#include "hil_replay/trace/trace_base.hpp"
#include "hil_replay/trace/words.hpp"

namespace axg {
namespace {

using detail::to_number;
using detail::Words;

constexpr std::uint32_t kBusError = 0x80;     // class of an error frame without further data
constexpr std::uint32_t kFlagFd = 1U << 12U;  // "EDL" in the flags column of a CANFD line
constexpr std::uint32_t kFlagRemote = 1U << 4U;
constexpr std::uint8_t kFdLengths[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64};

char lower(char c) noexcept {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
}

bool starts_with_any_case(std::string_view text, std::string_view start) noexcept {
    return text.size() >= start.size() &&
           std::equal(start.begin(), start.end(), text.begin(),
                      [](char a, char b) { return lower(a) == lower(b); });
}

struct OwnedLines {
    LineSource lines;
};

class AscTrace : private OwnedLines, public TextTrace {
  public:
    template <class Source>
    AscTrace(std::string name, Source source, const TraceOptions& options)
        : OwnedLines{LineSource(source)}, TextTrace(std::move(name), OwnedLines::lines, options) {}

  protected:
    Line parse(std::string_view line, CanFrame& frame, std::string_view& device,
               LineFault& fault) override;

  private:
    bool parse_header(std::string_view line, LineFault& fault);
    bool parse_stamp(std::string_view word, std::int64_t& time_us) const;
    Line parse_classical(Words& words, CanFrame& frame, LineFault& fault) const;
    Line parse_flexible(Words& words, CanFrame& frame, std::string_view& device,
                        LineFault& fault) const;
    LineFault parse_id(std::string_view word, CanFrame& frame) const;
    LineFault parse_data(Words& words, std::size_t count, CanFrame& frame) const;

    int base_ = 0;  // 16 or 10 once the header has stated it
    bool is_relative_ = false;
    std::int64_t start_us_ = 0;
    std::int64_t last_us_ = 0;  // stamp of the last event, since the start
};

/// True if this is a line of the header or between blocks; it may still be a wrong one.
bool AscTrace::parse_header(std::string_view line, LineFault& fault) {
    Words words(line);
    const std::string_view first = words.peek();
    if (first.empty() || first.starts_with("//")) {
        return true;
    }
    if (first == "date") {
        words.next();
        const std::string_view date = words.rest();
        if (!parse_asc_date(date, start_us_)) {
            fault = {"date", date, "weekday, month, day, hh:mm:ss[.mmm] [am|pm], year"};
        }
        return true;
    }
    if (first == "base") {
        words.next();
        const std::string_view base = words.next(), key = words.next(), mode = words.next();
        const bool is_known = (base == "hex" || base == "dec") && key == "timestamps" &&
                              (mode == "absolute" || mode == "relative") && words.rest().empty();
        base_ = base == "hex" ? 16 : 10;
        is_relative_ = mode == "relative";
        if (!is_known) {
            fault = {"base", line, "base hex|dec  timestamps absolute|relative"};
        }
        return true;
    }
    const std::string_view whole = words.rest();
    return starts_with_any_case(whole, "internal events logged") ||
           starts_with_any_case(whole, "no internal events logged") ||
           starts_with_any_case(whole, "begin triggerblock") ||
           starts_with_any_case(whole, "end triggerblock");
}

/// Seconds with 1 to 9 digits after the point, rounded down to microseconds.
bool AscTrace::parse_stamp(std::string_view word, std::int64_t& time_us) const {
    const std::size_t point = word.find('.');
    std::uint32_t seconds = 0, fraction = 0;
    if (point == std::string_view::npos || !to_number(word.substr(0, point), 10, ~0U, seconds)) {
        return false;
    }
    const std::string_view digits = word.substr(point + 1);
    if (digits.size() > 9 || !to_number(digits, 10, 999'999'999, fraction)) {
        return false;
    }
    std::int64_t nanoseconds = fraction;
    for (std::size_t i = digits.size(); i < 9; ++i) {
        nanoseconds *= 10;
    }
    time_us = seconds * std::int64_t{1'000'000} + nanoseconds / 1000;
    if (is_relative_) {
        time_us += last_us_;
    }
    return true;
}

LineFault AscTrace::parse_id(std::string_view word, CanFrame& frame) const {
    frame.extended = !word.empty() && (word.back() == 'x' || word.back() == 'X');
    const std::string_view digits = word.substr(0, word.size() - (frame.extended ? 1 : 0));
    if (!to_number(digits, base_, frame.extended ? 0x1FFFFFFFU : 0x7FFU, frame.id)) {
        return {"id", word, "a standard id up to 7FF, or an extended one with x behind it"};
    }
    return {};
}

LineFault AscTrace::parse_data(Words& words, std::size_t count, CanFrame& frame) const {
    for (std::size_t i = 0; i < count; ++i) {
        const std::string_view word = words.next();
        std::uint32_t byte = 0;
        if (word.size() > 3 || !to_number(word, base_, 255, byte)) {
            return {"data", word, "as many bytes as the length states, in the base of the header"};
        }
        frame.data[i] = static_cast<std::uint8_t>(byte);
    }
    frame.length_bytes = static_cast<std::uint8_t>(count);
    return {};
}

void make_error_frame(CanFrame& frame) noexcept {
    const std::int64_t time_us = frame.time_us;
    frame = CanFrame{};
    frame.time_us = time_us;
    frame.error = true;
    frame.id = kBusError;
    frame.length_bytes = 8;
}

bool parse_direction(std::string_view word, CanFrame& frame) noexcept {
    frame.sent_by_host = word == "Tx";
    return word == "Rx" || word == "Tx";
}

/// `id[x] Rx|Tx d|r dlc bytes [Length = ...]`, after time and channel.
TextTrace::Line AscTrace::parse_classical(Words& words, CanFrame& frame, LineFault& fault) const {
    const std::string_view id = words.next();
    if (id == "ErrorFrame") {
        make_error_frame(frame);
        return Line::frame;  // what follows differs from writer to writer and adds no position
    }
    fault = parse_id(id, frame);
    if (fault) {
        return Line::fault;
    }
    const std::string_view direction = words.next();
    if (direction == "TxRq") {
        return Line::nothing;  // requested, not sent: the sent frame has its own line
    }
    if (!parse_direction(direction, frame)) {
        fault = {"direction", direction, "Rx, Tx or TxRq"};
        return Line::fault;
    }
    const std::string_view kind = words.next();
    frame.remote = kind == "r";
    if (kind != "d" && kind != "r") {
        fault = {"frame kind", kind, "d or r"};
        return Line::fault;
    }
    std::uint32_t dlc = 0;
    const bool has_dlc = !frame.remote || (!words.peek().empty() && words.peek() != "Length");
    const std::string_view dlc_word = has_dlc ? words.next() : std::string_view{};
    if (has_dlc && !to_number(dlc_word, base_, 15, dlc)) {
        fault = {"length", dlc_word, "0 to 8, or a raw DLC up to 15"};
        return Line::fault;
    }
    frame.raw_dlc = static_cast<std::uint8_t>(dlc > 8 ? dlc : 0);
    frame.length_bytes = static_cast<std::uint8_t>(std::min(dlc, 8U));
    if (!frame.remote) {
        fault = parse_data(words, frame.length_bytes, frame);
    }
    if (!fault && !words.rest().empty() && words.peek() != "Length") {
        fault = {"end of line", words.rest(), "nothing after the bytes but Length = ..."};
    }
    return fault ? Line::fault : Line::frame;
}

/// `CANFD chan Rx|Tx id[x] [name] brs esi dlc length bytes [duration bits flags ...]`, after the
/// time.
TextTrace::Line AscTrace::parse_flexible(Words& words, CanFrame& frame, std::string_view& device,
                                         LineFault& fault) const {
    words.next();  // CANFD
    device = words.next();
    const std::string_view direction = words.next();
    if (direction == "TxRq") {
        return Line::nothing;
    }
    if (!parse_direction(direction, frame)) {
        fault = {"direction", direction, "Rx, Tx or TxRq"};
        return Line::fault;
    }
    const std::string_view id = words.next();
    if (id == "ErrorFrame") {
        make_error_frame(frame);
        return Line::frame;
    }
    fault = parse_id(id, frame);
    if (fault) {
        return Line::fault;
    }
    if (words.peek() != "0" && words.peek() != "1") {
        words.next();  // the symbolic name, which no number can be
    }
    const std::string_view brs = words.next(), esi = words.next(), dlc_word = words.next();
    const std::string_view length_word = words.next();
    std::uint32_t brs_bit = 0, esi_bit = 0, dlc = 0, length = 0;
    if (!to_number(brs, 10, 1, brs_bit) || !to_number(esi, 10, 1, esi_bit) ||
        !to_number(dlc_word, dlc_word.size() == 1 ? 16 : 10, 15, dlc) ||
        !to_number(length_word, 10, 64, length) || (length != kFdLengths[dlc] && length != 0)) {
        fault = {"CANFD", words.rest(), "brs esi dlc length, the length being that of the dlc"};
        return Line::fault;
    }
    frame.bit_rate_switch = brs_bit != 0;
    frame.error_state = esi_bit != 0;
    fault = parse_data(words, length, frame);
    if (fault) {
        return Line::fault;
    }
    std::uint32_t duration = 0, bits = 0, flags = 0;
    if (!words.rest().empty() &&
        (!to_number(words.next(), 10, ~0U, duration) || !to_number(words.next(), 10, ~0U, bits) ||
         !to_number(words.next(), 16, ~0U, flags))) {
        fault = {"CANFD", words.rest(), "duration, bits and flags after the bytes"};
        return Line::fault;
    }
    // A channel that can do FD carries classical frames too; the flags distinguish them, if the
    // writer sets any.
    const bool is_classical = flags != 0 && (flags & kFlagFd) == 0;
    frame.fd = !is_classical;
    frame.remote = is_classical && (flags & kFlagRemote) != 0;
    const bool is_possible = frame.fd ? length == kFdLengths[dlc] : length <= 8;
    if (!is_possible) {
        fault = {"length", length_word, "a length that this kind of frame can have"};
        return Line::fault;
    }
    frame.length_bytes =
        frame.remote ? static_cast<std::uint8_t>(std::min(dlc, 8U)) : frame.length_bytes;
    return Line::frame;
}

/// In English and German; where the channels can do FD, behind CANFD.
bool is_start(Words words) noexcept {
    if (words.peek() == "CANFD") {
        words.next();
    }
    return starts_with_any_case(words.rest(), "start of measurement") ||
           starts_with_any_case(words.rest(), "start der messung");
}

/// Begins an event of CANoe itself, or of a bus that is not CAN.
bool is_of_no_can(std::string_view word) noexcept {
    constexpr std::array<std::string_view, 13> kWords{"SV:",  "TFS:", "ETH",       "Fr",  "AFDX",
                                                      "A429", "WLAN", "J1708",     "M25", "M50",
                                                      "M150", "Li",   "GPS-Event:"};
    std::uint32_t channel = 0;  // L2 is the second channel of LIN
    return std::find(kWords.begin(), kWords.end(), word) != kWords.end() ||
           (word.starts_with('L') && to_number(word.substr(1), 10, 255, channel));
}

/// Chip status, bus statistics, system and environment variables, triggers, other buses, overload
/// frames, which carry nothing, and messages that CANoe's transport layer put together from frames,
/// which have lines of their own.
bool is_event_without_frame(Words words) noexcept {
    if (starts_with_any_case(words.rest(), "log trigger") ||
        starts_with_any_case(words.rest(), "log direct")) {
        return true;
    }
    std::string_view word = words.next();
    if (is_of_no_can(word) || words.peek() == ":=") {
        return true;
    }
    if (word == "CAN" || word == "CANFD") {
        word = words.next();
    }
    std::uint32_t channel = 0;
    const std::string_view event = words.next();
    return to_number(word, 10, 255, channel) &&
           (event.starts_with("Status:") || event.starts_with("Statistic:") || event == "J1939TP" ||
            event == "OverloadFrame");
}

TextTrace::Line AscTrace::parse(std::string_view line, CanFrame& frame, std::string_view& device,
                                LineFault& fault) {
    if (parse_header(line, fault)) {
        return fault ? Line::fault : Line::nothing;
    }
    frame = CanFrame{};
    Words words(line);
    const std::string_view stamp = words.next();
    std::int64_t time_us = 0;
    if (!parse_stamp(stamp, time_us)) {
        fault = {"line", line, "a header, a comment, or seconds.fraction and an event", true};
        return Line::fault;
    }
    last_us_ = time_us;
    frame.time_us = start_us_ + time_us;
    const std::string_view event = words.peek();
    if (is_start(words)) {
        return Line::nothing;
    }
    if (is_event_without_frame(words)) {
        return Line::event;
    }
    if (base_ == 0) {
        fault = {"header", line, "a line base hex|dec before the first frame"};
        return Line::fault;
    }
    if (event == "CANFD") {
        return parse_flexible(words, frame, device, fault);
    }
    std::uint32_t channel = 0;
    if (!to_number(event, 10, 255, channel)) {
        fault = {"event", words.rest(), "a channel, CANFD or Start of measurement", true};
        return Line::fault;
    }
    device = words.next();
    return parse_classical(words, frame, fault);
}

}  // namespace

std::unique_ptr<TraceReader> read_asc(std::string name, std::string_view text,
                                      const TraceOptions& options) {
    return std::make_unique<AscTrace>(std::move(name), text, options);
}

std::unique_ptr<TraceReader> open_asc(const std::string& path, const TraceOptions& options,
                                      std::string& error) {
    error.clear();
    std::FILE* file = open_text(path, error);
    return file == nullptr ? nullptr : std::make_unique<AscTrace>(path, file, options);
}

}  // namespace axg
