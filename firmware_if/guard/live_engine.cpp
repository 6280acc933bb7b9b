// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/guard/live_engine.hpp"

#include <array>

namespace axg {

bool passes_self_test(const LiveEngine& live) noexcept {
    const std::uint32_t mesh = canary_mesh_index(live.machine);
    const std::array<Question, 2> questions{canary_question(mesh, false),
                                            canary_question(mesh, true)};
    std::array<Answer, 2> answers{};
    live.engine.begin();
    live.engine(questions, answers);
    return canary_signature(answers[0], answers[1]) == kCanarySignature;
}

LiveAnswer answer_to(const LiveEngine& live, const LiveQuestion& question,
                     std::uint32_t taken) noexcept {
    LiveAnswer out;
    out.kind = question.kind;
    out.number = question.number;
    out.epoch = question.epoch;
    out.period = question.period;
    out.taken = taken;
    if (question.kind == LiveQuestion::Kind::self_test) {
        out.is_passed = passes_self_test(live);
        return out;
    }
    live.chain.ask();
    out.result = live.chain.decide(question.event.state == ReceiverState::valid, question.is_armed);
    out.sync_counter = question.event.sync_counter;
    out.latched_us = question.event.snapshot.latched_us;
    out.arrived_us = question.event.snapshot.arrived_us;
    return out;
}

}  // namespace axg
