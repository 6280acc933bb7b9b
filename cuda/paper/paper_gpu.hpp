// SPDX-License-Identifier: Apache-2.0
// The seed paper's kernels on a GPU, each of its techniques on or off, and the certified test of
// every pair of triangles. For comparison only: no engine runs these. This header has no CUDA
// types: a build without a CUDA compiler has it too, and create() then reports absent kernels.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cuda/paper/paper_scene.hpp"

namespace axg::paper {

/// The paper's techniques; docs/theory/paper-mode.md defines each.
struct Techniques {
    bool boxes = false;        // two levels of boxes, breadth first, before any triangle
    bool interchange = false;  // each group's triangles against the other group's box
    bool unroll = false;       // loops over axes unrolled
    bool prefetch = false;     // groups in shared memory; the next one loads meanwhile
    bool carry = false;        // tries first the axis that separated a pair at the last pose
    // Each coordinate in its own array: a warp loads neighbours. Excludes the others but boxes.
    bool coalesced = false;
};

inline constexpr Techniques kNoTechnique{};
inline constexpr Techniques kAllTechniques{true, true, true, true, true, false};

struct Device {
    std::string name;
    unsigned multiprocessors = 0, multiprocessors_used = 0;
    int driver = 0, runtime = 0;  // as CUDA numbers them: 13000 is 13.0
};

/// Resources of a compiled kernel, read from the runtime.
struct KernelFacts {
    std::string name;
    int registers = 0;
    std::size_t shared_bytes = 0, local_bytes = 0;  // local: stack and spills, a thread
};

/// One query to the GPU: a pair of bodies and its pose (a's frame to b's).
struct PairPose {
    std::uint32_t pair = 0;
    Pose pose;
};

enum class Timing : std::uint8_t {
    each,    // one after the other, until the host has the counts: the wait of a cycle
    queued,  // all recorded as one graph; measured by the device's clock
};

class Gpu {
  public:
    /// Copies the scene. Returns nothing and sets `fault` without a device, after a CUDA error, or
    /// unless the scene has 1 to 8 pairs.
    /// @param multiprocessors  size of the partition (a green context); 0: all
    [[nodiscard]] static std::optional<Gpu> create(const Scene& scene, unsigned multiprocessors,
                                                   std::string& fault);
    Gpu(Gpu&&) noexcept;
    Gpu& operator=(Gpu&&) = delete;
    ~Gpu();

    /// Runs the queries in turn; axes carried over start empty. found, us: one per query.
    /// False: the device failed or the kernel is not compiled; `fault()` returns the reason.
    /// @param together  number of queries timed as one, at most 8, a divisor of their number: us[i]
    ///                  of the first of them is their time, of the others 0
    [[nodiscard]] bool run_paper(const Techniques& techniques, Timing timing,
                                 std::uint32_t together, std::span<const PairPose> queries,
                                 std::span<Found> found, std::span<double> us);
    /// The certified test of every pair of triangles with all seventeen axes, without early exit.
    /// @param together  number of queries per launch, timed as one; at most 8
    [[nodiscard]] bool run_certified(Timing timing, std::uint32_t together,
                                     std::span<const PairPose> queries, std::span<Found> found,
                                     std::span<double> us);

    [[nodiscard]] const Device& device() const noexcept;
    [[nodiscard]] const std::string& fault() const noexcept;
    [[nodiscard]] std::vector<KernelFacts> kernels() const;

  private:
    struct Parts;
    explicit Gpu(std::unique_ptr<Parts> parts) noexcept;

    std::unique_ptr<Parts> parts_;
};

}  // namespace axg::paper
