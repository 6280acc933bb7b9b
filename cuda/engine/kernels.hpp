// SPDX-License-Identifier: Apache-2.0
// One wrapper a kernel: a constant grid, and the status of the launch. Every kernel takes all its
// addresses from DeviceBuffers; grids are sized by the multiprocessors given, never by a batch.
#pragma once

#include <cuda_runtime.h>

#include <cstddef>
#include <cstdint>

#include "cuda/engine/device_data.hpp"

namespace axg::cuda {

/// Compute capability (its major number) since which a kernel may be set up while the one before it
/// runs; cuda/engine/launch_kernel.cuh.
inline constexpr int kOverlapsSince = 9;

/// Where kernels go: a stream, how many multiprocessors it has, and what its device can.
struct Launch {
    cudaStream_t stream = nullptr;
    unsigned multiprocessors = 1;
    bool overlaps = false;  // a kernel may be set up while the one before it runs
};

/// Where the test of two triangles has its axis data from: edges, normals, squares and area of each
/// triangle. computed: from the vertices, for every pair anew. cached: once a triangle and pair of
/// leaves, in shared memory. prefetched: cached, and the next pair of leaves is on its way while
/// this one is tested. All give the same bits.
enum class AxisData : std::uint8_t { computed, cached, prefetched };

/// Bytes of one PreparedQuery, which only device code knows.
[[nodiscard]] std::size_t prepared_query_size_bytes() noexcept;

/// Zeroes the counters, reads the queries, works out their constants, lists the two roots.
cudaError_t launch_prepare_queries(const DeviceBuffers& buffers, const Launch& launch) noexcept;
/// The same where parts of boxes come first, which it poses.
cudaError_t launch_prepare_parts(const DeviceBuffers& buffers, const Launch& launch) noexcept;
/// Clearance: an upper bound of each distance, by going down to the nearest pair of leaves.
cudaError_t launch_seed_upper_bounds(const DeviceBuffers& buffers, const Launch& launch) noexcept;
/// Opens every pair of nodes of one tree level.
cudaError_t launch_open_pairs(const DeviceBuffers& buffers, const Launch& launch,
                              std::uint32_t tree_level) noexcept;
/// Pairs of leaves: clips their triangles and tests what is left, in float.
cudaError_t launch_test_leaves(const DeviceBuffers& buffers, const Launch& launch) noexcept;
/// The same for clearance: certified distances in float, and the candidates they leave.
cudaError_t launch_measure_leaves(const DeviceBuffers& buffers, const Launch& launch) noexcept;
/// Pairs of triangles that float could not tell apart, in double.
cudaError_t launch_recheck_pairs(const DeviceBuffers& buffers, const Launch& launch) noexcept;
/// Clearance: certified distances in double, first (0) of the candidates that float calls nearest,
/// then (1) of all that are not beyond those.
cudaError_t launch_refine_distances(const DeviceBuffers& buffers, const Launch& launch,
                                    unsigned step) noexcept;
/// Clearance: the candidate with the least distance; of equal ones that with the lowest ids.
cudaError_t launch_pick_nearest(const DeviceBuffers& buffers, const Launch& launch) noexcept;
/// Results into pinned memory, the batch's sequence number last.
cudaError_t launch_write_results(const DeviceBuffers& buffers, const Launch& launch) noexcept;

}  // namespace axg::cuda
