// SPDX-License-Identifier: Apache-2.0
// A result that cannot be written says why: what fails when the last bytes leave the buffer is the
// file's close, and its reason is the one to be told.
#include "firmware_if/cli/whole_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <string>
#include <thread>

#include "hil_replay/page/run_page.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg::test {
namespace {

TEST(WholeFile, AFullDiskIsCalledThatHoweverShortTheText) {
    if (!std::filesystem::exists("/dev/full")) {
        GTEST_SKIP() << "no /dev/full";
    }
    for (const std::size_t size : {std::size_t{5}, std::size_t{1} << 20U}) {
        const std::string said = printed_text([size](std::FILE* messages) {
            EXPECT_FALSE(write_whole_file("/dev/full", std::string(size, 'x'), messages));
        });
        EXPECT_NE(said.find("No space left on device"), std::string::npos) << size << ": " << said;
    }
}

TEST(WholeFile, WhatCannotBeWrittenLeavesNothingBehind) {
    const Workshop shop;
    const std::string folder = shop.file("results");
    std::filesystem::create_directory(folder);
    const std::string said = printed_text([&](std::FILE* messages) {
        EXPECT_FALSE(write_whole_file(folder + "/none/a.csv", "text", messages));
    });
    EXPECT_NE(said.find("No such file or directory"), std::string::npos) << said;
    EXPECT_TRUE(std::filesystem::is_empty(folder));
}

// A rename puts a regular file in the place of whatever had the name.
TEST(WholeFile, APipeIsWrittenToAndStaysAPipe) {
    const Workshop shop;
    const std::string pipe = shop.file("pipe");
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    std::string read;
    std::thread reader([&] { read = content_of(pipe); });
    EXPECT_TRUE(write_whole_file(pipe, "text", stderr));
    reader.join();
    EXPECT_EQ(read, "text");
    EXPECT_TRUE(std::filesystem::is_fifo(pipe));
}

TEST(WholeFile, ALinkIsFollowedAndTheFilesRightsStay) {
    const Workshop shop;
    const std::string file = shop.write("file", "old"), link = shop.file("link");
    std::filesystem::permissions(file, std::filesystem::perms(0640));
    std::filesystem::create_symlink("file", link);
    EXPECT_TRUE(write_whole_file(link, "new", stderr));
    EXPECT_TRUE(std::filesystem::is_symlink(link));
    EXPECT_EQ(content_of(file), "new");
    EXPECT_EQ(std::filesystem::status(file).permissions(), std::filesystem::perms(0640));
}

// Something that took the name after the file was opened.
TEST(WholeFile, ADeviceThatAppearsMeanwhileIsNotReplaced) {
    const Workshop shop;
    const std::string path = shop.file("out");
    WholeFile file;
    ASSERT_TRUE(file.open(path) && file.write("text"));
    ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
    EXPECT_FALSE(file.finish());
    EXPECT_NE(file.error().find("cannot be renamed"), std::string::npos) << file.error();
    EXPECT_TRUE(std::filesystem::is_fifo(path));
}

// A child opens a result and ends by a signal: the folder is as it was.
TEST(WholeFile, ASignalLeavesNothingBehind) {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) {
        const Workshop shop;
        const std::string file = shop.write("file", "old");
        const pid_t child = fork();
        ASSERT_GE(child, 0);
        if (child == 0) {
            std::signal(signal, SIG_DFL);
            WholeFile out;
            const bool is_begun =
                out.open(file) && out.write(std::string(std::size_t{1} << 20U, 'x'));
            raise(signal);
            _exit(is_begun ? 1 : 2);
        }
        int status = 0;
        ASSERT_EQ(waitpid(child, &status, 0), child);
        ASSERT_TRUE(WIFSIGNALED(status)) << status;
        EXPECT_EQ(WTERMSIG(status), signal);
        EXPECT_EQ(content_of(file), "old");
        std::filesystem::remove(file);
        EXPECT_TRUE(std::filesystem::is_empty(shop.file(""))) << signal;
    }
}

TEST(WholeFile, AnIgnoredSignalStaysIgnored) {
    const Workshop shop;
    std::signal(SIGHUP, SIG_IGN);  // as nohup does
    WholeFile out;
    ASSERT_TRUE(out.open(shop.file("file")));
    raise(SIGHUP);
    EXPECT_TRUE(out.write("text") && out.finish()) << out.error();
    std::signal(SIGHUP, SIG_DFL);
}

TEST(IsSameFile, LeadsThroughLinksAndSpelling) {
    const Workshop shop;
    const std::string file = shop.write("file", "");
    std::filesystem::create_hard_link(file, shop.file("hard"));
    std::filesystem::create_symlink("file", shop.file("soft"));
    for (const char* const name : {"file", "hard", "soft", "./file"}) {
        EXPECT_TRUE(is_same_file(file, shop.file(name))) << name;
    }
    EXPECT_FALSE(is_same_file(file, shop.file("other")));
    EXPECT_TRUE(is_same_file(shop.file("new"), shop.file("./new"))) << "two that do not exist";
    EXPECT_TRUE(is_same_file("new-here", "./new-here"));
    EXPECT_TRUE(is_same_file("-", "/dev/stdout"));
    EXPECT_FALSE(is_same_file("-", shop.file("-")));
    EXPECT_FALSE(is_same_file("/dev/null", "/dev/null")) << "it has nothing to destroy";
}

TEST(OutputFault, NamesWhatIsWrongBeforeTheWork) {
    const Workshop shop;
    const std::string file = shop.write("file", "");
    EXPECT_EQ(output_fault(file), "");
    EXPECT_EQ(output_fault(shop.file("new")), "");
    EXPECT_EQ(output_fault("-"), "");
    EXPECT_NE(output_fault("").find("empty file name"), std::string::npos);
    EXPECT_EQ(output_fault(shop.file("")), "is a folder (expected a file)");
    EXPECT_NE(output_fault(shop.file("none/new")).find("No such file"), std::string::npos);
    EXPECT_NE(output_fault(shop.file("new/")).find("No such file"), std::string::npos);
    EXPECT_NE(output_fault(file + "/new").find("Not a directory"), std::string::npos);
    std::filesystem::create_symlink("nothing", shop.file("dangling"));
    EXPECT_EQ(output_fault(shop.file("dangling")), "is a broken link. Remove it.");
    EXPECT_EQ(output_folder_fault(shop.file("new/folder")), "");
    EXPECT_NE(output_folder_fault(file + "/folder").find("is not a folder"), std::string::npos);
    if (geteuid() != 0) {  // root may write everywhere
        std::filesystem::permissions(file, std::filesystem::perms(0444));
        EXPECT_EQ(output_fault(file), "Permission denied");
    }
}

}  // namespace
}  // namespace axg::test
