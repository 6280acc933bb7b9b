// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/page/pair_clearances.hpp"

#include <algorithm>

namespace axg {

PairClearances::PairClearances(const LoadedMachine& loaded, Engine engine, double within_mm)
    : machine_(loaded.machine),
      triangles_(loaded),
      engine_(engine),
      within_mm_(within_mm),
      mm_(machine_.pairs.size()) {}

PageClearances PairClearances::at(const AxisSnapshot& snapshot) {
    std::fill(mm_.begin(), mm_.end(), kNotNear);
    PageClearances out{.mm = mm_};
    make_contact_queries(machine_, snapshot, pair_queries_);
    double least_mm = within_mm_;
    for (std::uint32_t i = 0; pair_queries_.status == SnapshotStatus::ok && i < pair_queries_.count;
         ++i) {
        Query query = pair_queries_.queries[i];
        query.kind = QueryKind::clearance;
        query.r_mm = within_mm_;
        QueryResult result;
        engine_({&query, 1}, {&result, 1});
        const bool is_known = result.status == QueryStatus::ok;
        if (is_known && result.clearance_mm >= within_mm_) {
            continue;
        }
        mm_[pair_queries_.pair[i]] = result.clearance_mm;  // unknown: 0, and no triangles to show
        if (is_known && result.clearance_mm < least_mm) {
            least_mm = result.clearance_mm;
            out.pair = pair_queries_.pair[i];
            out.triangles = triangles_.of(query, result.nearest);
        }
    }
    return out;
}

}  // namespace axg
