// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/proof_test/proof_steps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace axg {
namespace {

constexpr std::uint64_t kHeldMs = 1000;  // older: the bus thread does not turn

/// Fresh, and in this phase.
bool is_in(const GuardSight& now, std::string_view phase) {
    return now.has_view && now.age_ms <= kHeldMs && now.phase == phase;
}

/// A guard that permits now, not one that did.
StepEnd judge_armed(const ProofView& view) {
    return is_in(view.now, "armed") && view.now.permits > view.before.permits ? StepEnd::passed
                                                                              : StepEnd::waiting;
}

/// The stop has to be a verdict about the expected pair: any other stop proves nothing here.
StepEnd judge_place(const ProofView& view) {
    if (!is_in(view.now, "stopped")) {
        return StepEnd::waiting;
    }
    const bool is_expected =
        !view.now.pair.empty() && (view.pair.empty() || view.now.pair == view.pair);
    return view.now.cause == "verdict" && is_expected ? StepEnd::passed : StepEnd::failed;
}

/// Still that stop: a guard that was reset meanwhile has not shown that the axes rested.
StepEnd judge_rest(const ProofView& view) {
    if (!is_in(view.now, "stopped")) {
        return view.now.has_view ? StepEnd::failed : StepEnd::waiting;
    }
    return view.now.stands && view.now.is_confirmed ? StepEnd::passed : StepEnd::waiting;
}

/// Causes of a bus that is not whole, seen from either end of the cable.
StepEnd judge_plug(const ProofView& view) {
    constexpr std::array<std::string_view, 3> kCauses{"input", "silence", "output"};
    if (!is_in(view.now, "stopped")) {
        return StepEnd::waiting;
    }
    return std::find(kCauses.begin(), kCauses.end(), view.now.cause) != kCauses.end()
               ? StepEnd::passed
               : StepEnd::failed;
}

/// A guard that comes back remembers that it was armed.
StepEnd judge_killed(const ProofView& view) {
    if (!view.was_gone || !view.now.has_view) {
        return StepEnd::waiting;
    }
    return is_in(view.now, "stopped") && view.now.cause == "latched" ? StepEnd::passed
                                                                     : StepEnd::failed;
}

constexpr std::array<ProofStep, 8> kSteps{{
    {"armed",
     "Bring the machine to rest, clear of everything. Reset, arm the board, then arm the guard.",
     judge_armed, ""},
    {"place",
     "Low override, a hand on the emergency stop. Jog slowly towards the known place: a soft block "
     "that the machine file has. Do not reset.",
     judge_place, ""},
    {"rest", "", judge_rest, "Did the machine rest before it touched the block?"},
    {"way_out", "Move away from the block. Reset, arm the board, then arm the guard.", judge_armed,
     ""},
    {"plug", "At rest, pull the CAN plug of the board. Then press a jog key shortly.", judge_plug,
     "Did every axis stay at rest?"},
    {"again", "Plug it in. Reset, arm the board, then arm the guard.", judge_armed, ""},
    {"killed",
     "At rest, kill the guard: sudo systemctl kill -s KILL axguardd@BUS. It starts again by "
     "itself.",
     judge_killed, "Did the machine refuse to move meanwhile?"},
    {"estop", "Press the wired emergency stop.", nullptr, "Are all drives without power?"},
}};

}  // namespace

std::string summary_of(const GuardSight& sight) {
    const auto with = [](const std::string& text) { return text.empty() ? "" : ": " + text; };
    if (sight.phase == "stopped") {
        return sight.phase + with(sight.cause) + with(sight.reason == "none" ? "" : sight.reason) +
               with(sight.pair);
    }
    return sight.phase == "armed" || !sight.has_view || sight.withheld == "nothing"
               ? sight.phase
               : fmt::format("{}, no permit: {}{}", sight.phase, sight.withheld,
                             with(sight.withheld_pair));
}

std::span<const ProofStep> proof_steps() noexcept {
    return kSteps;
}

}  // namespace axg
