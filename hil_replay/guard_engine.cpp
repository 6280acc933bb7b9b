// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/guard_engine.hpp"

#include <algorithm>
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

std::vector<const Mesh*> engine_surfaces_of(const LoadedMachine& loaded) {
    std::vector<const Mesh*> meshes = surfaces_of(loaded);
    std::size_t place = 0;
    for (const std::vector<Mesh>* simple :
         {&loaded.meshes.simple_bodies, &loaded.meshes.simple_tools}) {
        for (const Mesh& mesh : *simple) {
            meshes[place] = mesh.triangles.empty() ? meshes[place] : &mesh;
            ++place;
        }
    }
    return meshes;
}

std::optional<CpuEngine> make_engine(const LoadedMachine& loaded) {
    std::vector<const Mesh*> meshes = engine_surfaces_of(loaded);
    const std::vector<const Mesh*> whole = surfaces_of(loaded);
    const Mesh canary = canary_mesh();
    meshes.push_back(&canary);
    for (std::size_t i = 0; i < whole.size(); ++i) {  // their trees, for make_solids
        if (meshes[i] != whole[i]) {
            meshes.push_back(whole[i]);
        }
    }
    return CpuEngine::create(meshes, loaded.machine.capacities);
}

std::optional<CudaEngine> make_gpu_engine(const LoadedMachine& loaded, std::string& fault) {
    std::vector<const Mesh*> meshes = engine_surfaces_of(loaded);
    const Mesh canary = canary_mesh();
    meshes.push_back(&canary);
    return CudaEngine::create(meshes, loaded.machine.capacities, {}, fault);
}

std::uint32_t levels_of(const LoadedMachine& loaded) {
    std::uint32_t levels = 1;
    for (const Mesh* mesh : engine_surfaces_of(loaded)) {
        if (has_usable_triangles(*mesh)) {
            levels = std::max(levels, size_of(shape_of(*mesh)).depth - 1);
        }
    }
    return levels;
}

std::optional<Solids> make_solids(const LoadedMachine& loaded, const CpuEngine& engine) {
    const std::vector<const Mesh*> whole = surfaces_of(loaded);
    const std::vector<const Mesh*> simple = engine_surfaces_of(loaded);
    std::vector<Tree> trees(engine.trees().begin(), engine.trees().end());
    std::size_t next = whole.size() + 1;  // behind the canary
    for (std::size_t i = 0; i < whole.size(); ++i) {
        trees[i] = simple[i] == whole[i] ? trees[i] : trees[next++];
    }
    return Solids::create(whole, trees, loaded.machine.capacities);
}

std::optional<StopPlan> make_stop_plan(const LoadedMachine& loaded, bool forgets_jerk_ramp) {
    const AxisFrameSet set = make_frame_set(loaded.machine);
    StopOptions options;
    options.forgets_jerk_ramp = forgets_jerk_ramp;
    for (std::uint32_t i = 0; i < set.axis_count; ++i) {
        options.count[i] = set.axes[i].unit;
    }
    return StopPlan::create(loaded.machine, engine_surfaces_of(loaded), options);
}

}  // namespace axg
