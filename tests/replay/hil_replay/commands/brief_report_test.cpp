// SPDX-License-Identifier: Apache-2.0
// What `axguard replay` prints by default: one screen, with everything that a reader may not miss;
// --details prints the tables too and changes neither results nor figures. Runs the program itself.
// ctest-labels: long
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <memory>
#include <regex>
#include <string>

#include "firmware_if/cli/exit_codes.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/machine_text.hpp"
#include "tests/support/replay_fixture.hpp"
#include "tests/support/screen.hpp"

namespace axg::test {
namespace {

const std::string kMeshes = " --mesh-root " + source_file("config/machines");

/// A trace or a machine with something that must be seen, and the texts that show it.
struct Unmissable {
    const char* name;
    const char* arguments;  // behind "replay"; files are made by the fixture
    std::vector<std::string> shown;
};

class BriefReport : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        shop = std::make_unique<Workshop>();
        (void)shop->write("brief.ngc", "T1 M6\nG0 X20 Y5 Z40\nG1 A-10 C30 F3000\nM2\n");
        (void)shop->write("rest.ngc", "T1 M6\nG4 P0.5\nM2\n");
        for (const std::string& made :
             {kDemoProgram + " -o demo.log", std::string("brief.ngc -o brief.log"),
              std::string("rest.ngc -o rest.log --start 'X0 Y107.132 Z-222.9 A-19.1943 "
                          "C97.0863'")}) {
            ASSERT_EQ(shop->run("simulate " + kPaperMachine + " " + made), kExitClean) << shop->err;
        }
        const std::string whole = content_of(shop->file("brief.log"));
        const std::size_t middle = whole.find('\n', whole.size() / 2) + 1;
        (void)shop->write("bad.log", whole.substr(0, middle) + "garbage\n" + whole.substr(middle));
        (void)shop->write("half.log", whole.substr(0, middle));
        (void)shop->write("lossy.log", without_some_samples(whole));
        const std::string machine = content_of(kPaperMachine);
        (void)shop->write("weak.yaml",
                          std::regex_replace(machine, std::regex("acceleration_mm_s2: [0-9]+"),
                                             "acceleration_mm_s2: 400"));
        (void)shop->write("line.yaml", with(machine, "guard:\n", "guard:\n  obeyed_by: line\n"));
        (void)shop->write("cap.yaml", with(machine, "guard:\n", "guard:\n  cap: all_axes\n"));
    }
    static void TearDownTestSuite() { shop.reset(); }

    static std::string without_some_samples(const std::string& whole) {
        std::string kept;
        int samples = 0;
        for (const std::string& line : lines_of(whole)) {
            const bool is_last_axis = line.find(" 281#") != std::string::npos;
            samples += is_last_axis ? 1 : 0;
            if (!is_last_axis || samples < 100 || samples % 3 != 0) {
                kept += line + "\n";
            }
        }
        return kept;
    }
    static Json document(const std::string& name) {
        return Json::parse(content_of(shop->file(name)));
    }
    static std::unique_ptr<Workshop> shop;
};

std::unique_ptr<Workshop> BriefReport::shop;

class NeverHidden : public BriefReport, public testing::WithParamInterface<Unmissable> {};

TEST_P(NeverHidden, IsOnTheScreen) {
    const std::string machine = std::string(GetParam().arguments).find(".yaml") == std::string::npos
                                    ? kPaperMachine + " "
                                    : std::string();
    (void)shop->run("replay " + machine + GetParam().arguments + kMeshes);
    for (const std::string& text : GetParam().shown) {
        EXPECT_NE(shop->out.find(text), std::string::npos) << text << "\n"
                                                           << shop->out << shop->err;
    }
    EXPECT_LE(lines_of(shop->out).size(), kScreenLines) << shop->out;
    EXPECT_EQ(shop->out.find("samples not proven"), std::string::npos) << "a table";
}

INSTANTIATE_TEST_SUITE_P(
    Each, NeverHidden,
    testing::Values(
        Unmissable{"Stop",
                   "demo.log",
                   {"\nSTOP at 40.875405 s, sample 39875: predicted, cutter-c\n",
                    "demo.ngc:700: G1 ", "cutter (tool 1) and c are too near to be proven clear",
                    "they are at least 4.6609 mm apart",
                    "caps and commands ahead change the motion: axguard drive ",
                    "jog A+ (0.5 deg: clearance at least "}},
        Unmissable{
            "Contact",
            "demo.log --mode contact",
            {": contact, cutter-c\n", "12 pairs of triangles touch\n", "no way out is proven"}},
        Unmissable{"WithheldPermit",
                   "rest.log",
                   {"\nNO PERMIT from ", "withheld for ", "cutter (tool 1) and c "}},
        Unmissable{
            "NeverArmed", "brief.log --arm-at 100000", {"NO PERMIT: the guard was never armed"}},
        Unmissable{"TruncatedTrace",
                   "bad.log",
                   {"\nTHE TRACE IS TRUNCATED: the rest is not proven\n", "found \"garbage\""}},
        Unmissable{"SkippedLine", "bad.log --lenient", {"1 lines skipped, the first: "}},
        Unmissable{"EndInMotion", "half.log", {"\nTHE TRACE ENDS IN MOTION at "}},
        Unmissable{"LostSamples",
                   "lossy.log",
                   {" samples, 15 lost, ", "\n  torn  ", "\nSTOP at ", ": flapping\n"}},
        Unmissable{"MissingHashes", "brief.log", {"hashes: the trace contains 0 of 4"}},
        Unmissable{"BrokenLimit",
                   "weak.yaml demo.log",
                   {": left_limits\n", "declared 400 mm/s2", "above the declared limit: "}},
        Unmissable{"LateCyclesThatAreJudged",
                   "brief.log --realtime --deadline-us 1",
                   {"deadline 1 us: ", " cycles late\n", "NO PERMIT"}},
        Unmissable{
            "LateCyclesThatAreCounted", "brief.log --deadline-us 1", {"counted, not judged"}},
        Unmissable{"DisobedientDevice", "line.yaml brief.log", {"no line can obey these permits"}},
        Unmissable{"UnusedCap", "cap.yaml brief.log", {"guard.cap: all_axes: not used"}}),
    [](const auto& row) { return std::string(row.param.name); });

TEST_F(BriefReport, OfManyStopsTheFirstIsWholeAndAllAreCounted) {
    ASSERT_EQ(
        shop->run("simulate " + kPaperMachine + " " +
                  source_file("hil_replay/programs/paper-trunnion-near.ngc") + " -o near.log"),
        kExitClean);
    ASSERT_EQ(shop->run("replay " + kPaperMachine +
                        " near.log --keep-going --deadline-us 10000000 --json=all.json"),
              kExitCollision);
    const auto count = document("all.json")["stop_count"].get<std::size_t>();
    ASSERT_GT(count, 1U);
    std::size_t shown = 0, sentences = 0;
    for (const std::string& line : lines_of(shop->out)) {
        shown += line.rfind("STOP at ", 0) == 0 ? 1 : 0;
        sentences += line.find(" apart, the proof of a stop") != std::string::npos ? 1 : 0;
    }
    EXPECT_LE(shown, 5U);
    EXPECT_EQ(sentences, 1U) << shop->out;
    EXPECT_NE(shop->out.find(fmt::format("\n{} stops in all\n", count)), std::string::npos)
        << shop->out;
    EXPECT_LE(lines_of(shop->out).size(), kScreenLines) << shop->out;
}

TEST_F(BriefReport, DetailsHaveTheTablesAndTheSameFigures) {
    // Times differ from run to run; the rest of the document does not.
    const auto figures = [](const std::string& name) {
        Json all = document(name);
        for (const char* const key : {"cycle", "slowest", "overruns"}) {
            if (all.contains(key)) {
                all.erase(key);
            }
        }
        return all;
    };
    const std::string command = "replay " + kPaperMachine + " demo.log --json=";
    ASSERT_EQ(shop->run(command + "brief.json"), kExitCollision);
    const std::string brief = shop->out;
    for (const std::string option : {"--details", "-v"}) {
        ASSERT_EQ(shop->run(command + "full.json " + option), kExitCollision);
        for (const char* const text :
             {"samples not proven\n", "queries per cycle: median ", "plan: 3 stages",
              "samples above\n", "  why (capacity): cutter-c, tool 1 needs ",
              "    motion until braking ", "a list of the engine was full: leaf_pairs"}) {
            EXPECT_NE(shop->out.find(text), std::string::npos) << text;
            EXPECT_EQ(brief.find(text), std::string::npos) << text;
        }
    }
    EXPECT_EQ(figures("brief.json"), figures("full.json"));
    const Json why = document("full.json")["stops"][0]["why"];
    for (const std::string& text : {brief, shop->out}) {
        EXPECT_NE(text.find(fmt::format(
                      "\n  they are at least {:.4f} mm apart, the proof of a stop needs up to "
                      "{:.4f} mm\n",
                      why["available_mm"].get<double>(), why["needed_mm"].get<double>())),
                  std::string::npos)
            << text;
    }
}

// The page is for looking closely: it has the whole text, and each sentence once in its data.
TEST_F(BriefReport, ThePageKeepsTheDetails) {
    ASSERT_EQ(shop->run("replay " + kPaperMachine + " demo.log --report page.html --json=p.json"),
              kExitCollision)
        << shop->err;
    const std::string page = content_of(shop->file("page.html"));
    EXPECT_NE(page.find("samples not proven"), std::string::npos);
    EXPECT_NE(page.find("\"sentences\":[\"cutter (tool 1) and c are too near to be proven clear"),
              std::string::npos);
    EXPECT_EQ(content_of(shop->file("p.json")).find("sentences"), std::string::npos)
        << "documents stay as they are";
}

}  // namespace
}  // namespace axg::test
