// SPDX-License-Identifier: Apache-2.0
// From the verdict to the return of the call that sends the stop: how long, and how many page
// faults. The guard's own code over a socket pair, on a thread that locks its memory and takes the
// priority of the deployed one, with the latch in a real file that was written to the disk since
// it was touched last, as the logger does. Without page faults: in memory of the system, and on the
// disk. AXG_COUNT: stops; AXG_LATCH_DIR: another folder of the disk.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "firmware_if/system/latch_file.hpp"
#include "firmware_if/system/real_time.hpp"
#include "tests/support/count.hpp"
#include "tests/support/live_world.hpp"

namespace axg {
namespace {

std::int64_t now_ns() {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

/// Of the calling thread, with and without a disk.
long page_faults() {
    rusage used{};
    getrusage(RUSAGE_THREAD, &used);
    return used.ru_minflt + used.ru_majflt;
}

struct Stops {
    std::vector<std::int64_t> ns;  // from the step that brings the verdict to the end of the call
    long faults = 0;
};

/// What the logger does with notes of the bus thread.
void log_notes(test::LiveWorld& world, BlackBoxQueue& records, LatchCell& latch) {
    LiveNote note;
    while (world.queues->notes.pop(note)) {
        if (note.kind == LiveNote::Kind::phase) {
            keep_latch(latch);
        }
    }
    BlackBoxEntry record;
    while (records.pop(record)) {
    }
}

class Measurement {
  public:
    Measurement(LatchCell& latch, int socket)
        : latch_(latch), socket_(socket), world_(CanFormat::classical, latch) {
        world_.options.black_box = records_.get();
    }

    void stop_once(Stops& out) {
        prepare();
        std::int64_t verdict_ns = 0;
        long faults = 0;
        bool is_sent = false;
        world_.wire.on_send = [&](const CanFrame& frame) {
            if (frame.id == world_.machine.can.stop_id && !is_sent) {
                const ssize_t sent = ::send(socket_, &frame, sizeof frame, MSG_DONTWAIT);
                out.ns.push_back(now_ns() - verdict_ns);
                out.faults += page_faults() - faults;
                is_sent = sent == static_cast<ssize_t>(sizeof frame);
            }
        };
        world_.each_step = [&] {
            if (!is_sent) {
                faults = page_faults();
                verdict_ns = now_ns();
            }
        };
        world_.verdict = [](std::uint64_t) {
            return CycleResult{.is_stop = true, .reason = StopReason::predicted, .pair = 1};
        };
        world_.run_periods(4);
        EXPECT_TRUE(is_sent);
        EXPECT_EQ(world_.guard->guard().cause, GuardFault::verdict);
        world_.wire.on_send = nullptr;
    }

  private:
    /// Armed, in motion, everything written down; the latch on the disk.
    void prepare() {
        world_.each_step = nullptr;
        world_.verdict = [](std::uint64_t) {
            return CycleResult{.has_permit = true, .known_answer_signature = kKnownAnswerSignature};
        };
        set_latch(latch_, false);
        keep_latch(latch_);
        world_.wire.sent.clear();
        world_.start();
        world_.run_to_armed();
        world_.run_periods(10);
        ASSERT_EQ(world_.guard->guard().phase, GuardPhase::armed);
        log_notes(world_, *records_, latch_);
    }

    LatchCell& latch_;
    int socket_;
    std::unique_ptr<BlackBoxQueue> records_ = std::make_unique<BlackBoxQueue>();
    test::LiveWorld world_;
};

Stops measure(const std::string& folder, std::uint64_t count, std::string& refused) {
    refused = lock_memory() + take_priority(80);
    Stops stops;
    stops.ns.reserve(count);
    std::string fault;
    const std::string path = folder + "/stop_first." + std::to_string(getpid()) + ".latch";
    const LatchFile latch = open_latch(path, fault);
    std::array<int, 2> pair{};
    if (!latch || socketpair(AF_UNIX, SOCK_DGRAM, 0, pair.data()) != 0) {
        ADD_FAILURE() << fault;
        return stops;
    }
    Measurement measurement(*latch, pair[0]);
    CanFrame heard;
    for (std::uint64_t i = 0; i < count && !testing::Test::HasFatalFailure(); ++i) {
        measurement.stop_once(stops);
        EXPECT_EQ(recv(pair[1], &heard, sizeof heard, MSG_DONTWAIT),
                  static_cast<ssize_t>(sizeof heard));
    }
    close(pair[0]);
    close(pair[1]);
    unlink(path.c_str());
    return stops;
}

void expect_no_fault(const char* name, const std::string& folder) {
    const std::uint64_t count = test::count_from_environment(1000);
    Stops stops;
    std::string refused;
    std::thread([&] { stops = measure(folder, count, refused); }).join();
    ASSERT_FALSE(stops.ns.empty());
    std::sort(stops.ns.begin(), stops.ns.end());
    const auto at = [&](double share) {
        const auto last = static_cast<double>(stops.ns.size() - 1);
        return static_cast<double>(stops.ns[static_cast<std::size_t>(share * last)]) * 1e-3;
    };
    std::printf(
        "latch %s: %zu stops, verdict to send us: p50 %.1f, p99 %.1f, p99.9 %.1f, "
        "longest %.1f; %ld page faults; %s\n",
        name, stops.ns.size(), at(0.5), at(0.99), at(0.999), at(1), stops.faults,
        refused.empty() ? "locked memory, SCHED_FIFO 80" : refused.c_str());
    EXPECT_EQ(stops.faults, 0);
}

TEST(StopFirstTime, HasNoPageFaultWithALatchInMemory) {
    expect_no_fault("in /dev/shm", "/dev/shm");
}

TEST(StopFirstTime, HasNoPageFaultWithALatchOnTheDisk) {
    const char* const folder = std::getenv("AXG_LATCH_DIR");
    expect_no_fault("on the disk", folder != nullptr ? folder : AXG_BINARY_DIR);
}

}  // namespace
}  // namespace axg
