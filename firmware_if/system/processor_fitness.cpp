// SPDX-License-Identifier: Apache-2.0
// The processors of the guard's two threads: what they are, and which of this machine to give them.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>

#include "firmware_if/system/fitness.hpp"

namespace axg {
namespace {

constexpr int kProcessorsMax = 1024;  // as --bus-cpu accepts

/// Each in ascending order.
struct Processors {
    std::vector<int> online, isolated, tickless;
};

/// The processor of each thread; -1: none to spare.
struct Choice {
    int bus = -1, engine = -1;
};

bool has(const std::vector<int>& numbers, int number) {
    return std::find(numbers.begin(), numbers.end(), number) != numbers.end();
}

std::string print_processors(const std::vector<int>& numbers) {
    std::string text;
    for (std::size_t first = 0, last = 0; first < numbers.size(); first = last + 1) {
        last = first;
        while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) {
            ++last;
        }
        text += fmt::format("{}{}", text.empty() ? "" : ",", numbers[first]);
        text += last == first ? "" : fmt::format("-{}", numbers[last]);
    }
    return text;
}

/// Isolated ones first, then the highest. The first of the machine serves everything else.
std::vector<int> find_spare(const Processors& have) {
    std::vector<int> spare(have.online.rbegin(), have.online.rend());
    std::erase_if(spare,
                  [&](int cpu) { return cpu == have.online.front() && !has(have.isolated, cpu); });
    std::stable_partition(spare.begin(), spare.end(),
                          [&](int cpu) { return has(have.isolated, cpu); });
    return spare;
}

/// Assigns each thread its stated processor if that one is spare, else the first spare one.
Choice choose(const Processors& have, const SystemRequest& request) {
    const std::vector<int> spare = find_spare(have);
    Choice choice{.bus = has(spare, request.bus_cpu) ? request.bus_cpu : -1,
                  .engine = has(spare, request.engine_cpu) ? request.engine_cpu : -1};
    for (const int cpu : spare) {
        if (choice.bus < 0 && cpu != choice.engine) {
            choice.bus = cpu;
        } else if (choice.engine < 0 && cpu != choice.bus) {
            choice.engine = cpu;
        }
    }
    return choice;
}

/// All that is isolated or should be, for a command line states the whole list.
std::string kernel_options(const Processors& have, const Choice& choice) {
    std::vector<int> ours, others;
    for (const int cpu : have.online) {
        const bool is_ours = has(have.isolated, cpu) || cpu == choice.bus || cpu == choice.engine;
        (is_ours ? ours : others).push_back(cpu);
    }
    return fmt::format(
        "isolcpus=managed_irq,domain,{0} nohz_full={0} rcu_nocbs={0} irqaffinity={1} on the "
        "kernel's command line",
        print_processors(ours), print_processors(others));
}

struct Thread {
    const char* name;
    int cpu, choice;  // stated and advised
};

std::string advise(const Processors& have, const Choice& choice, const Thread& thread) {
    if (have.online.empty()) {
        return "nproc --all";
    }
    if (thread.choice < 0) {
        return fmt::format("a computer with 3 processors or more; online here: {}",
                           print_processors(have.online));
    }
    std::string option =
        thread.choice == thread.cpu ? "" : fmt::format("--{}-cpu {}", thread.name, thread.choice);
    if (has(have.isolated, thread.choice)) {
        return option;
    }
    return kernel_options(have, choice) + (option.empty() ? "" : ", and: " + option);
}

Finding check_processor(const Processors& have, const Choice& choice, const Thread& thread) {
    const std::string subject = fmt::format("{} thread", thread.name);
    const std::string mend = advise(have, choice, thread);
    if (thread.cpu < 0) {
        return {Fitness::warn, subject, "no processor of its own", mend};
    }
    if (!has(have.online, thread.cpu)) {
        return {Fitness::bad, subject, fmt::format("processor {} is not there", thread.cpu), mend};
    }
    const bool is_isolated = has(have.isolated, thread.cpu);
    return {is_isolated ? Fitness::ok : Fitness::warn, subject,
            fmt::format("processor {}: {}, {}", thread.cpu,
                        is_isolated ? "isolated" : "shared with other programs",
                        has(have.tickless, thread.cpu) ? "without ticks" : "with ticks"),
            is_isolated ? "" : mend};
}

}  // namespace

std::vector<int> parse_processors(const std::string& list) {
    std::vector<int> numbers;
    const char* at = list.c_str();
    while (std::isdigit(static_cast<unsigned char>(*at)) != 0) {
        char* end = nullptr;
        const long first = std::strtol(at, &end, 10);
        const long last = *end == '-' ? std::strtol(end + 1, &end, 10) : first;
        for (long cpu = first; cpu <= last && cpu < kProcessorsMax; ++cpu) {
            numbers.push_back(static_cast<int>(cpu));
        }
        at = *end == ',' ? end + 1 : end;
    }
    return numbers;
}

std::vector<Finding> check_processors(const SystemRequest& request) {
    const std::string folder = request.root + "/sys/devices/system/cpu/";
    const auto list = [&](const char* name) {
        return parse_processors(read_small_file(folder + name));
    };
    const Processors have{
        .online = list("online"), .isolated = list("isolated"), .tickless = list("nohz_full")};
    const Choice choice = choose(have, request);
    return {check_processor(have, choice, {"bus", request.bus_cpu, choice.bus}),
            check_processor(have, choice, {"engine", request.engine_cpu, choice.engine})};
}

}  // namespace axg
