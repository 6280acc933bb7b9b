// SPDX-License-Identifier: Apache-2.0
// How near the bodies come in a run: the nearest pair with each tool, and the first sample at which
// a pair is not proven apart. Independent of the guard. mm.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "hil_replay/page/clearance_tracker.hpp"
#include "hil_replay/page/pair_clearances.hpp"

namespace axg {

/// A pair at one sample.
struct NearPair {
    std::uint32_t pair = kNoIndex;  // kNoIndex: none came within the range of the search
    double clearance_mm = kNotNear;
    AxisSnapshot snapshot{};
};

class NearestApproach {
  public:
    /// `loaded` and what `engine` points to must outlive finish().
    /// @param within_mm  no interest beyond
    void begin(const LoadedMachine& loaded, Engine engine, double within_mm);
    void note(const AxisSnapshot& snapshot);
    /// After the last sample: queries the nearest samples again, and releases the engine.
    void finish();

    /// One for each tool, in the order of their use; after finish() with certified clearances.
    [[nodiscard]] std::span<const NearPair> of_tools() const noexcept { return of_tools_; }
    /// The first sample of each pair that is not proven apart.
    [[nodiscard]] std::span<const NearPair> contacts() const noexcept { return contacts_; }

  private:
    [[nodiscard]] NearPair& with_tool(const AxisSnapshot& snapshot);

    std::unique_ptr<ClearanceTracker> bounds_;  // both contain queries by the thousand
    std::unique_ptr<PairClearances> certified_;
    std::vector<bool> touches_;  // [pairs]
    std::vector<NearPair> of_tools_, contacts_;
};

}  // namespace axg
