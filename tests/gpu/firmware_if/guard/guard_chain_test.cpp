// SPDX-License-Identifier: Apache-2.0
// The guard's chain over a GPU: on the example programs, in both modes, it decides sample for
// sample what it decides over the CPU engine, with lists that are long enough; and with short
// ones, in two stages, it never gives a permit that the CPU does not. In contact mode a sample is
// one batch.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/setup/choose_engine.hpp"
#include "tests/support/cuda_fixture.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

/// What a sample came to.
struct Sample {
    std::uint16_t counter;
    bool has_permit;
    StopReason reason;
    std::uint32_t pair, queries, stages;

    friend bool operator==(const Sample&, const Sample&) = default;
};

struct Decisions {
    std::vector<Sample> samples;
    std::uint64_t permits = 0;

    /// What an engine that leaves queries out decides too.
    [[nodiscard]] std::vector<Sample> without_work() const {
        std::vector<Sample> out = samples;
        for (Sample& sample : out) {
            sample.queries = sample.stages = 0;
        }
        return out;
    }
};

/// Of two runs, where they first decide differently.
std::string first_difference(const Decisions& x, const Decisions& y) {
    const std::size_t count = std::min(x.samples.size(), y.samples.size());
    for (std::size_t i = 0; i < count; ++i) {
        const Sample &a = x.samples[i], &b = y.samples[i];
        if (a != b) {
            const auto text = [](const Sample& s) {
                return std::to_string(s.has_permit ? 1 : 0) + " reason " +
                       std::to_string(static_cast<int>(s.reason)) + " pair " +
                       std::to_string(s.pair) + " queries " + std::to_string(s.queries) +
                       " stages " + std::to_string(s.stages);
            };
            return "sample " + std::to_string(i) + ": permit " + text(a) + "; permit " + text(b);
        }
    }
    return std::to_string(x.samples.size()) + " and " + std::to_string(y.samples.size());
}

/// Passes calls on, and counts them: all, those of stages, and of those the ones of parts.
struct Counted {
    Engine engine;
    std::uint64_t calls = 0, calls_of_stages = 0, calls_of_parts = 0;

    static Engine over(Counted& counted) {
        Engine out = counted.engine;
        out.self = &counted;
        out.run = [](void* self, std::span<const Query> queries,
                     std::span<QueryResult> results) noexcept {
            auto& own = *static_cast<Counted*>(self);
            ++own.calls;
            own.engine(queries, results);
        };
        out.run_groups = [](void* self, std::span<const Query> queries,
                            std::span<QueryResult> results, std::span<GroupWork> groups) noexcept {
            auto& own = *static_cast<Counted*>(self);
            ++own.calls;
            ++own.calls_of_stages;
            own.engine(queries, results, groups);
        };
        out.run_parts = [](void* self, const PartQueries& parts, std::span<const Query> queries,
                           std::span<QueryResult> results, std::span<GroupWork> groups) noexcept {
            auto& own = *static_cast<Counted*>(self);
            ++own.calls;
            ++own.calls_of_stages;
            ++own.calls_of_parts;
            own.engine.run_parts(own.engine.self, parts, queries, results, groups);
        };
        return out;
    }
};

Decisions replayed(const LoadedMachine& loaded, const ContainmentTest& containment_test,
                   Engine engine, const std::vector<CanFrame>& frames, bool is_stoppable) {
    std::optional<StopCertificate> certificate =
        is_stoppable ? make_stop_certificate(loaded) : std::nullopt;
    ReplayOptions options;
    options.parts.stop_certificate = certificate ? &*certificate : nullptr;
    options.deadline_us = 1'000'000'000;
    options.keep_going = true;
    Decisions out;
    ReplayRun run(loaded.machine, engine, containment_test, options, [&](const ReplayCycle& cycle) {
        const StagedWork work = certificate ? certificate->work() : StagedWork{};
        out.samples.push_back({cycle.sync_counter, cycle.result.has_permit, cycle.result.reason,
                               cycle.result.pair, work.queries, work.stages});
        out.permits += cycle.result.has_permit ? 1 : 0;
    });
    for (const CanFrame& frame : frames) {
        static_cast<void>(run.on_frame(frame));
    }
    return out;
}

class CudaGuardChain : public testing::Test {
  protected:
    void SetUp() override {
        if (!std::filesystem::exists(AXG_PROGRAM)) {
            GTEST_SKIP() << AXG_PROGRAM << " is not built";
        }
        // Long lists, but for rechecks: what is certified within the margin needs none.
        paper.loaded.machine.capacities.batch = {1024, 8192, 32768, 1U << 18U, 512};
        // And of the plan, whose groups have shares: no list is full on either engine.
        paper.loaded.machine.cycle.lists = {1U << 16U, 1U << 16U, 1U << 20U, 1U << 20U, 0};
    }
    std::vector<CanFrame> simulated(const std::string& program) {
        EXPECT_EQ(shop.run("simulate " + test::kPaperMachine + " " + program + " -o t.log"),
                  kExitClean)
            << shop.err;
        return test::read_trace(shop.file("t.log"));
    }
    test::PaperMachine paper;
    test::Workshop shop;
};

#define AXG_GPU_OR_SKIP(name)                                                     \
    std::string name##_fault;                                                     \
    std::optional<CudaEngine> name = make_gpu_engine(paper.loaded, name##_fault); \
    if (!name) {                                                                  \
        GTEST_SKIP() << name##_fault;                                             \
    }

TEST_F(CudaGuardChain, DecidesWhatItDecidesOverTheCpu) {
    AXG_GPU_OR_SKIP(gpu);
    for (const std::string& program : {test::kDemoProgram, test::kCleanProgram}) {
        const std::vector<CanFrame> frames = simulated(program);
        for (const bool is_stoppable : {false, true}) {
            SCOPED_TRACE(program + (is_stoppable ? ", stoppable" : ", contact"));
            const Decisions cpu = replayed(paper.loaded, *paper.containment_test,
                                           paper.engine->engine(), frames, is_stoppable);
            // As a GPU does: whole batches, no early exit.
            paper.engine->set_counts_all(true);
            const Decisions eager = replayed(paper.loaded, *paper.containment_test,
                                             paper.engine->engine(), frames, is_stoppable);
            paper.engine->set_counts_all(false);
            Counted counted{gpu->engine()};
            const Decisions found = replayed(paper.loaded, *paper.containment_test,
                                             Counted::over(counted), frames, is_stoppable);
            ASSERT_EQ(gpu->fault(), nullptr) << gpu->fault();
            ASSERT_GT(cpu.samples.size(), 40'000U);
            EXPECT_TRUE(eager.samples == found.samples) << first_difference(eager, found);
            EXPECT_TRUE(cpu.without_work() == found.without_work()) << first_difference(cpu, found);
            EXPECT_GT(cpu.permits, 30'000U);
            EXPECT_TRUE(!is_stoppable || program != test::kDemoProgram ||
                        counted.calls_of_parts != 0)
                << "near contact the engine poses";
            for (const std::uint32_t of_host : {1U, 2U}) {
                Counted few{gpu->engine()};
                const Decisions shared = replayed(
                    paper.loaded, *paper.containment_test,
                    with_host(Counted::over(few), *paper.engine, of_host), frames, is_stoppable);
                ASSERT_EQ(gpu->fault(), nullptr) << gpu->fault();
                EXPECT_TRUE(cpu.without_work() == shared.without_work())
                    << of_host << ": " << first_difference(cpu, shared);
                if (is_stoppable) {
                    EXPECT_LT(few.calls_of_stages, counted.calls_of_stages) << of_host;
                    EXPECT_GE(few.calls, shared.samples.size()) << "it is kept awake";
                } else {
                    EXPECT_EQ(few.calls, counted.calls) << of_host;
                }
            }
            if (!is_stoppable) {
                EXPECT_EQ(counted.calls, found.samples.size() + 1)
                    << "a sample is one batch, and the self-test";
            }
        }
    }
}

// Both sides of the limit, and the two modes: more launches take longer.
TEST_F(CudaGuardChain, MayRunOnlyWhereItsLongestCycleFits) {
    AXG_GPU_OR_SKIP(gpu);
    paper.loaded.machine.capacities = Capacities{};
    paper.loaded.machine.cycle = CycleRules{};
    const auto chosen_for = [this](bool is_stoppable, std::uint32_t deadline_us) {
        Machine& machine = paper.loaded.machine;
        machine.deadline_us = deadline_us;
        return choose_engine(paper.loaded, *paper.engine, EngineChoice::cuda,
                             cycle_demand(machine, is_stoppable));
    };
    const ChosenEngine generous = chosen_for(true, 1'000'000);
    EXPECT_TRUE(generous.gpu) << generous.words;
    EXPECT_EQ(generous.host_stages, 2U) << "they have few queries: " << generous.words;
    EXPECT_EQ(generous.refusal, EngineRefusal::none);
    const ChosenEngine narrow = chosen_for(false, 30);
    EXPECT_FALSE(narrow.gpu) << narrow.words;
    EXPECT_EQ(narrow.refusal, EngineRefusal::unfit);
    EXPECT_NE(narrow.words.find("capacities.batch"), std::string::npos) << narrow.words;
    std::printf("%s\n%s\n", generous.words.c_str(), narrow.words.c_str());
}

// With lists that are too short something is not proven that could be: never the other way round,
// and never called a broken engine.
TEST_F(CudaGuardChain, ShortListsOnlyKeepPermitsBack) {
    // With three, where a list is full on the GPU alone, the CPU may go deeper and use more.
    paper.loaded.machine.cycle.stages = 2;
    paper.loaded.machine.cycle.lists = {24, 30, 384, 128, 0};
    AXG_GPU_OR_SKIP(gpu);
    const std::vector<CanFrame> frames = simulated(test::kDemoProgram);
    LoadedMachine roomy = paper.loaded;
    roomy.machine.cycle.lists = {1U << 16U, 1U << 16U, 1U << 20U, 1U << 20U, 0};
    const Decisions all =
        replayed(roomy, *paper.containment_test, paper.engine->engine(), frames, true);
    const Decisions cpu =
        replayed(paper.loaded, *paper.containment_test, paper.engine->engine(), frames, true);
    const Decisions found =
        replayed(paper.loaded, *paper.containment_test, gpu->engine(), frames, true);
    ASSERT_EQ(gpu->fault(), nullptr) << gpu->fault();
    ASSERT_EQ(cpu.samples.size(), found.samples.size());
    for (std::size_t i = 0; i < cpu.samples.size(); ++i) {
        ASSERT_FALSE(found.samples[i].has_permit && !cpu.samples[i].has_permit) << "sample " << i;
        ASSERT_NE(found.samples[i].reason, StopReason::known_answer) << "sample " << i;
    }
    EXPECT_LE(found.permits, cpu.permits);
    EXPECT_LT(found.permits, all.permits) << "the lists are short enough to be noticed";
    EXPECT_GT(found.permits, 30'000U);
}

}  // namespace
}  // namespace axg
