// SPDX-License-Identifier: Apache-2.0
// The sections `guard` and `output_line` of a machine file: what the board promises about motion
// and stops, the budget of a cycle for proving that a stop ends clear, and the GPIO line.
#include <array>

#include "config/machine/machine_keys.hpp"
#include "config/machine/read_sections.hpp"
#include "config/text/fault_list.hpp"
#include "config/text/map_reader.hpp"
#include "config/text/quote_text.hpp"

namespace axg {
namespace {

/// A promise that is stated elsewhere is no misspelling, and must not pass for another one.
void read_promise(MapReader& reader, Machine& machine) {
    constexpr std::array<std::string_view, 3> kPromises{"independent", "path_keeping",
                                                        "single_jog"};
    std::size_t promise = 0;
    if (!reader.choice("promise", Need::optional, kPromises, promise) || promise == 0) {
        return;
    }
    if (promise == 2) {
        reader.report("promise", std::string{kPromises[promise]},
                      "independent or path_keeping; state single_jog in addition, as the map "
                      "guard.single_jog");
    } else if (machine.can.look_ahead_samples == 0) {
        reader.report(
            "promise", std::string{kPromises[promise]},
            "independent, or can.ahead; without look-ahead the guard does not know the path");
    } else if (!machine.can.quick_stop_ids.empty()) {
        reader.report(
            "promise", std::string{kPromises[promise]} + " with can.quick_stop",
            "independent, or no quick_stop; a drive that stops by itself leaves the path");
    } else {
        machine.guard.promise = StopPromise::path_keeping;
    }
}

/// The limits of a jog are all required. Only our frame formats name the axis that may move.
void read_jog(MapReader& guard_reader, MachineDraft& draft) {
    const YamlNode* section = guard_reader.find(
        "single_jog", Need::optional,
        "a map, such as {speed_mm_min: 300, acceleration_mm_s2: 100, speed_deg_s: 2, "
        "acceleration_deg_s2: 20}");
    if (section == nullptr) {
        return;
    }
    if (!is_native(draft.machine.can)) {
        guard_reader.report(
            "single_jog", "a jog with frames of another format",
            "can.format classical or fd; other formats do not name the axis that may move");
    }
    JogRules& jog = draft.machine.guard.jog;
    MapReader reader{*section, "guard.single_jog", keys_of(jog_keys()), draft.faults};
    read_scalars(reader, jog_keys(), jog, draft.machine.states);
    jog.is_promised = true;
}

/// An enforced cap needs a permit that orders it and a sample that acknowledges it.
void read_cap(MapReader& reader, MachineDraft& draft) {
    Machine& machine = draft.machine;
    constexpr std::array<std::string_view, 3> kCaps{"none", "all_axes", "per_axis"};
    std::size_t cap = 0;
    if (!reader.choice("cap", Need::optional, kCaps, cap) || cap == 0) {
        return;
    }
    const std::string found{kCaps[cap]};
    const CanLayout& can = machine.can;
    const bool has_ack = is_native(can);
    if (!has_ack) {
        reader.report(
            "cap", found + " with frames of another format",
            "none, or can.format classical or fd; other formats do not acknowledge a cap");
    } else if (!tries_longer(can.permit_samples)) {
        reader.report(
            "cap", found + " with one number as can.permit_samples",
            "none, or two numbers, such as [8, 12]; the cap falls where the longer permit "
            "is not proven");
    } else {
        machine.guard.cap = static_cast<CapPromise>(cap);
        if (!draft.states_permit_samples) {
            machine.can.permit_samples = kPermitSamplesLonger;
        }
    }
}

/// SYNC of the guard ends later than its instant by the time to wake up, by a frame that has the
/// bus, and by its own: no bus is so fast that the usual value covers that.
void check_sync_jitter(MapReader& reader, const Machine& machine) {
    constexpr double kLeastUs = 100;
    const double stated_us = machine.guard.latch_jitter_s * 1e6;
    if (machine.can.guard_sends_sync && stated_us < kLeastUs - 1e-6) {
        reader.report("latch_jitter_us", shown(stated_us) + " with can.sync: guard",
                      "at least 100; it covers the time from the guard's clock to the end of SYNC "
                      "on the bus");
    }
}

void check_free_jerk(MapReader& reader, const Machine& machine) {
    for (const Axis& axis : machine.axes) {
        if (machine.guard.free_jerk_limited && !has_jerk_limit(axis)) {
            reader.report("free_jerk", "limited, and axis " + axis.name + " without a jerk limit",
                          "any, or a number for jerk_... of that axis");
        }
    }
}

}  // namespace

void read_guard(MapReader& top, MachineDraft& draft) {
    const YamlNode* section = top.find("guard", Need::optional, "a map");
    if (section == nullptr) {
        check_sync_jitter(top, draft.machine);
        return;
    }
    MapReader reader{*section, "guard", keys_of(guard_keys(), {"slow_mm", "warn_mm", "single_jog"}),
                     draft.faults};
    read_promise(reader, draft.machine);
    read_scalars(reader, guard_keys(), draft.machine.guard, draft.machine.states);
    check_sync_jitter(reader, draft.machine);
    check_free_jerk(reader, draft.machine);
    read_cap(reader, draft);
    read_clearance_levels(reader, draft.usual_clearance_levels);
    read_jog(reader, draft);
}

void read_output_line(MapReader& top, MachineDraft& draft) {
    const YamlNode* section =
        top.find("output_line", Need::optional, "a map, such as {chip: gpiochip0, line: 17}");
    if (section == nullptr) {
        return;
    }
    MapReader reader{*section, "output_line", {"chip", "line"}, draft.faults};
    OutputLine& out = draft.machine.output_line;
    std::string chip;
    if (reader.text("chip", Need::required, 32, chip)) {
        constexpr std::string_view kPrefix = "gpiochip";
        const std::string_view number = std::string_view(chip).substr(
            chip.rfind(kPrefix, 0) == 0 ? kPrefix.size() : chip.size());
        const bool is_number =
            !number.empty() && number.find_first_not_of("0123456789") == std::string_view::npos;
        if (is_number) {
            out.chip = chip;
        } else {
            reader.report("chip", '"' + escaped(chip, 32) + '"',
                          "the name of a GPIO chip, such as gpiochip0; list them with ls /dev");
        }
    }
    reader.whole("line", Need::required, {0, 1023}, out.line);
}

}  // namespace axg
