// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <linux/can/netlink.h>
#include <net/if.h>
#include <net/if_arp.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "firmware_if/system/fitness.hpp"

namespace axg {
namespace {

constexpr std::uint64_t kQueueLeast = 10, kQueueMost = 128;  // frames
constexpr std::uint32_t kErrorsWarned = 96;                  // of either counter: error-warning

std::uint64_t number_in(const std::string& path) {
    return std::strtoull(read_small_file(path).c_str(), nullptr, 0);
}

Finding check_state(const CanLink& link, const std::string& bus) {
    constexpr std::array kStates{"error-active", "error-warning", "error-passive",
                                 "bus-off",      "stopped",       "sleeping"};
    const char* const state = link.state < kStates.size() ? kStates[link.state] : "unknown";
    const std::string found =
        fmt::format("{}, errors tx {} rx {}; bus-off {}, passive {}, restarted {} times", state,
                    link.tx_errors, link.rx_errors, link.bus_offs, link.passives, link.restarts);
    if (link.state == CAN_STATE_BUS_OFF) {
        return {Fitness::bad, bus + " state", found,
                fmt::format("check wiring and bit rate, then: sudo ip link set {0} down && sudo ip "
                            "link set {0} up",
                            bus)};
    }
    if (link.state != CAN_STATE_ERROR_ACTIVE && link.state != CAN_STATE_ERROR_WARNING) {
        return {Fitness::bad, bus + " state", found,
                "check wiring, termination and bit rate: ip -details -statistics link show " + bus};
    }
    const bool has_history = link.bus_offs != 0 || link.passives != 0;
    if (link.state == CAN_STATE_ERROR_WARNING || link.tx_errors >= kErrorsWarned ||
        link.rx_errors >= kErrorsWarned || has_history) {
        return {Fitness::warn, bus + " state", found,
                "check wiring and termination: candump -e " + bus + ",0:0,#FFFFFFFF"};
    }
    return {Fitness::ok, bus + " state", found, ""};
}

Finding check_modes(const CanLink& link, const std::string& bus) {
    struct Mode {
        std::uint32_t bit;
        Fitness fitness;
        const char* name;
        const char* why;
    };
    constexpr std::array<Mode, 4> kModes{{
        {CAN_CTRLMODE_LISTENONLY, Fitness::bad, "listen-only", "the guard cannot send"},
        {CAN_CTRLMODE_LOOPBACK, Fitness::bad, "loopback", "the board receives nothing"},
        {CAN_CTRLMODE_ONE_SHOT, Fitness::warn, "one-shot", "a corrupted frame is not sent again"},
        {CAN_CTRLMODE_BERR_REPORTING, Fitness::warn, "berr-reporting",
         "a disturbed bus overloads the processor"},
    }};
    for (const Mode& mode : kModes) {
        if ((link.modes & mode.bit) != 0) {
            return {mode.fitness, bus + " modes", fmt::format("{}: {}", mode.name, mode.why),
                    fmt::format("sudo ip link set {0} down && sudo ip link set {0} up type can {1} "
                                "off",
                                bus, mode.name)};
        }
    }
    return {Fitness::ok, bus + " modes", (link.modes & CAN_CTRLMODE_FD) != 0 ? "fd" : "classical",
            ""};
}

void check_controller(const CanLink& link, const std::string& bus, std::vector<Finding>& out) {
    if (link.kind != "can") {
        out.push_back({Fitness::warn, bus + " kind",
                       fmt::format("\"{}\": a virtual bus, for testing", link.kind), ""});
        return;
    }
    out.push_back({link.bitrate == 0 ? Fitness::bad : Fitness::ok, bus + " bit rate",
                   link.data_bitrate == 0
                       ? fmt::format("{} bit/s", link.bitrate)
                       : fmt::format("{} bit/s, data {} bit/s", link.bitrate, link.data_bitrate),
                   link.bitrate == 0
                       ? fmt::format("sudo ip link set {} up type can bitrate 1000000", bus)
                       : ""});
    out.push_back(
        {link.restart_ms == 0 ? Fitness::ok : Fitness::warn, bus + " restart-ms",
         link.restart_ms == 0
             ? "0"
             : fmt::format("{}: the controller restarts by itself after bus-off", link.restart_ms),
         link.restart_ms == 0
             ? ""
             : fmt::format("sudo ip link set {0} down && sudo ip link set {0} up type "
                           "can restart-ms 0",
                           bus)});
    out.push_back(check_modes(link, bus));
    out.push_back(check_state(link, bus));
}

Finding check_queue(const std::string& folder, const std::string& bus) {
    const std::uint64_t length = number_in(folder + "/tx_queue_len");
    const bool is_fit = length >= kQueueLeast && length <= kQueueMost;
    return {is_fit ? Fitness::ok : Fitness::warn, bus + " queue",
            fmt::format("{} frames{}", length,
                        length < kQueueLeast  ? ": too few if this host has other senders"
                        : length > kQueueMost ? ": a guard frame may wait behind that many others"
                                              : ""),
            is_fit ? "" : fmt::format("sudo ip link set {} txqueuelen {}", bus, kQueueLeast)};
}

Finding check_losses(const std::string& folder, const std::string& bus) {
    const std::uint64_t overruns = number_in(folder + "/statistics/rx_over_errors");
    const std::uint64_t dropped = number_in(folder + "/statistics/rx_dropped");
    const bool is_fit = overruns == 0 && dropped == 0;
    return {
        is_fit ? Fitness::ok : Fitness::warn, bus + " losses",
        fmt::format("{} overruns of the controller, {} frames dropped", overruns, dropped),
        is_fit ? "" : "assign a processor to the controller's interrupt: /proc/irq/N/smp_affinity"};
}

/// Last name of a link of /sys; empty: it is not there.
std::string name_behind(const std::string& link) {
    std::error_code error;
    return std::filesystem::read_symlink(link, error).filename().string();
}

/// A controller behind SPI is read by a thread of its driver, a transfer for each register: at a
/// full bus it loses frames, and a frame waits for that thread.
void check_driver(const std::string& folder, const std::string& bus, std::vector<Finding>& out) {
    const std::string driver = name_behind(folder + "/device/driver");
    if (driver.empty()) {
        return;  // a virtual bus
    }
    const std::string behind = name_behind(folder + "/device/subsystem");
    const bool is_spi = behind == "spi" || driver.rfind("mcp251", 0) == 0;
    out.push_back({is_spi ? Fitness::warn : Fitness::ok, bus + " driver",
                   fmt::format("{}{}{}", driver, behind.empty() ? "" : ", " + behind,
                               is_spi ? ": a controller behind SPI delays and loses frames" : ""),
                   is_spi ? "use a controller of the processor's own, or on PCIe; else measure at "
                            "full load: ip -details -statistics link show " +
                                bus
                          : ""});
}

}  // namespace

std::vector<Finding> check_bus(const std::string& root, const std::string& bus,
                               const std::optional<CanLink>& link) {
    const std::string folder = root + "/sys/class/net/" + bus;
    if (bus.find('/') != std::string::npos || !std::filesystem::is_directory(folder)) {
        return {{Fitness::bad, bus, "no such interface",
                 "list interfaces: ip link show type can; load a missing driver: sudo modprobe "
                 "can-dev"}};
    }
    if (number_in(folder + "/type") != ARPHRD_CAN) {
        return {{Fitness::bad, bus, "no CAN interface", "ip link show type can"}};
    }
    const bool is_up = (number_in(folder + "/flags") & IFF_UP) != 0;
    std::vector<Finding> findings{{is_up ? Fitness::ok : Fitness::bad, bus, is_up ? "up" : "down",
                                   is_up ? "" : "sudo ip link set " + bus + " up"}};
    check_driver(folder, bus, findings);
    findings.push_back(check_queue(folder, bus));
    findings.push_back(check_losses(folder, bus));
    if (link) {
        check_controller(*link, bus, findings);
    } else {
        findings.push_back({Fitness::warn, bus + " controller",
                            "unknown: bit rate, state and error counters were not read",
                            "ip -details -statistics link show " + bus});
    }
    return findings;
}

}  // namespace axg
