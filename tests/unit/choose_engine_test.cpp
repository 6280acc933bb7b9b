// SPDX-License-Identifier: Apache-2.0
// Which engine is asked, where there is no GPU to measure.
#include "hil_replay/choose_engine.hpp"

#include <gtest/gtest.h>

#include <utility>

#include "hil_replay/commands.hpp"
#include "hil_replay/guard_engine.hpp"

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
    ChosenEngine choose(EngineChoice wanted) { return choose_engine(loaded_, *cpu_, wanted, 500); }

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

TEST_F(ChooseEngine, TheCpuIsNotMeasured) {
    const ChosenEngine chosen = choose(EngineChoice::cpu);
    EXPECT_FALSE(chosen.gpu);
    EXPECT_EQ(chosen.words, "");
    EXPECT_EQ(chosen.exit_code, kExitClean);
}

TEST_F(ChooseEngine, WithoutAGpuCudaIsRefusedAndAutoIsTheCpu) {
    ChosenEngine wanted = choose(EngineChoice::cuda);
    if (wanted.gpu || wanted.exit_code == kExitUnfit) {
        GTEST_SKIP() << "there is a GPU";
    }
    EXPECT_EQ(wanted.exit_code, kExitGpu);
    EXPECT_NE(wanted.words.find("--engine cpu"), std::string::npos) << wanted.words;
    const ChosenEngine automatic = choose(EngineChoice::automatic);
    EXPECT_FALSE(automatic.gpu);
    EXPECT_EQ(automatic.words, "");
    EXPECT_EQ(automatic.exit_code, kExitClean);
}

}  // namespace
}  // namespace axg
