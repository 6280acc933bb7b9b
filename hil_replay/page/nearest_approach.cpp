// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/page/nearest_approach.hpp"

#include <algorithm>

namespace axg {

void NearestApproach::begin(const LoadedMachine& loaded, Engine engine, double within_mm) {
    bounds_ = std::make_unique<ClearanceTracker>(loaded, engine, within_mm);
    certified_ = std::make_unique<PairClearances>(loaded, engine, within_mm);
    touches_.assign(loaded.machine.pairs.size(), false);
    of_tools_.clear();
    contacts_.clear();
}

NearPair& NearestApproach::with_tool(const AxisSnapshot& snapshot) {
    const auto found = std::find_if(
        of_tools_.begin(), of_tools_.end(),
        [&snapshot](const NearPair& one) { return one.snapshot.tool == snapshot.tool; });
    if (found != of_tools_.end()) {
        return *found;
    }
    return of_tools_.emplace_back(NearPair{.snapshot = snapshot});
}

void NearestApproach::note(const AxisSnapshot& snapshot) {
    const std::span<const double> bounds_mm = bounds_->at(snapshot);
    NearPair& nearest = with_tool(snapshot);
    for (std::uint32_t i = 0; i < bounds_mm.size(); ++i) {
        if (bounds_mm[i] < nearest.clearance_mm) {
            nearest = {.pair = i, .clearance_mm = bounds_mm[i], .snapshot = snapshot};
        }
        // A bound of 0 may be below a certified clearance of hundredths.
        if (bounds_mm[i] == 0 && !touches_[i] && certified_->at(snapshot).mm[i] == 0) {
            touches_[i] = true;
            contacts_.push_back({.pair = i, .clearance_mm = 0, .snapshot = snapshot});
        }
    }
}

void NearestApproach::finish() {
    for (NearPair& nearest : of_tools_) {
        if (nearest.pair != kNoIndex) {
            nearest.clearance_mm = certified_->at(nearest.snapshot).mm[nearest.pair];
        }
    }
    bounds_.reset();
    certified_.reset();
}

}  // namespace axg
