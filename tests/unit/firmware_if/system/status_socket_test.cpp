// SPDX-License-Identifier: Apache-2.0
// The status socket with readers that read, that do not, and that write; names that are taken by
// something else; and the command that reads it.
#include "firmware_if/system/status_socket.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <thread>
#include <vector>

#include "firmware_if/axguardd/run_command.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

namespace fs = std::filesystem;

std::string line_of(const std::string& phase, const std::string& cause) {
    return "{\"axguardd\":\"9\",\"bus\":\"can0\",\"machine\":\"m\",\"file\":\"m.yaml\","
           "\"configuration_sha256\":\"a\","
           "\"mode\":\"contact\",\"board_test\":{\"record\":\"none\",\"serial\":null,"
           "\"date\":null,\"differs\":[]},\"age_ms\":3,\"phase\":\"" +
           phase + "\",\"phase_ms\":40,\"cause\":\"" + cause +
           "\",\"reason\":\"none\",\"pair\":null,\"why\":null,\"program_line\":null,"
           "\"unknown_tool\":null,\"way_out\":null,\"withheld\":\"nothing\","
           "\"withheld_reason\":\"none\",\"withheld_pair\":null,\"withheld_why\":null,\"tool\":"
           "null,\"guarded_tool\":null,\"stands\":"
           "true,"
           "\"confirmed\":false,\"session\":true,\"sample_us\":1000,\"period_us\":null,\"hashes\":"
           "\"required\",\"snapshots\":5,"
           "\"permits\":0,\"permits_slow\":0,\"stop_frames\":0,\"late\":0,\"refused\":0,"
           "\"send_faults\":0,\"samples_lost\":0,\"frames_dropped\":0,\"operator_acts\":0,"
           "\"operator_refused\":0,\"operator_ignored\":0}\n";
}
const std::string kText = line_of("ready", "none");

/// Whoever is served is given this.
auto said(const std::string& text) {
    return [&text] { return std::span(text.data(), text.size()); };
}

class StatusSocketTest : public testing::Test {
  protected:
    StatusSocket open() {
        std::string fault;
        StatusSocket socket = StatusSocket::open(path, fault);
        EXPECT_EQ(fault, "");
        EXPECT_TRUE(socket.is_open());
        EXPECT_TRUE(socket.listen());
        return socket;
    }
    std::string refusal() const {
        std::string fault;
        EXPECT_FALSE(StatusSocket::open(path, fault).is_open());
        return fault;
    }
    /// A reader that is connected, and has read nothing; negative: it is refused.
    int connected() const {
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        path.copy(address.sun_path, sizeof address.sun_path - 1);
        const int reader = socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
        if (connect(reader, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
            close(reader);
            return -1;
        }
        return reader;
    }
    static std::string heard(int reader) {
        std::array<char, 8192> part{};
        const ssize_t size = recv(reader, part.data(), part.size(), 0);
        return {part.data(), size > 0 ? static_cast<std::size_t>(size) : 0};
    }

    test::Workshop shop;
    std::string path = shop.file("can0.status");
};

TEST_F(StatusSocketTest, EveryoneIsGivenTheTextAndTheEnd) {
    const mode_t before = umask(0077);
    const StatusSocket socket = open();
    umask(before);
    struct stat status {};
    ASSERT_EQ(stat(path.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777U, 0666U);
    EXPECT_FALSE(socket.await(0));
    EXPECT_EQ(socket.serve(said(kText)), 0);
    const int reader = connected();
    ASSERT_GE(reader, 0);
    EXPECT_TRUE(socket.await(1000));
    EXPECT_EQ(socket.serve(said(kText)), 1);
    EXPECT_EQ(heard(reader), kText);
    EXPECT_EQ(heard(reader), "") << "closed";
    close(reader);
}

TEST_F(StatusSocketTest, TheLongestTextIsHandedOverToAReaderThatSleeps) {
    const StatusSocket socket = open();
    const std::string text(StatusSocket::kTextMax, 'x');
    const int reader = connected();
    EXPECT_EQ(socket.serve(said(text)), 1);
    EXPECT_EQ(heard(reader), text);
    close(reader);
}

TEST_F(StatusSocketTest, ReadersThatDoNothingOrWriteHoldNobodyUp) {
    const StatusSocket socket = open();
    std::vector<int> readers;
    const auto began = std::chrono::steady_clock::now();
    int served = 0;
    for (int i = 0; i < 400; ++i) {
        const int reader = connected();
        if (reader >= 0) {
            readers.push_back(reader);
            if (i % 2 == 0) {
                const std::string words(60'000, 'w');
                (void)send(reader, words.data(), words.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
            }
            if (i % 3 == 0) {
                close(reader);
                readers.pop_back();
            }
        }
        if (i % 10 == 9) {
            const int now = socket.serve(said(kText));
            EXPECT_LE(now, StatusSocket::kServedATurn) << "then it rests";
            served += now;
        }
    }
    EXPECT_GT(served, 200);
    while (socket.serve(said(kText)) != 0) {
    }
    EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(10));
    const int last = connected();
    EXPECT_EQ(socket.serve(said(kText)), 1);
    EXPECT_EQ(heard(last), kText) << "and the next reader is served";
    close(last);
    for (const int reader : readers) {
        close(reader);
    }
}

TEST_F(StatusSocketTest, MoreThanWaitAreRefusedByTheKernel) {
    const StatusSocket socket = open();
    std::vector<int> readers;
    for (int i = 0; i < 100; ++i) {
        const int reader = connected();
        if (reader >= 0) {
            readers.push_back(reader);
        }
    }
    EXPECT_LE(readers.size(), StatusSocket::kBacklog + 1U);
    for (const int reader : readers) {
        close(reader);
    }
}

TEST_F(StatusSocketTest, BeforeItListensNobodyIsKept) {
    std::string fault;
    const StatusSocket socket = StatusSocket::open(path, fault);
    EXPECT_LT(connected(), 0);
}

TEST_F(StatusSocketTest, AnOldSocketIsReplacedAndAServedOneIsNot) {
    {
        const StatusSocket first = open();
        EXPECT_NE(refusal().find("another process serves"), std::string::npos) << refusal();
        for (int i = 0; i < 50; ++i) {  // also while more wait than it has room for
            (void)connected();
        }
        EXPECT_NE(refusal().find("another process serves"), std::string::npos);
    }
    EXPECT_FALSE(fs::exists(path)) << "removed at the end";
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    const int old = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    ASSERT_EQ(bind(old, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    close(old);
    ASSERT_TRUE(fs::is_socket(path));
    const StatusSocket second = open();
    const int reader = connected();
    EXPECT_EQ(second.serve(said(kText)), 1);
    EXPECT_EQ(heard(reader), kText);
    close(reader);
}

TEST_F(StatusSocketTest, WhatIsNoSocketIsNeitherReplacedNorRemoved) {
    (void)shop.write("can0.status", "precious");
    EXPECT_NE(refusal().find("not a socket"), std::string::npos);
    EXPECT_EQ(test::content_of(path), "precious");
    fs::remove(path);
    fs::create_directory(path);
    EXPECT_NE(refusal().find("not a socket"), std::string::npos);
    fs::remove(path);
    fs::create_symlink(shop.file("elsewhere"), path);
    EXPECT_NE(refusal().find("not a socket"), std::string::npos);
    fs::remove(path);
    ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
    EXPECT_NE(refusal().find("not a socket"), std::string::npos);
    fs::remove(path);
    {
        const StatusSocket socket = open();
        fs::remove(path);
        (void)shop.write("can0.status", "precious");
    }
    EXPECT_EQ(test::content_of(path), "precious") << "it took the name meanwhile";
    path = shop.file("no/folder");
    EXPECT_NE(refusal().find("in a writable folder"), std::string::npos);
    path = std::string(200, 'x');
    EXPECT_NE(refusal().find("invalid socket name"), std::string::npos);
}

class StatusCommand : public StatusSocketTest {
  protected:
    /// The command beside a guard that says this.
    int status(const std::string& text, std::vector<std::string> more = {}) {
        const StatusSocket socket = open();
        std::thread guard([&] {
            if (socket.await(5000)) {
                (void)socket.serve(said(text));
            }
        });
        const int code = run(std::move(more));
        guard.join();
        return code;
    }
    int run(std::vector<std::string> more) const {
        std::vector<std::string> words{"status", "--socket", path};
        words.insert(words.end(), more.begin(), more.end());
        testing::internal::CaptureStdout();
        const int code = run_axguardd(words);
        out = testing::internal::GetCapturedStdout();
        return code;
    }
    mutable std::string out;
};

TEST_F(StatusCommand, PrintsTheStateInWords) {
    EXPECT_EQ(status(kText), kExitClean);
    EXPECT_EQ(out.substr(0, 11), "can0: ready");
}

TEST_F(StatusCommand, WithJsonItIsTheLineAndNothingElse) {
    EXPECT_EQ(status(kText, {"--json"}), kExitClean);
    EXPECT_EQ(out, kText);
}

TEST_F(StatusCommand, AStopIsItsExitCode) {
    EXPECT_EQ(status(line_of("stopped", "verdict")), kExitCollision);
    EXPECT_EQ(status(line_of("stopped", "input")), kExitCan);
}

TEST_F(StatusCommand, WhatItDoesNotKnowIsThree) {
    testing::internal::CaptureStderr();
    EXPECT_EQ(status(line_of("stopped", "boredom")), kExitInput);
    EXPECT_EQ(out, "");
    EXPECT_EQ(status(line_of("dancing", "none"), {"--json"}), kExitInput);
    EXPECT_NE(out.find("\"exit_code\": 3,\n  \"fault\": \""), std::string::npos) << out;
    EXPECT_NE(testing::internal::GetCapturedStderr().find(
                  "incompatible status: the guard runs another axguardd version"),
              std::string::npos);
}

TEST_F(StatusCommand, OneBoundHoldsForTheWholeAnswer) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    const int listener = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    ASSERT_EQ(bind(listener, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    ASSERT_EQ(listen(listener, 1), 0);
    std::thread dribbler([listener] {
        const int reader = accept4(listener, nullptr, nullptr, SOCK_CLOEXEC);
        for (int i = 0; i < 120 && send(reader, " ", 1, MSG_NOSIGNAL) == 1; ++i) {
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
        }
        close(reader);
    });
    const auto began = std::chrono::steady_clock::now();
    testing::internal::CaptureStderr();
    EXPECT_EQ(run({}), kExitInput);
    EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(4));
    EXPECT_NE(testing::internal::GetCapturedStderr().find("no reply from the guard within 2000 ms"),
              std::string::npos);
    dribbler.join();
    close(listener);
}

TEST_F(StatusCommand, WithoutAGuardOrWithAnotherProgramItIsThree) {
    EXPECT_EQ(run({}), kExitInput) << "no such file";
    EXPECT_EQ(status("hello\n"), kExitInput);
    EXPECT_EQ(status(""), kExitInput);
    (void)shop.write("can0.status", "precious");
    EXPECT_EQ(run({}), kExitInput);
    EXPECT_EQ(run({"--bus", "can0"}), kExitUsage) << "one of both";
    EXPECT_EQ(run_axguardd({"status"}), kExitUsage);
}

// At the machine the guard is a service: nobody starts axguardd run there.
TEST(ReadStatus, WithoutAGuardItNamesHowThatOneIsStarted) {
    std::string fault;
    EXPECT_EQ(read_status("/run/axguardd/nocan9/status", fault), "");
    EXPECT_EQ(fault,
              "/run/axguardd/nocan9/status: no guard. Start it: sudo systemctl start "
              "axguardd@nocan9. Why it ended: journalctl -u axguardd@nocan9.");
    for (const char* path : {"/run/axguardd/status", "/run/axguardd//status", "none.status"}) {
        EXPECT_EQ(read_status(path, fault), "");
        EXPECT_EQ(fault,
                  std::string(path) + ": no guard. Start axguardd run with --status-socket.");
    }
}

}  // namespace
}  // namespace axg
