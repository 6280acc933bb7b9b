// SPDX-License-Identifier: Apache-2.0
// Reads a recorded bus of any file format: returns frames in file order, or the first fault.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "firmware_if/can/can_frame.hpp"

namespace axg {

struct TraceOptions {
    bool lenient = false;  // skip and count what cannot be read, where the default is to refuse
    std::string device{};  // only this interface or channel; empty: the trace must hold one only
    std::int64_t backwards_us_max = 0;  // time may step back by this much (logs of several queues)
};

/// Reads frame by frame with fixed memory. After next() returned false: error() is empty at the end
/// of the trace, or holds `FILE:LINE: message`.
class TraceReader {
  public:
    virtual ~TraceReader() = default;
    [[nodiscard]] virtual bool next(CanFrame& frame) = 0;
    [[nodiscard]] virtual const std::string& error() const noexcept = 0;
    [[nodiscard]] virtual std::uint64_t line() const noexcept = 0;  // of the last frame, from 1
    [[nodiscard]] virtual std::uint64_t skipped()
        const noexcept = 0;                                       // lines passed over, lenient only
    [[nodiscard]] virtual std::string first_skipped() const = 0;  // message of the first of them
    [[nodiscard]] virtual std::uint64_t events()
        const noexcept = 0;  // lines passed over that have no frame, as bus statistics
    [[nodiscard]] virtual std::string_view device() const noexcept = 0;  // of the last frame
    // The share of the file that was read, 0 to 1; 0: no estimate, as for a packed file.
    [[nodiscard]] virtual double share() const noexcept = 0;
};

/// How the reading of a trace ended. A report states it, so that partial data are recognisable.
struct TraceEnd {
    std::string fault{};  // empty: read to the end, or as far as needed
    std::uint64_t lines_skipped = 0;
    std::string first_skipped{};  // FILE:LINE: what was wrong with it
};
[[nodiscard]] inline TraceEnd end_of(const TraceReader& trace) {
    return {trace.error(), trace.skipped(), trace.first_skipped()};
}

/// Opens a candump log or a Vector ASC file; the first line that is not blank shows which.
/// @return null with a message in `error` when the file cannot be read or is neither
[[nodiscard]] std::unique_ptr<TraceReader> open_trace(const std::string& path,
                                                      const TraceOptions& options,
                                                      std::string& error);

}  // namespace axg
