// SPDX-License-Identifier: Apache-2.0
// The guard's state as one line of JSON, for every client of the status socket, and that line in
// words. Keys: docs/reference/axguardd.md, "State without root".
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/machine/machine.hpp"
#include "firmware_if/axguardd/board_test_record.hpp"
#include "firmware_if/axguardd/metrics.hpp"
#include "firmware_if/guard/why_desk.hpp"

namespace axg {

inline constexpr std::size_t kStatusLineBytesMax = 4096;

/// Writes status lines; stores the part that is the same in every line of a run.
class StatusLine {
  public:
    /// `machine` must outlive it.
    StatusLine(const Machine& machine, std::string_view bus, std::string_view mode,
               std::string_view configuration_sha256, const FoundRecord& board_test = {});

    /// @param view  null: the guard has shown nothing yet
    /// @param why   of that view
    /// @param out   kStatusLineBytesMax at least; the line ends with a line feed
    /// @return      how much was written. No allocation
    [[nodiscard]] std::size_t write(const LiveView* view, const GuardWhy& why, std::int64_t now_us,
                                    std::span<char> out) const noexcept;

  private:
    const Machine& machine_;
    std::string head_;  // its keys and values
};

/// A line as a person reads it.
struct StatusWords {
    std::string text;  // without a character that steers a terminal
    std::string json;  // the line, in ASCII
    int exit_code =
        0;  // as of `axguardd run`: that of the stop's cause; 11: the guard shows nothing
};
/// @return  empty if a key is missing or has another type, or the name of phase or cause is unknown
[[nodiscard]] std::optional<StatusWords> words_of_status(std::string_view line);

}  // namespace axg
