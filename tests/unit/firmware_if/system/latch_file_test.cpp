// SPDX-License-Identifier: Apache-2.0
// The file of the latch: a new one is clear, any byte that is not of the page of "clear" latches,
// and what another user could have written is refused.
#include "firmware_if/system/latch_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

namespace fs = std::filesystem;

class LatchFileTest : public testing::Test {
  protected:
    /// Opened by a guard, and closed again.
    bool begins_latched() const {
        std::string fault;
        const LatchFile latch = open_latch(path, fault);
        EXPECT_TRUE(latch) << fault;
        return !latch || is_latched(*latch);
    }
    void reset() const {
        std::string fault;
        const LatchFile latch = open_latch(path, fault);
        ASSERT_TRUE(latch) << fault;
        set_latch(*latch, false);
    }
    void put(const std::string& bytes) const {
        (void)shop.write("can0.latch", bytes);
        fs::permissions(path, fs::perms(0600));
    }
    void expect_refused(const std::string& words) const {
        std::string fault;
        EXPECT_FALSE(open_latch(path, fault));
        EXPECT_NE(fault.find(words), std::string::npos) << fault;
    }

    test::Workshop shop;
    std::string path = shop.file("can0.latch");
};

TEST_F(LatchFileTest, ANewOneIsClearAndKeepsWhatIsStored) {
    EXPECT_FALSE(begins_latched());
    struct stat status {};
    ASSERT_EQ(stat(path.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777U, 0600U);
    EXPECT_EQ(status.st_size, 4096);
    {
        std::string fault;
        const LatchFile latch = open_latch(path, fault);
        ASSERT_TRUE(latch) << fault;
        set_latch(*latch, true);
    }
    EXPECT_TRUE(begins_latched());
    reset();
    EXPECT_FALSE(begins_latched());
}

TEST_F(LatchFileTest, AnythingButThatPageIsLatched) {
    EXPECT_FALSE(begins_latched());
    const std::string clear = test::content_of(path);
    for (const std::size_t at :
         {std::size_t{0}, std::size_t{15}, std::size_t{16}, std::size_t{2000}, std::size_t{4095}}) {
        std::string other = clear;
        other[at] = static_cast<char>(other[at] ^ 1);
        put(other);
        EXPECT_TRUE(begins_latched()) << at;
        EXPECT_TRUE(begins_latched()) << at << ", and the next time";
        reset();
        EXPECT_FALSE(begins_latched()) << at << ", after a reset";
    }
    for (const std::string& other :
         {std::string(), clear.substr(0, 16), clear.substr(0, 4095), clear + '\0', clear + clear}) {
        put(other);
        EXPECT_TRUE(begins_latched()) << other.size();
        EXPECT_TRUE(begins_latched()) << other.size() << ", and the next time";
        reset();
        EXPECT_FALSE(begins_latched()) << other.size() << ", after a reset";
        EXPECT_EQ(test::content_of(path), clear);
    }
}

TEST_F(LatchFileTest, WhatOthersCanOpenIsRefused) {
    EXPECT_FALSE(begins_latched());
    const std::string clear = test::content_of(path);
    for (const unsigned mode : {0620U, 0602U, 0640U, 0666U}) {
        fs::permissions(path, fs::perms(mode));
        expect_refused("not a latch that only user");
    }
    fs::permissions(path, fs::perms(0600));
    fs::create_hard_link(path, shop.file("second name"));
    expect_refused("2 names");
    fs::remove(path);
    fs::create_symlink(shop.file("second name"), path);
    expect_refused("cannot create the latch file");
    fs::remove(path);
    ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
    expect_refused("not a latch that only user");
    EXPECT_EQ(test::content_of(shop.file("second name")), clear) << "nothing was written";
}

TEST_F(LatchFileTest, ThatOfAnotherUserIsRefused) {
    if (geteuid() != 0) {
        GTEST_SKIP() << "only root can give files to another user";
    }
    constexpr uid_t kOther = 65534, kThird = 65533;
    EXPECT_FALSE(begins_latched());
    ASSERT_EQ(chown(path.c_str(), kThird, static_cast<gid_t>(-1)), 0);
    expect_refused("owner 65533");
    fs::remove(path);
    ASSERT_EQ(chown(shop.file(".").c_str(), kOther, static_cast<gid_t>(-1)), 0);
    EXPECT_FALSE(begins_latched()) << "root uses the service's folder";
    struct stat status {};
    ASSERT_EQ(stat(path.c_str(), &status), 0);
    EXPECT_EQ(status.st_uid, kOther) << "and the service can open it afterwards";
    EXPECT_FALSE(begins_latched());
}

}  // namespace
}  // namespace axg
