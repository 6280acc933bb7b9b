// SPDX-License-Identifier: Apache-2.0
// The seed paper's way on a processor: every pair of triangles, six or eleven axes each, in float.
#include <vector>

#include "core/machine/kinematics.hpp"
#include "cuda/paper/brute_cpu.hpp"
#include "tests/benchmarks/peer.hpp"

namespace axg::test {
namespace {

class PaperPeer final : public Peer {
  public:
    explicit PaperPeer(const Scene& scene) : scene_{scene} {
        for (const Mesh& mesh : scene.bodies) {
            bodies_.push_back(paper::make_body(mesh.triangles));
        }
    }
    [[nodiscard]] std::string name() const override { return "paper's test"; }

    void cycle(std::span<const Pose> placed, std::span<std::uint8_t> hit) override {
        for (std::size_t pair = 0; pair < scene_.pairs.size(); ++pair) {
            const ScenePair& p = scene_.pairs[pair];
            const paper::Found found = paper::test_naively(bodies_[p.a], bodies_[p.b],
                                                           relative_pose(placed[p.a], placed[p.b]));
            hit[pair] = found.touching > 0 ? 1 : 0;
        }
    }

  private:
    const Scene& scene_;
    std::vector<paper::Body> bodies_;
};

}  // namespace

std::unique_ptr<Peer> make_paper(const Scene& scene) {
    return std::make_unique<PaperPeer>(scene);
}

}  // namespace axg::test
