// SPDX-License-Identifier: Apache-2.0
// The certified clearance of every checked pair at one snapshot, beside the cycle: for tables and
// pages. mm.
#pragma once

#include <vector>

#include "core/certificate/pair_queries.hpp"
#include "hil_replay/replay/body_triangles.hpp"
#include "hil_replay/replay/page_samples.hpp"

namespace axg {

class PairClearances {
  public:
    /// `loaded` and what `engine` points to must outlive it.
    /// @param within_mm  no interest beyond
    PairClearances(const LoadedMachine& loaded, Engine engine, double within_mm);

    /// Valid until the next call.
    [[nodiscard]] PageClearances at(const AxisSnapshot& snapshot);

  private:
    const Machine& machine_;
    BodyTriangles triangles_;
    Engine engine_;
    double within_mm_;
    PairQueries pair_queries_;
    std::vector<double> mm_;
};

}  // namespace axg
