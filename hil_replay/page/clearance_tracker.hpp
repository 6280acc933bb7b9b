// SPDX-License-Identifier: Apache-2.0
// Clearances of a motion, sample by sample, at a fraction of the queries: a pair is queried again
// only when its bodies have moved. Between two queries its clearance has shrunk by no more than
// the farthest that any point moved, so the rest is a certified lower bound. mm.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/certificate/pair_queries.hpp"
#include "hil_replay/replay/body_triangles.hpp"
#include "hil_replay/replay/page_samples.hpp"

namespace axg {

/// How far a bound may be below the certified clearance: less than a plot can show.
[[nodiscard]] constexpr double tracking_error_mm(double clearance_mm) noexcept {
    constexpr double kLeastMm = 0.02, kShare = 0.01;
    return clearance_mm * kShare > kLeastMm ? clearance_mm * kShare : kLeastMm;
}

class ClearanceTracker {
  public:
    /// `loaded` and what `engine` points to must outlive it.
    /// @param within_mm  no interest beyond
    ClearanceTracker(const LoadedMachine& loaded, Engine engine, double within_mm);

    /// [pairs] lower bounds: less than the certified clearance by tracking_error_mm of it at most;
    /// kNotNear: beyond within_mm. 0: nothing is certified. Valid until the next call.
    [[nodiscard]] std::span<const double> at(const AxisSnapshot& snapshot);

    /// The certified clearance of the nearest pair. `mm` has one entry of each pair that had to be
    /// queried for it, kNotNear of the others. Valid until the next call.
    /// @param bounds_mm  [pairs] as `at` had them: pairs that cannot be the nearest are left out
    [[nodiscard]] PageClearances nearest(const AxisSnapshot& snapshot,
                                         std::span<const double> bounds_mm);

    [[nodiscard]] std::uint64_t queries() const noexcept { return query_count_; }

  private:
    struct Box {
        Vec3d low{}, high{};
    };
    /// Surfaces, pose and clearance of a pair at its last query.
    struct Known {
        bool is_known = false;
        std::uint32_t mesh_a = 0, mesh_b = 0;
        Pose pose;
        double clearance_mm = 0;
    };

    [[nodiscard]] double moved_mm(const Known& known, const Query& query) const noexcept;
    [[nodiscard]] QueryResult ask(Query query, double within_mm);
    [[nodiscard]] double follow(Known& known, const Query& query);

    const Machine& machine_;
    BodyTriangles triangles_;
    Engine engine_;
    double within_mm_;
    std::vector<Box> boxes_;  // [surfaces of the engine], what a simplified one leaves out included
    std::vector<Known> known_;  // [pairs]
    std::vector<double> mm_;    // [pairs]
    PairQueries pair_queries_;
    std::uint64_t query_count_ = 0;
};

}  // namespace axg
