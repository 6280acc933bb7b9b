// SPDX-License-Identifier: Apache-2.0
// Which engine is run, where there is no GPU to measure.
#include "firmware_if/setup/choose_engine.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "core/certificate/jog.hpp"
#include "firmware_if/setup/guard_engine.hpp"

namespace axg {
namespace {

class ChooseEngine : public ::testing::Test {
  protected:
    void SetUp() override {
        ASSERT_TRUE(
            load(AXG_SOURCE_DIR "/config/machines/paper-trunnion.yaml", "", loaded_, stderr));
        std::optional<CpuEngine> made = make_engine(loaded_);
        ASSERT_TRUE(made);
        cpu_.emplace(std::move(*made));
    }
    ChosenEngine choose(EngineChoice wanted) {
        return choose_engine(loaded_, *cpu_, wanted, cycle_demand(loaded_.machine, true));
    }

    LoadedMachine loaded_;
    std::optional<CpuEngine> cpu_;
};

TEST_F(ChooseEngine, TheWordGoesBeforeTheMachineFile) {
    Machine machine;
    EXPECT_EQ(engine_choice("", machine), EngineChoice::automatic);
    machine.engine = EngineChoice::cuda;
    EXPECT_EQ(engine_choice("", machine), EngineChoice::cuda);
    EXPECT_EQ(engine_choice("cpu", machine), EngineChoice::cpu);
    EXPECT_EQ(engine_choice("auto", machine), EngineChoice::automatic);
    machine.engine = EngineChoice::cpu;
    EXPECT_EQ(engine_choice("cuda", machine), EngineChoice::cuda);
}

// The most launches that rounds of any sizes can come to, counted out for small numbers.
TEST_F(ChooseEngine, NoCycleTakesMoreLaunches) {
    Machine machine = loaded_.machine;
    const auto launches_of = [](std::uint32_t queries) { return (queries + 511) / 512; };
    // Where a jog begins, the ladders.
    machine.guard.jog.is_promised = true;
    const std::uint32_t rungs = stop_tasks(machine) * kJogRungs;
    const std::uint32_t pose_launches = launches_of(rungs);
    for (const std::uint32_t queries : {1U, 2U, 508U, 509U, 510U, 511U, 512U, 1020U, 1021U}) {
        machine.guard.queries = queries;
        for (std::uint32_t rounds = 1; rounds <= 3; ++rounds) {
            machine.guard.rounds = rounds;
            std::uint32_t most = 0;
            for (std::uint32_t first = 0; first <= queries; ++first) {
                const std::uint32_t second = rounds > 1 ? (queries - first) / (rounds - 1) : 0;
                const std::uint32_t rest = queries - first - (rounds > 2 ? second : 0);
                most = std::max(most, launches_of(first + 2) +
                                          (rounds > 2 ? launches_of(second + 2) : 0) +
                                          (rounds > 1 ? launches_of(rest + 2) : 0));
            }
            const CycleDemand demand = cycle_demand(machine, true);
            EXPECT_GE(demand.launches, most + pose_launches) << queries << " in " << rounds;
            EXPECT_LE(demand.launches, most + pose_launches + 1) << "a bound that is no use";
            EXPECT_EQ(demand.queries, queries + 2 * rounds + rungs);
        }
    }
    EXPECT_EQ(cycle_demand(machine, false).launches, 1U);
}

TEST_F(ChooseEngine, TheCpuIsNotMeasured) {
    const ChosenEngine chosen = choose(EngineChoice::cpu);
    EXPECT_FALSE(chosen.gpu);
    EXPECT_EQ(chosen.words, "");
    EXPECT_EQ(chosen.refusal, EngineRefusal::none);
}

TEST_F(ChooseEngine, WithoutAGpuCudaIsRefusedAndAutoIsTheCpu) {
    ChosenEngine wanted = choose(EngineChoice::cuda);
    if (wanted.gpu || wanted.refusal == EngineRefusal::unfit) {
        GTEST_SKIP() << "there is a GPU";
    }
    EXPECT_EQ(wanted.refusal, EngineRefusal::no_gpu);
    EXPECT_NE(wanted.words.find("--engine cpu"), std::string::npos) << wanted.words;
    const ChosenEngine automatic = choose(EngineChoice::automatic);
    EXPECT_FALSE(automatic.gpu);
    EXPECT_EQ(automatic.words, "");
    EXPECT_EQ(automatic.refusal, EngineRefusal::none);
}

}  // namespace
}  // namespace axg
