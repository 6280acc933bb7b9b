// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/drive/path_judge.hpp"

namespace axg {

void PathJudge::look(std::int64_t time_us, std::span<const AxisMotion> axes, std::uint16_t tool) {
    if (contact_) {
        return;
    }
    ++instants_;
    AxisSnapshot snapshot;
    snapshot.latched_us = snapshot.arrived_us = time_us;
    snapshot.axis_count = static_cast<std::uint32_t>(axes.size());
    snapshot.tool = tool;
    snapshot.mode = kModeMoving;
    for (std::size_t i = 0; i < axes.size(); ++i) {
        snapshot.position[i] = axes[i].position;
    }
    make_contact_queries(machine_, snapshot, *pair_queries_);
    if (pair_queries_->status != SnapshotStatus::ok) {
        return;  // the guard stops for it
    }
    const std::span<Query> queries{pair_queries_->queries.data(), pair_queries_->count};
    for (Query& query : queries) {
        query.r_mm = 0;
    }
    results_.resize(queries.size());
    contained_.resize(queries.size());
    engine_(queries, results_);
    containment_test_.run(queries, results_, contained_);
    for (std::size_t i = 0; i < queries.size() && !contact_; ++i) {
        if (results_[i].proof != Proof::far || contained_[i].containment != Containment::none) {
            contact_ = {.pair = pair_queries_->pair[i], .time_us = time_us, .snapshot = snapshot};
        }
    }
}

}  // namespace axg
