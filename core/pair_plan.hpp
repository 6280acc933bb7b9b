// SPDX-License-Identifier: Apache-2.0
// From one axis picture to the questions of one cycle: every checked pair at the sampled pose, and
// the canary.
#pragma once

#include <array>
#include <cstdint>

#include "core/axis_picture.hpp"
#include "core/engine.hpp"
#include "core/machine.hpp"
#include "core/mesh.hpp"

namespace axg {

/// The engine is given the machine's surfaces in this order: bodies, tools, canary (canary_mesh()).
[[nodiscard]] constexpr std::uint32_t tool_mesh_index(const Machine& machine,
                                                      std::uint32_t tool) noexcept {
    return static_cast<std::uint32_t>(machine.bodies.size()) + tool;
}
[[nodiscard]] constexpr std::uint32_t canary_mesh_index(const Machine& machine) noexcept {
    return static_cast<std::uint32_t>(machine.bodies.size() + machine.tools.size());
}

/// A tetrahedron of 1 mm: asked about at a known-far and a known-near pose in every cycle, so that
/// an engine that always says the same is found out.
[[nodiscard]] Mesh canary_mesh();

inline constexpr std::uint32_t kQuestionsMax = kPairsMax + 2;  // pairs, canary far, canary near

enum class PlanStatus : std::uint8_t { not_run = 0, ok, wrong_axes, not_finite, unknown_tool };

struct PairPlan {
    PlanStatus status = PlanStatus::not_run;
    std::uint32_t count = 0;        // pairs asked about; the two canary questions follow them
    std::uint32_t tool = kNoIndex;  // slot in the spindle; kNoIndex: none
    std::array<std::uint32_t, kPairsMax> pair{};  // index into Machine::pairs
    std::array<Question, kQuestionsMax> questions{};
};

/// Contact mode: is each pair farther apart than its margin, at the sampled pose alone?
/// A pair whose tool body is empty (no tool in the spindle) is left out. Tool number 0 means that
/// the board does not say: Machine::first_tool. Any other number without a slot: unknown_tool, and
/// nothing is asked.
void plan_contact(const Machine& machine, const AxisPicture& picture, PairPlan& out) noexcept;

}  // namespace axg
