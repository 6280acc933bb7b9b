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

constexpr std::uint32_t kAmple = 1U << 30U;

/// One group of them all, or none. Of an exact layout the batch's own size is the end of its lists.
std::vector<GroupWork> groups_of(const Capacities& capacities, const WorstCaseCycle& cycle,
                                 WorstCaseLayout layout) {
    const BatchCapacities& batch = capacities.batch;
    const WorkLists lists{batch.level_pairs, batch.leaf_pairs, batch.box_rows, batch.triangle_pairs,
                          batch.rechecks};
    const bool is_exact = layout != WorstCaseLayout::overflowing;
    const WorkLists share = is_exact ? WorkLists{kAmple, kAmple, kAmple, kAmple, kAmple} : lists;
    return std::vector<GroupWork>(cycle.is_stage ? 1 : 0, {.share = share});
}

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
        const bool is_right =
            is_exact ? result.status == QueryStatus::ok : is_overflow(result.status);
        if (fault.empty() && !is_right) {
            fault = "the longest batch got an answer it should not get: a bug";
        }
    }
    return fault;
}

/// Empty, or why this condition could not be measured.
std::string measure_line(CudaEngine& engine, const WorstCaseBatch& worst_case,
                         const std::vector<GroupWork>& groups, std::uint32_t launches,
                         Condition condition, Hog& hog, std::uint32_t count,
                         WorstCaseMeasurement::Line& line) {
    std::vector<GroupWork> work = groups;
    std::vector<QueryResult> results(worst_case.queries.size());
    line.cycle_us.reserve(count);
    for (std::uint32_t i = 0; i < count && engine.fault() == nullptr; ++i) {
        if (!hog.prepare(condition, static_cast<int>(i))) {
            return "the GPU has no room for what the longest batch is measured beside";
        }
        const Clock::time_point start = Clock::now();
        for (std::uint32_t launch = 0; launch < launches; ++launch) {
            std::copy(groups.begin(), groups.end(), work.begin());
            engine.run(worst_case.queries, results, work);
        }
        const std::chrono::duration<double, std::micro> spent = Clock::now() - start;
        line.cycle_us.push_back(spent.count());
        if (!hog.wait()) {
            return "the GPU failed while the longest batch was measured";
        }
    }
    return engine.fault() == nullptr ? std::string() : engine.fault();
}

std::string measure_layout(const Capacities& capacities, const CudaOptions& options,
                           WorstCaseLayout layout, std::optional<Hog>& hog,
                           WorstCaseMeasurement& out) {
    WorstCaseBatch worst_case;
    const std::uint32_t queries =
        std::min(out.cycle.queries, std::clamp(options.queries_max, 1U, kBatchQueriesMax));
    std::string fault =
        make_worst_case_batch(capacities, queries, out.cycle.tree_levels, layout, worst_case);
    if (!fault.empty()) {
        return fault;
    }
    std::optional<CudaEngine> engine =
        CudaEngine::Parts::engine_over(worst_case.bodies, capacities, options, fault);
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
    const std::vector<GroupWork> groups = groups_of(capacities, out.cycle, layout);
    std::vector<GroupWork> work = groups;
    engine->run(worst_case.queries, results, work);
    fault = engine->fault() == nullptr ? wrong_work(*engine, worst_case, layout, results) : "";
    for (const Condition condition : kConditions) {
        WorstCaseMeasurement::Line line{name_of(layout), name_of(condition), {}};
        if (fault.empty()) {
            fault = measure_line(*engine, worst_case, groups, out.cycle.launches, condition, *hog,
                                 std::max(1U, out.cycle.count / 3), line);
        }
        for (const double us : line.cycle_us) {
            out.us_max = std::max(out.us_max, us);
        }
        out.lines.push_back(std::move(line));
    }
    return fault;
}

}  // namespace

std::optional<WorstCaseMeasurement> measure_worst_case(const Capacities& capacities,
                                                       const CudaOptions& options,
                                                       const WorstCaseCycle& cycle,
                                                       std::string& fault) {
    WorstCaseMeasurement out;
    out.cycle = cycle;
    std::optional<Hog> hog;
    for (const WorstCaseLayout layout : kWorstCaseLayouts) {
        fault = measure_layout(capacities, options, layout, hog, out);
        if (!fault.empty()) {
            return std::nullopt;
        }
    }
    return out;
}

}  // namespace axg
