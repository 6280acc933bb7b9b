// SPDX-License-Identifier: Apache-2.0
// `axguard compile`, and every command given what it wrote: the verdicts of the machine file, byte
// for byte, with machine file and meshes gone. Runs the program itself.
// ctest-labels: long
#include <gtest/gtest.h>

#include <memory>

#include "firmware_if/cli/exit_codes.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

namespace fs = std::filesystem;

class CompiledCommand : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        shop = std::make_unique<test::Workshop>();
        if (!fs::exists(AXG_PROGRAM)) {
            return;
        }
        fs::copy(test::kPaperMachine, shop->file("paper.yaml"));
        fs::create_directories(shop->file("meshes"));
        fs::copy(test::source_file("config/machines/meshes/paper-trunnion"),
                 shop->file("meshes/paper-trunnion"));
        ASSERT_EQ(shop->run("compile paper.yaml -o paper.axg --json=compiled.json"), kExitClean)
            << shop->err;
        for (const char* machine : {"paper.yaml", "paper.axg"}) {
            ASSERT_EQ(shop->run(std::string("simulate ") + machine + " " + test::kDemoProgram +
                                " -o " + machine + ".log"),
                      kExitClean)
                << shop->err;
        }
        for (const char* mode : {"contact", "stoppable"}) {
            ASSERT_EQ(replay("paper.yaml", mode), kExitCollision) << shop->err;
        }
        ASSERT_EQ(shop->run("check paper.yaml --json=check.yaml.json"), kExitClean) << shop->err;
        fs::remove(shop->file("paper.yaml"));  // from here on the compiled machine is all there is
        fs::remove_all(shop->file("meshes"));
    }
    static void TearDownTestSuite() { shop.reset(); }
    void SetUp() override {
        if (!fs::exists(AXG_PROGRAM)) {
            GTEST_SKIP() << AXG_PROGRAM << " is not built";
        }
    }
    static int replay(const std::string& machine, const std::string& mode) {
        const std::string name = machine + "." + mode;
        return shop->run("replay " + machine + " paper.yaml.log --keep-going --engine cpu --mode " +
                         mode + " --deadline-us 10000000 --csv " + name + ".csv --frames-out " +
                         name + ".frames --json=" + name + ".json");
    }
    static std::string content(const std::string& name) {
        return test::content_of(shop->file(name));
    }
    static test::Json document(const std::string& name) { return test::Json::parse(content(name)); }
    static std::unique_ptr<test::Workshop> shop;
};

std::unique_ptr<test::Workshop> CompiledCommand::shop;

TEST_F(CompiledCommand, TheVerdictsAreThoseOfTheMachineFileByteForByte) {
    for (const std::string mode : {"contact", "stoppable"}) {
        ASSERT_EQ(replay("paper.axg", mode), kExitCollision) << shop->err;
        for (const std::string kind : {".csv", ".frames"}) {
            const std::string wanted = content("paper.yaml." + mode + kind);
            EXPECT_GT(wanted.size(), 1000U) << mode << kind;
            EXPECT_TRUE(content("paper.axg." + mode + kind) == wanted) << mode << kind;
        }
        EXPECT_EQ(document("paper.axg." + mode + ".json")["stops"],
                  document("paper.yaml." + mode + ".json")["stops"]);
    }
}

TEST_F(CompiledCommand, TheSimulatedTraceIsTheSame) {
    EXPECT_GT(content("paper.yaml.log").size(), 1000U);
    EXPECT_TRUE(content("paper.axg.log") == content("paper.yaml.log"));
}

TEST_F(CompiledCommand, CheckSaysWhatItWasCompiledFromAndFindsTheSame) {
    ASSERT_EQ(shop->run("check paper.axg --json=check.axg.json"), kExitClean) << shop->err;
    test::Json compiled = document("check.axg.json"), read = document("check.yaml.json");
    EXPECT_EQ(compiled["compiled_from"], "paper.yaml");
    EXPECT_EQ(compiled["configuration_sha256"], read["configuration_sha256"]);
    EXPECT_EQ(compiled["hashes"], read["hashes"]);
    compiled.erase("compiled_from");
    compiled.set("file", read["file"]);
    EXPECT_EQ(compiled, read);
    ASSERT_EQ(shop->run("check paper.axg"), kExitClean);
    EXPECT_NE(shop->out.find("compiled from paper.yaml\n"), std::string::npos) << shop->out;
}

TEST_F(CompiledCommand, OtherCommandsTakeItAsWell) {
    EXPECT_EQ(shop->run("inspect paper.yaml.log --machine paper.axg"), kExitClean) << shop->err;
    EXPECT_EQ(shop->run("drive paper.axg " + test::kCleanProgram + " --mode contact"), kExitClean)
        << shop->err;
}

TEST_F(CompiledCommand, TellsWhatItWrote) {
    const test::Json said = document("compiled.json");
    EXPECT_EQ(said["compiled_from"], "paper.yaml");
    EXPECT_EQ(said["bytes"], content("paper.axg").size());
    EXPECT_GT(said["triangles"], 100);
}

/// Engines accept 1 mm: more is an error of the machine file, not a machine without a permit.
TEST_F(CompiledCommand, MoreErrorThanAnEngineAcceptsIsRefused) {
    std::string text = test::content_of(test::kPaperMachine);
    const std::size_t at = text.find("    pivot_mm:");
    ASSERT_NE(at, std::string::npos);
    text.insert(at, "    direction_error_deg: 0.5\n");
    (void)shop->write("errors.yaml", text);
    EXPECT_EQ(shop->run("check errors.yaml --mesh-root " + test::source_file("config/machines")),
              kExitInput);
    EXPECT_NE(shop->err.find("errors.yaml: pairs.cutter-c: invalid value (found 3."),
              std::string::npos)
        << shop->err;
    EXPECT_NE(
        shop->err.find(" mm of stated errors and simplified surfaces, expected at most 1 mm). "
                       "State smaller errors, and add the rest to margin_mm.\n"),
        std::string::npos)
        << shop->err;
}

/// The skew of a gantry is a part of the sum that check prints.
TEST_F(CompiledCommand, CheckListsWhatASkewCosts) {
    std::string text = test::content_of(test::kPaperMachine);
    const std::string axis = "  Y: {kind: linear, ";
    const std::size_t at = text.find(axis);
    ASSERT_NE(at, std::string::npos);
    text.insert(at + axis.size(), "skew_mm: 0.1, ");
    (void)shop->write("skew.yaml", text);
    ASSERT_EQ(shop->run("check skew.yaml --json=skew.json --mesh-root " +
                        test::source_file("config/machines")),
              kExitClean)
        << shop->err;
    const test::Json errors = document("skew.json").at("pose_errors");
    ASSERT_EQ(errors.at("parts").size(), 1U) << errors.dump();
    EXPECT_EQ(errors.at("parts").at(0).at("key"), "axes.Y.skew_mm");
    EXPECT_EQ(errors.at("parts").at(0).at("mm"), errors.at("mm"));
    EXPECT_GE(errors.at("mm").get<double>(), 0.1);
}

/// Stated errors cost the compiled machine the same, and the guard stops earlier for them.
TEST_F(CompiledCommand, StatedErrorsCostTheSameAndStopEarlier) {
    std::string text = test::content_of(test::kPaperMachine);
    for (std::size_t at = 0; (at = text.find("    pivot_mm:", at)) != std::string::npos; at += 60) {
        text.insert(at, "    pivot_error_mm: 0.02\n    direction_error_deg: 0.01\n");
    }
    (void)shop->write("errors.yaml", text);
    const std::string root = " --mesh-root " + test::source_file("config/machines");
    ASSERT_EQ(shop->run("compile errors.yaml -o errors.axg" + root), kExitClean) << shop->err;
    ASSERT_EQ(shop->run("check errors.yaml --json=a.json" + root), kExitClean) << shop->err;
    EXPECT_NE(shop->out.find("\nstated errors: pairs count as nearer than they are drawn, "
                             "cutter-c most: 0.2249 mm\n  bodies.a.direction_error_deg "),
              std::string::npos)
        << shop->out;
    ASSERT_EQ(shop->run("check errors.axg --json=b.json"), kExitClean) << shop->err;
    EXPECT_EQ(document("a.json").at("pose_errors"), document("b.json").at("pose_errors"));
    EXPECT_EQ(document("a.json").at("pose_errors").at("parts").size(), 4U);
    const std::string replay = " paper.yaml.log --engine cpu --deadline-us 10000000 --advice-s 0";
    ASSERT_EQ(shop->run("replay errors.axg" + replay + " --json=c.json"), kExitCollision);
    ASSERT_EQ(shop->run("replay paper.axg" + replay + " --json=d.json"), kExitCollision);
    const auto stop_at = [](const std::string& name) {
        return document(name).at("stops").at(0).at("sample").get<double>();
    };
    EXPECT_LT(stop_at("c.json"), stop_at("d.json"));
}

TEST_F(CompiledCommand, RefusesWhatItCannotMean) {
    const std::string yaml = shop->write("other.yaml", test::content_of(test::kPaperMachine));
    const std::string before = content("other.yaml");
    EXPECT_EQ(shop->run("compile other.yaml -o other.yaml"), kExitUsage);
    EXPECT_EQ(content("other.yaml"), before);
    EXPECT_EQ(shop->run("compile other.yaml -o new.yaml"), kExitUsage);
    EXPECT_NE(shop->err.find("ends in .axg"), std::string::npos) << shop->err;
    EXPECT_EQ(content("other.yaml"), before);
    EXPECT_EQ(shop->run("compile paper.axg -o again.axg"), kExitUsage);
    EXPECT_NE(shop->err.find("found a compiled machine"), std::string::npos) << shop->err;
    EXPECT_EQ(shop->run("check paper.axg --mesh-root ."), kExitInput);
    EXPECT_NE(shop->err.find("Leave the option out"), std::string::npos) << shop->err;
    EXPECT_EQ(shop->run("compile other.yaml -o no.axg"), kExitInput) << "its meshes are not there";
    EXPECT_FALSE(fs::exists(shop->file("no.axg")));
    EXPECT_EQ(shop->run("check none.axg"), kExitInput);
    EXPECT_NE(shop->err.find("none.axg"), std::string::npos) << shop->err;
}

TEST_F(CompiledCommand, ADamagedFileEndsWithTheCommandThatMendsIt) {
    std::string bytes = content("paper.axg");
    bytes[bytes.size() / 2] ^= 4;
    const std::string path = shop->write("bad.axg", bytes);
    for (const std::string command :
         {"check bad.axg", "simulate bad.axg p.ngc -o t.log", "replay bad.axg paper.yaml.log",
          "inspect paper.yaml.log --machine bad.axg", "drive bad.axg p.ngc"}) {
        SCOPED_TRACE(command);
        EXPECT_EQ(shop->run(command), kExitInput);
        EXPECT_NE(shop->err.find("bad.axg:"), std::string::npos) << shop->err;
        EXPECT_NE(shop->err.find("section MESH"), std::string::npos) << shop->err;
        EXPECT_TRUE(shop->err.ends_with("Run axguard compile paper.yaml -o bad.axg.\n"))
            << shop->err;
    }
}

}  // namespace
}  // namespace axg
