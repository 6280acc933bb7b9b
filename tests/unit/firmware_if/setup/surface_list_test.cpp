// SPDX-License-Identifier: Apache-2.0
// A pair with a surface of its own is judged by it, in both modes and with the tool it was made
// for; every other pair by the body's own surface, and containment tests by whole bodies.
#include "firmware_if/setup/surface_list.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <optional>

#include "core/certificate/pair_queries.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "tests/support/solids.hpp"
#include "tests/support/table_and_head.hpp"

namespace axg::test {
namespace {

constexpr Vec3f kPostLow{-20, -20, 0}, kPostHigh{20, 20, 100};

/// A table and a plate side by side at z = 0, both fixed to the ground, and a head whose lower end
/// is at z = 0 too; where the head has a surface of its own that one ends 50 mm above.
class PairSurfaces : public testing::Test {
  protected:
    enum : std::uint32_t { kPlate = kBodies };  // behind table, head, cutter

    PairSurfaces() {
        Machine& m = loaded_.machine;
        m = table_and_head_machine();
        m.bodies[kTable].joint = {};
        m.bodies.push_back(m.bodies[kTable]);
        m.pairs = {{kHead, kTable, 1}, {kPlate, kHead, 1}, {kCutter, kTable, 1}};
        loaded_.meshes.bodies = {{"table", box({-50, -50, -10}, {0, 50, 0})},
                                 {"head", box(kPostLow, kPostHigh)},
                                 {"", {}},
                                 {"plate", box({1, -50, -10}, {50, 50, 0})}};
        loaded_.meshes.tools = {{"long", box({-2, -2, 0}, {2, 2, 40})},
                                {"other", box({-2, -2, 0}, {2, 2, 40})}};
        loaded_.meshes.of_pairs = {{"upper part", box({-20, -20, 50}, kPostHigh)},
                                   {"shank", box({-2, -2, 30}, {2, 2, 40})}};
        m.pair_surfaces = {{.body = kHead, .against = kTable, .surface = 0},
                           {.body = kCutter, .against = kTable, .tool = 1, .surface = 1}};
    }

    void make() {
        certificate_.reset();
        engine_.emplace(std::move(*make_engine(loaded_)));
        containment_test_.emplace(std::move(*make_containment_test(loaded_, *engine_)));
        certificate_.emplace(*make_stop_certificate(loaded_));
    }

    /// What the pairs are called at the head's height `z` in contact mode: 'f' for far and nothing
    /// inside, 'i' for something inside, 'n' for near.
    std::string contact(double z, std::uint16_t tool) {
        AxisSnapshot snapshot = at(z, tool);
        const auto pair_queries = std::make_unique<PairQueries>();
        make_contact_queries(loaded_.machine, snapshot, *pair_queries);
        std::vector<QueryResult> results(pair_queries->count + 2);
        std::vector<ContainmentResult> inside(pair_queries->count);
        engine_->run({pair_queries->queries.data(), results.size()}, results);
        containment_test_->run({pair_queries->queries.data(), inside.size()},
                               std::span(results).first(pair_queries->count), inside);
        EXPECT_EQ(
            known_answer_signature(results[pair_queries->count], results[pair_queries->count + 1]),
            kKnownAnswerSignature);
        std::string out;
        for (std::size_t i = 0; i < inside.size(); ++i) {
            out += letter(results[i].proof == Proof::far, inside[i]);
        }
        return out;
    }

    /// The same in stoppable mode, of a machine that stands.
    std::string stoppable(double z, std::uint16_t tool) {
        certificate_.emplace(*make_stop_certificate(loaded_));
        AxisSnapshot snapshot = at(z, tool);
        for (std::uint32_t i = 0; i < kSamplesKept; ++i) {
            ++snapshot.sample;
            certificate_->note(snapshot, i == 0);
        }
        certificate_->prove(engine_->engine(), *containment_test_);
        EXPECT_EQ(certificate_->cycle().known_answer_signature, kKnownAnswerSignature);
        std::string out;
        for (const PairProof& proof : certificate_->cycle().proofs) {
            out += letter(proof.surfaces.proof == JointBoxProof::proven, proof.containment_result);
        }
        return out;
    }

    static AxisSnapshot at(double z, std::uint16_t tool) {
        AxisSnapshot snapshot;
        snapshot.axis_count = 5;
        snapshot.tool = tool;
        snapshot.mode = kModeMoving;
        snapshot.position[2] = z;
        return snapshot;
    }
    static char letter(bool is_far, const ContainmentResult& inside) {
        return !is_far                                         ? 'n'
               : inside.containment == Containment::none       ? 'f'
               : inside.containment == Containment::not_proven ? '?'
                                                               : 'i';
    }

    LoadedMachine loaded_;
    std::optional<CpuEngine> engine_;
    std::optional<ContainmentTest> containment_test_;
    std::optional<StopCertificate> certificate_;
};

TEST_F(PairSurfaces, StandForABodyInTheirPairWithTheirToolAlone) {
    make();
    EXPECT_EQ(contact(0.5, 1), "fnn") << "head and table, plate and head, tool 1 and table";
    EXPECT_EQ(contact(0.5, 2), "fnf");
    EXPECT_EQ(contact(1.5, 1), "fff");
    EXPECT_EQ(contact(-49.5, 2), "nnn") << "the upper part comes near in its turn, and the shank";
    // A stop takes the axes some millimetres further.
    EXPECT_EQ(stoppable(0.5, 1), "fnn");
    EXPECT_EQ(stoppable(0.5, 2), "fnf");
    EXPECT_EQ(stoppable(40, 1), "fff");
    EXPECT_EQ(stoppable(-49.5, 2), "nnn");
}

TEST_F(PairSurfaces, WithoutThemEveryPairIsJudgedByItsBodies) {
    loaded_.machine.pair_surfaces.clear();
    make();
    EXPECT_EQ(contact(0.5, 2), "nnn");
    EXPECT_EQ(stoppable(0.5, 2), "nnn");
}

/// Surfaces that are far say nothing of insides, and a part of one says less.
TEST_F(PairSurfaces, ContainmentTestsAreOfWholeBodies) {
    loaded_.meshes.bodies[kTable] = {"core", box({-5, -5, 20}, {5, 5, 30})};
    make();
    EXPECT_EQ(contact(0, 1).front(), 'i') << "the core of the head's lower half";
    EXPECT_EQ(stoppable(0, 1).front(), 'i');
    loaded_.machine.pair_surfaces[0].is_whole = true;
    make();
    EXPECT_EQ(contact(0, 1).front(), 'f') << "now the upper part is all there is";
    EXPECT_EQ(contact(-40, 1).front(), 'i') << "and the core is inside of it";
    EXPECT_EQ(stoppable(0, 1).front(), 'f');
}

/// Simplified bodies have their whole surfaces behind all others, for the insides.
TEST_F(PairSurfaces, AreFoundBesideSimplifiedOnes) {
    loaded_.meshes.simple_bodies.resize(loaded_.meshes.bodies.size());
    loaded_.meshes.simple_bodies[kHead] = {"open head", box(kPostLow, kPostHigh)};
    loaded_.meshes.simple_bodies[kHead].triangles.pop_back();  // no inside of its own
    loaded_.meshes.bodies[kPlate] = {"core", box({-5, -5, 20}, {5, 5, 30})};
    make();
    EXPECT_EQ(contact(0, 1), "fin");
    const SurfaceList list = surface_list(loaded_);
    EXPECT_EQ(list.engines.size(), 4U + 2U + 1U + 2U);
    ASSERT_EQ(list.behind.size(), 1U);
    EXPECT_EQ(list.behind[0], &loaded_.meshes.bodies[kHead]);
    EXPECT_EQ(list.engines[kHead], &loaded_.meshes.simple_bodies[kHead]);
    EXPECT_EQ(list.bodies().size(), 4U);
    EXPECT_EQ(list.tools()[1], &loaded_.meshes.tools[1]);
}

}  // namespace
}  // namespace axg::test
