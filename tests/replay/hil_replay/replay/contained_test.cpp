// SPDX-License-Identifier: Apache-2.0
// A body that gets inside another without a sample in contact: coarse samples jump over the wall,
// or the trace begins there. The program stops at the first sample inside, and says who is inside
// whom.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>

#include "core/mesh/stl.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/protocol/guard_frames.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/replay_fixture.hpp"
#include "tests/support/solids.hpp"

namespace axg {
namespace {

// At 10 m/min and a sample every 10 ms the cutter moves 1.7 mm a sample, and it is 0.2 mm long.
constexpr const char* kRoomMachine = R"(version: 1
name: nest
axes:
  X: {kind: linear, travel_mm: [-300, 300], speed_mm_min: 10000, acceleration_mm_s2: 2000,
      jerk_mm_s3: 50000, stopping_mm_s2: 1500}
bodies:
  - {name: block, mesh: {file: block.stl, unit: mm@ALLOW@}}
  - {name: slide, axis: X, direction: [1, 0, 0]}
  - {name: cutter, parent: slide, tool: true}
tools:
  - {number: 1, length_mm: 1, profile_mm: [[0, -0.1], [0.1, -0.1], [0.1, 0.1], [0, 0.1]]}
pairs:
  - {a: cutter, b: block, margin_mm: 0.001}
can:
  format: classical
  sample_us: 10000
  stale_after_us: 30000
  ids: {axes: [0x181]}
  data_ids: [0x0181]
)";

class ContainedReplay : public testing::Test {
  protected:
    void SetUp() override {
        if (!std::filesystem::exists(AXG_PROGRAM)) {
            GTEST_SKIP() << AXG_PROGRAM << " is not built";
        }
    }

    /// A machine file whose block has these facets.
    void write_machine(const test::Triangles& block, const std::string& allow = "") {
        const std::vector<std::byte> bytes = write_stl(block);
        (void)shop.write("block.stl", {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
        std::string text = kRoomMachine;
        (void)shop.write("m.yaml", text.replace(text.find("@ALLOW@"), 7, allow));
    }
    void simulate(const std::string& program, const std::string& options = "") {
        (void)shop.write("p.ngc", "G21\n" + program);
        ASSERT_EQ(shop.run("simulate m.yaml p.ngc -o t.log " + options), kExitClean) << shop.err;
    }
    test::Json replay(int wanted, const std::string& options = "") {
        const int code = shop.run(
            "replay m.yaml t.log --mode contact --json=r.json --deadline-us 1000000 " + options);
        EXPECT_EQ(code, wanted) << shop.out << shop.err;
        const std::string text = test::content_of(shop.file("r.json"));
        return text.empty() ? test::Json() : test::Json::parse(text);
    }

    test::Workshop shop;
};

const test::Triangles kBlock = test::box({50, -20, -20}, {90, 20, 20});

TEST_F(ContainedReplay, AJumpOverTheWallStopsAtTheFirstSampleInside) {
    write_machine(kBlock);
    simulate("G1 X70 F10000\nM2\n", "--start X0");
    const auto document = replay(kExitCollision, "--csv r.csv --frames-out f.log");
    ASSERT_EQ(document["stops"].size(), 1U);
    const auto& stop = document["stops"][0];
    EXPECT_EQ(stop["reason"], "contained");
    EXPECT_EQ(stop["pair"], "cutter-block");
    const auto x_mm = stop["axes"]["X_mm"].get<double>();
    EXPECT_GT(x_mm, 50.1);
    EXPECT_LT(x_mm, 52) << "the first sample beyond the wall";
    ASSERT_EQ(stop["pairs"].size(), 1U);
    EXPECT_EQ(stop["pairs"][0]["inside"], "cutter");
    EXPECT_GT(stop["pairs"][0]["clearance_mm"], 0.0);
    EXPECT_EQ(stop["pairs"][0]["touching"], 0);
    EXPECT_NE(shop.out.find(": contained, cutter-block"), std::string::npos) << shop.out;
    EXPECT_NE(shop.out.find("cutter is inside block, their surfaces at least "), std::string::npos);
    // The table: a permit up to the wall, and the reason behind it.
    const std::string table = test::content_of(shop.file("r.csv"));
    EXPECT_NE(table.rfind(",0,contained,1,"), std::string::npos) << table.substr(0, 200);
    EXPECT_NE(table.find(",1,none,0,"), std::string::npos);
    EXPECT_EQ(table.find("contact"), std::string::npos) << "no sample touched the wall";
    // The frames: a stop, and the emergency message of a contact.
    const auto frames = test::read_trace(shop.file("f.log"));
    const bool has_emergency = std::any_of(frames.begin(), frames.end(), [](const CanFrame& f) {
        return f.id == 0x082 && f.data[0] == 0x02 && f.data[1] == 0xff;
    });
    EXPECT_TRUE(has_emergency);
}

// Every sample inside is an episode of one stop, up to the contact with the far wall or the exit.
TEST_F(ContainedReplay, KeepGoingCountsTheSamplesInside) {
    write_machine(kBlock);
    simulate("G1 X70 F10000\nG1 X0\nM2\n", "--start X0");
    const auto document = replay(kExitCollision, "--keep-going --csv r.csv");
    ASSERT_GE(document["stops"].size(), 1U);
    EXPECT_EQ(document["stops"][0]["reason"], "contained");
    const std::string table = test::content_of(shop.file("r.csv"));
    std::uint64_t inside = 0;
    for (std::size_t at = 0; (at = table.find(",contained,", at)) != std::string::npos; ++at) {
        ++inside;
    }
    EXPECT_GT(inside, 10U);
    EXPECT_EQ(document["pairs"]["cutter-block"]["not_proven"].get<std::uint64_t>(),
              document["stops"][0]["samples"].get<std::uint64_t>());
    EXPECT_GE(document["stops"][0]["samples"].get<std::uint64_t>(), inside);
}

TEST_F(ContainedReplay, ATraceThatStartsInsideNeverHasAPermit) {
    write_machine(kBlock);
    simulate("G1 X71 F1000\nM2\n", "--start X70");
    const auto document = replay(kExitCollision);
    EXPECT_EQ(document["permits"], 0);
    EXPECT_EQ(document["stops"][0]["reason"], "contained");
}

TEST_F(ContainedReplay, ACavityIsFree) {
    write_machine(
        test::together(kBlock, test::turned_over(test::box({60, -10, -10}, {80, 10, 10}))));
    simulate("G1 X72 F10000\nM2\n", "--start X70");
    const auto document = replay(kExitClean);
    EXPECT_EQ(document["stop_count"], 0);
}

// No claim about what is open: said by name in check, and nothing stops there.
TEST_F(ContainedReplay, AnOpenBlockHoldsNothing) {
    test::Triangles open = kBlock;
    open.pop_back();
    write_machine(open, ", allow_open: true");
    simulate("G1 X71 F1000\nM2\n", "--start X70");
    EXPECT_EQ(replay(kExitClean)["stop_count"], 0);
    ASSERT_EQ(shop.run("check m.yaml --json=c.json"), kExitClean) << shop.err;
    EXPECT_NE(shop.out.find("OPEN: bodies inside are not detected"), std::string::npos) << shop.out;
    const auto check = test::Json::parse(test::content_of(shop.file("c.json")));
    EXPECT_EQ(check["bodies"][0]["mesh"]["open_shells"], 1);
    EXPECT_EQ(check["contacts"][0]["contained"], 0);
}

TEST_F(ContainedReplay, CheckSaysWhichShellsAreOpenAndWhichHold) {
    test::Triangles open = test::box({-90, -20, -20}, {-50, 20, 20});
    open.pop_back();
    write_machine(test::together(kBlock, open), ", allow_open: true");
    ASSERT_EQ(shop.run("check m.yaml --json=c.json"), kExitClean) << shop.err;
    EXPECT_NE(shop.out.find("2 shells  1 OPEN: bodies inside it are not detected"),
              std::string::npos)
        << shop.out;
    simulate("G1 X-71 F1000\nM2\n", "--start X-70");
    EXPECT_EQ(replay(kExitClean)["stop_count"], 0);
    simulate("G1 X71 F1000\nM2\n", "--start X70");
    EXPECT_EQ(replay(kExitCollision)["stops"][0]["reason"], "contained");
}

TEST_F(ContainedReplay, CheckNamesWhatIsInsideWhat) {
    write_machine(kBlock);
    ASSERT_EQ(shop.run("check m.yaml --json=c.json"), kExitClean) << shop.err;
    auto document = test::Json::parse(test::content_of(shop.file("c.json")));
    EXPECT_GT(document["contacts"][0]["contained"].get<int>(), 5);  // 40 of 600 mm of travel
    EXPECT_LT(document["contacts"][0]["contained"].get<int>(), 40);
    EXPECT_EQ(document["contacts"][0]["containment_not_known"], 0);
    EXPECT_NE(shop.out.find(" of 256  cutter inside block"), std::string::npos) << shop.out;
    EXPECT_EQ(shop.out.find("at the zero pose"), std::string::npos);
    // Around the zero pose: something to look at, by name.
    write_machine(test::moved(kBlock, {-70, 0, 0}));
    ASSERT_EQ(shop.run("check m.yaml"), kExitClean) << shop.err;
    EXPECT_NE(shop.out.find("cutter-block: cutter inside block at the zero pose"),
              std::string::npos)
        << shop.out;
    // All along the travel: never a permit.
    write_machine(test::box({-400, -20, -20}, {400, 20, 20}));
    ASSERT_EQ(shop.run("check m.yaml"), kExitClean) << shop.err;
    EXPECT_NE(shop.out.find("256 of 256  cutter inside block  permanent"), std::string::npos);
    EXPECT_NE(shop.out.find("cutter-block: in contact or one inside the other at every sampled "
                            "position, so that no permit is possible."),
              std::string::npos)
        << shop.out;
}

}  // namespace
}  // namespace axg
