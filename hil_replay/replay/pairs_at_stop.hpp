// SPDX-License-Identifier: Apache-2.0
// Data on a stop that a report of a replay adds: the near pairs, queried again in full, and the
// ways out.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/collision/containment.hpp"
#include "core/collision/engine.hpp"
#include "core/guard/escape.hpp"
#include "hil_replay/replay/replay_report.hpp"

namespace axg {

inline constexpr double kStopWithinMm = 50.0;

struct PairAtStop {
    std::uint32_t pair = kNoIndex;
    std::uint32_t touching = 0;
    bool is_cut_short = false;                // a list was full: at least so many
    std::vector<TriangleIds> triangles;       // the first few, lowest indices first
    double clearance_mm = 0;                  // kStopWithinMm: nothing nearer
    TriangleIds nearest{kNoIndex, kNoIndex};  // of least clearance, if available
    double margin_mm = 0;
    Containment containment = Containment::not_proven;
};

/// Every pair within kStopWithinMm or nested at the moment of a stop, nearest first.
[[nodiscard]] std::vector<PairAtStop> pairs_at(const ReplayReport& report, const StopEvent& stop);
[[nodiscard]] bool is_contained(const PairAtStop& pair);
/// The inner body's name first.
[[nodiscard]] std::pair<std::string, std::string> nested_names(const Machine& machine,
                                                               const PairAtStop& pair);

/// Returns the ways out of the position at the stop.
[[nodiscard]] Escapes escapes_at(const ReplayReport& report, const StopEvent& stop);

/// Whether reports list pairs and ways out for stops of this reason.
[[nodiscard]] bool is_about_distance(StopReason reason);

}  // namespace axg
