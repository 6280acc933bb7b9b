// SPDX-License-Identifier: Apache-2.0
#include "cuda/bench/measure_worst_case.hpp"

#include <algorithm>
#include <chrono>

#include "core/worst_case/worst_case_batch.hpp"
#include "cuda/bench/batch_work.hpp"
#include "cuda/engine/engine_parts.hpp"

namespace axg {

BatchWork cuda::last_work(const CudaEngine::Parts& parts, std::string& fault) {
    BatchWork work;
    Counters counters;
    std::vector<Tally> tallies(parts.buffers.limits.queries);
    if (cudaStreamSynchronize(parts.partition.stream) != cudaSuccess ||
        cudaMemcpy(&counters, parts.buffers.counters, sizeof counters, cudaMemcpyDeviceToHost) !=
            cudaSuccess ||
        cudaMemcpy(tallies.data(), parts.buffers.tallies, tallies.size() * sizeof(Tally),
                   cudaMemcpyDeviceToHost) != cudaSuccess) {
        fault = "the GPU does not hand out its counters";
        return work;
    }
    std::copy(std::begin(counters.handled), std::end(counters.handled), work.level_pairs.begin());
    work.leaf_pairs = counters.leaf_handled;
    work.box_rows = counters.box_rows;
    work.triangle_pairs = counters.triangle_pairs;
    for (std::uint32_t i = 0; i < std::min(counters.count, parts.buffers.limits.queries); ++i) {
        work.rechecks += tallies[i].recheck_done;
    }
    return work;
}

namespace {

using namespace cuda;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kHogBytes = std::size_t{64} << 20U;  // beyond any cache of these devices
constexpr std::size_t kBusBytes = std::size_t{8} << 20U;
constexpr int kHogCopies = 24;  // at 5 TB/s more than a millisecond

/// What stands beside a batch.
enum class Condition : std::uint8_t { warm, cold, beside };
constexpr std::array kConditions = {Condition::warm, Condition::cold, Condition::beside};

const char* name_of(Condition condition) {
    constexpr const char* kNames[] = {"warm", "cold cache", "beside copies"};
    return kNames[static_cast<unsigned>(condition)];
}

/// Memory and a stream of its own for what stands beside a batch.
class Hog {
  public:
    Hog() {
        is_ready_ = cudaMalloc(&device_, 2 * kHogBytes) == cudaSuccess &&
                    cudaHostAlloc(&pinned_, kBusBytes, 0) == cudaSuccess &&
                    cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking) == cudaSuccess;
    }
    Hog(const Hog&) = delete;
    Hog& operator=(const Hog&) = delete;
    ~Hog() {
        static_cast<void>(cudaFree(device_));
        static_cast<void>(cudaFreeHost(pinned_));
        if (stream_ != nullptr) {
            static_cast<void>(cudaStreamDestroy(stream_));
        }
    }
    [[nodiscard]] bool prepare(Condition condition, int cycle) {
        auto* const second = static_cast<std::byte*>(device_) + kHogBytes;
        if (!is_ready_) {
            return false;
        }
        if (condition == Condition::cold) {
            return cudaMemsetAsync(device_, cycle, 2 * kHogBytes, stream_) == cudaSuccess && wait();
        }
        bool is_good = true;
        for (int i = 0; condition == Condition::beside && is_good && i < kHogCopies; ++i) {
            is_good = cudaMemcpyAsync(device_, second, kHogBytes, cudaMemcpyDeviceToDevice,
                                      stream_) == cudaSuccess;
            if (i % 8 == 0) {
                is_good =
                    is_good && cudaMemcpyAsync(device_, pinned_, kBusBytes, cudaMemcpyHostToDevice,
                                               stream_) == cudaSuccess;
            }
        }
        return is_good;
    }
    [[nodiscard]] bool wait() { return cudaStreamSynchronize(stream_) == cudaSuccess; }

  private:
    void *device_ = nullptr, *pinned_ = nullptr;
    cudaStream_t stream_ = nullptr;
    bool is_ready_ = false;
};

/// The batch did what it was made for: an exact layout fills every list, an overflowing one leaves
/// every query unproven.
std::string wrong_work(CudaEngine& engine, const WorstCaseBatch& worst_case, WorstCaseLayout layout,
                       const std::vector<QueryResult>& results) {
    std::string fault;
    const BatchWork work = last_work(engine.parts(), fault);
    const bool is_exact = layout != WorstCaseLayout::overflowing;
    if (fault.empty() && is_exact && work != worst_case.work) {
        fault = "the longest batch did other work than it was made for: a bug";
    }
    for (const QueryResult& result : results) {
        const bool is_right = is_exact ? result.status == QueryStatus::ok
                                       : result.status == QueryStatus::too_many_node_pairs;
        if (fault.empty() && !is_right) {
            fault = "the longest batch got an answer it should not get: a bug";
        }
    }
    return fault;
}

/// A cycle's launches: how many of the batch's queries each of them runs.
using Launches = std::vector<std::size_t>;

/// Empty, or why this condition could not be measured.
std::string measure_line(CudaEngine& engine, const WorstCaseBatch& worst_case,
                         const Launches& launches, Condition condition, Hog& hog,
                         std::uint32_t count, WorstCaseMeasurement::Line& line) {
    std::vector<QueryResult> results(worst_case.queries.size());
    line.cycle_us.reserve(count);
    for (std::uint32_t i = 0; i < count && engine.fault() == nullptr; ++i) {
        if (!hog.prepare(condition, static_cast<int>(i))) {
            return "the GPU has no room for what the longest batch is measured beside";
        }
        const Clock::time_point start = Clock::now();
        engine.begin_cycle();
        for (const std::size_t query_count : launches) {
            engine.run({worst_case.queries.data(), query_count}, {results.data(), query_count});
        }
        const std::chrono::duration<double, std::micro> spent = Clock::now() - start;
        line.cycle_us.push_back(spent.count());
        if (!hog.wait()) {
            return "the GPU failed while the longest batch was measured";
        }
    }
    return engine.fault() == nullptr ? std::string() : engine.fault();
}

/// One way to deal a cycle's queries and lists out to its launches.
struct Split {
    const char* name;
    Capacities cycle;       // of the engine
    Capacities launch;      // what the batch fills: those, or a launch's part of them
    std::uint32_t queries;  // of the batch
    Launches launches;
};

std::string measure_split(const Split& split, const CudaOptions& options, WorstCaseLayout layout,
                          std::optional<Hog>& hog, WorstCaseMeasurement& out) {
    WorstCaseBatch worst_case;
    std::string fault = make_worst_case_batch(split.launch, split.queries, out.cycle.tree_levels,
                                              layout, worst_case);
    if (!fault.empty()) {
        return fault;
    }
    std::optional<CudaEngine> engine =
        CudaEngine::Parts::engine_over(worst_case.bodies, split.cycle, options, fault);
    if (!engine) {
        return fault;
    }
    if (!hog) {
        hog.emplace();
    }
    out.device = engine->device();
    std::vector<TriangleIds> list(engine->parts().buffers.limits.listed);
    for (Query& query : worst_case.queries) {
        query.list = list;  // naming what touches is work too
    }
    std::vector<QueryResult> results(worst_case.queries.size());
    engine->run(worst_case.queries, results);
    fault = engine->fault() == nullptr ? wrong_work(*engine, worst_case, layout, results) : "";
    for (const Condition condition : kConditions) {
        WorstCaseMeasurement::Line line{name_of(layout), name_of(condition), split.name, {}};
        if (fault.empty()) {
            fault = measure_line(*engine, worst_case, split.launches, condition, *hog,
                                 std::max(1U, out.cycle.count / 3), line);
        }
        for (const double us : line.cycle_us) {
            out.us_max = std::max(out.us_max, us);
        }
        out.lines.push_back(std::move(line));
    }
    return fault;
}

/// Everything in the first launch; what queries are left then, in the others.
Split at_once(const Capacities& capacities, const WorstCaseCycle& cycle, std::uint32_t room) {
    const std::uint32_t first = std::min(cycle.queries, room);
    Split split{"at once", capacities, capacities, first, {first}};
    const std::uint32_t others = cycle.launches - 1;
    if (others != 0) {
        const std::uint32_t each = (cycle.queries - first + others - 1) / others;
        split.launches.resize(cycle.launches, std::clamp(each, 1U, first));
    }
    return split;
}

/// The same part of everything in each launch.
Split dealt_out(const Capacities& capacities, const WorstCaseCycle& cycle, std::uint32_t room) {
    const auto part = [&cycle](std::uint32_t all) { return std::max(1U, all / cycle.launches); };
    const std::uint32_t each = (cycle.queries + cycle.launches - 1) / cycle.launches;
    Split split{"dealt out", capacities, capacities, std::min(each, room), {}};
    BatchCapacities& batch = split.launch.batch;
    batch = {part(batch.level_pairs), part(batch.leaf_pairs), part(batch.box_rows),
             part(batch.triangle_pairs), part(batch.rechecks)};
    split.launches.assign(cycle.launches, split.queries);
    return split;
}

}  // namespace

std::optional<WorstCaseMeasurement> measure_worst_case(const Capacities& capacities,
                                                       const CudaOptions& options,
                                                       const WorstCaseCycle& cycle,
                                                       std::string& fault) {
    WorstCaseMeasurement out;
    out.cycle = cycle;
    const std::uint32_t room = std::clamp(options.queries_max, 1U, kBatchQueriesMax);
    std::vector<Split> splits{at_once(capacities, cycle, room)};
    if (cycle.launches > 1) {
        splits.push_back(dealt_out(capacities, cycle, room));
    }
    std::optional<Hog> hog;
    for (const WorstCaseLayout layout : kWorstCaseLayouts) {
        for (const Split& split : splits) {
            fault = measure_split(split, options, layout, hog, out);
            if (!fault.empty()) {
                return std::nullopt;
            }
        }
    }
    return out;
}

}  // namespace axg
