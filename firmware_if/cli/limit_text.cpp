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
    }
    return "speed";
}

}  // namespace

LimitFigure figure_of(LimitKind kind) noexcept {
    switch (kind) {
        case LimitKind::none:
        case LimitKind::speed:
        case LimitKind::speed_range:
            return LimitFigure::speed;
        case LimitKind::acceleration:
        case LimitKind::acceleration_range:
            return LimitFigure::acceleration;
        case LimitKind::jerk:
            return LimitFigure::jerk;
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
    }
    return "";
}

double in_axis_units(const Axis& axis, double value) noexcept {
    return axis.kind == AxisKind::rotary ? value * (180.0 / kPi) : value;
}

std::size_t format_limit(const LimitFact& fact, const Machine& machine,
                         std::span<char> out) noexcept {
    if (fact.axis >= machine.axes.size()) {
        return 0;
    }
    const Axis& axis = machine.axes[fact.axis];
    const LimitFigure figure = figure_of(fact.kind);
    const double measured = in_axis_units(axis, fact.measured);
    const bool is_range =
        fact.kind == LimitKind::speed_range || fact.kind == LimitKind::acceleration_range;
    char* const end =
        is_range
            ? fmt::format_to_n(out.data(), out.size(),
                               "axis {}: contradictory bounds of its {} (by {:.6g} {})", axis.name,
                               word_of(figure), measured, unit_of(axis, figure))
                  .out
            : fmt::format_to_n(out.data(), out.size(), "axis {}: {} {:.6g} {}, declared {:.6g} {}",
                               axis.name, word_of(figure), measured, unit_of(axis, figure),
                               in_axis_units(axis, fact.declared), unit_of(axis, figure))
                  .out;
    const char* const next =
        ". Correct the limits of this axis in the machine file or in the control; axguard inspect "
        "--limits proposes values";
    const std::size_t used = static_cast<std::size_t>(end - out.data());
    const auto tail = fmt::format_to_n(end, out.size() - used, "{}", next);
    return static_cast<std::size_t>(tail.out - out.data());
}

std::string limit_text(const LimitFact& fact, const Machine& machine) {
    std::array<char, 400> line{};
    return {line.data(), format_limit(fact, machine, line)};
}

}  // namespace axg
