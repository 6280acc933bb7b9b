// SPDX-License-Identifier: Apache-2.0
// Messages between the threads of the live guard: the bus thread submits queries, the engine
// returns results, the logger gets notes. Plain data, copied into queues and into the black box.
#pragma once

#include <cstdint>

#include "core/guard/ack_ledger.hpp"
#include "core/guard/guard_state.hpp"
#include "core/guard/monitor.hpp"
#include "firmware_if/receiver/axis_receiver.hpp"
#include "firmware_if/receiver/receiver_faults.hpp"

namespace axg {

/// To the engine's thread, in order.
struct LiveQuery {
    enum class Kind : std::uint8_t { self_test, snapshot, look_ahead };
    Kind kind = Kind::self_test;
    std::uint32_t number = 0;  // counted up
    std::uint32_t epoch = 0;   // which run since the last reset
    std::uint32_t period = 0;  // of the guard, when it was submitted
    bool is_armed = false;     // the guard, when it was submitted
    ReceiverEvent event;       // snapshot, look_ahead
    CapFacts caps;             // snapshot, of a board that applies caps
};

/// The engine thread's result for its newest query.
struct LiveResult {
    LiveQuery::Kind kind = LiveQuery::Kind::self_test;
    bool is_passed = false;  // self-test
    std::uint32_t number = 0, epoch = 0, period = 0;
    std::uint32_t taken = 0;  // the last query that the engine had read before this result
    CycleResult result;
    std::uint8_t sync_counter = 0;
    std::int64_t latched_us = 0, arrived_us = 0, done_us = 0;
};

/// To the logger, for a line or a record.
struct LiveNote {
    enum class Kind : std::uint8_t {
        phase,     // the guard's phase has changed
        input,     // the receiver gave up
        wire,      // the socket or a frame of ours failed
        refused,   // a person's reset or arm has no effect now
        lost,      // notes were lost: the logger is slow
        hashes,    // the board has another configuration: `words` names the part
        withheld,  // not ready: `pair` is not proven, for `reason`
        motion,    // an axis moves though the frames, or an earlier check, reported standstill
        person,    // an operator's frame resets or arms
    };
    Kind kind = Kind::phase;
    std::int64_t time_us = 0;
    GuardPhase phase = GuardPhase::stopped;
    GuardFault cause = GuardFault::none;
    StopReason reason = StopReason::none;
    std::uint32_t pair = kNoIndex;
    ReceiverFault fault = ReceiverFault::none;
    std::uint32_t frame_id = 0, axis = kNoIndex;
    const char* words = "";  // wire, refused, motion, person: static text
    std::uint32_t count = 0;
    std::uint32_t ours = 0, theirs = 0;  // hashes; of sync_period: ns, measured is theirs
};

}  // namespace axg
