// SPDX-License-Identifier: Apache-2.0
#include "cuda/bench/measure_worst_case.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <span>
#include <utility>

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

constexpr std::size_t kHogBytes = std::size_t{64} << 20U;  // larger than any cache of these devices
constexpr std::size_t kBusBytes = std::size_t{8} << 20U;
constexpr int kHogCopies = 24;  // at 5 TB/s more than a millisecond

/// The state of the caches and the load on the device during a batch.
enum class Condition : std::uint8_t { warm, cold, beside };
constexpr std::array kConditions = {Condition::warm, Condition::cold, Condition::beside};

const char* name_of(Condition condition) {
    constexpr const char* kNames[] = {"warm", "cold cache", "beside copies"};
    return kNames[static_cast<unsigned>(condition)];
}

/// Memory and a separate stream to clear the caches before a batch or to copy during it.
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
constexpr std::size_t kNoLayout = kWorstCaseLayouts.size();

/// A batch's queries as parts of boxes that need the most work for posing: with the most joints
/// possible. The parts of a root have at most two kinds of bodies: the first ones are within the
/// travel of pruned surfaces. No joint moves a body, so every pose is the one the batch needs.
struct PosedBatch {
    std::vector<QueryTree> trees;
    std::vector<TreeRoot> roots;
    std::vector<Query> queries;  // after the parts
    std::uint32_t depth = 1;

    PosedBatch() = default;
    /// @param roots_max, trees_max  of a call of the guard; more kinds of bodies need more roots
    PosedBatch(const WorstCaseBatch& batch, std::uint32_t roots_max, std::uint32_t trees_max) {
        std::vector<Query> sorted = batch.queries;
        std::stable_sort(sorted.begin(), sorted.end(),
                         [](const Query& a, const Query& b) { return a.mesh_a < b.mesh_a; });
        const std::size_t parts = sorted.size() - kKnownAnswers;
        while (depth < kTreeDepthOfParts && parts >> depth > roots_max &&
               fits(sorted, parts, depth + 1)) {
            ++depth;
        }
        const std::size_t each = std::size_t{1} << depth, count = parts >> depth;
        trees.assign(std::min<std::size_t>(trees_max, std::min<std::size_t>(count, kQueryTreesMax)),
                     tree_of(sorted.front(), depth));
        for (std::size_t i = 0; i < count; ++i) {
            roots.push_back(root_of({sorted.data() + i * each, each}));
            roots.back().tree = static_cast<std::uint16_t>(i * trees.size() / count);
        }
        queries.assign(sorted.begin() + static_cast<std::ptrdiff_t>(count * each), sorted.end());
    }

  private:
    static constexpr std::size_t kKnownAnswers = 2;
    static constexpr double kPartMm = 2;  // from one part to the next

    /// Whether no root has more than two kinds of bodies.
    static bool fits(const std::vector<Query>& sorted, std::size_t parts, std::uint32_t depth) {
        const std::size_t each = std::size_t{1} << depth;
        bool fit = true;
        for (std::size_t first = 0; first + each <= parts; first += each) {
            std::size_t kinds = 1;
            for (std::size_t i = first + 1; i < first + each; ++i) {
                kinds += sorted[i].mesh_a != sorted[i - 1].mesh_a ? 1 : 0;
            }
            fit = fit && kinds <= 2;
        }
        return fit;
    }
    /// All cuts are along the first joint, whose direction is zero; the others turn by 0 rad.
    static QueryTree tree_of(const Query& query, std::uint32_t depth) {
        QueryTree tree;
        tree.is_float_only = true;
        tree.may_be_pruned = true;
        tree.joints = kTreeJointsMax;
        tree.split = kTreeJointsMax - 1;  // one thread poses nearly all joints
        tree.r_mm = query.r_mm;
        for (PathJoint& joint : tree.joint) {
            joint.is_linear = false;
        }
        tree.joint[0] = {{0, 0, 0}, {}, 1, true};
        tree.cut[0] = {0, -1e5, 0, (1U << depth) - 1};
        for (TreeCut& cut : std::span(tree.cut).subspan(1)) {
            cut = {0, -1, 1};
        }
        for (std::uint32_t level = 0; level < depth; ++level) {
            tree.quarter[level] = 0.5 * kPartMm * static_cast<double>(1U << (depth - 1 - level));
        }
        return tree;
    }
    /// Places the root so that the parts before the change of kind are below 0.
    static TreeRoot root_of(std::span<const Query> parts) {
        const auto changes = [&parts](const Query& q) { return q.mesh_a != parts[0].mesh_a; };
        const auto first = std::find_if(parts.begin(), parts.end(), changes) - parts.begin();
        const Query& other = parts.back();
        TreeRoot root;
        root.pruned_a = parts[0].mesh_a;
        root.pruned_b = parts[0].mesh_b;
        root.mesh_a = other.mesh_a;
        root.mesh_b = other.mesh_b;
        // Part p is centred at centre + kPartMm (p + 1/2 - n/2).
        const double middle = 0.5 * static_cast<double>(parts.size());
        root.centre[0] = kPartMm * (middle - static_cast<double>(first));
        return root;
    }
};

/// A call in one layout, ready to be run.
struct Filled {
    WorstCaseBatch batch;
    PosedBatch posed;                     // empty if the host poses
    std::vector<GroupWork> groups, work;  // before the call, and after it
    std::vector<QueryResult> results;
};

/// Calls of a cycle, in their order.
using FilledCycle = std::vector<Filled*>;

/// One group of all queries of a stage, else none. In an exact layout only the size of the batch
/// bounds its lists.
std::vector<GroupWork> groups_of(const WorstCaseCall& call, WorstCaseLayout layout) {
    const BatchCapacities& batch = call.capacities.batch;
    const WorkLists lists{batch.level_pairs, batch.leaf_pairs, batch.box_rows, batch.triangle_pairs,
                          batch.rechecks};
    const bool is_exact = layout != WorstCaseLayout::overflowing;
    const WorkLists share = is_exact ? WorkLists{kAmple, kAmple, kAmple, kAmple, kAmple} : lists;
    return std::vector<GroupWork>(call.is_stage ? 1 : 0, {.share = share});
}

/// Appends the bodies of `more` to those of an engine.
void append(TreeBodies& bodies, WorstCaseBatch& more) {
    const auto first = static_cast<std::uint32_t>(bodies.trees.size());
    for (Query& query : more.queries) {
        query.mesh_a += first;
        query.mesh_b += first;
    }
    bodies.tree_levels = std::max(bodies.tree_levels, more.bodies.tree_levels);
    for (std::size_t i = 0; i < more.bodies.trees.size(); ++i) {
        bodies.trees.push_back(std::move(more.bodies.trees[i]));
        bodies.reach_mm.push_back(more.bodies.reach_mm[i]);
    }
}

/// The lists of an engine: each has the longest length of all calls.
Capacities longest_of(const WorstCaseCycle& cycle) {
    Capacities out = cycle.calls.front().capacities;
    for (const WorstCaseCall& call : cycle.calls) {
        const BatchCapacities& batch = call.capacities.batch;
        const auto take = [](std::uint32_t& to, std::uint32_t from) { to = std::max(to, from); };
        take(out.batch.level_pairs, batch.level_pairs);
        take(out.batch.leaf_pairs, batch.leaf_pairs);
        take(out.batch.box_rows, batch.box_rows);
        take(out.batch.triangle_pairs, batch.triangle_pairs);
        take(out.batch.rechecks, batch.rechecks);
    }
    return out;
}

/// Every call of the cycle in every layout, over the bodies of one engine.
class Fillings {
  public:
    /// Returns an empty text, or why these capacities cannot be filled.
    std::string make(const WorstCaseCycle& cycle, std::uint32_t queries_max) {
        for (const WorstCaseLayout layout : kWorstCaseLayouts) {
            for (const WorstCaseCall& call : cycle.calls) {
                Filled& filled = *filled_.emplace_back(std::make_unique<Filled>());
                const std::uint32_t queries = std::min(call.queries, queries_max);
                if (std::string fault = make_worst_case_batch(
                        call.capacities, queries, cycle.tree_levels, layout, filled.batch);
                    !fault.empty()) {
                    return fault;
                }
                append(bodies, filled.batch);
                if (call.roots_max != 0) {
                    filled.posed = PosedBatch(filled.batch, call.roots_max, call.trees_max);
                }
                filled.groups = groups_of(call, layout);
                filled.work = filled.groups;
                filled.results.resize(queries);
            }
        }
        return {};
    }
    [[nodiscard]] Filled& at(std::size_t layout, std::size_t call) const {
        const std::size_t calls = filled_.size() / kWorstCaseLayouts.size();
        return *filled_[layout * calls + call];
    }
    /// Gives every query a list: listing the touching pairs is work too.
    void list_touching(std::span<TriangleIds> list) {
        for (const std::unique_ptr<Filled>& filled : filled_) {
            for (Query& query : filled->batch.queries) {
                query.list = list;
            }
        }
    }

    TreeBodies bodies;

  private:
    std::vector<std::unique_ptr<Filled>> filled_;
};

void run(CudaEngine& engine, Filled& filled) {
    std::copy(filled.groups.begin(), filled.groups.end(), filled.work.begin());
    const PosedBatch& posed = filled.posed;
    if (posed.roots.empty()) {
        engine.run(filled.batch.queries, filled.results, filled.work);
    } else {
        engine.run({posed.trees, posed.roots, posed.depth}, posed.queries, filled.results,
                   filled.work);
    }
}

/// Checks the work of a batch: an exact layout fills every list; an overflowing one leaves every
/// query unproven. Returns the fault, or an empty text.
std::string wrong_work(CudaEngine& engine, Filled& filled, WorstCaseLayout layout) {
    run(engine, filled);
    if (engine.fault() != nullptr) {
        return engine.fault();
    }
    std::string fault;
    const BatchWork work = last_work(engine.parts(), fault);
    const bool is_exact = layout != WorstCaseLayout::overflowing;
    if (fault.empty() && is_exact && work != filled.batch.work) {
        fault = "the longest batch did other work than it was made for: a bug";
    }
    for (const QueryResult& result : filled.results) {
        const bool is_right =
            is_exact ? result.status == QueryStatus::ok : is_overflow(result.status);
        if (fault.empty() && !is_right) {
            fault = "the longest batch got an answer it should not get: a bug";
        }
    }
    return fault;
}

/// Measures cycles under one condition. Adds their times to `line`, and the time of each call to
/// `spent_us`. Returns the fault, or an empty text.
std::string measure_line(CudaEngine& engine, const WorstCaseCycle& cycle, const FilledCycle& filled,
                         Condition condition, Hog& hog, std::vector<double>& spent_us,
                         WorstCaseMeasurement::Line& line) {
    const std::uint32_t count = std::max(1U, cycle.count / 3);
    line.cycle_us.reserve(count);
    for (std::uint32_t i = 0; i < count && engine.fault() == nullptr; ++i) {
        if (!hog.prepare(condition, static_cast<int>(i))) {
            return "the GPU has no room for what the longest batch is measured beside";
        }
        const Clock::time_point start = Clock::now();
        Clock::time_point from = start;
        for (std::size_t call = 0; call < filled.size(); ++call) {
            for (std::uint32_t times = 0; times < cycle.calls[call].times; ++times) {
                run(engine, *filled[call]);
            }
            const Clock::time_point now = Clock::now();
            spent_us[call] += std::chrono::duration<double, std::micro>(now - from).count();
            from = now;
        }
        line.cycle_us.push_back(std::chrono::duration<double, std::micro>(from - start).count());
        if (!hog.wait()) {
            return "the GPU failed while the longest batch was measured";
        }
    }
    return engine.fault() == nullptr ? std::string() : engine.fault();
}

/// Measures under each condition. Stores the total time of each call in `spent_us`.
std::string measure_conditions(CudaEngine& engine, const FilledCycle& filled, const char* layout,
                               Hog& hog, std::vector<double>& spent_us, WorstCaseMeasurement& out) {
    std::string fault;
    spent_us.assign(filled.size(), 0);
    for (const Condition condition : kConditions) {
        WorstCaseMeasurement::Line line{layout, name_of(condition), {}};
        if (fault.empty()) {
            fault = measure_line(engine, out.cycle, filled, condition, hog, spent_us, line);
        }
        for (const double us : line.cycle_us) {
            out.us_max = std::max(out.us_max, us);
        }
        out.lines.push_back(std::move(line));
    }
    return fault;
}

/// Measures all calls in each layout in turn. If the slowest layout is not the same for all calls,
/// measures a cycle with each call in its slowest layout too.
std::string measure_layouts(CudaEngine& engine, const Fillings& fillings, Hog& hog,
                            WorstCaseMeasurement& out) {
    const std::size_t calls = out.cycle.calls.size();
    std::vector<double> spent_us(calls), longest_us(calls, -1);
    std::vector<std::size_t> slowest(calls, kNoLayout);
    FilledCycle filled(calls);
    for (std::size_t layout = 0; layout < kWorstCaseLayouts.size(); ++layout) {
        for (std::size_t call = 0; call < calls; ++call) {
            filled[call] = &fillings.at(layout, call);
            if (std::string fault = wrong_work(engine, *filled[call], kWorstCaseLayouts[layout]);
                !fault.empty()) {
                return fault;
            }
        }
        if (std::string fault = measure_conditions(
                engine, filled, name_of(kWorstCaseLayouts[layout]), hog, spent_us, out);
            !fault.empty()) {
            return fault;
        }
        for (std::size_t call = 0; call < calls; ++call) {
            if (spent_us[call] > longest_us[call]) {
                longest_us[call] = spent_us[call];
                slowest[call] = layout;
            }
        }
    }
    if (std::all_of(slowest.begin(), slowest.end(),
                    [&slowest](std::size_t layout) { return layout == slowest.front(); })) {
        return {};
    }
    for (std::size_t call = 0; call < calls; ++call) {
        filled[call] = &fillings.at(slowest[call], call);
    }
    return measure_conditions(engine, filled, "slowest", hog, spent_us, out);
}

}  // namespace

std::optional<WorstCaseMeasurement> measure_worst_case(const CudaOptions& options,
                                                       const WorstCaseCycle& cycle,
                                                       std::string& fault) {
    WorstCaseMeasurement out;
    out.cycle = cycle;
    Fillings fillings;
    fault = fillings.make(cycle, std::clamp(options.queries_max, 1U, kBatchQueriesMax));
    if (!fault.empty()) {
        return std::nullopt;
    }
    std::optional<CudaEngine> engine =
        CudaEngine::Parts::engine_over(fillings.bodies, longest_of(cycle), options, fault);
    if (!engine) {
        return std::nullopt;
    }
    out.device = engine->device();
    std::vector<TriangleIds> list(engine->parts().buffers.limits.listed);
    fillings.list_touching(list);
    Hog hog;
    fault = measure_layouts(*engine, fillings, hog, out);
    return fault.empty() ? std::optional(std::move(out)) : std::nullopt;
}

}  // namespace axg
