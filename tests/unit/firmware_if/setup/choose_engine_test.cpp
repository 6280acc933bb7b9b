// SPDX-License-Identifier: Apache-2.0
// Which engine is run, where there is no GPU to measure.
#include "firmware_if/setup/choose_engine.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "core/certificate/jog.hpp"
#include "core/certificate/stop_certificate.hpp"
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

// Of the plan's stages, and where a jog begins of its ladders: each call with all lists.
TEST_F(ChooseEngine, NoCycleTakesMoreLaunches) {
    Machine machine = loaded_.machine;
    machine.guard.jog.is_promised = false;
    const std::uint32_t tasks = stop_tasks(machine);
    ASSERT_LT(tasks, 100U);
    for (const std::uint32_t queries : {510U, 512U, 513U, 1021U}) {
        machine.plan = plan_of(2, tasks, queries, {512, 512, 2048, 4096, 0});
        const CycleDemand demand = cycle_demand(machine, true);
        EXPECT_EQ(demand.calls, 2U);
        EXPECT_EQ(demand.queries, queries + 2);
        EXPECT_EQ(demand.launches, queries <= 512 ? 1U : queries <= 1026 ? 2U : 3U);
        EXPECT_EQ(demand.plan, machine.plan);
    }
    machine.plan = plan_of(3, tasks, 64, {512, 384, 2048, 3072, 0});
    EXPECT_EQ(cycle_demand(machine, true).calls, 3U);
    EXPECT_EQ(cycle_demand(machine, true).queries, 64U + 2);
    machine.guard.jog.is_promised = true;
    EXPECT_EQ(cycle_demand(machine, true).calls, 5U);
    EXPECT_EQ(cycle_demand(machine, true).queries, kJogLaddersMax * (kJogRungs - 1) + 2);
    EXPECT_EQ(cycle_demand(machine, true).launches, 1U);
    EXPECT_EQ(cycle_demand(machine, false).calls, 1U);
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
