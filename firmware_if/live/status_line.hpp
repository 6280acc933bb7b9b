// SPDX-License-Identifier: Apache-2.0
// The guard's state as one line of JSON, for every client of the status socket. Keys:
// docs/reference/axguardd.md, "State without root".
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/machine/machine.hpp"
#include "firmware_if/explain/stop_desk.hpp"
#include "firmware_if/guard/why_desk.hpp"
#include "firmware_if/live/live_view.hpp"

namespace axg {

enum class RecordState : std::uint8_t { none, this_configuration, another, unreadable };
[[nodiscard]] const char* to_text(RecordState state) noexcept;

/// A test of the board. Frames name no board: a person typed its serial.
struct TestedBoard {
    RecordState state = RecordState::none;
    std::string serial, date;          // empty: none
    std::vector<std::string> differs;  // names of the hashes; another configuration
};

inline constexpr std::size_t kStatusLineBytesMax = 4096;

/// Reasons of a stop and of a withheld permit, from a desk.
struct StatusWhy {
    StopView stop;
    std::optional<PairWhy> withheld;
    std::optional<std::uint16_t> tool;  // of the newest sample
};

/// Writes status lines; stores the part that is the same in every line of a run.
class StatusLine {
  public:
    /// `machine` must outlive it.
    /// @param file  name of the machine file
    StatusLine(const Machine& machine, std::string_view file, std::string_view bus,
               std::string_view mode, std::string_view configuration_sha256,
               const TestedBoard& board_test = {});

    /// @param view  null: the guard has shown nothing yet
    /// @param more  of that view
    /// @param out   kStatusLineBytesMax at least; the line ends with a line feed
    /// @return      how much was written. No allocation
    [[nodiscard]] std::size_t write(const LiveView* view, const StatusWhy& more,
                                    std::int64_t now_us, std::span<char> out) const noexcept;

  private:
    const Machine& machine_;
    std::string head_;  // its keys and values
};

}  // namespace axg
