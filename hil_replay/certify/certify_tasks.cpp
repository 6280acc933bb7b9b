// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/certify/certify_tasks.hpp"

#include "core/certificate/pair_tasks.hpp"
#include "core/certificate/travel.hpp"

namespace axg {

CertifyTasks certify_tasks(const LoadedMachine& loaded) {
    const Machine& machine = loaded.machine;
    const SurfaceList surfaces = surface_list(loaded);
    CertifyTasks out;
    for (const Mesh* mesh : surfaces.engines) {
        out.extents.push_back(extent_of(*mesh));
    }
    for (std::uint32_t i = 0; i < machine.pairs.size(); ++i) {
        const Pair& pair = machine.pairs[i];
        for (std::uint32_t k = 0; k < tasks_of(machine, pair); ++k) {
            const std::uint32_t tool = has_tool(machine, pair) ? k : kNoIndex;
            CertifyTask task;
            task.pair = i;
            task.tool = tool;
            task.task = pair_task(machine, i, tool, out.extents);
            task.surface_a = surfaces.engines[task.task.mesh_a];
            task.surface_b = surfaces.engines[task.task.mesh_b];
            task.whole_a = surfaces.whole[surfaces.same_as[task.task.mesh_a]];
            task.whole_b = surfaces.whole[surfaces.same_as[task.task.mesh_b]];
            out.tasks.push_back(task);
        }
    }
    return out;
}

}  // namespace axg
