// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/setup/pose_errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "config/machine/machine_keys.hpp"
#include "core/certificate/pair_queries.hpp"
#include "core/certificate/pose_error.hpp"
#include "core/certificate/travel.hpp"
#include "core/machine/kinematics.hpp"

namespace axg {
namespace {

std::vector<BodyExtent> extents_of(const std::vector<Mesh>& meshes) {
    std::vector<BodyExtent> out;
    for (const Mesh& mesh : meshes) {
        out.push_back(extent_of(mesh));
    }
    return out;
}

/// What `value` costs the pair: without it the pair's error is smaller by so much.
/// @param value  in `machine`; as before on return
double cost_mm(double& value, const Machine& machine, const MachineMeshes& meshes,
               const WorstPoseError& worst) {
    const double stated = std::exchange(value, 0);
    const double without_mm = find_pose_errors(machine, meshes).mm[worst.pair];
    value = stated;
    return worst.mm - without_mm;
}

/// Lists what each key of the table costs the pair.
/// @param owner  in `machine`
template <class Owner>
void add_parts(ScalarKeys<Owner> table, const std::string& path, Owner& owner,
               const Machine& machine, const MachineMeshes& meshes, WorstPoseError& out) {
    for (const ScalarKey<Owner>& row : table) {
        double& value = owner.*row.number;
        if (value > 0) {
            out.parts.push_back({path + row.key, cost_mm(value, machine, meshes, out)});
        }
    }
}

}  // namespace

PoseErrors find_pose_errors(const Machine& machine, const MachineMeshes& meshes) {
    PoseErrors out{.are_stated = machine.pose_errors.are_stated};
    if (!out.are_stated) {
        return out;
    }
    out.within = error_range(machine);
    const std::vector<BodyExtent> bodies = extents_of(meshes.bodies),
                                  tools = extents_of(meshes.tools);
    for (const Pair& pair : machine.pairs) {
        double most_mm = 0;
        for (std::uint32_t k = 0; k < tasks_of(machine, pair); ++k) {
            const std::uint32_t tool = has_tool(machine, pair) ? k : kNoIndex;
            const auto extent = [&](std::uint32_t body) -> const BodyExtent& {
                return machine.bodies[body].is_tool ? tools[tool] : bodies[body];
            };
            most_mm = std::max(most_mm, pose_error_mm(machine, pair, tool, extent(pair.a),
                                                      extent(pair.b), out.within));
        }
        out.mm.push_back(most_mm);
    }
    return out;
}

std::vector<ConfigFault> pose_error_faults(const LoadedMachine& loaded) {
    const Machine& machine = loaded.machine;
    std::vector<ConfigFault> out;
    for (std::uint32_t i = 0; i < machine.pose_errors.mm.size(); ++i) {
        const Pair& pair = machine.pairs[i];
        double surfaces_mm = 0;
        for (std::uint32_t k = 0; k < tasks_of(machine, pair); ++k) {
            const std::uint32_t tool = has_tool(machine, pair) ? k : kNoIndex;
            surfaces_mm = std::max(surfaces_mm, deviation_of(machine, pair.a, tool) +
                                                    deviation_of(machine, pair.b, tool));
        }
        const double sum_mm = machine.pose_errors.mm[i] + surfaces_mm + kPlacementErrorMm;
        if (!(sum_mm <= kPoseErrorMmMax)) {
            out.push_back(
                {loaded.source.file,
                 fmt::format("pairs.{}-{}", machine.bodies[pair.a].name,
                             machine.bodies[pair.b].name),
                 fmt::format("{:.4g} mm of stated errors and simplified surfaces", sum_mm),
                 fmt::format("at most {:g} mm; state smaller errors, and add the rest to "
                             "margin_mm",
                             kPoseErrorMmMax)});
        }
    }
    return out;
}

WorstPoseError worst_pose_error(const LoadedMachine& loaded) {
    Machine machine = loaded.machine;
    const std::vector<double>& mm = machine.pose_errors.mm;
    const auto most = std::max_element(mm.begin(), mm.end());
    WorstPoseError out{static_cast<std::uint32_t>(most - mm.begin()), *most, {}};
    for (Axis& axis : machine.axes) {
        if (axis.skew_mm > 0) {
            out.parts.push_back({fmt::format("axes.{}.skew_mm", axis.name),
                                 cost_mm(axis.skew_mm, machine, loaded.meshes, out)});
        }
    }
    for (Body& body : machine.bodies) {
        const std::string path = fmt::format("bodies.{}.", body.name);
        add_parts(joint_keys(AxisKind::rotary), path, body.joint, machine, loaded.meshes, out);
        add_parts(body_keys(), path, body, machine, loaded.meshes, out);
    }
    for (Tool& tool : machine.tools) {
        add_parts(tool_keys(), fmt::format("tools.{}.", tool.number), tool, machine, loaded.meshes,
                  out);
    }
    std::erase_if(out.parts, [](const PoseErrorPart& part) { return part.mm <= 0; });
    std::stable_sort(out.parts.begin(), out.parts.end(),
                     [](const auto& a, const auto& b) { return a.mm > b.mm; });
    return out;
}

}  // namespace axg
