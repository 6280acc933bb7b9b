// SPDX-License-Identifier: Apache-2.0
// Vector's ASC trace in text form: classical and CANFD lines, error frames, remote frames; base hex
// and dec; absolute and relative stamps. Anything else is an error with its line: a guard does not
// guess what a line meant.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "hil_replay/trace/trace_reader.hpp"

namespace axg {

/// Times are microseconds since 1970 as the header's date and the stamps give them; the file names
/// no time zone, so the date is read as UTC. The interface of a frame is its channel, "1". An
/// ErrorFrame line becomes an error frame of class "bus error" (0x80) of 8 bytes: the rest of
/// the line differs from writer to writer.
/// @param text  the trace in memory, which must outlive the reader
[[nodiscard]] std::unique_ptr<TraceReader> read_asc(std::string name, std::string_view text,
                                                    const TraceOptions& options);
/// @return null with a message in `error` when the file cannot be opened
[[nodiscard]] std::unique_ptr<TraceReader> open_asc(const std::string& path,
                                                    const TraceOptions& options,
                                                    std::string& error);

}  // namespace axg
