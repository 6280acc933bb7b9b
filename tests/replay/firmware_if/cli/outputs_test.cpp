// SPDX-License-Identifier: Apache-2.0
// Results of every command: none destroys what a person has, each name is tried before the work,
// and a stdout that takes nothing is a failure. Runs the programs themselves.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <filesystem>

#include "firmware_if/cli/exit_codes.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg::test {
namespace {

namespace fs = std::filesystem;

const std::string kMachine = kPaperMachine;

class Outputs : public testing::Test {
  protected:
    void SetUp() override {
        (void)shop.write("p.ngc", "G0 X1\nM2\n");
        ASSERT_EQ(shop.run("simulate " + kMachine + " p.ngc -o t.log"), kExitClean) << shop.err;
    }

    /// Exit 2, and the file as it was.
    void expect_refused(const std::string& arguments, const std::string& file) {
        const std::string before = content_of(shop.file(file));
        EXPECT_EQ(shop.run(arguments), kExitUsage) << arguments;
        EXPECT_NE(shop.err.find("is the same file as"), std::string::npos) << arguments << shop.err;
        EXPECT_EQ(content_of(shop.file(file)), before) << arguments;
    }

    Workshop shop;
};

TEST_F(Outputs, NoneIsAnInput) {
    fs::create_hard_link(shop.file("t.log"), shop.file("hard.log"));
    fs::create_symlink("t.log", shop.file("soft.log"));
    expect_refused("simulate " + kMachine + " p.ngc -o p.ngc", "p.ngc");
    fs::copy_file(shop.file("p.ngc"), shop.file("p.lines"));  // where the lines of "p" would be
    expect_refused("simulate " + kMachine + " p.lines -o p", "p.lines");
    for (const char* const name : {"t.log", "./t.log", "hard.log", "soft.log"}) {
        const std::string replay = "replay " + kMachine + " t.log ";
        for (const char* const option : {"--csv ", "--frames-out ", "--report ", "--json="}) {
            expect_refused(replay + option + name, "t.log");
            expect_refused(replay + option + "t.log.lines", "t.log.lines");
        }
        expect_refused("inspect t.log --json=" + std::string(name), "t.log");
    }
    expect_refused("drive " + kMachine + " p.ngc --csv p.ngc", "p.ngc");
    (void)shop.write("m.yaml", content_of(kMachine));
    expect_refused("check m.yaml --json=m.yaml", "m.yaml");
    expect_refused("simulate m.yaml p.ngc -o m.yaml", "m.yaml");
}

// What the machine file names is read too.
TEST_F(Outputs, NoneIsAMeshOfTheMachine) {
    (void)shop.write("m.yaml", content_of(kMachine));
    fs::copy(source_file("config/machines/meshes"), shop.file("meshes"),
             fs::copy_options::recursive);
    const std::string mesh = "meshes/paper-trunnion/a.stl";
    expect_refused("simulate m.yaml p.ngc -o " + mesh, mesh);
    expect_refused("replay m.yaml t.log --csv " + mesh, mesh);
    expect_refused("check m.yaml --json=" + mesh, mesh);
    expect_refused("init meshes/paper-trunnion --unit mm --force -o " + mesh, mesh);
}

TEST_F(Outputs, NoTwoAreOneFile) {
    const std::string replay = "replay " + kMachine + " t.log ";
    expect_refused(replay + "--csv a --report a", "a");
    expect_refused(replay + "--csv a --report ./a", "a");
    expect_refused(replay + "--csv - --json", "a");
    EXPECT_FALSE(fs::exists(shop.file("a")));
    // A null device of our own: whoever breaks this as root must not lose the machine's.
    const std::string null = shop.file("null");
    if (mknod(null.c_str(), S_IFCHR | 0600, makedev(1, 3)) == 0) {
        EXPECT_EQ(shop.run(replay + "--csv null --frames-out null"), kExitClean) << shop.err;
        EXPECT_TRUE(fs::is_character_file(null));
    }
}

TEST_F(Outputs, NamesAreTriedBeforeTheWork) {
    fs::create_directory(shop.file("folder"));
    for (const char* const name : {"''", "folder", "folder/", "none/a", "p.ngc/a"}) {
        EXPECT_EQ(shop.run("simulate " + kMachine + " p.ngc -o " + name), kExitUsage) << name;
        EXPECT_EQ(shop.run("replay " + kMachine + " t.log --csv " + name), kExitUsage) << name;
        EXPECT_EQ(shop.out, "") << name;
        EXPECT_EQ(shop.run("drive " + kMachine + " p.ngc --report " + name), kExitUsage) << name;
        EXPECT_EQ(shop.run("compile " + kMachine + " -o " + name), kExitUsage) << name;
        EXPECT_EQ(shop.run("query scene --output " + std::string(name)), kExitUsage) << name;
    }
    EXPECT_EQ(shop.run("check " + kMachine + " --plan --output p.ngc"), kExitUsage);
    EXPECT_EQ(shop.run("demo --output ''"), kExitUsage);
}

TEST_F(Outputs, APipeStaysAPipe) {
    ASSERT_EQ(mkfifo(shop.file("pipe").c_str(), 0600), 0);
    const std::string line = "simulate " + kMachine + " p.ngc -o pipe & cat pipe > got; wait";
    ASSERT_EQ(std::system(("cd '" + shop.file("") + "' && ( '" + AXG_PROGRAM + "' " + line +
                           " ) > words 2>&1")
                              .c_str()),
              0);
    EXPECT_TRUE(fs::is_fifo(shop.file("pipe")));
    EXPECT_EQ(content_of(shop.file("got")), content_of(shop.file("t.log")));
}

TEST_F(Outputs, AHyphenIsStdoutAndTheWordsGoToStderr) {
    const std::string trace = content_of(shop.file("t.log"));
    // A link of our own, as /dev/stdout is one.
    fs::create_symlink("/proc/self/fd/1", shop.file("stdout"));
    for (const char* const name : {"-", "stdout"}) {
        ASSERT_EQ(shop.run("simulate " + kMachine + " p.ngc -o " + name), kExitClean) << shop.err;
        EXPECT_EQ(shop.out, trace) << name;
        EXPECT_TRUE(fs::is_symlink(shop.file("stdout")));
        EXPECT_NE(shop.err.find("s of program"), std::string::npos) << shop.err;
    }
    EXPECT_FALSE(fs::exists(shop.file("-")));
    ASSERT_EQ(shop.run("replay " + kMachine + " t.log --csv -"), kExitClean);
    EXPECT_TRUE(shop.out.starts_with("sample,latched_us")) << shop.out.substr(0, 80);
    ASSERT_EQ(shop.run("drive " + kMachine + " p.ngc --csv -"), kExitClean);
    EXPECT_TRUE(shop.out.starts_with("sample,board")) << shop.out.substr(0, 80);
    const std::string meshes = source_file("config/machines/meshes/paper-trunnion");
    ASSERT_EQ(shop.run("init " + meshes + " --unit mm -o -"), kExitClean) << shop.err;
    EXPECT_TRUE(shop.out.starts_with("# Machine file")) << shop.out.substr(0, 80);
    EXPECT_EQ(shop.run("replay " + kMachine + " t.log --json --report r.html"), kExitClean);
    EXPECT_TRUE(shop.out.starts_with("{")) << shop.out.substr(0, 80);
}

TEST_F(Outputs, AStdoutThatTakesNothingIsSaidAndExit1) {
    if (!fs::exists("/dev/full")) {
        GTEST_SKIP() << "no /dev/full";
    }
    const std::string at = "cd '" + shop.file("") + "' && '";
    const std::vector<std::string> lines = {"check " + kMachine, "replay " + kMachine + " t.log",
                                            "inspect t.log --json",
                                            "simulate " + kMachine + " p.ngc -o -", "--help"};
    for (const std::string& arguments : lines) {
        const int status =
            std::system((at + AXG_PROGRAM + "' " + arguments + " > /dev/full 2> said").c_str());
        EXPECT_EQ(WEXITSTATUS(status), kExitInternal) << arguments;
        const std::string said = content_of(shop.file("said"));
        EXPECT_NE(said.find("No space left on device"), std::string::npos) << arguments << said;
        EXPECT_EQ(said.find("internal error"), std::string::npos) << arguments << said;
    }
}

TEST_F(Outputs, AMissingMachineFileIsNotToBeRepaired) {
    EXPECT_EQ(shop.run("check none.yaml"), kExitInput);
    EXPECT_NE(shop.err.find("No such file"), std::string::npos) << shop.err;
    EXPECT_EQ(shop.err.find("repair"), std::string::npos) << shop.err;
}

}  // namespace
}  // namespace axg::test
