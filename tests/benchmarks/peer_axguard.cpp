// SPDX-License-Identifier: Apache-2.0
// axguard's own engine: the relative poses are composed inside the timed cycle, all pairs are asked
// in one batch, and "not proven" counts as a contact.
#include <stdexcept>
#include <vector>

#include "core/collision/cpu_engine.hpp"
#include "core/machine/kinematics.hpp"
#include "tests/benchmarks/peer.hpp"

namespace axg::test {
namespace {

class AxguardPeer final : public Peer {
  public:
    AxguardPeer(const Scene& scene, CpuEngine engine)
        : scene_{scene},
          engine_{std::move(engine)},
          questions_(scene.pairs.size()),
          answers_(scene.pairs.size()) {
        for (std::size_t pair = 0; pair < questions_.size(); ++pair) {
            questions_[pair].mesh_a = scene.pairs[pair].a;
            questions_[pair].mesh_b = scene.pairs[pair].b;
        }
    }
    [[nodiscard]] std::string name() const override {
        return "axguard " + std::string{engine_.lanes()};
    }

    void cycle(std::span<const Pose> placed, std::span<std::uint8_t> hit) override {
        for (std::size_t pair = 0; pair < questions_.size(); ++pair) {
            const ScenePair& p = scene_.pairs[pair];
            questions_[pair].pose = relative_pose(placed[p.a], placed[p.b]);
        }
        engine_.ask(questions_, answers_);
        for (std::size_t pair = 0; pair < answers_.size(); ++pair) {
            hit[pair] = answers_[pair].proof == Proof::far ? 0 : 1;
        }
    }

  private:
    const Scene& scene_;
    CpuEngine engine_;
    std::vector<Question> questions_;
    std::vector<Answer> answers_;
};

}  // namespace

std::unique_ptr<Peer> make_axguard(const Scene& scene) {
    std::vector<const Mesh*> meshes;
    for (const Mesh& mesh : scene.bodies) {
        meshes.push_back(&mesh);
    }
    auto engine = CpuEngine::create(meshes, Capacities{});
    if (!engine) {
        throw std::runtime_error(std::string{kNoLaneSet});
    }
    return std::make_unique<AxguardPeer>(scene, std::move(*engine));
}

}  // namespace axg::test
