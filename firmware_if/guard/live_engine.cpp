// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/guard/live_engine.hpp"

#include <array>

namespace axg {

bool passes_self_test(const LiveEngine& live) noexcept {
    const std::uint32_t mesh = known_answer_mesh_index(live.machine);
    const std::array<Query, 2> queries{known_answer_query(mesh, false),
                                       known_answer_query(mesh, true)};
    std::array<QueryResult, 2> results{};
    live.chain.engine()(queries, results);
    return known_answer_signature(results[0], results[1]) == kKnownAnswerSignature;
}

LiveResult live_result_of(const LiveEngine& live, const LiveQuery& query,
                          std::uint32_t taken) noexcept {
    LiveResult out;
    out.kind = query.kind;
    out.number = query.number;
    out.epoch = query.epoch;
    out.period = query.period;
    out.taken = taken;
    if (query.kind == LiveQuery::Kind::self_test) {
        out.is_passed = passes_self_test(live);
        return out;
    }
    live.chain.evaluate(live.clock);
    out.result = live.chain.decide(query.event.state == ReceiverState::valid, query.is_armed);
    out.sync_counter = query.event.sync_counter;
    out.latched_us = query.event.snapshot.latched_us;
    out.arrived_us = query.event.snapshot.arrived_us;
    return out;
}

}  // namespace axg
