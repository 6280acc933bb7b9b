// SPDX-License-Identifier: Apache-2.0
// The seed paper's kernels on a GPU, each of its techniques on or off, and beside them the
// certified test of every pair of triangles. For comparison only: no engine runs these. No CUDA
// type shows here, and a build without a CUDA compiler has this header too: create() then says so.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cuda/paper/paper_scene.hpp"

namespace axg::paper {

/// The paper's techniques. What each name stands for here: docs/theory/paper-mode.md.
struct Techniques {
    bool boxes = false;        // two levels of boxes, breadth first, before any triangle
    bool interchange = false;  // each group's triangles against the other group's box
    bool unroll = false;       // loops over axes unrolled
    bool prefetch = false;     // groups through shared memory, the next one on its way
    bool carry = false;        // the axis that separated a pair at the last pose is tried first
    // Each coordinate in an array of its own: a warp's loads are of neighbours. Only by itself.
    bool coalesced = false;
};

inline constexpr Techniques kNoTechnique{};
inline constexpr Techniques kAllTechniques{true, true, true, true, true, false};

struct Device {
    std::string name;
    unsigned multiprocessors = 0, multiprocessors_used = 0;
    int driver = 0, runtime = 0;  // as CUDA numbers them: 13000 is 13.0
};

/// What a kernel was compiled to, as the runtime tells it.
struct KernelFacts {
    std::string name;
    int registers = 0;
    std::size_t shared_bytes = 0, local_bytes = 0;  // local: stack and spills, a thread
};

/// One query to the GPU: which pair, placed how (a's frame to b's).
struct PairPose {
    std::uint32_t pair = 0;
    Pose pose;
};

enum class Timing : std::uint8_t {
    each,    // one after the other, until the host has the count: what a cycle would wait
    queued,  // all recorded as one graph; the device's own clock
};

class Gpu {
  public:
    /// Copies the scene. Empty, with `fault` set: no device, or it refused.
    /// @param multiprocessors  a partition of so many (a green context); 0: all
    [[nodiscard]] static std::optional<Gpu> create(const Scene& scene, unsigned multiprocessors,
                                                   std::string& fault);
    Gpu(Gpu&&) noexcept;
    Gpu& operator=(Gpu&&) = delete;
    ~Gpu();

    /// Runs query after query; axes carried over start empty. found, us: one a query.
    /// False: the device failed, and `fault()` says how.
    /// @param together  so many queries are timed as one, a divisor of their number: us[i] of the
    ///                  first of them is their time, of the others 0
    [[nodiscard]] bool run_paper(const Techniques& techniques, Timing timing,
                                 std::uint32_t together, std::span<const PairPose> queries,
                                 std::span<Found> found, std::span<double> us);
    /// The certified test of every pair of triangles, all seventeen axes of each, none left early.
    /// @param together  so many queries a launch, timed as one; at most 8
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
