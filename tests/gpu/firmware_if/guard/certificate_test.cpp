// SPDX-License-Identifier: Apache-2.0
// Whole certificates over both engines, at random places of the travel and near contact, at random
// speeds: with lists that are long enough every pair is decided alike; where they are short, what
// the GPU proves the CPU proves too. AXG_COUNT: certificates of each kind; AXG_SEED: which.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <random>

#include "core/certificate/stop_certificate.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "firmware_if/setup/surface_list.hpp"
#include "firmware_if/setup/travel_sample.hpp"
#include "tests/support/count.hpp"
#include "tests/support/cuda_fixture.hpp"
#include "tests/support/replay_fixture.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

struct Tally {
    std::uint64_t both = 0, neither = 0, cpu_alone = 0, gpu_alone = 0, stages = 0;
    std::uint64_t full = 0, contradictions = 0;  // decided differently, and no list was full
};

class CudaCertificate : public testing::Test {
  protected:
    /// Two snapshots, the fewest that anything is proven of: most anywhere, the others a little off
    /// the last place where something was not proven.
    void draw(std::mt19937_64& random) {
        const Machine& machine = paper.loaded.machine;
        const auto between = [&random](double low, double high) {
            return low + (high - low) * static_cast<double>(random() >> 11U) * 0x1p-53;
        };
        const bool stays_near = has_near && random() % 8 == 0;
        before =
            stays_near ? near : sampled_position(machine, static_cast<std::uint32_t>(random()));
        before.tool = machine.first_tool;
        before.sample = 2 * ++number;
        const double speed = between(0, 1) * between(0, 0.95);
        now = before;
        now.sample = before.sample + 1;
        for (std::size_t i = 0; i < machine.axes.size(); ++i) {
            const Axis& axis = machine.axes[i];
            const double off = stays_near ? 0.002 * (axis.max - axis.min) * between(-1, 1) : 0;
            const double step =
                between(-1, 1) * speed * axis.speed_max * machine.can.sample_us * 1e-6;
            const auto kept = [&axis](double at) {
                return axis.unlimited ? at : std::min(std::max(at, axis.min), axis.max);
            };
            before.position[i] = kept(before.position[i] + off);
            now.position[i] = kept(before.position[i] + step);
        }
    }
    void prove(StopCertificate& certificate, const Engine& engine) const {
        certificate.note(before, true);
        certificate.note(now, false);
        certificate.prove(engine, *paper.containment_test);
        certificate.keep();
    }
    /// Of AXG_COUNT certificates with the machine's plan, pair by pair; printed as `what`.
    Tally compare(CudaEngine& gpu, const char* what, std::uint64_t usual_seed) {
        const std::uint64_t seed = test::printed_seed(usual_seed);
        std::optional<StopCertificate> on_cpu = make_stop_certificate(paper.loaded),
                                       on_gpu = make_stop_certificate(paper.loaded);
        std::mt19937_64 random(seed);
        Tally tally;
        for (std::uint64_t i = 0; i < count && gpu.fault() == nullptr; ++i) {
            draw(random);
            prove(*on_cpu, paper.engine->engine());
            prove(*on_gpu, gpu.engine());
            const StopCycle cpu = on_cpu->cycle(), other = on_gpu->cycle();
            EXPECT_EQ(cpu.known_answer_signature, other.known_answer_signature);
            EXPECT_EQ(cpu.proofs.size(), other.proofs.size());
            for (std::size_t k = 0; k < cpu.proofs.size(); ++k) {
                const PairProof &x = cpu.proofs[k], &y = other.proofs[k];
                const bool is_on_cpu = is_proven(x), is_on_gpu = is_proven(y);
                const bool is_full =
                    is_overflow(x.surfaces.status) || is_overflow(y.surfaces.status);
                ++(is_on_cpu   ? is_on_gpu ? tally.both : tally.cpu_alone
                   : is_on_gpu ? tally.gpu_alone
                               : tally.neither);
                tally.full += is_full ? 1 : 0;
                tally.contradictions += is_on_cpu != is_on_gpu && !is_full ? 1 : 0;
                if (!is_on_cpu) {
                    near = now;
                    has_near = true;
                }
            }
            tally.stages += on_gpu->work().stages;
        }
        EXPECT_EQ(gpu.fault(), nullptr) << gpu.fault();
        print(what, seed, tally);
        return tally;
    }
    static bool is_proven(const PairProof& proof) {
        return proof.surfaces.proof == JointBoxProof::proven &&
               proof.containment_result.containment == Containment::none;
    }
    void print(const char* what, std::uint64_t seed, const Tally& tally) const {
        std::printf(
            "%s: %llu certificates (seed %llu), %.2f stages each; pairs proven by both %llu, by "
            "neither %llu, by the CPU alone %llu, by the GPU alone %llu; with full lists %llu\n",
            what, static_cast<unsigned long long>(count), static_cast<unsigned long long>(seed),
            static_cast<double>(tally.stages) / static_cast<double>(count),
            static_cast<unsigned long long>(tally.both),
            static_cast<unsigned long long>(tally.neither),
            static_cast<unsigned long long>(tally.cpu_alone),
            static_cast<unsigned long long>(tally.gpu_alone),
            static_cast<unsigned long long>(tally.full));
    }

    test::PaperMachine paper;
    AxisSnapshot before, now, near;
    bool has_near = false;
    const std::uint64_t count = test::count_from_environment(4000);
    std::uint64_t number = 0;
};

/// An engine with room for every pair of leaves of the machine in every query of a stage.
std::optional<CudaEngine> roomy_engine(const LoadedMachine& loaded, std::string& fault) {
    CudaOptions options{.level_pairs = 1U << 18U, .leaf_pairs = 1U << 20U};
    options.multiprocessors = test::number_from("AXG_SMS", 0);
    options.deadline_us = test::number_from("AXG_DEADLINE_US", options.deadline_us);
    return CudaEngine::create(surface_list(loaded).engines, loaded.machine.capacities, options,
                              fault);
}

#define AXG_GPU_OR_SKIP(name)                                                  \
    std::string name##_fault;                                                  \
    std::optional<CudaEngine> name = roomy_engine(paper.loaded, name##_fault); \
    if (!name) {                                                               \
        GTEST_SKIP() << name##_fault;                                          \
    }

TEST_F(CudaCertificate, WithLongListsPairsAreDecidedAlike) {
    // A whole box has a quarter of a stage's list, shared by all boxes left open, and the GPU
    // counts on behind the first contact: with 2^26 pairs of triangles 179 pairs are full, with
    // 2^28 four.
    paper.loaded.machine.cycle.lists = {1U << 22U, 1U << 22U, 1U << 26U, 1U << 29U, 0};
    AXG_GPU_OR_SKIP(gpu);
    const Tally tally = compare(*gpu, "long lists", 20261128);
    EXPECT_EQ(tally.contradictions, 0U);
    EXPECT_EQ(tally.full, 0U);
    EXPECT_GT(20 * tally.neither, count) << "near contact often enough";
    EXPECT_GT(tally.both, count);
}

// In two stages that is a theorem (docs/theory/certificate.md, "Stages and groups"). In three it
// holds where both engines find the same pairs open behind the second.
TEST_F(CudaCertificate, WithShortListsTheCpuProvesWhatTheGpuProves) {
    paper.loaded.machine.cycle.stages = 2;
    AXG_GPU_OR_SKIP(gpu);
    const Tally tally = compare(*gpu, "two stages", 20261129);
    EXPECT_EQ(tally.contradictions, 0U);
    EXPECT_EQ(tally.gpu_alone, 0U);
    EXPECT_GT(tally.full, 0U) << "lists are short enough to be noticed";
}

}  // namespace
}  // namespace axg
