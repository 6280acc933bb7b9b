// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <system_error>

#include "firmware_if/system/fitness.hpp"

namespace axg {
namespace {

namespace fs = std::filesystem;

constexpr double kSettledS = 120;  // what starts with the machine is done by then

Finding fit(std::string subject, std::string found) {
    return {Fitness::ok, std::move(subject), std::move(found), ""};
}

Finding check_kernel(const std::string& root) {
    const std::string release = read_small_file(root + "/proc/sys/kernel/osrelease");
    const std::string version = read_small_file(root + "/proc/version");
    if (read_small_file(root + "/sys/kernel/realtime") == "1" ||
        version.find("PREEMPT_RT") != std::string::npos) {
        return fit("kernel", release + ", PREEMPT_RT");
    }
    return {Fitness::warn, "kernel",
            release + ", without PREEMPT_RT: high wake-up latency under load",
            "sudo apt install linux-image-rt-amd64 (Jetson: nvidia-l4t-rt-kernel), then run "
            "axguardd latency-test"};
}

Finding check_clock(const std::string& root) {
    const std::string folder = root + "/sys/devices/system/clocksource/clocksource0/";
    const std::string source = read_small_file(folder + "current_clocksource");
    constexpr std::array kGood{"tsc", "arch_sys_counter", "kvm-clock"};
    if (std::find(kGood.begin(), kGood.end(), source) != kGood.end()) {
        return fit("clock", source);
    }
    return {Fitness::warn, "clock",
            (source.empty() ? "unknown" : source) + ": reading the time is slow",
            "dmesg | grep -i clocksource, and tsc=reliable on the kernel's command line"};
}

Finding check_governor(const std::string& root) {
    std::string slow;
    int scaled = 0;
    std::error_code error;
    for (const auto& entry :
         fs::directory_iterator(root + "/sys/devices/system/cpu/cpufreq", error)) {
        const std::string governor = read_small_file(entry.path().string() + "/scaling_governor");
        scaled += governor.empty() ? 0 : 1;
        slow = governor.empty() || governor == "performance" ? slow : governor;
    }
    if (slow.empty()) {
        return fit("governor", scaled == 0 ? "frequencies are not scaled" : "performance");
    }
    return {Fitness::warn, "governor", slow + ": a sleeping processor wakes up slowly",
            "echo performance | sudo tee /sys/devices/system/cpu/cpufreq/*/scaling_governor"};
}

Finding check_swap(const std::string& root) {
    const std::string table = read_small_file(root + "/proc/swaps");
    const auto lines = std::count(table.begin(), table.end(), '\n');
    if (lines < 1) {
        return fit("swap", "none");
    }
    return {Fitness::warn, "swap", fmt::format("{} in use", lines), "sudo swapoff -a"};
}

/// The soft limit of a line of /proc/self/limits; empty: no such line.
std::string limit_of(const std::string& table, const std::string& name) {
    const std::size_t at = table.find(name);
    if (at == std::string::npos) {
        return {};
    }
    std::istringstream words(table.substr(at + name.size()));
    std::string soft;
    words >> soft;
    return soft;
}

Finding check_memory_limit(const std::string& root) {
    const std::string limit =
        limit_of(read_small_file(root + "/proc/self/limits"), "Max locked memory");
    if (limit == "unlimited" || has_capability(root, kCapIpcLock)) {
        return fit("locked memory", "without limit");
    }
    return {Fitness::bad, "locked memory", (limit.empty() ? "unknown" : limit + " bytes"),
            "ulimit -l unlimited, or a file in /etc/security/limits.d, or LimitMEMLOCK=infinity in "
            "the unit"};
}

Finding check_priority_limit(const std::string& root, int wanted) {
    const std::string limit =
        limit_of(read_small_file(root + "/proc/self/limits"), "Max realtime priority");
    const bool is_high = limit == "unlimited" || std::atoi(limit.c_str()) >= wanted;
    if (is_high || has_capability(root, kCapSysNice)) {
        return fit("priority", fmt::format("{} is available", wanted));
    }
    return {
        Fitness::bad, "priority",
        fmt::format("limit {1} (expected at least {0})", wanted, limit.empty() ? "unknown" : limit),
        "ulimit -r 99, or a file in /etc/security/limits.d, or LimitRTPRIO=99 in the unit"};
}

Finding check_throttling(const std::string& root) {
    const std::string runtime = read_small_file(root + "/proc/sys/kernel/sched_rt_runtime_us");
    if (runtime == "-1") {
        return fit("throttling", "off");
    }
    return {Fitness::warn, "throttling",
            fmt::format("real-time threads are throttled after {} us of each second",
                        runtime.empty() ? "an unknown number of" : runtime),
            "sudo sysctl -w kernel.sched_rt_runtime_us=-1"};
}

bool is_gpu_node(const std::string& path) {
    constexpr std::array kNodes{"/dev/nvidia", "/dev/nvgpu", "/dev/nvhost-gpu",
                                "/dev/nvhost-as-gpu", "/dev/nvmap"};
    return std::any_of(kNodes.begin(), kNodes.end(),
                       [&](const char* node) { return path.rfind(node, 0) == 0; });
}

bool has_gpu(const std::string& root) {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(root + "/dev", error)) {
        if (is_gpu_node("/dev/" + entry.path().filename().string())) {
            return true;
        }
    }
    return false;
}

/// Whether the process has a GPU open. `is_closed`: it may not be looked into.
bool uses_gpu(const fs::path& process, bool& is_closed) {
    std::error_code error;
    fs::directory_iterator entries(process / "fd", error);
    is_closed = error == std::errc::permission_denied;
    for (; !error && entries != fs::directory_iterator(); entries.increment(error)) {
        std::error_code gone;
        if (is_gpu_node(fs::read_symlink(entries->path(), gone).string())) {
            return true;
        }
    }
    return false;
}

Finding check_gpu(const std::string& root) {
    if (!has_gpu(root)) {
        return fit("gpu", "none: the CPU engine is used");
    }
    std::string users;
    int closed = 0;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(root + "/proc", error)) {
        const std::string name = entry.path().filename().string();
        const bool is_process = std::all_of(name.begin(), name.end(),
                                            [](unsigned char c) { return std::isdigit(c) != 0; });
        bool is_closed = false;
        if (is_process && uses_gpu(entry.path(), is_closed)) {
            users += fmt::format("{}{} ({})", users.empty() ? "" : ", ", name,
                                 read_small_file(entry.path().string() + "/comm"));
        }
        closed += is_closed ? 1 : 0;
    }
    if (!users.empty()) {
        return {Fitness::warn, "gpu", "used by " + users + ": shared time and shared faults",
                "end them, display included: sudo systemctl isolate multi-user.target"};
    }
    if (closed != 0) {
        return {Fitness::warn, "gpu",
                fmt::format("unknown: {} processes of other users cannot be inspected", closed),
                "sudo axguardd doctor"};
    }
    return fit("gpu", "not used by other processes");
}

Finding check_boot(const std::string& root) {
    const std::string text = read_small_file(root + "/proc/uptime");
    const double up_s = std::strtod(text.c_str(), nullptr);
    if (up_s >= kSettledS) {
        return fit("boot", fmt::format("{:.0f} s ago", up_s));
    }
    return {Fitness::warn, "boot",
            fmt::format("{:.0f} s ago: services may still be starting", up_s),
            "systemctl is-system-running --wait"};
}

}  // namespace

std::string read_small_file(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(file), {}};
    text.erase(text.find_last_not_of(" \n\t") + 1);
    return text;
}

bool has_capability(const std::string& root, int capability) {
    const std::string status = read_small_file(root + "/proc/self/status");
    const std::size_t at = status.find("CapEff:");
    return at != std::string::npos &&
           (std::strtoull(status.c_str() + at + 7, nullptr, 16) >> capability & 1U) != 0;
}

const char* to_text(Fitness fitness) noexcept {
    constexpr std::array kWords{"OK", "WARN", "BAD"};
    return kWords[static_cast<std::size_t>(fitness)];
}

std::vector<Finding> check_system(const SystemRequest& request) {
    const std::string& root = request.root;
    std::vector<Finding> findings{check_kernel(root), check_clock(root)};
    const std::vector<Finding> threads = check_processors(request);
    findings.insert(findings.end(), threads.begin(), threads.end());
    findings.insert(findings.end(),
                    {check_governor(root), check_swap(root), check_memory_limit(root),
                     check_priority_limit(root, request.priority), check_throttling(root),
                     check_gpu(root), check_boot(root)});
    return findings;
}

}  // namespace axg
