// SPDX-License-Identifier: Apache-2.0
// What the service tells: to systemd, whose watchdog is fed only while periods go on, and to the
// Prometheus node exporter, line by line in its format.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <map>
#include <regex>
#include <set>

#include "firmware_if/axguardd/admission.hpp"
#include "firmware_if/live/metrics.hpp"
#include "firmware_if/system/service_notify.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

/// systemd's end of the socket.
class Manager {
  public:
    explicit Manager(const std::string& name) {
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        name.copy(address.sun_path, sizeof address.sun_path - 1);
        if (name[0] == '@') {
            address.sun_path[0] = '\0';
        }
        const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size());
        EXPECT_EQ(bind(socket_, reinterpret_cast<const sockaddr*>(&address), size), 0);
        setenv("NOTIFY_SOCKET", name.c_str(), 1);
    }
    ~Manager() {
        close(socket_);
        for (const char* const name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) {
            unsetenv(name);
        }
    }
    Manager(const Manager&) = delete;
    Manager& operator=(const Manager&) = delete;

    /// Everything that was said, one a line.
    [[nodiscard]] std::string heard() const {
        std::string all;
        std::array<char, 512> text{};
        for (ssize_t size = 0;
             (size = recv(socket_, text.data(), text.size(), MSG_DONTWAIT)) > 0;) {
            all += std::string(text.data(), static_cast<std::size_t>(size)) + "\n";
        }
        return all;
    }

  private:
    int socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
};

TEST(ServiceNotify, IsReadyWithTheFirstPeriodAndFeedsTheWatchdogWhilePeriodsGoOn) {
    const test::Workshop shop;
    const Manager manager(shop.file("notify"));
    setenv("WATCHDOG_USEC", "2000000", 1);
    setenv("WATCHDOG_PID", std::to_string(getpid()).c_str(), 1);
    ServiceNotify service;
    std::int64_t now_us = 10'000'000;
    service.work(0, now_us);
    EXPECT_EQ(manager.heard(), "") << "no period has ended";
    service.work(1, now_us);
    EXPECT_EQ(manager.heard(), "READY=1\nWATCHDOG=1\n");
    service.work(2, now_us += 499'999);
    EXPECT_EQ(manager.heard(), "") << "not due";
    service.work(3, now_us += 1);
    EXPECT_EQ(manager.heard(), "WATCHDOG=1\n");
    for (int i = 0; i < 100; ++i) {
        service.work(3, now_us += 500'000);
    }
    EXPECT_EQ(manager.heard(), "") << "the bus thread stands still";
    service.work(4, now_us);
    EXPECT_EQ(manager.heard(), "WATCHDOG=1\n");
    service.status("armed");
    service.status(std::string(1000, 'x'));
    service.stopping();
    const std::string heard = manager.heard();
    EXPECT_EQ(heard.substr(0, 13), "STATUS=armed\n");
    EXPECT_EQ(heard.size(), 13 + 257 + 11U);
    EXPECT_NE(heard.find("\nSTOPPING=1\n"), std::string::npos);
}

TEST(ServiceNotify, TakesANameWithoutAFileAndLeavesOthersWatchdogsAlone) {
    const Manager manager("@axguard-test-" + std::to_string(getpid()));
    setenv("WATCHDOG_USEC", "2000000", 1);
    setenv("WATCHDOG_PID", "1", 1);
    ServiceNotify service;
    service.work(1, 10'000'000);
    service.work(2, 20'000'000);
    EXPECT_EQ(manager.heard(), "READY=1\n");
}

TEST(ServiceNotify, SaysNothingWithoutAManager) {
    for (const char* const name : {"", "relative", "/nowhere/at/all", "@nobody-listens"}) {
        setenv("NOTIFY_SOCKET", name, 1);
        ServiceNotify service;
        service.work(1, 1);
        service.status("armed");  // and does not wait, and does not end by a signal
    }
    unsetenv("NOTIFY_SOCKET");
}

LiveView busy_view() {
    LiveView view;
    view.phase = GuardPhase::armed;
    view.counters.snapshots = 123;
    view.counters.permits = 45;
    view.input.samples_lost = 7;
    view.input.faults[static_cast<std::size_t>(ReceiverFault::bad_crc)] = 3;
    view.frames_dropped = 8;
    view.compares_hashes = false;
    view.admission = {.is_fit = false, .margin = 0.25, .failed = 1U << 1};
    return view;
}

std::string text_of(const LiveView& view, const std::string& bus) {
    std::array<char, 16384> text{};
    return {text.data(), write_metrics(view, bus, text)};
}

// The rules of the text format, and those of promtool check metrics: HELP and TYPE once and before
// the samples, samples of one name together, counters and they alone end in _total, no label twice.
TEST(Metrics, KeepTheTextFormatOfPrometheus) {
    const std::string text = text_of(busy_view(), "can0");
    ASSERT_FALSE(text.empty());
    ASSERT_EQ(text.back(), '\n');
    const std::regex help("# HELP ([a-z_]+) [A-Z0-9].*\\.");
    const std::regex type("# TYPE ([a-z_]+) (counter|gauge)");
    const std::regex sample(
        "([a-z_]+)\\{([a-z]+=\"[^\"\\\\]*\"(?:,[a-z]+=\"[^\"\\\\]*\")*)\\} [0-9]+(\\.[0-9]+)?");
    std::string helped, current;
    std::set<std::string> names, samples;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        std::smatch match;
        if (std::regex_match(line, match, help)) {
            helped = match[1];
        } else if (std::regex_match(line, match, type)) {
            current = match[1];
            EXPECT_EQ(current, helped);
            EXPECT_TRUE(names.insert(current).second) << "twice: " << current;
            EXPECT_EQ(current.rfind("axguard_", 0), 0U) << current;
            EXPECT_EQ(match[2] == "counter", current.ends_with("_total")) << current;
        } else {
            ASSERT_TRUE(std::regex_match(line, match, sample)) << line;
            EXPECT_EQ(match[1], current);
            EXPECT_TRUE(samples.insert(line.substr(0, line.find('}'))).second) << line;
        }
    }
    EXPECT_EQ(names.size(), 21U);
    EXPECT_EQ(samples.size(),
              kGuardPhases + 1 + 2 + 1 + kAdmissionCount + 14 + kReceiverFaults - 1);
}

TEST(Metrics, CarryTheNumbersOfTheGuard) {
    const std::string text = text_of(busy_view(), "can0");
    for (const char* const line :
         {"\naxguard_phase_info{bus=\"can0\",phase=\"armed\"} 1\n",
          "\naxguard_phase_info{bus=\"can0\",phase=\"stopped\"} 0\n",
          "\naxguard_stop_cause_info{bus=\"can0\",cause=\"none\"} 1\n",
          "\naxguard_admission_fit{bus=\"can0\"} 0\n",
          "\naxguard_admission_margin_ratio{bus=\"can0\"} 0.250\n",
          "\naxguard_admission_waived{bus=\"can0\",check=\"system\"} 0\n",
          "\naxguard_admission_waived{bus=\"can0\",check=\"latency\"} 1\n",
          "\naxguard_hashes_compared{bus=\"can0\"} 0\n",
          "\naxguard_snapshots_total{bus=\"can0\"} 123\n",
          "\naxguard_permits_total{bus=\"can0\"} 45\n",
          "\naxguard_samples_lost_total{bus=\"can0\"} 7\n",
          "\naxguard_frames_dropped_total{bus=\"can0\"} 8\n",
          "\naxguard_receiver_faults_total{bus=\"can0\",fault=\"bad_crc\"} 3\n"}) {
        EXPECT_NE(text.find(line), std::string::npos) << line;
    }
}

// The largest numbers fit, and what would not is no half a page.
TEST(Metrics, FitOrAreNotWritten) {
    LiveView view = busy_view();
    view.input.faults.fill(UINT64_MAX);
    view.input.samples_lost = view.input.frames = view.frames_dropped = UINT64_MAX;
    EXPECT_FALSE(text_of(view, std::string(15, 'x')).empty());
    const std::size_t size = text_of(view, "can0").size();
    std::vector<char> room(size);
    EXPECT_EQ(write_metrics(view, "can0", room), size);
    room.resize(size - 1);
    EXPECT_EQ(write_metrics(view, "can0", room), 0U);
}

TEST(Metrics, TheFileIsReplacedAsAWholeAndReadableForEveryone) {
    const test::Workshop shop;
    const ReplacedFile file(shop.file("a.prom"));
    const mode_t before = umask(0077);
    const std::string first = "first\n", second = "2\n";
    EXPECT_TRUE(file.replace(first));
    EXPECT_EQ(test::content_of(shop.file("a.prom")), first);
    EXPECT_TRUE(file.replace(second));
    umask(before);
    EXPECT_EQ(test::content_of(shop.file("a.prom")), second);
    struct stat status {};
    ASSERT_EQ(stat(shop.file("a.prom").c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777U, 0644U);
    EXPECT_FALSE(std::filesystem::exists(shop.file("a.prom.part")));
    file.remove();
    EXPECT_FALSE(std::filesystem::exists(shop.file("a.prom")));
    EXPECT_FALSE(ReplacedFile(shop.file("no/folder.prom")).replace(first));
    EXPECT_FALSE(ReplacedFile("").is_wanted());
    const ReplacedFile pipe(shop.file("pipe"));
    ASSERT_EQ(mkfifo(shop.file("pipe").c_str(), 0600), 0);
    EXPECT_FALSE(pipe.replace(first));
    pipe.remove();
    EXPECT_TRUE(std::filesystem::is_fifo(shop.file("pipe"))) << "neither replaced nor removed";
}

}  // namespace
}  // namespace axg
