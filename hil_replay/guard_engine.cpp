// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/guard_engine.hpp"

#include <vector>

#include "core/pair_plan.hpp"
#include "firmware_if/axis_frames.hpp"

namespace axg {

namespace {

/// Bodies, then tools.
std::vector<const Mesh*> surfaces_of(const LoadedMachine& loaded) {
    std::vector<const Mesh*> meshes;
    for (const Mesh& mesh : loaded.meshes.bodies) {
        meshes.push_back(&mesh);
    }
    for (const Mesh& mesh : loaded.meshes.tools) {
        meshes.push_back(&mesh);
    }
    return meshes;
}

}  // namespace

std::optional<CpuEngine> make_engine(const LoadedMachine& loaded) {
    std::vector<const Mesh*> meshes = surfaces_of(loaded);
    const Mesh canary = canary_mesh();
    meshes.push_back(&canary);
    return CpuEngine::create(meshes, loaded.machine.capacities);
}

std::optional<Solids> make_solids(const LoadedMachine& loaded, const CpuEngine& engine) {
    return Solids::create(surfaces_of(loaded), engine.trees(), loaded.machine.capacities);
}

std::optional<StopPlan> make_stop_plan(const LoadedMachine& loaded, bool forgets_jerk_ramp) {
    const AxisFrameSet set = make_frame_set(loaded.machine);
    StopOptions options;
    options.forgets_jerk_ramp = forgets_jerk_ramp;
    for (std::uint32_t i = 0; i < set.axis_count; ++i) {
        options.count[i] = set.axes[i].unit;
    }
    return StopPlan::create(loaded.machine, surfaces_of(loaded), options);
}

}  // namespace axg
