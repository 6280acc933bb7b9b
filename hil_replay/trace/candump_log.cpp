// SPDX-License-Identifier: Apache-2.0
// The reader. One pass over each line, no copies: the grammar is in docs/reference/protocol.md.
#include "hil_replay/trace/candump_log.hpp"

#include <array>
#include <utility>

#include "hil_replay/trace/candump_line.hpp"
#include "hil_replay/trace/trace_base.hpp"

namespace axg {
namespace {

/// Base class members are made before ours: the lines must exist before TextTrace refers to them.
struct OwnedLines {
    LineSource lines;
};

class CandumpTrace : private OwnedLines, public TextTrace {
  public:
    template <class Source>
    CandumpTrace(std::string name, Source source, const TraceOptions& options)
        : OwnedLines{LineSource(source)}, TextTrace(std::move(name), OwnedLines::lines, options) {}

  protected:
    Line parse(std::string_view line, CanFrame& frame, std::string_view& device,
               LineFault& fault) override {
        if (line[0] == '#') {
            return Line::nothing;  // every reader passes over these, and over blank lines
        }
        if (line.starts_with("DROPCOUNT")) {
            fault = {"dropped frames", line,
                     "a complete trace; frames are missing here: record it again"};
            return Line::fault;
        }
        if (line[0] == '\t' && is_behind_error_) {
            return Line::nothing;  // of candump -e: the error frame above in words
        }
        fault = parse_candump_line(line, frame, device);
        is_behind_error_ = !fault && frame.error;
        if (!has_frame_ && !fault) {
            has_frame_ = true;
            constexpr std::string_view kZero = "(000.000000)";  // -ta and -L write ten digits
            begins_at_zero_ = line.substr(line.find('(')).starts_with(kZero);
        }
        return fault ? Line::fault : Line::frame;
    }

    [[nodiscard]] std::string_view when_time_decreases() const noexcept override {
        return begins_at_zero_ ? "a time that does not decrease; candump -td writes differences, "
                                 "which are no times: record with candump -L or -ta"
                               : TextTrace::when_time_decreases();
    }

  private:
    bool has_frame_ = false, begins_at_zero_ = false, is_behind_error_ = false;
};

}  // namespace

std::unique_ptr<TraceReader> read_candump(std::string name, std::string_view text,
                                          const TraceOptions& options) {
    return std::make_unique<CandumpTrace>(std::move(name), text, options);
}

std::unique_ptr<TraceReader> open_candump(const std::string& path, const TraceOptions& options,
                                          std::string& error) {
    error.clear();
    std::FILE* file = open_text(path, error);
    if (file == nullptr) {
        return nullptr;
    }
    return std::make_unique<CandumpTrace>(path, file, options);
}

}  // namespace axg
