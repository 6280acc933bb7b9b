// SPDX-License-Identifier: Apache-2.0
// Which engine is run, where there is no GPU to measure.
#include "firmware_if/setup/choose_engine.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

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

TEST_F(ChooseEngine, ACycleDemandsWhatThePlanAndTheMachineSay) {
    Machine machine = loaded_.machine;
    machine.plan = plan_of(3, stop_tasks(machine), 64, {512, 384, 2048, 3072, 0});
    for (const bool has_jogs : {false, true}) {
        for (const PermitSamples samples : {PermitSamples{3, 3}, PermitSamples{3, 12}}) {
            machine.guard.jog.is_promised = has_jogs;
            machine.can.permit_samples = samples;
            const CycleDemand demand = cycle_demand(machine, true);
            EXPECT_EQ(demand.plan, machine.plan);
            EXPECT_EQ(demand.tasks, stop_tasks(machine));
            EXPECT_EQ(demand.has_jogs, has_jogs);
            EXPECT_EQ(demand.asks_twice, samples.most > samples.least);
            EXPECT_FALSE(cycle_demand(machine, false).plan);
        }
    }
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
