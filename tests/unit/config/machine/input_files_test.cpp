// SPDX-License-Identifier: Apache-2.0
// Real DBC, EDS and DCF files of other makers, and files beside a machine file on disk.
// ctest-labels: data
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "config/can/dbc_signal.hpp"
#include "config/can/eds.hpp"
#include "config/compiled/compiled_machine.hpp"
#include "tests/support/dbc_text.hpp"

namespace axg::test {
namespace {

namespace fs = std::filesystem;

std::string read(const std::string& name) {
    std::ifstream file(std::string(AXG_SHARED_DATA) + '/' + name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

std::string printed(const std::vector<ConfigFault>& faults) {
    std::string all;
    for (const ConfigFault& fault : faults) {
        all += to_string(fault) + '\n';
    }
    return all;
}

class SharedInputs : public testing::Test {
  protected:
    void SetUp() override {
        if (!fs::exists(std::string(AXG_SHARED_DATA) + "/can/odrive-cansimple.dbc")) {
            GTEST_SKIP() << "no data under " << AXG_SHARED_DATA;
        }
    }
};

TEST_F(SharedInputs, EveryDbcIsReadWhole) {
    std::size_t count = 0;
    for (const auto& entry : fs::directory_iterator(std::string(AXG_SHARED_DATA) + "/can")) {
        if (entry.path().extension() != ".dbc") {
            continue;
        }
        ++count;
        Dbc dbc;
        EXPECT_EQ(printed(parse_dbc(read("can/" + entry.path().filename().string()), "d", dbc)),
                  "");
        std::size_t usable = 0;
        std::size_t all = 0;
        for (const DbcMessage& message : dbc.messages) {
            for (const DbcSignal& signal : message.signals) {
                CanSignal wire;
                usable += to_can_signal(message, signal, wire).empty() ? 1 : 0;
                ++all;
            }
        }
        EXPECT_GT(all, 50U) << entry.path();
        EXPECT_EQ(usable, all) << entry.path() << ": what these boards send can be read";
    }
    EXPECT_GE(count, 2U);
}

TEST_F(SharedInputs, AMotorControllersFloatsAreAxes) {
    std::string text = dbc_machine();
    const std::size_t begin = text.find("  axes:\n    X");
    text = text.substr(0, begin) + R"(  axes:
    X: {signal: Axis0_Set_Linear_Count.Position, unit: um}
    A: {signal: Axis1_Get_Encoder_Estimates.Pos_Estimate, unit: turn}
    C: {signal: Axis2_Get_Encoder_Count.Shadow_Count, unit: deg}
)" + text.substr(text.find("capacities"));
    Machine machine;
    EXPECT_EQ(faults_with_file(text, read("can/odrive-cansimple.dbc"), machine), "");
    ASSERT_EQ(machine.can.signals.size(), 3U);
    EXPECT_EQ(machine.can.signals[1].type, SignalType::float32);
    EXPECT_EQ(machine.can.signals[1].factor, 360);
    EXPECT_EQ(machine.can.signals[0].id, 25U);
}

TEST_F(SharedInputs, TheDcfOfAnArmsJointSaysWhatIsSent) {
    Eds eds;
    ASSERT_EQ(printed(parse_eds(read("eds/prbt_0_1.dcf"), "d", 3, eds)), "");
    ASSERT_GE(eds.pdos.size(), 3U);
    EXPECT_EQ(eds.pdos[0].cob_id, 0x183U);
    EXPECT_EQ(eds.pdos[0].transmission_type, 1U);
    EXPECT_EQ(eds.pdos[0].map, (std::vector<std::uint32_t>{0x60410010, 0x60610008}))
        << "the third entry stands in the file but is not active";
    EXPECT_EQ(eds.pdos[2].map, (std::vector<std::uint32_t>{0x60640020, 0x606C0020}));
}

TEST_F(SharedInputs, AnEdsWhosePdosAreOffGivesNoAxis) {
    Eds eds;
    ASSERT_EQ(printed(parse_eds(read("eds/cia402_slave.eds"), "d", 3, eds)), "");
    ASSERT_EQ(eds.pdos.size(), 4U);
    for (const EdsPdo& pdo : eds.pdos) {
        EXPECT_NE(pdo.cob_id & 0x80000000U, 0U);
    }
    EXPECT_EQ(eds.pdos[2].map, (std::vector<std::uint32_t>{0x60410010, 0x60640020}));
}

TEST(InputFiles, AreFoundBesideTheMachineFileAndNowhereElse) {
    const fs::path folder =
        fs::temp_directory_path() /
        ("axg-inputs-" + std::to_string(testing::UnitTest::GetInstance()->random_seed()) +
         std::to_string(static_cast<long>(::getpid())));
    fs::create_directories(folder / "in");
    std::ofstream(folder / "in" / "m.yaml") << dbc_machine();
    std::ofstream(folder / "in" / "board.dbc") << kBoardDbc;
    std::ofstream(folder / "out.yaml") << with(dbc_machine(), "board.dbc", "../board.dbc");
    Machine machine;
    EXPECT_EQ(printed(load_machine((folder / "in" / "m.yaml").string(), machine)), "");
    EXPECT_EQ(machine.can.signals.size(), 8U);
    fs::rename(folder / "out.yaml", folder / "in" / "out.yaml");
    fs::copy_file(folder / "in" / "board.dbc", folder / "board.dbc");
    EXPECT_NE(
        printed(load_machine((folder / "in" / "out.yaml").string(), machine)).find("can.file"),
        std::string::npos);
    fs::remove(folder / "in" / "board.dbc");
    EXPECT_NE(printed(load_machine((folder / "in" / "m.yaml").string(), machine)).find("can.file"),
              std::string::npos);
    fs::remove_all(folder);
}

}  // namespace
}  // namespace axg::test
