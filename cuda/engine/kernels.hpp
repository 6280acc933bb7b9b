// SPDX-License-Identifier: Apache-2.0
// One wrapper per kernel: a constant grid, and the status of the launch. A kernel reads all its
// addresses from DeviceBuffers. Grids depend on multiprocessors or capacities, never on a batch.
#pragma once

#include <cuda_runtime.h>

#include <cstddef>
#include <cstdint>

#include "cuda/engine/device_data.hpp"

namespace axg::cuda {

/// Compute capability (its major number) since which a kernel may be set up while the one before it
/// runs; cuda/engine/launch_kernel.cuh.
inline constexpr int kOverlapsSince = 9;

/// Target of a launch: a stream, the number of its multiprocessors, and an ability of its device.
struct Launch {
    cudaStream_t stream = nullptr;
    unsigned multiprocessors = 1;
    bool overlaps = false;  // a kernel may be set up while the one before it runs
};

/// Source of the axis data (edges, normals, squares and area of each triangle) in the test of two
/// triangles. computed: from the vertices, anew for every pair. cached: computed once per triangle
/// and pair of leaves, in shared memory. prefetched: cached, and the next pair of leaves loads
/// while this one is tested. All give the same bits.
enum class AxisData : std::uint8_t { computed, cached, prefetched };

/// Bytes of one PreparedQuery, which only device code defines.
[[nodiscard]] std::size_t prepared_query_size_bytes() noexcept;

/// Zeroes the counters, reads the queries, computes their constants, lists the two roots.
cudaError_t launch_prepare_queries(const DeviceBuffers& buffers, const Launch& launch) noexcept;
/// The same for a batch that begins with parts of boxes, which it poses.
cudaError_t launch_prepare_parts(const DeviceBuffers& buffers, const Launch& launch) noexcept;
/// Clearance: computes an upper bound of each distance by a descent to the nearest pair of leaves.
cudaError_t launch_seed_upper_bounds(const DeviceBuffers& buffers, const Launch& launch) noexcept;
/// Opens every pair of nodes of one tree level.
cudaError_t launch_open_pairs(const DeviceBuffers& buffers, const Launch& launch,
                              std::uint32_t tree_level) noexcept;
/// Pairs of leaves: clips their triangles and tests the remaining pairs in float.
cudaError_t launch_test_leaves(const DeviceBuffers& buffers, const Launch& launch) noexcept;
/// The same for clearance: computes certified distances in float and lists the candidates.
cudaError_t launch_measure_leaves(const DeviceBuffers& buffers, const Launch& launch) noexcept;
/// Tests in double the pairs of triangles that float could not decide.
cudaError_t launch_recheck_pairs(const DeviceBuffers& buffers, const Launch& launch) noexcept;
/// Clearance: computes certified distances in double, in step 0 of the candidates nearest in float,
/// in step 1 of all others whose bound in float is below the least of step 0.
cudaError_t launch_refine_distances(const DeviceBuffers& buffers, const Launch& launch,
                                    unsigned step) noexcept;
/// Clearance: finds the candidate with the least distance; of equal ones that with the lowest ids.
cudaError_t launch_pick_nearest(const DeviceBuffers& buffers, const Launch& launch) noexcept;
/// Writes results to pinned memory, each with the batch's sequence number and a check word.
cudaError_t launch_write_results(const DeviceBuffers& buffers, const Launch& launch) noexcept;

}  // namespace axg::cuda
