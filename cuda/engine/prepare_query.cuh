// SPDX-License-Identifier: Apache-2.0
// The constants of one query, computed by one thread before any node is opened.
#pragma once

#include "cuda/engine/device_traversal.cuh"

namespace axg::cuda {

/// Whether the engine can run the query; if so, fills all of `prepared` but its group.
__device__ __forceinline__ bool prepare_query(const DeviceTree* trees, std::uint32_t meshes,
                                              const Query& q, PreparedQuery& prepared) {
    if (q.mesh_a >= meshes || q.mesh_b >= meshes || !usable(q)) {
        return false;
    }
    prepared.a = trees[q.mesh_a];
    prepared.b = trees[q.mesh_b];
    if (prepared.a.node_count == 0 || prepared.b.node_count == 0) {
        return false;
    }
    prepared.pose = q.pose;
    prepared.inverse = inverse(q.pose);
    prepared.kind = q.kind;
    prepared.is_float_only = q.is_float_only;
    prepared.r_mm = q.r_mm;
    prepared.wants_list = q.list.size() != 0;
    set_constants(prepared.c, q, prepared.a.reach_mm, prepared.b.reach_mm);
    prepared.near_mm = prepared.c.has_margin ? sat::near_limit(q.r_mm) : 0.0F;
    return true;
}

}  // namespace axg::cuda
