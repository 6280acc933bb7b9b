// SPDX-License-Identifier: Apache-2.0
// The state machine of the guard: computes permission or stop from faults, verdicts and a person's
// orders, as a pure function over a plain struct. core/guard/monitor.hpp computes the verdict of
// one cycle, which is one event among others here. docs/reference/states.md lists every row, its
// proofs and its assumptions.
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/guard/monitor.hpp"

namespace axg {

/// Zeroed memory is stopped.
enum class GuardPhase : std::uint8_t {
    stopped = 0,  // latched; only a reset leaves it, to init
    init,         // silent: files are read; no evidence yet
    selftest,     // the self-test runs, snapshots are counted, no permits are sent
    ready,        // healthy snapshots, self-test passed, own frames received; permission off
    armed,        // permission on, period by period
};
inline constexpr std::uint32_t kGuardPhases = 5;

enum class GuardFault : std::uint8_t {
    none = 0,
    // reported: a period with one counts as a bad one, and too many bad ones stop
    input_noise,  // frames dropped, samples lost
    recorder,     // records lost
    // at once
    input,         // the receiver gave up
    verdict,       // the monitor stopped: contact, containment, known-answer test, engine ...
    engine,        // the engine is lost or silent beyond its deadline
    gap,           // the process itself did not run
    second_guard,  // our frames from another sender
    refused,       // configuration, device or versions not fit; self-test failed
    // found here
    silence,   // the last permit has ended
    flapping,  // the leaky count of bad periods is full
    output,    // a frame did not get out while armed
    latched,   // the stop of an earlier run
    // at once; last, because black boxes store the numbers
    foreign_stop,  // a stop frame from another sender
};
inline constexpr GuardFault kGuardFaultLast = GuardFault::foreign_stop;
[[nodiscard]] const char* to_text(GuardPhase phase) noexcept;
[[nodiscard]] const char* to_text(GuardFault fault) noexcept;

/// Whether a fault only makes its period a bad one. A fault that lasts is reported every period.
[[nodiscard]] constexpr bool is_reported_only(GuardFault fault) noexcept {
    return fault == GuardFault::input_noise || fault == GuardFault::recorder;
}

/// Kinds of events. Reset and arm are edges: a button held down is one event.
enum class GuardEventKind : std::uint8_t {
    fault = 0,    // see GuardEvent::fault; none, or one found here, stops too
    loaded,       // every file is read, checked and planned
    tested,       // the self-test has passed
    snapshot,     // the evaluation of a snapshot has ended
    deadline,     // a period has ended, by the timer and nothing else
    tx_ok,        // an own frame was seen on the bus
    tx_fail,      // one could not be sent, retries included, or was not seen in time
    board_ack,    // the axes are at rest since the stop
    board_moves,  // no longer at rest, or no more evidence of it
    reset_edge,   // a person acknowledges the stop
    arm,          // a person orders to go on
    restart,      // a new process begins with the stored state of the old one
    kill,         // the process ends
    own_stop,     // the board stops by itself: no permit until a person arms anew
};

struct GuardEvent {
    GuardEventKind kind = GuardEventKind::fault;
    GuardFault fault = GuardFault::none;  // for fault
    // For snapshot:
    bool is_proven = false;    // the monitor would give a permit
    std::uint32_t period = 0;  // Guard::period when the evaluation began
    std::int64_t age_us = -1;  // of the snapshot, since it was latched; negative is no age
    std::uint8_t samples = 0;  // n: periods after the latch that the permit would be valid for
};

/// Returns the event of a cycle that the monitor has judged: a stop is a fault, a stop of the
/// board's own is own_stop, and any other cycle without a permit is a snapshot that is not proven.
/// A withheld permit is no stop.
[[nodiscard]] GuardEvent guard_event_of(const CycleResult& cycle, std::uint32_t period,
                                        std::int64_t age_us) noexcept;

struct GuardLimits {
    std::uint32_t snapshots_min = 10;  // good periods in a row before ready
    std::int64_t period_us = 1000;     // a permit that ends sooner than in one is not sent
    // The count of bad periods leaks: one in four forever does not fill it, one in three does.
    std::uint32_t bad_weight = 3;
    std::uint32_t bad_limit = 60;
};

struct Guard {
    GuardPhase phase = GuardPhase::stopped;
    GuardFault cause = GuardFault::none;  // of the stop
    bool is_tested = false;               // the self-test passed since init
    bool is_heard = false;                // an own frame was seen since, and none failed after it
    bool is_proven = false;               // this period has a snapshot in time, proven
    bool is_confirmed = false;            // the axes are at rest since this stop
    std::uint8_t quiet = 0;               // 0: a fault in this period; kQuiet: a whole one without
    std::uint32_t good = 0;               // good periods in a row, up to snapshots_min
    // Periods until the permit that ends last has ended, this one included. A newer, shorter
    // permit does not reduce it.
    std::uint32_t held = 0;
    std::uint32_t bad = 0;     // leaky
    std::uint32_t period = 0;  // deadlines seen, modulo 2^32
};
static_assert(std::is_trivially_copyable_v<Guard>);
inline constexpr std::uint8_t kQuiet = 2;  // after so many deadlines the last fault is over

/// The byte of the heartbeat (docs/reference/protocol.md). Silent is not sent.
enum class GuardHeartbeat : std::uint8_t { silent = 0, tripped = 4, running = 5, starting = 127 };

/// Frames to send now. Without an event, no frame is sent.
struct GuardOutput {
    bool sends_permit = false;
    bool sends_stop = false;
    GuardHeartbeat heartbeat = GuardHeartbeat::silent;  // until the next event
};

/// Returns the state of a new process; its next event must be restart.
/// @param is_latched  a stop was stored and not reset, or the store cannot be read
[[nodiscard]] Guard start_guard(bool is_latched) noexcept;

/// Processes one event. The caller sends the returned frames first, stores the latch when the phase
/// becomes armed or stopped, and clears it and acknowledges to the receiver when stopped becomes
/// init. Constant cost.
[[nodiscard]] GuardOutput on_event(Guard& guard, const GuardEvent& event,
                                   const GuardLimits& limits) noexcept;

}  // namespace axg
