// SPDX-License-Identifier: Apache-2.0
// A result that cannot be written says why: what fails when the last bytes leave the buffer is the
// file's close, and its reason is the one to be told.
#include "firmware_if/cli/whole_file.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

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

}  // namespace
}  // namespace axg::test
