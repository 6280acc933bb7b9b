// SPDX-License-Identifier: Apache-2.0
// One guard for each interface and state directory: a second one hears who holds the lock, nobody
// else can take it, and it goes with the process that holds it.
#include "firmware_if/system/one_guard.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

namespace fs = std::filesystem;
using Status = OneGuard::Status;

class OneGuardLock : public testing::Test {
  protected:
    [[nodiscard]] std::string folder() const { return shop_.file("."); }
    [[nodiscard]] std::string lock() const { return shop_.file("can0.lock"); }

    void expect_no_place(const std::string& words) const {
        const OneGuard guard(folder(), "can0");
        EXPECT_EQ(guard.status(), Status::no_place);
        EXPECT_NE(guard.fault().find(words), std::string::npos) << guard.fault();
    }

    test::Workshop shop_;
};

TEST_F(OneGuardLock, RefusesASecondAndNamesTheFirst) {
    const OneGuard first(folder(), "can0");
    ASSERT_EQ(first.status(), Status::mine) << first.fault();
    const OneGuard second(folder(), "can0");
    EXPECT_EQ(second.status(), Status::held);
    const std::string pid = std::to_string(getpid());
    EXPECT_EQ(second.fault(),
              "another axguardd, process " + pid + ", guards can0. End it first: kill " + pid);
    EXPECT_EQ(OneGuard(folder(), "can1").status(), Status::mine) << "another interface";
}

TEST_F(OneGuardLock, GoesWithItsProcess) {
    int ready[2];
    ASSERT_EQ(pipe(ready), 0);
    const pid_t child = fork();
    if (child == 0) {
        const OneGuard held(folder(), "can0");
        const char mark = held.status() == Status::mine ? 'y' : 'n';
        _exit(write(ready[1], &mark, 1) == 1 ? (pause(), 0) : 1);
    }
    char mark = 'n';
    ASSERT_EQ(read(ready[0], &mark, 1), 1);
    EXPECT_EQ(mark, 'y');
    const OneGuard second(folder(), "can0");
    EXPECT_EQ(second.status(), Status::held);
    EXPECT_NE(second.fault().find("process " + std::to_string(child)), std::string::npos);
    ASSERT_EQ(kill(child, SIGKILL), 0);
    ASSERT_EQ(waitpid(child, nullptr, 0), child);
    EXPECT_EQ(OneGuard(folder(), "can0").status(), Status::mine);
    close(ready[0]);
    close(ready[1]);
}

// Any local user can take an abstract name.
TEST_F(OneGuardLock, IsNotHeldByAnAbstractName) {
    const int holder = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::string("axguardd/can0").copy(address.sun_path + 1, sizeof address.sun_path - 1);
    ASSERT_EQ(bind(holder, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(OneGuard(folder(), "can0").status(), Status::mine);
    close(holder);
}

TEST_F(OneGuardLock, FollowsNoLinkAndSharesNoFile) {
    fs::create_symlink(shop_.write("target", ""), lock());
    expect_no_place("cannot open the lock");
    fs::remove(lock());
    fs::create_hard_link(shop_.file("target"), lock());
    expect_no_place("not a lock that only user");
    fs::remove(lock());
    ASSERT_EQ(mkfifo(lock().c_str(), 0600), 0);
    expect_no_place("not a lock that only user");
    fs::remove(lock());
    fs::create_directory(lock());
    expect_no_place("cannot open the lock");
}

TEST_F(OneGuardLock, RefusesWhatOthersCanOpen) {
    std::ofstream(lock()) << "1\n";
    fs::permissions(lock(), fs::perms(0640));
    expect_no_place("mode 640");
    fs::permissions(lock(), fs::perms(0600));
    EXPECT_EQ(OneGuard(folder(), "can0").status(), Status::mine);
    fs::permissions(folder(), fs::perms(01777));
    expect_no_place("other users may write to this folder (found mode 777");
    fs::permissions(folder(), fs::perms(0700));
    EXPECT_EQ(OneGuard(shop_.file("missing"), "can0").status(), Status::no_place);
}

TEST_F(OneGuardLock, RefusesTheFolderAndTheFileOfAnotherUser) {
    if (geteuid() != 0) {
        GTEST_SKIP() << "only root can give files to another user";
    }
    constexpr uid_t kOther = 65534, kThird = 65533;
    std::ofstream(lock()) << "1\n";
    fs::permissions(lock(), fs::perms(0600));
    ASSERT_EQ(chown(lock().c_str(), kThird, static_cast<gid_t>(-1)), 0);
    expect_no_place("not a lock that only user");
    fs::remove(lock());
    ASSERT_EQ(chown(folder().c_str(), kOther, static_cast<gid_t>(-1)), 0);
    EXPECT_EQ(OneGuard(folder(), "can0").status(), Status::mine) << "root uses the service's";
    struct stat status {};
    ASSERT_EQ(stat(lock().c_str(), &status), 0);
    EXPECT_EQ(status.st_uid, kOther) << "and the service can open it afterwards";
    fs::permissions(folder(), fs::perms(0755));
    const pid_t child = fork();
    if (child == 0) {
        const bool is_refused =
            setuid(kThird) == 0 && OneGuard(folder(), "can0").status() == Status::no_place;
        _exit(is_refused ? 0 : 1);
    }
    int code = 1;
    ASSERT_EQ(waitpid(child, &code, 0), child);
    EXPECT_EQ(code, 0);
}

}  // namespace
}  // namespace axg
