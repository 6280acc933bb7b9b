// SPDX-License-Identifier: Apache-2.0
// One collision library as the benchmark sees it: the meshes once, then yes or no for all pairs of
// a pose. Each library has its own file, so that their headers never meet.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "tests/support/scene.hpp"

namespace axg::test {

class Peer {
  public:
    virtual ~Peer() = default;
    [[nodiscard]] virtual std::string name() const = 0;

    /// Answers every pair of the scene in one pose; what a caller would do each cycle is inside:
    /// setting the placements, or composing them.
    ///
    /// @param placed  [bodies] mesh frame to machine coordinates
    /// @param hit     [pairs] out, 1 for a contact
    virtual void cycle(std::span<const Pose> placed, std::span<std::uint8_t> hit) = 0;
};

/// Each takes the meshes and pairs of the scene, which outlives the peer.
[[nodiscard]] std::unique_ptr<Peer> make_axguard(const Scene& scene);
[[nodiscard]] std::unique_ptr<Peer> make_fcl(const Scene& scene);
[[nodiscard]] std::unique_ptr<Peer> make_bullet(const Scene& scene);
[[nodiscard]] std::unique_ptr<Peer> make_ode(const Scene& scene);
[[nodiscard]] std::unique_ptr<Peer> make_coal(const Scene& scene);  // where AXG_COAL is defined
[[nodiscard]] std::unique_ptr<Peer> make_boxes(const Scene& scene);
[[nodiscard]] std::unique_ptr<Peer> make_spheres(const Scene& scene);
[[nodiscard]] std::unique_ptr<Peer> make_paper(const Scene& scene);

/// Certified lower bounds of the clearances, mm, 0 for a contact: [pose][pair]. What is farther
/// than `within_mm` has that.
[[nodiscard]] std::vector<double> clearances_mm(const Scene& scene, double within_mm);

}  // namespace axg::test
