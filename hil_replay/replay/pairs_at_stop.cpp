// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/replay/pairs_at_stop.hpp"

#include <algorithm>
#include <memory>

#include "firmware_if/explain/format_escapes.hpp"
#include "hil_replay/replay/body_triangles.hpp"

namespace axg {
namespace {

constexpr std::size_t kListed = 4096;  // touching pairs of triangles that are sorted and named

PairAtStop look_at(const ReplayReport& report, const BodyTriangles& named,
                   const PairQueries& pair_queries, std::uint32_t place) {
    PairAtStop out;
    out.pair = pair_queries.pair[place];
    out.margin_mm = report.loaded.machine.pairs[out.pair].margin_mm;
    Query query = pair_queries.queries[place];
    QueryResult result;
    ContainmentResult contained;
    report.engine.run({&query, 1}, {&result, 1});
    report.containment_test.run({&query, 1}, {&result, 1}, {&contained, 1});
    out.containment = contained.containment;
    query.kind = QueryKind::clearance;
    query.r_mm = kStopWithinMm;
    report.engine.run({&query, 1}, {&result, 1});
    out.clearance_mm = result.clearance_mm;
    if (result.status == QueryStatus::ok && result.clearance_mm < kStopWithinMm) {
        out.nearest = named.of(query, result.nearest);
    }
    std::vector<TriangleIds> list(kListed);
    query.kind = QueryKind::touching;
    query.r_mm = 0;
    query.list = list;
    report.engine.run({&query, 1}, {&result, 1});
    out.touching = result.touching;
    out.is_cut_short = result.status != QueryStatus::ok;
    list.resize(std::min<std::size_t>(result.touching, kListed));
    for (TriangleIds& ids : list) {
        ids = named.of(query, ids);
    }
    std::sort(list.begin(), list.end());
    list.resize(std::min<std::size_t>(list.size(), 8));
    out.triangles = std::move(list);
    return out;
}

}  // namespace

std::vector<PairAtStop> pairs_at(const ReplayReport& report, const StopEvent& stop) {
    std::vector<PairAtStop> out;
    const BodyTriangles named(report.loaded);
    const auto pair_queries = std::make_unique<PairQueries>();
    make_contact_queries(report.loaded.machine, stop.snapshot, *pair_queries);
    for (std::uint32_t i = 0; pair_queries->status == SnapshotStatus::ok && i < pair_queries->count;
         ++i) {
        PairAtStop pair = look_at(report, named, *pair_queries, i);
        if (pair.clearance_mm < kStopWithinMm || is_contained(pair)) {
            out.push_back(std::move(pair));
        }
    }
    std::stable_sort(out.begin(), out.end(), [](const PairAtStop& a, const PairAtStop& b) {
        return a.clearance_mm < b.clearance_mm;
    });
    return out;
}

bool is_contained(const PairAtStop& pair) {
    return pair.containment == Containment::a_in_b || pair.containment == Containment::b_in_a;
}

std::pair<std::string, std::string> nested_names(const Machine& machine, const PairAtStop& pair) {
    const std::string& a = machine.bodies[machine.pairs[pair.pair].a].name;
    const std::string& b = machine.bodies[machine.pairs[pair.pair].b].name;
    return pair.containment == Containment::a_in_b ? std::pair{a, b} : std::pair{b, a};
}

Escapes escapes_at(const ReplayReport& report, const StopEvent& stop) {
    AxisSnapshot snapshot = stop.snapshot;
    snapshot.mode = kModeStandstill;
    return find_escapes(report.loaded, report.engine.engine(), report.containment_test, snapshot);
}

bool is_about_distance(StopReason reason) {
    return reason == StopReason::contact || reason == StopReason::contained ||
           reason == StopReason::predicted;
}

}  // namespace axg
