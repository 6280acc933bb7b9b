// SPDX-License-Identifier: Apache-2.0
// Every sequence of events of any length, from power-on: breadth first over all states of the guard
// and of a witness that knows only the events, for small limits and the usual ones. The witness
// judges seven properties at each step; the two that say "at last" are asked of every state found.
// The same eight properties are checked on the model, with a bus: docs/reference/states.md. Nothing
// here is random.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "core/guard/guard_state.hpp"

namespace axg::test {
namespace {

// Each greater than one but the period, in which ages are counted.
constexpr GuardLimits kSmall{.snapshots_min = 2, .period_us = 1, .bad_weight = 3, .bad_limit = 8};
constexpr GuardLimits kUsual{.period_us = 1};
constexpr std::uint8_t kSamples = 3;  // n of its permits

struct Named {
    const char* name;
    GuardEvent event;
    std::int32_t late = 0;  // periods since the evaluation began
};

constexpr GuardEvent snapshot(bool is_proven, std::int64_t age_us) {
    return {.kind = GuardEventKind::snapshot,
            .is_proven = is_proven,
            .age_us = age_us,
            .samples = kSamples};
}
constexpr GuardEvent fault(GuardFault kind) {
    return {.kind = GuardEventKind::fault, .fault = kind};
}

const std::array kEvents = std::to_array<Named>({
    {"snapshot", snapshot(true, 2)},
    {"not proven", snapshot(false, 0)},
    {"old", snapshot(true, 3)},
    {"of the last period", snapshot(true, 2), 1},
    {"deadline", {.kind = GuardEventKind::deadline}},
    {"reported fault", fault(GuardFault::input_noise)},
    {"fault", fault(GuardFault::input)},
    {"tx_ok", {.kind = GuardEventKind::tx_ok}},
    {"tx_fail", {.kind = GuardEventKind::tx_fail}},
    {"board_ack", {.kind = GuardEventKind::board_ack}},
    {"board_moves", {.kind = GuardEventKind::board_moves}},
    {"reset_edge", {.kind = GuardEventKind::reset_edge}},
    {"arm", {.kind = GuardEventKind::arm}},
    {"loaded", {.kind = GuardEventKind::loaded}},
    {"tested", {.kind = GuardEventKind::tested}},
    {"kill", {.kind = GuardEventKind::kill}},
    {"restart", {.kind = GuardEventKind::restart}},
});

const Named& event_named(const std::string& name) {
    return *std::find_if(kEvents.begin(), kEvents.end(),
                         [&](const Named& e) { return e.name == name; });
}

/// What the events alone say.
struct Witness {
    bool is_dead = false;        // killed and not restarted
    bool is_latched = false;     // a stop was seen, and no reset with right since
    bool owes_stop = false;      // a fault came while armed
    bool has_proof = false;      // this period has a snapshot: proven, in time, young
    bool is_confirmed = false;   // the axes stand since the stop
    bool has_noise = true;       // a fault in this period
    bool had_noise = true;       // or in the last one
    bool is_tested = false;      // since init
    bool is_heard = false;       // an own frame was seen in selftest, and none failed since
    std::uint32_t coherent = 0;  // such periods in a row, counted in selftest
    std::uint8_t released = 0;   // since the stop: 1 reset with right, 2 and then arm

    [[nodiscard]] auto key() const {
        return std::tuple(is_dead, is_latched, owes_stop, has_proof, is_confirmed, has_noise,
                          had_noise, is_tested, is_heard, coherent, released);
    }
};

struct State {
    Guard guard;
    Witness witness;

    /// Periods count up for ever and no rule reads more of them than "this one".
    [[nodiscard]] auto key() const {
        const Guard& g = guard;
        return std::tuple(g.phase, g.is_tested, g.is_heard, g.is_proven, g.is_confirmed, g.quiet,
                          g.good, g.held, g.bad, witness.key());
    }
};

void to_init(Witness& w) {
    w.is_tested = w.is_heard = false;
    w.coherent = 0;
}

/// Before the guard hears of it.
void observe(Witness& w, const Guard& guard, const Named& named, const GuardLimits& limits) {
    const GuardEvent& event = named.event;
    using enum GuardEventKind;
    if (event.kind == snapshot) {
        w.has_proof =
            w.has_proof || (event.is_proven && event.age_us < kSamples && named.late == 0);
    } else if (event.kind == deadline) {
        // Counted in selftest; what ready has seen already it need not see again.
        if (guard.phase == GuardPhase::selftest) {
            const bool is_good = w.has_proof && !w.has_noise;
            w.coherent = is_good ? std::min(w.coherent + 1, limits.snapshots_min) : 0;
        }
        w.had_noise = w.has_noise;
        w.has_noise = w.has_proof = false;
    } else if (event.kind == fault || event.kind == tx_fail) {
        w.has_noise = true;
        w.is_heard = w.is_heard && event.kind != tx_fail;
        const bool stops = event.kind == tx_fail || event.fault == GuardFault::input;
        w.owes_stop = w.owes_stop || (stops && guard.phase == GuardPhase::armed);
    } else if (event.kind == board_ack) {
        w.is_confirmed = w.is_latched;
    } else if (event.kind == board_moves) {
        w.is_confirmed = false;
    } else if (event.kind == reset_edge && w.is_latched && w.is_confirmed && !w.has_noise &&
               !w.had_noise) {
        w.is_latched = false;
        w.released = 1;
        to_init(w);
    } else if (event.kind == arm && w.released == 1) {
        w.released = 2;
    } else if (event.kind == tested && guard.phase == GuardPhase::selftest) {
        w.is_tested = true;
    } else if (event.kind == tx_ok && guard.phase == GuardPhase::selftest) {
        w.is_heard = true;
    } else if (event.kind == kill || event.kind == restart) {
        to_init(w);
        w.is_dead = event.kind == kill;
        w.owes_stop = w.has_proof = w.is_confirmed = false;
        w.has_noise = w.had_noise = true;
    }
}

/// The first property that this step breaks; none: nullptr.
const char* broken(const Witness& w, const Guard& before, const Guard& after,
                   const GuardOutput& out, const Named& named, const GuardLimits& limits) {
    const GuardEventKind kind = named.event.kind;
    const bool was_armed = before.phase == GuardPhase::armed;
    const bool is_armed = after.phase == GuardPhase::armed;
    const bool is_fault = kind == GuardEventKind::tx_fail || named.event.fault == GuardFault::input;
    if (out.sends_permit && !(was_armed && is_armed && w.has_proof)) {
        return "1: a permit without a proof of this period, or not armed";
    }
    if (out.sends_permit && kind != GuardEventKind::snapshot) {
        return "1: a permit that no evaluation sent";
    }
    if ((out.sends_permit && w.owes_stop) ||
        (was_armed && is_fault && (after.phase != GuardPhase::stopped || !out.sends_stop))) {
        return "2: a fault while armed did not stop";
    }
    if (!was_armed && is_armed && w.released != 2) {
        return "3: armed without a reset with right and a later arm";
    }
    if (w.is_latched && after.phase != GuardPhase::stopped) {
        return "3: left stopped without a reset with right";
    }
    if (is_armed && (kind == GuardEventKind::restart || kind == GuardEventKind::kill)) {
        return "4: armed after restart or kill";
    }
    if (kind == GuardEventKind::deadline && after.phase == GuardPhase::stopped &&
        out.sends_stop == w.is_confirmed) {
        return "5: the stop is repeated until the board confirms, and no longer";
    }
    if (!was_armed && is_armed &&
        !(w.is_tested && w.is_heard && w.coherent == limits.snapshots_min)) {
        return "6: armed without self-test, own frame and coherent pictures";
    }
    return nullptr;
}

/// One event on one state. A dead process hears nothing but its restart, which begins with what was
/// stored.
const char* advance(State& state, const Named& named, const GuardLimits& limits) {
    Witness& w = state.witness;
    if (w.is_dead && named.event.kind != GuardEventKind::restart) {
        return nullptr;
    }
    Guard& guard = state.guard;
    if (named.event.kind == GuardEventKind::restart) {
        guard = start_guard(w.is_latched);
    }
    const Guard before = guard;
    GuardEvent event = named.event;
    event.period = guard.period - static_cast<std::uint32_t>(named.late);
    observe(w, before, named, limits);
    const GuardOutput out = on_event(guard, event, limits);
    if (guard.phase == GuardPhase::stopped && before.phase != GuardPhase::stopped) {
        w.is_latched = true;
        w.owes_stop = w.is_confirmed = false;
        w.has_noise = true;  // the stop's cause is a fault of this period
        w.released = 0;
        to_init(w);
    }
    guard.period = 0;
    return broken(w, before, guard, out, named, limits);
}

/// Power-on for the first time: nothing was stopped, so nothing must be reset, but a person arms.
State power_on() {
    State state{start_guard(false), {}};
    state.witness.released = 1;
    return state;
}

struct Found {
    State state;
    std::size_t parent = 0;
    std::size_t event = 0;
    std::size_t depth = 0;
};

std::string path_to(const std::vector<Found>& all, std::size_t i) {
    std::string path;
    for (; all[i].depth > 0; i = all[i].parent) {
        path = std::string(kEvents[all[i].event].name) + ", " + path;
    }
    return path;
}

/// All states there are, in order of their depth.
std::vector<Found> explore(const GuardLimits& limits) {
    std::vector<Found> all{{power_on()}};
    std::map<decltype(all[0].state.key()), std::size_t> known{{all[0].state.key(), 0}};
    for (std::size_t i = 0; i < all.size(); ++i) {
        for (std::size_t e = 0; e < kEvents.size(); ++e) {
            State next = all[i].state;
            if (const char* const what = advance(next, kEvents[e], limits)) {
                ADD_FAILURE() << what << ": after " << path_to(all, i) << kEvents[e].name;
                return all;
            }
            if (known.try_emplace(next.key(), all.size()).second) {
                all.push_back({next, i, e, all[i].depth + 1});
            }
        }
    }
    return all;
}

const std::vector<Found>& all_states(const GuardLimits& limits) {
    static const std::vector<Found> small = explore(kSmall);
    static const std::vector<Found> usual = explore(kUsual);
    return limits.snapshots_min == kSmall.snapshots_min ? small : usual;
}

class GuardSequences : public testing::TestWithParam<GuardLimits> {
  protected:
    const GuardLimits& limits() const { return GetParam(); }
    /// More than enough for every count to fill and to empty.
    int periods_max() const { return static_cast<int>(3 * limits().bad_limit); }

    bool apply(State& state, const char* name) {
        const char* const what = advance(state, event_named(name), limits());
        EXPECT_EQ(what, nullptr) << what << " at " << name;
        return what == nullptr;
    }
    bool reaches_armed(State state);
    bool ends_stopped(State state, const std::vector<const char*>& bad);
};

TEST_P(GuardSequences, NoSequenceOfEventsBreaksASafetyProperty) {
    const std::vector<Found>& all = all_states(limits());
    std::array<std::size_t, kGuardPhases> phases{};
    for (const Found& found : all) {
        ++phases[static_cast<std::size_t>(found.state.guard.phase)];
    }
    std::printf(
        "%zu states, %zu transitions, the deepest after %zu events; stopped %zu, init %zu, "
        "selftest %zu, ready %zu, armed %zu\n",
        all.size(), all.size() * kEvents.size(), all.back().depth, phases[0], phases[1], phases[2],
        phases[3], phases[4]);
    for (const std::size_t count : phases) {
        EXPECT_GT(count, 0U) << "a phase that no sequence reaches makes the rest empty";
    }
}

/// A healthy bus, a board that confirms, and a person who resets and arms when there is reason.
bool GuardSequences::reaches_armed(State state) {
    for (int period = 0; period < periods_max(); ++period) {
        if (state.witness.is_dead && !apply(state, "restart")) {
            return false;
        }
        const GuardPhase phase = state.guard.phase;
        if (phase == GuardPhase::armed) {
            return true;
        }
        bool ok = true;
        if (phase == GuardPhase::stopped) {
            ok = apply(state, "board_ack") && apply(state, "reset_edge");
        } else if (phase == GuardPhase::init) {
            ok = apply(state, "loaded") && apply(state, "tested");
        } else if (phase == GuardPhase::ready) {
            ok = apply(state, "arm");
        } else {
            ok = apply(state, "tested");
        }
        if (!ok || !apply(state, "tx_ok") || !apply(state, "snapshot") ||
            !apply(state, "deadline")) {
            return false;
        }
    }
    return false;
}

// Property 7.
TEST_P(GuardSequences, FromEveryStateAHealthyBusAndAPersonReachArmed) {
    const std::vector<Found>& all = all_states(limits());
    for (std::size_t i = 0; i < all.size() && !HasFailure(); ++i) {
        EXPECT_TRUE(reaches_armed(all[i].state)) << path_to(all, i);
    }
}

/// Every second period is bad, the others are good.
bool GuardSequences::ends_stopped(State state, const std::vector<const char*>& bad) {
    for (int period = 0; period < periods_max() && state.guard.phase != GuardPhase::stopped;
         ++period) {
        if (period % 2 == 0) {
            for (const char* const name : bad) {
                apply(state, name);
            }
        } else {
            apply(state, "snapshot");
        }
        apply(state, "deadline");
    }
    return state.guard.phase == GuardPhase::stopped;
}

// Property 8. The faults that come and go are each too short to stop by themselves.
TEST_P(GuardSequences, FlappingFaultsStopInTheEnd) {
    const std::vector<Found>& all = all_states(limits());
    std::size_t armed = 0;
    for (std::size_t i = 0; i < all.size() && !HasFailure(); ++i) {
        const State& state = all[i].state;
        if (state.guard.phase != GuardPhase::armed || state.witness.is_dead) {
            continue;
        }
        ++armed;
        EXPECT_TRUE(ends_stopped(state, {"reported fault", "snapshot"})) << path_to(all, i);
        EXPECT_TRUE(ends_stopped(state, {})) << path_to(all, i);
        EXPECT_TRUE(ends_stopped(state, {"not proven"})) << path_to(all, i);
        EXPECT_TRUE(ends_stopped(state, {"of the last period"})) << path_to(all, i);
    }
    EXPECT_GT(armed, 0U);
}

INSTANTIATE_TEST_SUITE_P(Limits, GuardSequences, testing::Values(kSmall, kUsual),
                         [](const auto& tested) { return tested.index == 0 ? "small" : "usual"; });

}  // namespace
}  // namespace axg::test
