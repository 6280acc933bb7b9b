// SPDX-License-Identifier: Apache-2.0
// Tables of the machine file's scalar keys. A new one is a row here, a member of `Machine` and an
// entry of config/schema/machine.schema.json, whose ranges a test compares with these rows.
#pragma once

#include "config/machine/scalar_key.hpp"

namespace axg {

// Each table is in the order of its lines in the canonical text, which the hashes cover.
[[nodiscard]] ScalarKeys<Machine> top_keys() noexcept;
[[nodiscard]] ScalarKeys<Axis> axis_keys(AxisKind kind) noexcept;
/// Of a body that an axis moves. `direction_error_deg` alone for a linear one.
[[nodiscard]] ScalarKeys<Joint> joint_keys(AxisKind kind) noexcept;
[[nodiscard]] ScalarKeys<Body> body_keys() noexcept;
[[nodiscard]] ScalarKeys<Tool> tool_keys() noexcept;
[[nodiscard]] ScalarKeys<GuardRules> guard_keys() noexcept;
[[nodiscard]] ScalarKeys<JogRules> jog_keys() noexcept;
[[nodiscard]] ScalarKeys<Capacities> capacity_keys() noexcept;
[[nodiscard]] ScalarKeys<BatchCapacities> batch_keys() noexcept;
[[nodiscard]] ScalarKeys<CycleRules> cycle_keys() noexcept;
[[nodiscard]] ScalarKeys<WorkLists> list_keys() noexcept;

}  // namespace axg
