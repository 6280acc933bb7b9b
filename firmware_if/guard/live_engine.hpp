// SPDX-License-Identifier: Apache-2.0
// The engine's side of the live guard's queues (live_guard.hpp): takes what is asked, asks the
// chain, hands the answers to whoever sends them on. No clock, no thread, no allocation in it.
#pragma once

#include <cstdint>

#include "core/collision/canary.hpp"
#include "firmware_if/guard/guard_chain.hpp"
#include "firmware_if/guard/live_guard.hpp"

namespace axg {

/// `engine` is that of `chain`.
struct LiveEngine {
    const Machine& machine;
    Engine engine;
    GuardChain& chain;
};

/// Both known answers, through the same engine and the same call as every cycle.
[[nodiscard]] bool passes_self_test(const LiveEngine& live) noexcept;

/// What the question comes to, but for `done_us`.
/// @param taken  the last question that was taken before
[[nodiscard]] LiveAnswer answer_to(const LiveEngine& live, const LiveQuestion& question,
                                   std::uint32_t taken) noexcept;

/// Everything that waits. Of several snapshots all are noted, and the newest is asked about. The
/// speed cap of the next answer is looked for when this one is out: a permit waits for no hint.
/// @param publish  takes each LiveAnswer, dates it, and hands it to the bus
template <class Publish>
void answer_questions(const LiveEngine& live, LiveQueues& queues, Publish&& publish) {
    LiveQuestion question, newest;
    bool has_snapshot = false;
    while (queues.questions.pop(question)) {
        switch (question.kind) {
            case LiveQuestion::Kind::reset:
                live.chain.reset();
                has_snapshot = false;
                break;
            case LiveQuestion::Kind::self_test:
                publish(answer_to(live, question, question.number));
                break;
            case LiveQuestion::Kind::ahead:
                live.chain.take(question.event);
                break;
            case LiveQuestion::Kind::snapshot:
                live.chain.take(question.event);
                newest = question;
                has_snapshot = true;
                break;
        }
    }
    if (has_snapshot) {
        publish(answer_to(live, newest, question.number));
        live.chain.advise();  // of what the next permit says besides
    }
}

}  // namespace axg
