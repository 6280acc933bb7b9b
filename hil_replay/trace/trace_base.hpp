// SPDX-License-Identifier: Apache-2.0
// Base of all text traces: lines, one interface, time that does not run backwards, and the messages
// about faults.
#pragma once

#include <string>
#include <string_view>

#include "hil_replay/trace/line_source.hpp"
#include "hil_replay/trace/trace_reader.hpp"

namespace axg {

/// Why a line was refused. Views point into the line or to literals; empty `what`: it was not.
struct LineFault {
    std::string_view what;      // the part of the line: "time", "id"
    std::string_view got;       // as written
    std::string_view wanted;    // and what to do, where that is not plain
    bool is_skippable = false;  // the line is probably no frame: --lenient may pass over it
    [[nodiscard]] explicit operator bool() const noexcept { return !what.empty(); }
};

/// Payload lengths that a flexible frame can have.
[[nodiscard]] constexpr bool is_fd_length(std::size_t bytes) noexcept {
    return bytes <= 8 || bytes == 12 || bytes == 16 || bytes == 20 || bytes == 24 || bytes == 32 ||
           bytes == 48 || bytes == 64;
}

class TextTrace : public TraceReader {
  public:
    [[nodiscard]] bool next(CanFrame& frame) final;
    [[nodiscard]] const std::string& error() const noexcept final { return error_; }
    [[nodiscard]] std::uint64_t line() const noexcept final { return line_; }
    [[nodiscard]] std::uint64_t skipped() const noexcept final { return skipped_; }
    [[nodiscard]] std::string first_skipped() const final { return first_skipped_; }
    [[nodiscard]] std::uint64_t events() const noexcept final { return events_; }
    [[nodiscard]] std::string_view device() const noexcept final { return device_; }
    [[nodiscard]] double share() const noexcept final { return lines_.share(); }

  protected:
    TextTrace(std::string name, LineSource& lines, const TraceOptions& options)
        : name_(std::move(name)), options_(options), lines_(lines) {}

    enum class Line : std::uint8_t { frame, nothing, event, fault };
    /// Reads one line: a frame with its interface, nothing (a comment, a header), an event that
    /// has no frame, or a fault.
    [[nodiscard]] virtual Line parse(std::string_view line, CanFrame& frame,
                                     std::string_view& device, LineFault& fault) = 0;
    /// What a line was expected to have, and what to do, where its time is before the last one's.
    [[nodiscard]] virtual std::string_view when_time_decreases() const noexcept {
        return "a time that does not decrease; sort the trace";
    }

  private:
    Line read_line(std::string_view text, CanFrame& frame, std::string_view& device,
                   LineFault& fault);
    bool complain(const LineFault& fault);
    bool accept(const CanFrame& frame, std::string_view device);

    std::string name_;
    TraceOptions options_;
    LineSource& lines_;
    std::string error_, first_skipped_, device_;
    std::uint64_t line_ = 0, skipped_ = 0, events_ = 0;
    bool has_time_ = false;
    std::int64_t last_time_us_ = 0;
};

/// Opens a file for a LineSource, unpacking it where gzip packed it; null with a message in
/// `error`.
[[nodiscard]] std::FILE* open_text(const std::string& path, std::string& error);

}  // namespace axg
