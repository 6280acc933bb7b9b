// SPDX-License-Identifier: Apache-2.0
// The engine's side of the live guard's queues (guard_node.hpp): reads the queries, runs the chain
// and publishes the results. It has no clock, no thread and no allocation.
#pragma once

#include <cstdint>

#include "core/collision/known_answer.hpp"
#include "firmware_if/guard/guard_chain.hpp"
#include "firmware_if/guard/guard_node.hpp"

namespace axg {

struct LiveEngine {
    const Machine& machine;
    GuardChain& chain;
    EvaluationClock clock{};  // measures cycles, off line
};

/// Runs both queries of the known-answer test, with the same engine and call as every cycle.
[[nodiscard]] bool passes_self_test(const LiveEngine& live) noexcept;

/// Result of the query, without `done_us`.
/// @param taken  number of the last query that was read from the queue before
[[nodiscard]] LiveResult live_result_of(const LiveEngine& live, const LiveQuery& query,
                                        std::uint32_t taken) noexcept;

/// Processes all waiting queries. The chain notes every snapshot and evaluates only the newest.
/// It updates the advisories after publishing the result: a permit waits for no advisory.
/// @param publish  receives each LiveResult, dates it, and passes it to the bus thread
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
        live.chain.update_advisories();  // for the next permit
    }
}

}  // namespace axg
