// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/trace/program_lines.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <span>
#include <system_error>

#include "config/text/fault_text.hpp"
#include "config/text/quote_text.hpp"
#include "config/text/small_file.hpp"
#include "config/text/text_line.hpp"
#include "core/base/crc32.hpp"

namespace axg {
namespace {

constexpr std::string_view kTitle = "axguard program lines 3";
constexpr std::size_t kBlockBytesMax = 200;
constexpr std::size_t kProgramNameMax = 4096;
constexpr std::size_t kFileBytesMax = 256U << 20U;

std::uint32_t crc_of(std::string_view text) {
    const std::vector<std::uint8_t> bytes(text.begin(), text.end());
    return crc32(bytes);
}

std::string_view without_blanks(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t\r");
    if (first == std::string_view::npos) {
        return {};
    }
    return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// One line from the front, without its end.
std::string_view take_line(std::string_view& text) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    return line;
}

/// A number from the front, and the blank behind it.
template <typename Number>
bool take_number(std::string_view& text, Number& out, int base = 10) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out, base);
    if (error != std::errc{}) {
        return false;
    }
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    if (!text.empty() && text.front() == ' ') {
        text.remove_prefix(1);
    }
    return true;
}

bool take_key(std::string_view& text, std::string_view key, std::string_view& value) {
    const std::string_view line = take_line(text);
    if (line.substr(0, key.size()) != key) {
        return false;
    }
    value = line.substr(key.size());
    return true;
}

/// 0: it cannot be read.
std::uint32_t crc_of_file(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::array<std::uint8_t, 1U << 16U> bytes{};
    std::uint32_t crc = 0;
    while (file) {
        file.read(reinterpret_cast<char*>(bytes.data()), bytes.size());
        crc = crc32({bytes.data(), static_cast<std::size_t>(file.gcount())}, crc);
    }
    return crc;
}

bool exists(const std::string& path, std::uint64_t& size_bytes) {
    struct stat state {};
    if (stat(path.c_str(), &state) != 0) {
        return false;
    }
    size_bytes = static_cast<std::uint64_t>(state.st_size);
    return true;
}

/// The text without its last line, which is the checksum of what is before it. False: damaged.
bool take_checksum(std::string_view& text) {
    constexpr std::string_view kKey = "crc32 ";
    const std::size_t at = text.rfind("\ncrc32 ");
    if (at == std::string_view::npos) {
        return false;
    }
    std::string_view last = text.substr(at + 1 + kKey.size());
    std::uint32_t sum = 0;
    text = text.substr(0, at + 1);
    return take_number(last, sum, 16) && last == "\n" && sum == crc_of(text);
}

/// Escapes a name with an end of line as for a terminal: no reader opens a file by that name.
std::string on_one_line(const std::string& name) {
    return name.find_first_of("\n\r") == std::string::npos ? name : escaped(name, kProgramNameMax);
}

}  // namespace

std::string program_lines_name(const std::string& trace) {
    return trace + ".lines";
}

void add_program_step(ProgramLines& lines, std::int64_t time_us, std::uint32_t line) {
    if (lines.steps.empty() || lines.steps.back().line != line) {
        lines.steps.push_back({time_us, line, {}});
    }
}

void set_trace(ProgramLines& lines, const std::string& trace) {
    (void)exists(trace, lines.trace_bytes);
    lines.trace_crc = crc_of_file(trace);
}

bool is_program_of(const ProgramLines& lines) {
    std::uint64_t size_bytes = 0;
    return !lines.program.empty() && exists(lines.program, size_bytes) &&
           crc_of_file(lines.program) == lines.program_crc;
}

void add_blocks(ProgramLines& lines, std::string_view program_text) {
    lines.program_crc = crc_of(program_text);
    std::vector<std::string_view> blocks{{}};  // line 0 is none
    while (!program_text.empty()) {
        blocks.push_back(without_blanks(take_text_line(program_text)));
    }
    for (ProgramStep& step : lines.steps) {
        step.block = step.line < blocks.size() ? blocks[step.line].substr(0, kBlockBytesMax)
                                               : std::string_view{};
    }
}

std::string program_lines_text(const ProgramLines& lines) {
    std::string text = fmt::format(
        "{}\nprogram {}\nread_as {}\nprogram_crc32 {:08x}\ntrace_bytes {}\ntrace_crc32 {:08x}\n",
        kTitle, on_one_line(lines.program), on_one_line(lines.read_as), lines.program_crc,
        lines.trace_bytes, lines.trace_crc);
    for (const ProgramStep& step : lines.steps) {
        text += fmt::format("{} {} {}\n", step.time_us, step.line, step.block);
    }
    return text + fmt::format("crc32 {:08x}\n", crc_of(text));
}

std::string read_program_lines(const std::string& name, std::string_view text, ProgramLines& out) {
    out = {};
    std::string damaged = name +
                          ": no program lines: the file is damaged or was written by another "
                          "version. Run axguard simulate again.";
    ProgramLines lines;
    std::string_view program, read_as, crc, bytes, trace_crc;
    if (!take_checksum(text) || take_line(text) != kTitle || !take_key(text, "program ", program) ||
        !take_key(text, "read_as ", read_as) || !take_key(text, "program_crc32 ", crc) ||
        !take_key(text, "trace_bytes ", bytes) || !take_key(text, "trace_crc32 ", trace_crc) ||
        !take_number(crc, lines.program_crc, 16) || !take_number(bytes, lines.trace_bytes) ||
        !take_number(trace_crc, lines.trace_crc, 16)) {
        return damaged;
    }
    lines.program = program;
    lines.read_as = read_as;
    while (!text.empty()) {
        std::string_view line = take_line(text);
        ProgramStep step;
        if (!take_number(line, step.time_us) || !take_number(line, step.line) ||
            (!lines.steps.empty() && step.time_us <= lines.steps.back().time_us)) {
            return damaged;
        }
        step.block = line;
        lines.steps.push_back(std::move(step));
    }
    out = std::move(lines);
    return {};
}

std::string load_program_lines(const std::string& trace, const std::string& path,
                               ProgramLines& out) {
    out = {};
    const std::string name = path.empty() ? program_lines_name(trace) : path;
    std::uint64_t size_bytes = 0;
    std::string text;
    if (!exists(name, size_bytes)) {
        return path.empty() ? std::string{}
                            : name +
                                  ": no program lines: the file does not exist. Pass the file "
                                  "that axguard simulate wrote beside the trace.";
    }
    if (const SmallFileFault fault = read_small_file(name, kFileBytesMax, text);
        !fault.got.empty()) {
        return name + ": no program lines: " + fault_text("invalid file", fault.got, fault.wanted);
    }
    ProgramLines lines;
    if (std::string fault = read_program_lines(name, text, lines); !fault.empty()) {
        return fault;
    }
    if (!exists(trace, size_bytes) || size_bytes != lines.trace_bytes ||
        crc_of_file(trace) != lines.trace_crc) {
        return fmt::format(
            "{}: no program lines: they belong to another trace, of {} bytes and CRC {:08x}; {} "
            "has {} bytes. Run axguard simulate again.",
            name, lines.trace_bytes, lines.trace_crc, trace, size_bytes);
    }
    std::string program;
    std::string note;
    if (read_small_file(lines.program, kFileBytesMax, program).got.empty() &&
        crc_of(program) != lines.program_crc) {
        note = fmt::format(
            "{}: the program changed since the trace was simulated. Lines and blocks are those of "
            "the simulated one.",
            lines.program);
    }
    out = std::move(lines);
    return note;
}

const ProgramStep* step_at(const ProgramLines& lines, std::int64_t time_us) noexcept {
    const auto next = std::upper_bound(
        lines.steps.begin(), lines.steps.end(), time_us,
        [](std::int64_t time, const ProgramStep& step) { return time < step.time_us; });
    if (next == lines.steps.begin() || std::prev(next)->line == 0) {
        return nullptr;
    }
    return &*std::prev(next);
}

std::string format_step_at(const ProgramLines& lines, std::int64_t time_us) {
    const ProgramStep* const step = step_at(lines, time_us);
    return step == nullptr ? std::string{}
                           : fmt::format("  {}:{}: {}\n", escaped(lines.program, kProgramNameMax),
                                         step->line, escaped(step->block));
}

}  // namespace axg
