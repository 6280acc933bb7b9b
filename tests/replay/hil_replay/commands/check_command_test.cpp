// SPDX-License-Identifier: Apache-2.0
// What a person reads off a machine before trusting it: which way each axis moves, which bytes it
// has on the bus, every value in force, and a page of it. A wrong unit is refused by every program.
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <string>

#include "tests/support/machine_text.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg::test {
namespace {

class CheckCommand : public testing::Test {
  protected:
    /// Exit code of a command on this machine file, beside the meshes of the paper's machine.
    int run(const std::string& command, const std::string& text, const std::string& options = "") {
        EXPECT_NE(text, "") << "the change did not apply";
        const std::string file = shop_.write("m.yaml", text);
        const std::string root = std::filesystem::path(kPaperMachine).parent_path().string();
        return shop_.run(command + " '" + file + "' " + options + " --mesh-root '" + root + "'");
    }
    [[nodiscard]] bool says(const std::string& words) const {
        return shop_.out.find(words) != std::string::npos;
    }
    [[nodiscard]] std::string hash() const {
        std::smatch found;
        return std::regex_search(shop_.out, found, std::regex("configuration ([0-9a-f]{64})"))
                   ? found[1].str()
                   : "";
    }

    Workshop shop_;
    const std::string paper_ = content_of(kPaperMachine);
};

TEST_F(CheckCommand, NamesTheWayOfEachAxis) {
    ASSERT_EQ(run("check", paper_), 0) << shop_.err;
    for (const char* const line :
         {"  X+ moves x to -x with a, c; -250 to 250 mm\n",
          "  Z+ moves z to +z with cutter; -380 to 60 mm\n",
          "  A+ turns a about -x through (0, 0, -380) mm with c; -110 to 30 deg\n",
          "  C+ turns c about -z through (0, 0, 0) mm; endless\n",
          "  a                origin at (0, 0, -380) mm\n"}) {
        EXPECT_TRUE(says(line)) << line << shop_.out;
    }
    EXPECT_TRUE(says("acceleration 4000 mm/s2, jerk 50000 mm/s3"));
    const std::string a_axis = "axis: A\n    direction: [-1, 0, 0]\n    pivot_mm: [0, 0, -380]";
    ASSERT_EQ(run("check", with(paper_, a_axis,
                                "axis: A\n    direction: [0, 0.6, 0.8]\n    pivot_mm: [5, 8, "
                                "-374]")),
              0);
    EXPECT_TRUE(
        says("A+ turns a about (+0.0000, +0.6000, +0.8000) through (5, 184.64, -138.48) mm"))
        << shop_.out;
}

// What the file leaves out costs a stop something where its default is not true.
TEST_F(CheckCommand, ListsPromisesWithoutAStatedValue) {
    ASSERT_EQ(run("check", paper_), 0) << shop_.err;
    EXPECT_TRUE(says("\npromises not stated: 6 (a stop from rapid, with 3 samples of permit)\n"))
        << shop_.out;
    EXPECT_TRUE(
        says("  guard.stop_reversal: none assumed; with jerk_limited X stops 17.1 mm "
             "later\n"));
    EXPECT_TRUE(says("  guard.board_reaction_ms: 2 assumed; with 4 X stops 3.58 mm later\n"));
    EXPECT_TRUE(says("  can.latched_age_us: 0 assumed; with [0, 1000] X stops 1.86 mm later\n"));
    ASSERT_EQ(run("check", paper_, "--json"), 0) << shop_.err;
    EXPECT_TRUE(says("\"key\": \"guard.stop_reversal\"")) << shop_.out;
    const std::string stated = with_can(
        with(paper_, "guard:\n", "guard:\n  stop_reversal: none\n  board_reaction_ms: 2\n"),
        "  latched_age_us: 0\n");
    ASSERT_EQ(run("check", stated), 0) << shop_.err;
    EXPECT_TRUE(says("\npromises not stated: 3 (")) << shop_.out;
}

TEST_F(CheckCommand, NamesTheBytesOfEachAxis) {
    ASSERT_EQ(run("check", paper_), 0);
    EXPECT_TRUE(says("  0x281, data id 0x0281  Z in bytes 2 to 4  A in bytes 5 to 7\n"));
    EXPECT_TRUE(says("  0x381, data id 0x0381  C in bytes 2 to 4  status in bytes 5 to 7\n"));
    EXPECT_TRUE(says("from the guard: permit 0x103 and 0x104, stop 0x001"));
    ASSERT_EQ(run("check", with_can(paper_, "  format: fd\n  ids: {axes: [0x190]}\n")), 0)
        << shop_.err;
    EXPECT_TRUE(says("  0x190, data id 0x0190  X in bytes 4 to 7  Y in bytes 8 to 11"))
        << shop_.out;
}

TEST_F(CheckCommand, PrintsAnEffectiveFileOfTheSameHash) {
    ASSERT_EQ(run("check", paper_), 0);
    const std::string stated = hash();
    ASSERT_EQ(run("check", paper_, "--effective"), 0);
    EXPECT_EQ(hash(), stated);
    EXPECT_TRUE(says("  board_reaction_ms: 2  # default\n"));
    const std::string effective = shop_.out;
    ASSERT_EQ(run("check", effective), 0) << shop_.err;
    EXPECT_EQ(hash(), stated);
}

TEST_F(CheckCommand, WritesAPageOfTheMachine) {
    if (!std::filesystem::exists("/usr/share/javascript/three/three.min.js")) {
        GTEST_SKIP() << "libjs-three is not installed";
    }
    ASSERT_EQ(run("check", paper_, "--report m.html"), 0) << shop_.err;
    const std::string page = content_of(shop_.file("m.html"));
    EXPECT_NE(page.find("2 s to 4 s: +50 mm; Y+ moves y to -y with x, a, c"), std::string::npos);
}

// A table in inch that is read in mm would differ in every length, or, worse, agree by chance.
TEST_F(CheckCommand, NamesTheUnitOfAToolTable) {
    (void)shop_.write("tool.tbl", "T1 Z4\n");
    const std::string unit = "program: {start_unit: mm, ";
    const std::string option = "--tool-table '" + shop_.file("tool.tbl") + "'";
    const std::string silent = with(paper_, unit, "program: {");
    ASSERT_EQ(run("check", silent, option), 0) << shop_.err;
    EXPECT_TRUE(says(": tools read: 1, lengths in mm: program.start_unit is not stated\n"))
        << shop_.out;
    EXPECT_TRUE(says("tool.tbl:1: tool 1: length 4 mm, and "));
    EXPECT_TRUE(says("tool.tbl: read in mm. If the control counts in inch, state program: "));
    ASSERT_EQ(run("check", with(paper_, unit, "program: {start_unit: inch, "), option), 0)
        << shop_.err;
    EXPECT_TRUE(
        says(": tools read: 1, lengths in inch, as program.start_unit of the machine "
             "file\n"))
        << shop_.out;
    EXPECT_TRUE(says("tool.tbl:1: tool 1: length 4 inch (101.6 mm), and "));
    (void)shop_.write("tool.tbl", "T1 Z140 D12\n");
    ASSERT_EQ(run("check", paper_, option), 0) << shop_.err;
    EXPECT_TRUE(says(": tools read: 1, lengths in mm, as program.start_unit")) << shop_.out;
    EXPECT_FALSE(says("If the control counts in inch"));
}

TEST_F(CheckCommand, RefusesAToolThatContradictsItsLength) {
    const std::string tool = "cutter.stl, unit: ";
    const std::string wrong = with(paper_, tool + "mm", tool + "um");
    for (const char* const command : {"check", "replay"}) {
        EXPECT_EQ(run(command, wrong, command[0] == 'r' ? "no.log" : ""), 3);
        EXPECT_NE(shop_.err.find(
                      "tools.1.mesh.unit: invalid value (found meshes/paper-trunnion/cutter.stl: "),
                  std::string::npos)
            << shop_.err;
        EXPECT_NE(shop_.err.find("expected unit: mm, which makes it "), std::string::npos);
    }
}

}  // namespace
}  // namespace axg::test
