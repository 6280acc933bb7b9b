// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/setup/guard_engine.hpp"

#include <algorithm>
#include <vector>

#include "core/machine/cycle_plan.hpp"
#include "firmware_if/protocol/axis_frames.hpp"
#include "firmware_if/setup/surface_list.hpp"

namespace axg {

std::optional<CpuEngine> make_engine(const LoadedMachine& loaded) {
    const SurfaceList surfaces = surface_list(loaded);
    std::vector<const Mesh*> meshes = surfaces.engines;
    meshes.insert(meshes.end(), surfaces.behind.begin(), surfaces.behind.end());
    return CpuEngine::create(meshes, loaded.machine.capacities);
}

std::optional<CudaEngine> make_gpu_engine(const LoadedMachine& loaded, std::string& fault,
                                          std::uint32_t multiprocessors) {
    CudaOptions options;
    options.multiprocessors = multiprocessors;
    return CudaEngine::create(surface_list(loaded).engines, loaded.machine.capacities, options,
                              fault);
}

std::uint32_t tree_levels_of(const LoadedMachine& loaded) {
    std::uint32_t tree_levels = 1;
    for (const Mesh* mesh : surface_list(loaded).engines) {
        if (has_usable_triangles(*mesh)) {
            tree_levels = std::max(tree_levels, size_of(shape_of(*mesh)).depth - 1);
        }
    }
    return tree_levels;
}

std::optional<ContainmentTest> make_containment_test(const LoadedMachine& loaded,
                                                     const CpuEngine& engine) {
    const SurfaceList surfaces = surface_list(loaded);
    std::vector<Tree> trees;
    for (const std::uint32_t place : surfaces.whole_tree) {
        trees.push_back(engine.trees()[place]);
    }
    return ContainmentTest::create(surfaces.whole, trees, loaded.machine.capacities,
                                   surfaces.same_as);
}

std::optional<StopCertificate> make_stop_certificate(const LoadedMachine& loaded,
                                                     const std::optional<CyclePlan>& plan) {
    StopOptions options;
    options.plan = plan ? *plan : cycle_plan(loaded.machine, stop_tasks(loaded.machine));
    options.count = axis_units(loaded.machine);
    return StopCertificate::create(loaded.machine, surface_list(loaded).engines, options);
}

}  // namespace axg
