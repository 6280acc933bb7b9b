// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/cli/limit_text.hpp"

#include <fmt/format.h>

#include <array>

#include "core/base/sincos.hpp"

namespace axg {
namespace {

const char* word_of(LimitFigure figure) noexcept {
    switch (figure) {
        case LimitFigure::speed:
            return "speed";
        case LimitFigure::acceleration:
            return "acceleration";
        case LimitFigure::jerk:
            return "jerk";
        case LimitFigure::position:
            return "position";
    }
    return "speed";
}

char* write_fact(const LimitFact& fact, const Axis& axis, char* out, std::size_t size) noexcept {
    const LimitFigure figure = figure_of(fact.kind);
    const char* const unit = unit_of(axis, figure);
    const double measured = in_axis_units(axis, fact.measured);
    const double declared = in_axis_units(axis, fact.declared);
    switch (fact.kind) {
        case LimitKind::speed_range:
        case LimitKind::acceleration_range:
            return fmt::format_to_n(out, size,
                                    "axis {}: contradictory bounds of its {} (by {:.6g} {})",
                                    axis.name, word_of(figure), measured, unit)
                .out;
        case LimitKind::frozen_axis:
            return fmt::format_to_n(out, size,
                                    "axis {}: its position stands still, right after at least "
                                    "{:.6g} {} (frozen_axis)",
                                    axis.name, measured, unit)
                .out;
        case LimitKind::stopping:
            return fmt::format_to_n(out, size,
                                    "axis {}: braked at {:.6g} {}, its hardest stop is {:.6g} {} "
                                    "(stopping_most)",
                                    axis.name, measured, unit, declared, unit)
                .out;
        case LimitKind::left_reach:
            return fmt::format_to_n(out, size,
                                    "axis {}: {:.3g} {} beyond where its last permit let it stop "
                                    "(left_reach)",
                                    axis.name, measured, unit)
                .out;
        case LimitKind::none:
        case LimitKind::speed:
        case LimitKind::acceleration:
        case LimitKind::jerk:
            break;
    }
    return fmt::format_to_n(out, size, "axis {}: {} {:.6g} {}, declared {:.6g} {}", axis.name,
                            word_of(figure), measured, unit, declared, unit)
        .out;
}

const char* next_step(LimitKind kind, StopReason reason) noexcept {
    if (reason == StopReason::own_stop) {
        return "The board stops by itself: at rest, arm it anew. If no person stopped it, check "
               "encoder and drive of this axis";
    }
    if (kind == LimitKind::frozen_axis || kind == LimitKind::stopping) {
        return "The other axes went on: check encoder and drive of this axis";
    }
    if (kind == LimitKind::left_reach) {
        return "It braked late or softly: measure board_reaction_ms and stopping_... anew with "
               "axguardd board-test before arming";
    }
    return "Correct the limits of this axis in the machine file or in the control; axguard inspect "
           "--limits proposes values";
}

}  // namespace

LimitFigure figure_of(LimitKind kind) noexcept {
    switch (kind) {
        case LimitKind::none:
        case LimitKind::speed:
        case LimitKind::speed_range:
        case LimitKind::frozen_axis:
            return LimitFigure::speed;
        case LimitKind::acceleration:
        case LimitKind::acceleration_range:
        case LimitKind::stopping:
            return LimitFigure::acceleration;
        case LimitKind::jerk:
            return LimitFigure::jerk;
        case LimitKind::left_reach:
            return LimitFigure::position;
    }
    return LimitFigure::speed;
}

const char* unit_of(const Axis& axis, LimitFigure figure) noexcept {
    const bool is_rotary = axis.kind == AxisKind::rotary;
    switch (figure) {
        case LimitFigure::speed:
            return is_rotary ? "deg/s" : "mm/s";
        case LimitFigure::acceleration:
            return is_rotary ? "deg/s2" : "mm/s2";
        case LimitFigure::jerk:
            return is_rotary ? "deg/s3" : "mm/s3";
        case LimitFigure::position:
            return is_rotary ? "deg" : "mm";
    }
    return "";
}

double in_axis_units(const Axis& axis, double value) noexcept {
    return axis.kind == AxisKind::rotary ? value * (180.0 / kPi) : value;
}

std::size_t format_limit(const LimitFact& fact, StopReason reason, const Machine& machine,
                         std::span<char> out) noexcept {
    if (fact.axis >= machine.axes.size()) {
        return 0;
    }
    const Axis& axis = machine.axes[fact.axis];
    char* const end = write_fact(fact, axis, out.data(), out.size());
    const std::size_t used = static_cast<std::size_t>(end - out.data());
    const auto tail =
        fmt::format_to_n(end, out.size() - used, ". {}", next_step(fact.kind, reason));
    return static_cast<std::size_t>(tail.out - out.data());
}

std::string limit_text(const LimitFact& fact, StopReason reason, const Machine& machine) {
    std::array<char, 400> line{};
    return {line.data(), format_limit(fact, reason, machine, line)};
}

}  // namespace axg
