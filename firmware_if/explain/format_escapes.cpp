// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/explain/format_escapes.hpp"

#include <fmt/format.h>

#include <optional>

#include "firmware_if/setup/guard_engine.hpp"

namespace axg {

namespace {

bool is_rotary(const Machine& machine, const EscapeJog& jog) {
    return machine.axes[jog.axis].kind == AxisKind::rotary;
}

}  // namespace

double step_in_file_units(const Machine& machine, const EscapeJog& jog) {
    return is_rotary(machine, jog) ? kEscapeStepRad * 180.0 / kPi : kEscapeStepMm;
}

Escapes find_escapes(const LoadedMachine& loaded, const Engine& engine,
                     const ContainmentTest& containment_test, const AxisSnapshot& snapshot) {
    std::optional<StopCertificate> certificate = make_stop_certificate(loaded);
    std::optional<EscapeFinder> finder = EscapeFinder::create(loaded.machine);
    if (!certificate || !finder) {
        return {};
    }
    certificate->note(snapshot, true);
    certificate->prove(engine, containment_test);
    return finder->find(engine, containment_test, *certificate);
}

std::string format_escapes(const Machine& machine, const Escapes& escapes, Detail detail) {
    if (!escapes.is_clear) {
        return "no way out is proven: a pair is in contact or too near";
    }
    if (escapes.pair == kNoIndex) {
        return {};
    }
    if (escapes.count == 0) {
        return "no single-axis step is proven to increase the clearance of the nearest pair";
    }
    std::string text;
    for (const EscapeJog& jog : escapes.list()) {
        const bool is_first = text.empty();
        text += fmt::format("{} {}{}", is_first ? "jog" : " or", machine.axes[jog.axis].name,
                            jog.is_negative ? '-' : '+');
        if (is_first || detail == Detail::full) {
            text += fmt::format(" ({:g} {}: clearance at least {:.4f} mm)",
                                step_in_file_units(machine, jog),
                                is_rotary(machine, jog) ? "deg" : "mm", jog.clearance_mm);
        }
    }
    return text;
}

}  // namespace axg
