// SPDX-License-Identifier: Apache-2.0
// The guard's table as text, from the one in core/guard/guard_table.hpp: for the model that is
// checked (promela), for docs/reference/states.md (markdown), and, with the model's small limits,
// every state that there is and what each event makes of it (relation), which the model must find
// as well.
#include <array>
#include <cstdint>
#include <cstdio>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "core/guard/guard_state.hpp"
#include "core/guard/guard_table.hpp"

namespace axg::test {
namespace {

// Small, so that the states are few; each still greater than one.
constexpr GuardLimits kLimits{.snapshots_min = 2, .period_us = 1, .bad_weight = 2, .bad_limit = 4};
constexpr std::uint8_t kSamplesLeast = 2, kSamplesMost = 3;  // of a permit

constexpr std::array<const char*, kGuardPhases> kPhases{"stopped", "init", "selftest", "ready",
                                                        "armed"};
constexpr std::array<const char*, kGuardInputs> kInputs{
    "loaded",         "tested",           "proven",        "refused",       "period_good",
    "period_settled", "period_disturbed", "period_missed", "period_silent", "period_full",
    "fault_reported", "fault_stop",       "tx_ok",         "tx_fail",       "board_ack",
    "board_moves",    "reset_refused",    "reset",         "arm",           "restart",
    "kill",           "own_stop"};
constexpr std::array<const char*, kGuardActions> kActions{
    "none",   "begin",  "pass", "hear",   "wait",    "wait_deaf", "good", "disturbed",
    "missed", "permit", "stop", "repeat", "confirm", "withdraw",  "mute"};

const char* name_of(GuardPhase phase) {
    return kPhases[static_cast<std::size_t>(phase)];
}
const char* name_of(GuardInput input) {
    return kInputs[static_cast<std::size_t>(input)];
}
const char* name_of(GuardAction action) {
    return kActions[static_cast<std::size_t>(action)];
}

template <std::size_t N>
void print_names(const char* prefix, const std::array<const char*, N>& names) {
    for (std::size_t i = 0; i < N; ++i) {
        std::printf("#define %s_%s %zu\n", prefix, names[i], i);
    }
    std::printf("\n");
}

void print_promela() {
    std::printf(
        "/* SPDX-License-Identifier: Apache-2.0\n"
        " * Written by axg_guard_table from core/guard/guard_table.hpp: change that, and write\n"
        " * this again. Included by guard.pml. */\n\n");
    print_names("P", kPhases);
    print_names("I", kInputs);
    print_names("A", kActions);
    std::printf(
        "#define SNAPSHOTS_MIN %u\n#define SAMPLES_LEAST %d\n#define SAMPLES_MOST %d\n"
        "#define BAD_WEIGHT %u\n#define BAD_LIMIT %u\n\n",
        kLimits.snapshots_min, kSamplesLeast, kSamplesMost, kLimits.bad_weight, kLimits.bad_limit);
    std::printf("/* Sets next and action. */\ninline look_up(input, phase) {\n    if\n");
    for (const GuardRow& row : kGuardRows) {
        std::printf(
            "    :: input == I_%s && phase == P_%s ->\n"
            "        next = P_%s; action = A_%s\n",
            name_of(row.input), name_of(row.phase), name_of(row.next), name_of(row.action));
    }
    std::printf("    :: else -> next = phase; action = A_none\n    fi\n}\n");
}

/// One line an input, one column a phase: the next phase if it is another, and the action.
void print_markdown() {
    std::printf("| input |");
    for (const char* const phase : kPhases) {
        std::printf(" in %s |", phase);
    }
    std::printf("\n|---|---|---|---|---|---|\n");
    for (std::uint32_t i = 0; i < kGuardInputs; ++i) {
        std::printf("| `%s` |", kInputs[i]);
        for (std::uint32_t p = 0; p < kGuardPhases; ++p) {
            const auto phase = static_cast<GuardPhase>(p);
            const GuardRow row = guard_row(static_cast<GuardInput>(i), phase);
            const bool moves = row.next != phase;
            const bool acts = row.action != GuardAction::none;
            std::printf(" %s%s%s |",
                        moves ? (std::string("**") + name_of(row.next) + "**").c_str() : "",
                        moves && acts ? ", " : "", acts ? name_of(row.action) : "");
        }
        std::printf("\n");
    }
}

struct Named {
    const char* name;  // as in guard.pml
    GuardEvent event;
    std::uint32_t late = 0;  // periods since the evaluation began
};

std::vector<Named> all_events() {
    std::vector<Named> events;
    for (const bool is_proven : {false, true}) {
        for (std::uint32_t late = 0; late < 3; ++late) {
            for (std::int64_t age = 0; age <= 3; ++age) {
                for (const std::uint8_t samples : {kSamplesLeast, kSamplesMost}) {
                    events.push_back({"snapshot",
                                      {.kind = GuardEventKind::snapshot,
                                       .is_proven = is_proven,
                                       .age_us = age,
                                       .samples = samples},
                                      late});
                }
            }
        }
    }
    events.push_back(
        {"fault_reported", {.kind = GuardEventKind::fault, .fault = GuardFault::input_noise}});
    events.push_back({"fault_stop", {.kind = GuardEventKind::fault, .fault = GuardFault::input}});
    using enum GuardEventKind;
    for (const auto& [name, kind] : {std::pair{"deadline", deadline},
                                     {"loaded", loaded},
                                     {"tested", tested},
                                     {"tx_ok", tx_ok},
                                     {"tx_fail", tx_fail},
                                     {"board_ack", board_ack},
                                     {"board_moves", board_moves},
                                     {"reset_edge", reset_edge},
                                     {"arm", arm},
                                     {"restart", restart},
                                     {"kill", kill},
                                     {"own_stop", own_stop}}) {
        events.push_back({name, {.kind = kind}});
    }
    return events;
}

/// Periods count up for ever, and no rule reads more of them than "this one".
using Key = std::array<std::uint32_t, 9>;
Key key_of(const Guard& g) {
    return {static_cast<std::uint32_t>(g.phase),
            g.is_tested,
            g.is_heard,
            g.is_proven,
            g.is_confirmed,
            g.quiet,
            g.good,
            g.held,
            g.bad};
}

void print_key(const Key& key) {
    for (const std::uint32_t value : key) {
        std::printf("%u ", value);
    }
}

void print_relation() {
    std::vector<Guard> all{start_guard(false)};
    std::set<Key> known{key_of(all[0])};
    const std::vector<Named> events = all_events();
    for (std::size_t i = 0; i < all.size(); ++i) {
        for (const Named& named : events) {
            Guard guard = all[i];
            GuardEvent event = named.event;
            event.period = guard.period - named.late;
            const GuardOutput out = on_event(guard, event, kLimits);
            std::printf("STEP ");
            print_key(key_of(all[i]));
            std::printf("%s %d %u %d %d : ", named.name, event.is_proven, named.late,
                        event.kind == GuardEventKind::snapshot ? static_cast<int>(event.age_us) : 0,
                        event.samples);
            print_key(key_of(guard));
            std::printf("%d %d\n", out.sends_permit, out.sends_stop);
            if (known.insert(key_of(guard)).second) {
                all.push_back(guard);
            }
        }
    }
}

}  // namespace
}  // namespace axg::test

int main(int argc, char** argv) {
    const std::string what = argc == 2 ? argv[1] : "";
    if (what == "promela") {
        axg::test::print_promela();
    } else if (what == "markdown") {
        axg::test::print_markdown();
    } else if (what == "relation") {
        axg::test::print_relation();
    } else {
        std::fprintf(stderr, "usage: axg_guard_table promela|markdown|relation\n");
        return 2;
    }
    return 0;
}
