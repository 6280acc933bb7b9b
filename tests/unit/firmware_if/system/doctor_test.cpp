// SPDX-License-Identifier: Apache-2.0
// axguardd doctor: a made-up tree of /proc and /sys in which all is well, and then each thing that
// can be wrong by itself; what rtnetlink says of an interface, byte by byte.
#include <gtest/gtest.h>
#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/rtnetlink.h>

#include <algorithm>
#include <cstring>

#include "firmware_if/axguardd/run_command.hpp"
#include "firmware_if/system/fitness.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

namespace fs = std::filesystem;

/// Another machine, as files; a healthy one unless something is changed.
class Tree {
  public:
    Tree() {
        put("proc/version", "Linux version 6.1.0-rt-amd64 #1 SMP PREEMPT_RT Debian\n");
        put("proc/sys/kernel/osrelease", "6.1.0-rt-amd64\n");
        put("sys/devices/system/clocksource/clocksource0/current_clocksource", "tsc\n");
        put("sys/devices/system/cpu/online", "0-3\n");
        put("sys/devices/system/cpu/isolated", "2-3\n");
        put("sys/devices/system/cpu/nohz_full", "2-3\n");
        put("sys/devices/system/cpu/cpufreq/policy0/scaling_governor", "performance\n");
        put("proc/swaps", "Filename Type Size Used Priority\n");
        put("proc/self/limits",
            "Limit                     Soft Limit           Hard Limit           Units\n"
            "Max locked memory         unlimited            unlimited            bytes\n"
            "Max realtime priority     99                   99\n");
        put("proc/self/status", "Name:\taxguardd\nCapEff:\t0000000000000000\n");
        put("proc/sys/kernel/sched_rt_runtime_us", "-1\n");
        put("dev/nvidia0", "");
        put("proc/uptime", "5000.25 9999.00\n");
        put("proc/77/comm", "other\n");
        put("proc/77/fd/.keep", "");
        put("sys/class/net/can0/type", "280\n");
        put("sys/class/net/can0/flags", "0x400c1\n");
        put("sys/class/net/can0/tx_queue_len", "10\n");
        put("sys/class/net/can0/statistics/rx_over_errors", "0\n");
        put("sys/class/net/can0/statistics/rx_dropped", "0\n");
    }
    /// A controller and its driver, as links of /sys.
    void put_driver(const std::string& name, const std::string& behind) const {
        const fs::path device = path("sys/class/net/can0/device");
        fs::create_directories(device);
        for (const char* link : {"driver", "subsystem"}) {
            fs::remove(device / link);
        }
        fs::create_symlink("../../bus/" + behind + "/drivers/" + name, device / "driver");
        fs::create_symlink("../../bus/" + behind, device / "subsystem");
    }
    void put(const std::string& name, const std::string& text) const {
        fs::create_directories(fs::path(path(name)).parent_path());
        (void)shop_.write(name, text);
    }
    [[nodiscard]] std::string path(const std::string& name) const { return shop_.file(name); }
    [[nodiscard]] std::string root() const { return shop_.file(""); }
    [[nodiscard]] std::vector<Finding> system() const {
        return check_system({.root = root(), .bus_cpu = 3, .engine_cpu = 2});
    }

  private:
    test::Workshop shop_;
};

/// Those that are not well.
std::vector<Finding> faults_of(std::vector<Finding> findings) {
    std::erase_if(findings, [](const Finding& one) { return one.fitness == Fitness::ok; });
    return findings;
}

CanLink healthy_link() {
    CanLink link;
    link.kind = "can";
    link.bitrate = 1'000'000;
    return link;
}

TEST(Doctor, AHealthyMachineIsWellInEveryLine) {
    const Tree tree;
    const auto findings = tree.system();
    EXPECT_EQ(findings.size(), 11U);
    for (const Finding& finding : findings) {
        EXPECT_EQ(finding.fitness, Fitness::ok) << finding.subject << ": " << finding.found;
        EXPECT_FALSE(finding.found.empty()) << finding.subject;
        EXPECT_EQ(finding.mend, "") << finding.subject;
    }
    const auto bus = check_bus(tree.root(), "can0", healthy_link());
    EXPECT_EQ(bus.size(), 7U);
    EXPECT_TRUE(faults_of(bus).empty()) << faults_of(bus).front().found;
}

struct Change {
    const char* file;
    const char* text;
    const char* subject;
    Fitness fitness;
    const char* mend;  // a part of it
};

TEST(Doctor, EachFaultOfTheMachineIsOneLineWithTheCommandThatMendsIt) {
    for (const Change& change : std::initializer_list<Change>{
             {"proc/version", "Linux version 6.1.0 PREEMPT_DYNAMIC", "kernel", Fitness::warn,
              "linux-image-rt"},
             {"sys/devices/system/clocksource/clocksource0/current_clocksource", "hpet", "clock",
              Fitness::warn, "clocksource"},
             {"sys/devices/system/cpu/isolated", "2", "bus thread", Fitness::warn,
              "domain,2-3 nohz_full=2-3 rcu_nocbs=2-3 irqaffinity=0-1"},
             {"sys/devices/system/cpu/isolated", "1,3-7", "engine thread", Fitness::warn,
              "domain,1-3 nohz_full=1-3 rcu_nocbs=1-3 irqaffinity=0"},
             {"sys/devices/system/cpu/online", "0-2", "bus thread", Fitness::bad, "--bus-cpu 1"},
             {"sys/devices/system/cpu/cpufreq/policy3/scaling_governor", "powersave", "governor",
              Fitness::warn, "performance"},
             {"proc/swaps", "Filename Type\n/swapfile file 1 0 -2\n", "swap", Fitness::warn,
              "swapoff"},
             {"proc/self/limits",
              "Max locked memory         8388608   8388608  bytes\n"
              "Max realtime priority     99        99\n",
              "locked memory", Fitness::bad, "LimitMEMLOCK"},
             {"proc/self/limits",
              "Max locked memory         unlimited unlimited bytes\n"
              "Max realtime priority     79        79\n",
              "priority", Fitness::bad, "LimitRTPRIO"},
             {"proc/sys/kernel/sched_rt_runtime_us", "950000", "throttling", Fitness::warn,
              "sched_rt_runtime_us=-1"},
             {"proc/uptime", "119.9 1.0", "boot", Fitness::warn, "systemctl"},
         }) {
        const Tree tree;
        tree.put(change.file, change.text);
        const auto faults = faults_of(tree.system());
        ASSERT_EQ(faults.size(), 1U) << change.file << " " << change.text;
        EXPECT_EQ(faults[0].subject, change.subject);
        EXPECT_EQ(faults[0].fitness, change.fitness) << change.subject;
        EXPECT_NE(faults[0].mend.find(change.mend), std::string::npos) << faults[0].mend;
    }
}

TEST(Doctor, WithoutAnyFileNothingIsWellThatCouldNotBeSeen) {
    const test::Workshop empty;
    std::string well;
    for (const Finding& finding : check_system({.root = empty.file(""), .bus_cpu = 3})) {
        well += finding.fitness == Fitness::ok ? finding.subject + ";" : "";
    }
    EXPECT_EQ(well, "governor;swap;gpu;") << "no such files: no scaling, no swap, no GPU";
    EXPECT_EQ(check_bus(empty.file(""), "can0", std::nullopt)[0].fitness, Fitness::bad);
    EXPECT_EQ(check_bus(empty.file(""), "../sys", std::nullopt)[0].fitness, Fitness::bad);
}

TEST(Doctor, CapabilitiesStandForLimits) {
    const Tree tree;
    tree.put("proc/self/limits", "Max locked memory 8 8 bytes\nMax realtime priority 0 0\n");
    EXPECT_EQ(faults_of(tree.system()).size(), 2U);
    tree.put("proc/self/status", "CapEff:\t0000000000004000\n");  // CAP_IPC_LOCK
    EXPECT_EQ(faults_of(tree.system()).at(0).subject, "priority");
    tree.put("proc/self/status", "CapEff:\t0000000000800000\n");  // CAP_SYS_NICE
    EXPECT_EQ(faults_of(tree.system()).at(0).subject, "locked memory");
}

TEST(Doctor, WhoeverElseHasTheGpuOpenIsNamed) {
    const Tree tree;
    fs::create_symlink("/dev/nvidia0", tree.path("proc/77/fd/5"));
    const auto faults = faults_of(tree.system());
    ASSERT_EQ(faults.size(), 1U);
    EXPECT_NE(faults[0].found.find("77 (other)"), std::string::npos) << faults[0].found;
    fs::remove(tree.path("dev/nvidia0"));
    EXPECT_TRUE(faults_of(tree.system()).empty()) << "no GPU, nothing to share";
}

TEST(Doctor, ProcessorListsAreReadAsTheKernelWritesThem) {
    EXPECT_EQ(parse_processors("2-3,5"), (std::vector<int>{2, 3, 5}));
    EXPECT_EQ(parse_processors("0"), (std::vector<int>{0}));
    EXPECT_TRUE(parse_processors("").empty() && parse_processors("(null)").empty());
    EXPECT_EQ(parse_processors("0-99999999999999999999").size(), 1024U);
}

struct Computer {
    const char* online;
    const char* isolated;
    int bus_cpu, engine_cpu;  // as stated; -1: not
    std::string bus_mend, engine_mend;
};

std::string isolate(const std::string& ours, const std::string& others) {
    return "isolcpus=managed_irq,domain," + ours + " nohz_full=" + ours + " rcu_nocbs=" + ours +
           " irqaffinity=" + others + " on the kernel's command line";
}

// The advice names processors that the machine has, whatever their number and the holes among them;
// both lines state the same command line, which is right as it is.
TEST(Doctor, AdvisesProcessorsThatAreThere) {
    const std::string few = "a computer with 3 processors or more; online here: ";
    const auto both = [](const char* ours, const char* others, const char* option) {
        return isolate(ours, others) + ", and: " + option;
    };
    for (const Computer& computer : std::initializer_list<Computer>{
             {"0", "", -1, -1, few + "0", few + "0"},
             {"0", "", 0, 0, few + "0", few + "0"},
             {"0-1", "", -1, -1, both("1", "0", "--bus-cpu 1"), few + "0-1"},
             {"0-1", "1", 1, -1, "", few + "0-1"},
             {"0-3", "", -1, -1, both("2-3", "0-1", "--bus-cpu 3"),
              both("2-3", "0-1", "--engine-cpu 2")},
             {"0-5", "", -1, -1, both("4-5", "0-3", "--bus-cpu 5"),
              both("4-5", "0-3", "--engine-cpu 4")},
             {"0-7", "", -1, -1, both("6-7", "0-5", "--bus-cpu 7"),
              both("6-7", "0-5", "--engine-cpu 6")},
             {"0-11", "", -1, -1, both("10-11", "0-9", "--bus-cpu 11"),
              both("10-11", "0-9", "--engine-cpu 10")},
             {"0,2-3,6", "", -1, -1, both("3,6", "0,2", "--bus-cpu 6"),
              both("3,6", "0,2", "--engine-cpu 3")},
             {"1,4", "", -1, -1, both("4", "1", "--bus-cpu 4"), few + "1,4"},
             {"0-7", "2-3", -1, -1, "--bus-cpu 3", "--engine-cpu 2"},
             {"0-7", "2", -1, -1, "--bus-cpu 2", both("2,7", "0-1,3-6", "--engine-cpu 7")},
             {"0-3", "2-3,8-9", -1, -1, "--bus-cpu 3", "--engine-cpu 2"},
             {"0-7", "", 2, 3, isolate("2-3", "0-1,4-7"), isolate("2-3", "0-1,4-7")},
             {"0-7", "", -1, 7, both("6-7", "0-5", "--bus-cpu 6"), isolate("6-7", "0-5")},
             {"0-3", "", 0, 2, both("2-3", "0-1", "--bus-cpu 3"), isolate("2-3", "0-1")},
             {"0-3", "2-3", 9, 2, "--bus-cpu 3", ""},
             {"0-3", "0-3", 0, 1, "", ""},
             {"0-3", "0", 0, -1, "", both("0,3", "1-2", "--engine-cpu 3")},
             {"", "", 3, -1, "nproc --all", "nproc --all"},
         }) {
        const Tree tree;
        tree.put("sys/devices/system/cpu/online", computer.online);
        tree.put("sys/devices/system/cpu/isolated", computer.isolated);
        const auto threads = check_processors(
            {.root = tree.root(), .bus_cpu = computer.bus_cpu, .engine_cpu = computer.engine_cpu});
        ASSERT_EQ(threads.size(), 2U);
        EXPECT_EQ(threads[0].mend, computer.bus_mend) << computer.online;
        EXPECT_EQ(threads[1].mend, computer.engine_mend) << computer.online;
    }
}

struct BusChange {
    const char* subject;
    Fitness fitness;
    const char* mend;
    void (*change)(const Tree& tree, CanLink& link);
};

TEST(Doctor, EachFaultOfTheInterfaceIsOneLine) {
    using Link = CanLink;
    for (const BusChange& change : std::initializer_list<BusChange>{
             {"can0", Fitness::bad, "can0 up",
              [](const Tree&tree, Link&) { tree.put("sys/class/net/can0/flags", "0x40080"); }},
             {"can0 queue", Fitness::warn, "txqueuelen",
              [](const Tree&tree, Link&) { tree.put("sys/class/net/can0/tx_queue_len", "9"); }},
             {"can0 queue", Fitness::warn, "txqueuelen",
              [](const Tree&tree, Link&) { tree.put("sys/class/net/can0/tx_queue_len", "129"); }},
             {"can0 losses", Fitness::warn, "smp_affinity",
              [](const Tree&tree, Link&) {
                  tree.put("sys/class/net/can0/statistics/rx_over_errors", "1");
              }},
             {"can0 bit rate", Fitness::bad, "bitrate",
              [](const Tree&, Link&link) { link.bitrate = 0; }},
             {"can0 restart-ms", Fitness::warn, "restart-ms 0",
              [](const Tree&, Link&link) { link.restart_ms = 100; }},
             {"can0 modes", Fitness::bad, "listen-only off",
              [](const Tree&, Link&link) { link.modes = CAN_CTRLMODE_LISTENONLY; }},
             {"can0 modes", Fitness::bad, "loopback off",
              [](const Tree&, Link&link) { link.modes = CAN_CTRLMODE_LOOPBACK; }},
             {"can0 modes", Fitness::warn, "berr-reporting off",
              [](const Tree&, Link&link) { link.modes = CAN_CTRLMODE_BERR_REPORTING; }},
             {"can0 state", Fitness::warn, "termination",
              [](const Tree&, Link&link) { link.state = CAN_STATE_ERROR_WARNING; }},
             {"can0 state", Fitness::bad, "wiring",
              [](const Tree&, Link&link) { link.state = CAN_STATE_ERROR_PASSIVE; }},
             {"can0 state", Fitness::bad, "can0 down",
              [](const Tree&, Link&link) { link.state = CAN_STATE_BUS_OFF; }},
             {"can0 state", Fitness::warn, "termination",
              [](const Tree&, Link&link) { link.rx_errors = 96; }},
             {"can0 state", Fitness::warn, "termination",
              [](const Tree&, Link&link) { link.bus_offs = 1; }},
             {"can0 driver", Fitness::warn, "at full load",
              [](const Tree&tree, Link&) { tree.put_driver("mcp251xfd", "spi"); }},
             {"can0 driver", Fitness::warn, "at full load",  // m_can is behind either
              [](const Tree&tree, Link&) { tree.put_driver("tcan4x5x", "spi"); }},
             {"can0 kind", Fitness::warn, "", [](const Tree&, Link&link) { link.kind = "vcan"; }},
         }) {
        const Tree tree;
        CanLink link = healthy_link();
        change.change(tree, link);
        const auto faults = faults_of(check_bus(tree.root(), "can0", link));
        ASSERT_EQ(faults.size(), 1U) << change.subject;
        EXPECT_EQ(faults[0].subject, change.subject);
        EXPECT_EQ(faults[0].fitness, change.fitness) << faults[0].found;
        EXPECT_NE(faults[0].mend.find(change.mend), std::string::npos) << faults[0].mend;
    }
    const Tree tree;
    tree.put("sys/class/net/can0/type", "1");
    EXPECT_EQ(check_bus(tree.root(), "can0", std::nullopt).at(0).found, "no CAN interface");
}

TEST(Doctor, NamesTheDriverOfTheController) {
    const Tree tree;
    tree.put_driver("mttcan", "platform");
    const auto findings = check_bus(tree.root(), "can0", healthy_link());
    EXPECT_TRUE(faults_of(findings).empty());
    EXPECT_EQ(findings.at(1).subject, "can0 driver");
    EXPECT_EQ(findings.at(1).found, "mttcan, platform");
}

TEST(Doctor, TheCommandEndsWith14WhereSomethingIsBadAndSaysWhat) {
    const Tree tree;
    const std::string json = "--json=" + tree.path("found.json");
    const std::vector<std::string> words{"doctor",    "--root", tree.root(),    "--bus", "can0",
                                         "--bus-cpu", "3",      "--engine-cpu", "2",     json};
    EXPECT_EQ(run_axguardd(words), 0);
    tree.put("proc/uptime", "3 1");
    EXPECT_EQ(run_axguardd(words), 0) << "a warning is no refusal";
    tree.put("sys/class/net/can0/flags", "0x40080");
    EXPECT_EQ(run_axguardd(words), 14);
    const auto found = test::Json::parse(test::content_of(tree.path("found.json")));
    EXPECT_FALSE(found["fit"].get<bool>());
    EXPECT_EQ(found["bad"], 1);
    EXPECT_EQ(found["checks"].size(), 11U + 4U);
}

/// Attributes as the kernel writes them: length, type, value, padded to four bytes.
std::string attribute(std::uint16_t type, const std::string& value) {
    rtattr head{};
    head.rta_len = static_cast<std::uint16_t>(sizeof head + value.size());
    head.rta_type = type;
    std::string out(reinterpret_cast<const char*>(&head), sizeof head);
    out += value;
    out.resize((out.size() + 3) / 4 * 4);
    return out;
}

template <class Value>
std::string bytes_of(const Value& value) {
    return {reinterpret_cast<const char*>(&value), sizeof value};
}

std::string link_message() {
    can_bittiming timing{};
    timing.bitrate = 500'000;
    can_bittiming data_timing{};
    data_timing.bitrate = 2'000'000;
    const can_ctrlmode modes{.mask = ~0U, .flags = CAN_CTRLMODE_FD};
    const can_berr_counter errors{.txerr = 12, .rxerr = 130};
    can_device_stats stats{};
    stats.bus_off = 2;
    stats.error_passive = 3;
    stats.restarts = 4;
    const std::string data =
        attribute(IFLA_CAN_BITTIMING, bytes_of(timing)) +
        attribute(IFLA_CAN_DATA_BITTIMING, bytes_of(data_timing)) +
        attribute(IFLA_CAN_STATE, bytes_of(std::uint32_t{CAN_STATE_ERROR_PASSIVE})) +
        attribute(IFLA_CAN_CTRLMODE, bytes_of(modes)) +
        attribute(IFLA_CAN_RESTART_MS, bytes_of(std::uint32_t{100})) +
        attribute(IFLA_CAN_BERR_COUNTER, bytes_of(errors));
    const std::string info = attribute(IFLA_INFO_KIND, std::string("can\0", 4)) +
                             attribute(IFLA_INFO_DATA | NLA_F_NESTED, data) +
                             attribute(IFLA_INFO_XSTATS, bytes_of(stats));
    std::string body = attribute(IFLA_IFNAME, std::string("can0\0", 5)) +
                       attribute(IFLA_LINKINFO | NLA_F_NESTED, info);
    nlmsghdr head{};
    head.nlmsg_type = RTM_NEWLINK;
    head.nlmsg_len = static_cast<std::uint32_t>(sizeof head + sizeof(ifinfomsg) + body.size());
    return bytes_of(head) + bytes_of(ifinfomsg{}) + body;
}

bool parse(const std::string& message, CanLink& out) {
    return parse_can_link(std::as_bytes(std::span(message.data(), message.size())), out);
}

TEST(CanLinkMessage, IsReadAsTheKernelWritesIt) {
    CanLink link;
    ASSERT_TRUE(parse(link_message(), link));
    EXPECT_EQ(link.kind, "can");
    EXPECT_EQ(link.bitrate, 500'000U);
    EXPECT_EQ(link.data_bitrate, 2'000'000U);
    EXPECT_EQ(link.state, CAN_STATE_ERROR_PASSIVE);
    EXPECT_EQ(link.modes, std::uint32_t{CAN_CTRLMODE_FD});
    EXPECT_EQ(link.restart_ms, 100U);
    EXPECT_EQ(link.tx_errors, 12);
    EXPECT_EQ(link.rx_errors, 130);
    EXPECT_EQ(link.bus_offs, 2U);
    EXPECT_EQ(link.passives, 3U);
    EXPECT_EQ(link.restarts, 4U);
}

// Cut at every byte, and with every length field wrong: refused, or read within its bounds (the
// sanitizers watch).
TEST(CanLinkMessage, DamagedIsNeverReadBeyondItsEnd) {
    const std::string whole = link_message();
    for (std::size_t size = 0; size < whole.size(); ++size) {
        CanLink link;
        EXPECT_FALSE(parse(whole.substr(0, size), link)) << size;
    }
    std::size_t refused = 0;
    for (std::size_t at = 0; at < whole.size(); ++at) {
        for (const char value : {'\0', '\1', '\3', '\xFF'}) {
            std::string damaged = whole;
            damaged[at] = value;
            CanLink link;
            refused += parse(damaged, link) ? 0 : 1;
        }
    }
    EXPECT_GT(refused, 20U) << "lengths are looked at";
}

}  // namespace
}  // namespace axg
