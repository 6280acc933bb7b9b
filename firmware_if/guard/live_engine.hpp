// SPDX-License-Identifier: Apache-2.0
// The engine's side of the live guard's queues (guard_node.hpp): takes the queries, runs the
// chain, hands the results to whoever sends them on. No clock, no thread, no allocation in it.
#pragma once

#include <cstdint>

#include "core/collision/known_answer.hpp"
#include "firmware_if/guard/guard_chain.hpp"
#include "firmware_if/guard/guard_node.hpp"

namespace axg {

struct LiveEngine {
    const Machine& machine;
    GuardChain& chain;
    EvaluationClock clock{};  // what cycles are measured with, off line
};

/// Both known answers, through the same engine and the same call as every cycle.
[[nodiscard]] bool passes_self_test(const LiveEngine& live) noexcept;

/// Result of the query, without `done_us`.
/// @param taken  the last query that was taken before
[[nodiscard]] LiveResult live_result_of(const LiveEngine& live, const LiveQuery& query,
                                        std::uint32_t taken) noexcept;

/// Everything that waits. Of several snapshots all are noted, and the newest is queried. The
/// speed cap of the next result is looked for when this one is out: a permit waits for no advisory.
/// @param publish  takes each LiveResult, dates it, and hands it to the bus
template <class Publish>
void run_queries(const LiveEngine& live, LiveQueues& queues, Publish&& publish) {
    LiveQuery query, newest;
    bool has_snapshot = false;
    while (queues.queries.pop(query)) {
        switch (query.kind) {
            case LiveQuery::Kind::self_test:
                publish(live_result_of(live, query, query.number));
                break;
            case LiveQuery::Kind::look_ahead:
                live.chain.take(query.event);
                break;
            case LiveQuery::Kind::snapshot:
                live.chain.take(query.event, query.caps);
                newest = query;
                has_snapshot = true;
                break;
        }
    }
    if (has_snapshot) {
        publish(live_result_of(live, newest, query.number));
        live.chain.update_advisories();  // of what the next permit says besides
    }
}

}  // namespace axg
