// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/axguardd/admission_figures.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/sysinfo.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <memory>
#include <system_error>
#include <thread>
#include <vector>

#include "core/base/time_histogram.hpp"
#include "firmware_if/axguardd/latency_command.hpp"
#include "firmware_if/axguardd/live_threads.hpp"
#include "firmware_if/guard/guard_chain.hpp"
#include "firmware_if/guard/live_engine.hpp"
#include "firmware_if/setup/cold_caches.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "firmware_if/setup/longest_gpu_cycle.hpp"
#include "firmware_if/setup/travel_sample.hpp"
#include "firmware_if/system/real_time.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kPositions = 64;
constexpr double kFullSpeed = 0.9;  // of what an axis may do: rounding makes no faster one
// Between two cycles, so that a thread with a priority does not use up its share of a second
// (sched_rt_runtime_us).
constexpr timespec kPause{.tv_sec = 0, .tv_nsec = 5'000'000};

/// Runs on a thread of its own, whose priority ends with it. False: no thread could be created.
template <class Work>
bool on_thread(int priority, int cpu, const Work& work) {
    try {
        std::thread([&] {
            // The system check already reports a refusal.
            static_cast<void>(stay_on_cpu(cpu));
            static_cast<void>(priority > 0 ? take_priority(priority) : std::string());
            work();
        }).join();
        return true;
    } catch (const std::system_error&) {
        return false;
    }
}

std::vector<Finding> look_at_system(const AdmissionRun& run) {
    std::vector<Finding> findings = check_system({.root = "",
                                                  .bus_cpu = run.bus_cpu,
                                                  .engine_cpu = run.engine_cpu,
                                                  .priority = run.bus_priority});
    std::string fault;
    const auto more = check_bus("", run.bus, request_can_link(run.bus, fault));
    findings.insert(findings.end(), more.begin(), more.end());
    return findings;
}

std::optional<WakeUpFigures> measure_wake_ups(const AdmissionRun& run, std::int64_t sample_us) {
    const auto count =
        static_cast<std::uint64_t>(run.seconds * 1e6 / static_cast<double>(sample_us));
    const auto lateness = std::make_unique<TimeHistogram>();
    const bool is_done = on_thread(run.bus_priority, run.bus_cpu,
                                   [&] { measure_lateness(sample_us, count, *lateness); });
    return is_done ? std::optional(WakeUpFigures{lateness->count(), lateness->at_share_ns(0.99),
                                                 lateness->most_ns()})
                   : std::nullopt;
}

/// One cycle behind cold caches.
void run_cycle(GuardChain& chain, ColdCaches& caches, CycleFigures& out) noexcept {
    caches.write_through();
    clock_nanosleep(CLOCK_MONOTONIC, 0, &kPause, nullptr);
    const std::int64_t start_ns = monotonic_ns();
    chain.evaluate();
    const CycleResult result = chain.decide(false, false);
    const double took_us = static_cast<double>(monotonic_ns() - start_ns) * 1e-3;
    ++out.count;
    out.longest_us = std::max(out.longest_us, took_us);
    if (result.reason == StopReason::none) {
        ++out.proven_count;
        out.proven_us = std::max(out.proven_us, took_us);
    }
    if (chain.stop_certificate() != nullptr) {
        out.queries_max = std::max(out.queries_max, chain.stop_certificate()->work().queries);
    }
}

/// Two snapshots a cycle, the fewest that lead to queries: they bound the speeds but not the
/// accelerations, so the boxes are large. Near contact the prover halves them until it has used
/// all queries or rounds of a cycle.
void run_cycles(const Machine& machine, GuardChain& chain, ColdCaches& caches,
                CycleFigures& out) noexcept {
    const double period_s = static_cast<double>(machine.can.sample_us) * 1e-6;
    for (std::uint32_t i = 0; i < 2 * kPositions; ++i) {
        ReceiverEvent event;
        event.kind = ReceiverEvent::Kind::snapshot;
        event.state = ReceiverState::invalid;  // nothing before it counts
        event.snapshot = sampled_position(machine, i / 2);
        event.snapshot.sample = 2 * std::uint64_t{i};
        event.snapshot.tool = machine.first_tool;
        chain.take(event);
        event.state = ReceiverState::valid;
        ++event.snapshot.sample;
        for (std::size_t axis = 0; i % 2 != 0 && axis < machine.axes.size(); ++axis) {
            event.snapshot.position[axis] += kFullSpeed * machine.axes[axis].speed_max * period_s;
        }
        chain.take(event);
        run_cycle(chain, caches, out);
    }
}

/// Replaces a look-ahead path by boxes, for this measurement has no path. The same queries and
/// rounds bound a cycle of either.
LoadedMachine without_path(const LoadedMachine& loaded) {
    LoadedMachine out = loaded;
    out.machine.guard.promise = StopPromise::independent;
    out.machine.can.look_ahead_samples = 0;
    return out;
}

/// Measures the longest cycle of the chosen plan, in the engine thread's place. False: it could not
/// be measured.
bool measure_plan(const LoadedMachine& loaded, const LiveEngines& engines, CycleFigures& out) {
    std::string fault;
    if (engines.chosen.gpu && engines.plan) {
        CycleDemand demand = cycle_demand(loaded.machine, true);
        demand.plan = engines.plan->plan;
        demand.host_stages = engines.chosen.host_stages;
        const std::optional<double> host_us = host_share_us(loaded, demand, fault);
        out.worst_case_us = std::max(engines.chosen.longest_us,
                                     engines.chosen.proof_launches_us + host_us.value_or(0));
        out.plan = engines.plan->plan;
        return host_us.has_value();
    }
    const std::optional<ChosenPlan> measured =
        engines.plan ? judge_plan(loaded, engines.plan->plan, fault) : std::nullopt;
    if (measured) {
        out.worst_case_us = measured->longest_us;
        out.plan = measured->plan;
    }
    return measured.has_value();
}

/// Uses a chain of its own: the guard must not start with proofs of this measurement.
void measure_engine(const AdmissionRun& run, const LoadedMachine& loaded, LiveEngines& engines,
                    AdmissionFigures& out) {
    const LoadedMachine measured = without_path(loaded);
    const Machine& machine = measured.machine;
    std::optional<StopCertificate> certificate =
        run.is_stoppable && engines.plan ? make_stop_certificate(measured, engines.plan->plan)
                                         : std::nullopt;
    if (run.is_stoppable && !certificate) {
        return;
    }
    const Engine engine = engines.engine();
    const auto chain =
        std::make_unique<GuardChain>(machine, engine, *engines.containment_test,
                                     ChainParts{certificate ? &*certificate : nullptr});
    CycleFigures cycles;
    cycles.engine = engines.chosen.gpu ? engines.chosen.gpu_name()
                                       : fmt::format("cpu, {} lanes", engines.cpu->lanes());
    ColdCaches caches;
    bool passes_known_answer = false, has_plan = true;
    const bool is_done = on_thread(run.engine_priority, run.engine_cpu, [&] {
        has_plan = !run.is_stoppable || measure_plan(loaded, engines, cycles);
        run_cycles(machine, *chain, caches, cycles);
        passes_known_answer = passes_self_test({machine, *chain});  // behind everything else
    });
    if (is_done && has_plan) {
        out.cycles = cycles;
        out.passes_known_answer = passes_known_answer;
    }
}

/// MemAvailable of /proc/meminfo in bytes. A service cannot read that file: it uses the free memory
/// of sysinfo() instead, which is less than what is available.
std::uint64_t available_bytes() {
    const std::string table = read_small_file("/proc/meminfo");
    constexpr std::string_view kName = "MemAvailable:";
    const std::size_t at = table.find(kName);
    if (at != std::string::npos) {
        return std::strtoull(table.c_str() + at + kName.size(), nullptr, 10) * 1024;
    }
    struct sysinfo info {};
    return sysinfo(&info) == 0 ? std::uint64_t{info.freeram} * info.mem_unit : 0;
}

std::optional<MemoryFigures> look_at_memory(const Machine& machine, const LiveEngines& engines) {
    MemoryFigures out;
    out.reserved_bytes =
        engines.cpu->memory().total_bytes() + std::uint64_t{engines.containment_test->size_bytes()};
    out.device_bytes = engines.chosen.gpu ? engines.chosen.gpu->memory().device_bytes() : 0;
    out.more_bytes = live_bytes(machine);
    out.available_bytes = available_bytes();
    const std::uint64_t pages =
        std::strtoull(read_small_file("/proc/self/statm").c_str(), nullptr, 10);
    out.mapped_bytes = pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
    rlimit limit{};
    if (pages == 0 || getrlimit(RLIMIT_MEMLOCK, &limit) != 0) {
        return std::nullopt;
    }
    out.lock_limit_bytes = limit.rlim_cur == RLIM_INFINITY || has_capability("", kCapIpcLock)
                               ? std::numeric_limits<std::uint64_t>::max()
                               : limit.rlim_cur;
    return out;
}

}  // namespace

AdmissionFigures measure_admission(const AdmissionRun& run, const LoadedMachine& loaded,
                                   LiveEngines& engines) {
    const Machine& machine = loaded.machine;
    AdmissionFigures out;
    out.times = time_limits(machine);
    out.system = look_at_system(run);
    out.wake_ups = measure_wake_ups(run, out.times.period_us);
    measure_engine(run, loaded, engines, out);
    out.memory = look_at_memory(machine, engines);
    return out;
}

}  // namespace axg
