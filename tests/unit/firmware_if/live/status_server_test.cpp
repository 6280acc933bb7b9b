// SPDX-License-Identifier: Apache-2.0
// The status thread between readers of every kind and a thread that plays the bus thread: what the
// latter pays for them, and that each reader is served whatever the others do.
#include "firmware_if/live/status_server.hpp"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <thread>

#include "firmware_if/can/socket_can.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/motion_machine.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

/// Tried again for some seconds: the thread that plays the bus thread may wait for a processor.
template <class Condition>
bool comes_true(const Condition& condition) {
    for (int i = 0; i < 500; ++i) {
        if (condition()) {
            return true;
        }
        poll(nullptr, 0, 10);
    }
    return false;
}

class StatusServer : public testing::Test {
  protected:
    StatusServer() {
        std::string fault;
        socket = StatusSocket::open(path, fault);
        EXPECT_EQ(fault, "");
        EXPECT_TRUE(socket.listen());
        bus_thread = std::thread([this] { play_bus(); });
        status_thread = std::thread(
            [this] { serve_status({.socket = &socket, .line = &line}, exchange, is_ending); });
    }
    ~StatusServer() override {
        is_ending.store(true);
        bus_thread.join();
        status_thread.join();
    }
    void play_bus() {
        for (; !is_ending.load(); poll(nullptr, 0, 1)) {
            if (!is_held.load()) {
                answer(exchange, [this] {
                    ++views;
                    LiveView view;
                    view.phase = GuardPhase::ready;
                    view.time_us = monotonic_us();
                    return view;
                });
            }
        }
    }
    int connected() const {
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        path.copy(address.sun_path, sizeof address.sun_path - 1);
        const int reader = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
        const timeval limit{.tv_sec = 5, .tv_usec = 0};
        setsockopt(reader, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
        EXPECT_EQ(connect(reader, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
        return reader;
    }
    test::Json status() const {
        std::string fault;
        const std::string text = read_status(path, fault);
        EXPECT_EQ(fault, "");
        return test::Json::accept(text) ? test::Json::parse(text) : test::Json();
    }

    test::Workshop shop;
    std::string path = shop.file("can0.status");
    Machine machine = motion_test_machine();
    StatusLine line{machine, "m.yaml", "can0", "contact", "0"};
    StatusSocket socket;
    ViewExchange exchange;
    std::atomic<bool> is_ending{false}, is_held{false};
    std::atomic<int> views{0};
    std::thread bus_thread, status_thread;
};

TEST_F(StatusServer, EachReaderIsGivenAFreshState) {
    int asked = 0, fresh = 0;
    EXPECT_TRUE(comes_true([&] {
        const std::int64_t asked_us = monotonic_us();
        const auto said = status();
        ++asked;
        fresh += said["phase"] == "ready" && said["age_ms"].get<std::int64_t>() <=
                                                 (monotonic_us() - asked_us) / 1000 + 1
                     ? 1
                     : 0;
        return fresh == 3;
    })) << "of after it connected";
    EXPECT_LE(views.load(), asked) << "the bus thread makes one for each who asks";
}

TEST_F(StatusServer, WhoReadsNothingOrWritesCostsTheBusThreadOneViewEach20Ms) {
    std::vector<int> readers;
    const std::int64_t began_us = monotonic_us();
    for (int i = 0; i < 300; ++i) {
        readers.push_back(connected());
        const std::string words(10'000, 'w');
        (void)send(readers.back(), words.data(), words.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    }
    EXPECT_TRUE(comes_true([&] { return status()["phase"] == "ready"; })) << "the next is served";
    const std::int64_t spent_ms = (monotonic_us() - began_us) / 1000;
    EXPECT_LE(views.load(), spent_ms / kViewWaitMs + 2);
    EXPECT_LT(spent_ms, 20'000);
    for (const int reader : readers) {
        close(reader);
    }
}

TEST_F(StatusServer, OfABusThreadThatIsHeldTheAgeIsSaid) {
    is_held.store(true);
    EXPECT_EQ(status()["phase"], "init") << "it has shown nothing yet";
    is_held.store(false);
    EXPECT_TRUE(comes_true([&] { return status()["phase"] == "ready"; }));
    is_held.store(true);
    poll(nullptr, 0, 50);
    const auto said = status();
    EXPECT_EQ(said["phase"], "ready");
    EXPECT_GE(said["age_ms"], 50);
    const std::int64_t released_us = monotonic_us();
    is_held.store(false);
    EXPECT_TRUE(comes_true([&] {
        const auto age_ms = status()["age_ms"].get<std::int64_t>();
        return age_ms <= (monotonic_us() - released_us) / 1000 + 1;
    })) << "a view of then is not taken for one of now";
}

/// What a log prints of it.
std::string logged(StopLog& log, const LiveView& view, const StopAccount& account) {
    testing::internal::CaptureStderr();
    log.note(view, account);
    return testing::internal::GetCapturedStderr();
}

// A person reads it once at the stop, once more at rest, and not at each look of the thread.
TEST(StopLogTest, EachSentenceIsLoggedOnceAndTheWayOutAtRest) {
    StopLog log;
    LiveView view;
    view.phase = GuardPhase::stopped;
    view.cause = GuardFault::verdict;
    view.phase_us = 5'000'000;
    view.time_us = 5'020'001;
    StopAccount account;
    account.cause = GuardFault::verdict;
    account.reason = StopReason::predicted;
    account.a = "cutter";
    account.b = "plate";
    account.why = WhyFacts{.a = "cutter", .b = "plate", .available_mm = 6.5, .needed_mm = 7};
    const std::string why =
        "5.020001   cutter and plate could not be proven clear\n"
        "5.020001   they are at least 6.5000 mm apart, the proof of a stop needs up to 7.0000 mm\n";
    EXPECT_EQ(logged(log, view, account), why) << "the phase's own line has the cause";
    EXPECT_EQ(logged(log, view, account), "");
    view.is_confirmed = true;
    account.ways_out = "jog Z+";
    EXPECT_EQ(logged(log, view, account), "5.020001   jog Z+\n");
    EXPECT_EQ(logged(log, view, account), "");
    view.phase = GuardPhase::init;  // the reset
    EXPECT_EQ(logged(log, view, {}), "");
    view.phase = GuardPhase::stopped;
    view.is_confirmed = false;
    view.phase_us = 6'000'000;
    account.ways_out.clear();
    EXPECT_EQ(logged(log, view, account), why) << "of the next stop";
}

}  // namespace
}  // namespace axg
