// SPDX-License-Identifier: Apache-2.0
// What may stand under the name of a machine file, and what is refused without being opened for
// reading.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "config/compiled/compiled_machine.hpp"
#include "tests/support/machine_text.hpp"

namespace axg::test {
namespace {

namespace fs = std::filesystem;

class MachinePath : public testing::Test {
  protected:
    void SetUp() override { fs::create_directories(folder_); }
    void TearDown() override { fs::remove_all(folder_); }

    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    static std::string faults_at(const std::string& path) {
        Machine machine;
        std::string out;
        for (const ConfigFault& fault : load_machine(path, machine)) {
            out += to_string(fault) + '\n';
        }
        return out;
    }

  private:
    fs::path folder_ = fs::path(testing::TempDir()) / ("axg_path_" + std::to_string(getpid()));
};

TEST_F(MachinePath, ARegularFileLoadsAlsoThroughALink) {
    std::ofstream(path("m.yaml")) << kSmallMachine;
    fs::create_symlink("m.yaml", path("link.yaml"));
    EXPECT_EQ(faults_at(path("m.yaml")), "");
    EXPECT_EQ(faults_at(path("link.yaml")), "");
}

TEST_F(MachinePath, AMissingFileIsReported) {
    EXPECT_EQ(faults_at(path("none.yaml")),
              path("none.yaml") +
                  ":1: invalid file (found No such file or directory, expected a file that can be "
                  "opened). Check the name.\n");
}

// A pipe without a writer would hold up an ordinary open for ever.
TEST_F(MachinePath, APipeIsRefusedWithoutWaiting) {
    ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
    EXPECT_EQ(faults_at(path("pipe")),
              path("pipe") + ":1: invalid file (found a pipe, expected a regular file).\n");
}

TEST_F(MachinePath, DevicesAndFoldersAreRefused) {
    EXPECT_EQ(faults_at("/dev/zero"),
              "/dev/zero:1: invalid file (found a device, expected a regular file).\n");
    fs::create_symlink("/dev/zero", path("zero.yaml"));
    EXPECT_EQ(faults_at(path("zero.yaml")),
              path("zero.yaml") + ":1: invalid file (found a device, expected a regular file).\n");
    fs::create_directory(path("folder"));
    EXPECT_EQ(faults_at(path("folder")),
              path("folder") + ":1: invalid file (found a folder, expected a regular file).\n");
}

TEST_F(MachinePath, ALargeFileIsRefusedByItsSize) {
    std::ofstream(path("large.yaml")) << '#';
    fs::resize_file(path("large.yaml"), (1U << 20U) + 1);
    EXPECT_EQ(
        faults_at(path("large.yaml")),
        path("large.yaml") +
            ":1: invalid file (found more than 1048576 bytes, expected at most 1048576 bytes).\n");
}

TEST_F(MachinePath, ControlCharactersOfAFileNameAreEscaped) {
    EXPECT_EQ(faults_at("no\x1b[2J.yaml"),
              "no\\x1b[2J.yaml:1: invalid file (found No such file or directory, expected a file "
              "that can be opened). Check the name.\n");
}

TEST_F(MachinePath, AFaultLeavesTheMachineUntouched) {
    std::ofstream(path("m.yaml")) << with(kSmallMachine, "stopping_mm_s2: 1500",
                                          "stopping_mm_s2: 0");
    Machine machine;
    machine.name = "before";
    EXPECT_FALSE(load_machine(path("m.yaml"), machine).empty());
    EXPECT_EQ(machine.name, "before");
    EXPECT_TRUE(machine.axes.empty());
}

}  // namespace
}  // namespace axg::test
