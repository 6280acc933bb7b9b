// SPDX-License-Identifier: Apache-2.0
// The section `guard` of a machine file: what the board promises about motion and stops, and what a
// cycle may spend on proving that a stop ends clear.
#include <array>

#include "config/fault_list.hpp"
#include "config/machine_draft.hpp"
#include "config/map_reader.hpp"
#include "config/quote_text.hpp"

namespace axg {
namespace {

/// A promise that is known and not used yet is no misspelling, and must not pass for another one.
void read_promise(MapReader& reader, Machine& machine) {
    constexpr std::array<std::string_view, 3> kPromises{"independent", "path_keeping",
                                                        "single_jog"};
    std::size_t promise = 0;
    if (!reader.choice("promise", Need::optional, kPromises, promise) || promise == 0) {
        return;
    }
    if (promise == 2) {
        reader.report("promise", std::string{kPromises[promise]},
                      "independent or path_keeping: this one is not made use of in this version");
    } else if (machine.can.ahead_samples == 0) {
        reader.report(
            "promise", std::string{kPromises[promise]},
            "independent, or can.ahead: without the commands ahead nobody knows the path");
    } else {
        machine.guard.promise = StopPromise::path_keeping;
    }
}

}  // namespace

void read_guard(MapReader& top, MachineDraft& draft) {
    const YamlNode* section = top.find("guard", Need::optional, "a map");
    if (section == nullptr) {
        return;
    }
    MapReader reader{*section,
                     "guard",
                     {"promise", "board_reaction_ms", "latch_jitter_us", "free_jerk",
                      "travel_enforced", "rounds", "questions", "speed_cap", "cap_lead_ms",
                      "slow_mm", "warn_mm", "level_band_mm", "level_hold_samples"},
                     draft.faults};
    read_promise(reader, draft.machine);
    GuardRules& out = draft.machine.guard;
    double value = 0;
    if (reader.number("board_reaction_ms", Need::optional, {0, 1000}, value)) {
        out.board_reaction_s = value / 1e3;
    }
    if (reader.number("latch_jitter_us", Need::optional, {0, 10'000}, value)) {
        out.latch_jitter_s = value / 1e6;
    }
    constexpr std::array<std::string_view, 2> kJerk{"any", "limited"};
    std::size_t jerk = 0;
    if (reader.choice("free_jerk", Need::optional, kJerk, jerk)) {
        out.free_jerk_limited = jerk == 1;
    }
    reader.boolean("travel_enforced", Need::optional, out.travel_enforced);
    reader.whole("rounds", Need::optional, {1, 32}, out.rounds);
    reader.whole("questions", Need::optional, {1, 65'536}, out.questions);
    reader.boolean("speed_cap", Need::optional, out.speed_cap);
    if (reader.number("cap_lead_ms", Need::optional, {0, 1000}, value)) {
        out.cap_lead_s = value / 1e3;
    }
    read_levels(reader, draft.usual_levels);
    reader.number("level_band_mm", Need::optional, {0, 100}, out.level_band_mm);
    reader.whole("level_hold_samples", Need::optional, {1, 100'000}, out.level_hold_samples);
}

}  // namespace axg
