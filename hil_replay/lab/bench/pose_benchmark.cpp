// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/bench/pose_benchmark.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>

#include "core/certificate/stop_certificate.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/setup/guard_parts.hpp"
#include "firmware_if/setup/loaded_machine.hpp"
#include "firmware_if/setup/travel_sample.hpp"
#include "hil_replay/lab/bench/bench_json.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kPose = 5;  // index of the sampled position

/// Returns at once without a proof, so that the prover cuts boxes until the budget is spent.
struct IdleEngine {
    std::uint64_t queries = 0, batches = 0;

    static void run(void* self, std::span<const Query> queries,
                    std::span<QueryResult> results) noexcept {
        auto& idle = *static_cast<IdleEngine*>(self);
        idle.queries += queries.size();
        ++idle.batches;
        std::fill(results.begin(), results.end(), QueryResult{.status = QueryStatus::ok});
    }
};

PoseMeasurement measure(const Machine& machine, StopCertificate& certificate,
                        const ContainmentTest& containment_test, std::uint32_t passes) {
    PoseMeasurement out;
    AxisSnapshot snapshot = sampled_position(machine, kPose);
    snapshot.tool = machine.first_tool;
    for (std::uint32_t i = 0; i < kSamplesKept; ++i) {
        ++snapshot.sample;
        certificate.note(snapshot, i == 0);
    }
    out.tasks = stop_tasks(machine);
    out.us = std::numeric_limits<double>::infinity();
    for (std::uint32_t pass = 0; pass < passes; ++pass) {
        IdleEngine idle;
        const auto begin = std::chrono::steady_clock::now();
        certificate.prove({&idle, IdleEngine::run}, containment_test);
        const std::chrono::duration<double, std::micro> taken =
            std::chrono::steady_clock::now() - begin;
        out.us = std::min(out.us, taken.count());
        out.queries = idle.queries;
        out.batches = idle.batches;
    }
    return out;
}

}  // namespace

int run_pose_benchmark(const PoseBenchmarkOptions& options) {
    LoadedMachine loaded;
    if (!load(options.machine, "", loaded, stderr)) {
        return kExitInput;
    }
    GuardParts parts(loaded, true, false);
    if (!parts.fault().empty()) {
        fmt::print(stderr, "axguard-lab bench: {}\n", parts.fault());
        return kExitInternal;
    }
    const PoseMeasurement m = measure(loaded.machine, *parts.cycle.stop_certificate(),
                                      *parts.containment_test, options.passes);
    const double each_us = m.us / static_cast<double>(std::max<std::uint64_t>(m.queries, 1));
    fmt::print(options.json.words(),
               "{} pairs with each tool, {} queries in {} batches: posed in {:.1f} us, {:.3f} us "
               "each (minimum of {} passes)\n",
               m.tasks, m.queries, m.batches, m.us, each_us, options.passes);
    return write_json(options.json, describe_poses(m, options.passes)) ? kExitClean : kExitInternal;
}

}  // namespace axg
