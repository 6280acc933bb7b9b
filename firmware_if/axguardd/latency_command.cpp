// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/axguardd/latency_command.hpp"

#include <fmt/format.h>
#include <time.h>

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "firmware_if/axguardd/axguardd_json.hpp"
#include "firmware_if/cli/command_line.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/cli/json_output.hpp"
#include "firmware_if/system/real_time.hpp"

namespace axg {
namespace {

struct LatencyArguments {
    std::int64_t period_us = 1000;
    double seconds = 10;
    int cpu = -1, priority = 80;
    JsonOutput json;
};

int test_latency(const LatencyArguments& arguments) {
    std::vector<std::string> refused;
    for (const std::string& words :
         {lock_memory(), stay_on_cpu(arguments.cpu),
          arguments.priority > 0 ? take_priority(arguments.priority) : std::string()}) {
        if (!words.empty()) {
            fmt::print(stderr, "axguardd: {}\n", words);
            refused.push_back(words);
        }
    }
    const auto count = static_cast<std::uint64_t>(arguments.seconds * 1e6 /
                                                  static_cast<double>(arguments.period_us));
    const auto lateness = std::make_unique<TimeHistogram>();
    measure_lateness(arguments.period_us, count, *lateness);
    const auto late_us = [&](double share) {
        return static_cast<double>(lateness->at_share_ns(share)) * 1e-3;
    };
    const std::int64_t fit_us = fit_period_us(lateness->most_ns());
    const bool is_fit = count > 0 && fit_us <= arguments.period_us;
    const double rate = count == 0 ? 1 : 3 / static_cast<double>(count);
    fmt::print(arguments.json.words(),
               "{} wake-ups every {} us; latency, us: p50 {:.1f}, p99 {:.1f}, p99.9 {:.1f}, max "
               "{:.1f}\nP(worse) < {:.2g} at 95 % confidence (3/N)\n{}: period {} us, latency "
               "budget 20 % of it; smallest fit period {} us\n",
               count, arguments.period_us, late_us(0.5), late_us(0.99), late_us(0.999), late_us(1),
               rate, is_fit ? "PASS" : "FAIL", arguments.period_us, fit_us);
    const bool is_written =
        write_json(arguments.json, describe_latency({.count = count,
                                                     .period_us = arguments.period_us,
                                                     .fit_us = fit_us,
                                                     .lateness = *lateness,
                                                     .rate = rate,
                                                     .is_fit = is_fit,
                                                     .refused = refused}));
    return !is_written ? kExitInternal : is_fit ? kExitClean : kExitUnfit;
}

}  // namespace

std::int64_t monotonic_ns() noexcept {
    timespec time{};
    clock_gettime(CLOCK_MONOTONIC, &time);
    return time.tv_sec * std::int64_t{1'000'000'000} + time.tv_nsec;
}

void measure_lateness(std::int64_t period_us, std::uint64_t count,
                      TimeHistogram& lateness) noexcept {
    const std::int64_t period_ns = period_us * 1000;
    std::int64_t meant_ns = monotonic_ns() + period_ns;
    for (std::uint64_t i = 0; i < count; ++i, meant_ns += period_ns) {
        const timespec until{.tv_sec = meant_ns / 1'000'000'000,
                             .tv_nsec = meant_ns % 1'000'000'000};
        while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) != 0) {
        }
        lateness.add(monotonic_ns() - meant_ns);
    }
}

void add_thread_options(const Command& command, int& cpu, int& priority) {
    command.add_option("--cpu", cpu, "CPU of the measuring thread").between(0, 1023);
    command
        .add_option("--priority", priority,
                    "SCHED_FIFO priority of the thread; 0 = leave unchanged")
        .between(0, 99)
        .shows_default();
}

void add_latency_test(CommandLine& line) {
    const auto arguments = std::make_shared<LatencyArguments>();
    const Command command = line.add_command("latency-test", "Measure thread wake-up latency");
    command.set_example("axguardd latency-test --period-us 1000 --seconds 60");
    command.add_option("--period-us", arguments->period_us, "period of the wake-ups, us")
        .between(std::int64_t{50}, std::int64_t{100'000})
        .shows_default();
    command.add_option("--seconds", arguments->seconds, "duration of the measurement, s")
        .between(0.01, 86400.0)
        .shows_default();
    add_thread_options(command, arguments->cpu, arguments->priority);
    add_json_option(command, arguments->json);
    command.set_action([arguments] { return test_latency(*arguments); });
}

}  // namespace axg
