// SPDX-License-Identifier: Apache-2.0
// candump's compact log: reader for the whole grammar, writer for the core that every other reader
// agrees on. Grammar and the quirks of other readers: docs/reference/protocol.md, "Logs".
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "firmware_if/cli/whole_file.hpp"
#include "hil_replay/trace/trace_reader.hpp"

namespace axg {

/// @param name  for messages
/// @param text  the log in memory, which must outlive the reader
[[nodiscard]] std::unique_ptr<TraceReader> read_candump(std::string name, std::string_view text,
                                                        const TraceOptions& options);
/// @return null with a message in `error` when the file cannot be opened
[[nodiscard]] std::unique_ptr<TraceReader> open_candump(const std::string& path,
                                                        const TraceOptions& options,
                                                        std::string& error);

/// One line of the common core, newline included: six fraction digits, upper-case hexadecimal, no
/// dots, no raw DLC, FD flags 0..3, ` T` or ` R` only with `directions`. Negative times cannot be
/// written and become 0.
void append_candump(std::string& text, const CanFrame& frame, std::string_view device,
                    bool directions = false);

/// Writes a log. The file gets its name only when it is complete: no reader opens a partial log.
class CandumpWriter {
  public:
    explicit CandumpWriter(const std::string& path, std::string device = "can0",
                           bool directions = false);

    /// False after the first failure; error() is the message, with the file's name. Later calls
    /// do nothing.
    bool write(const CanFrame& frame);
    /// False: a file of the final name is unchanged.
    [[nodiscard]] bool finish();
    [[nodiscard]] const std::string& error() const noexcept { return file_.error(); }
    [[nodiscard]] std::uint64_t frame_count() const noexcept { return frame_count_; }

  private:
    WholeFile file_;
    std::string device_, buffer_;
    bool directions_ = false, is_open_ = false;
    std::uint64_t frame_count_ = 0;
};

}  // namespace axg
