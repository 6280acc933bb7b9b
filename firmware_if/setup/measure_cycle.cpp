// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/setup/measure_cycle.hpp"

#include <time.h>

#include <algorithm>
#include <memory>
#include <span>
#include <string_view>
#include <utility>

#include "core/certificate/pair_queries.hpp"
#include "core/certificate/stop_certificate.hpp"
#include "core/collision/containment.hpp"
#include "core/guard/monitor.hpp"
#include "cuda/engine/cuda_engine.hpp"
#include "firmware_if/setup/cold_caches.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "firmware_if/setup/travel_sample.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kPositions = 64;
constexpr std::uint32_t kBatchMax = CudaOptions{}.queries_max;
constexpr double kFullSpeed = 0.9;  // of what an axis may do: rounding makes no faster one

double us_of(clockid_t clock) noexcept {
    timespec now{};
    clock_gettime(clock, &now);
    return static_cast<double>(now.tv_sec) * 1e6 + static_cast<double>(now.tv_nsec) * 1e-3;
}

/// Calls of stages from this one on, of engines that prefer batches: at most.
std::uint32_t calls_from(const CyclePlan& plan, std::uint32_t stage) {
    const bool has_rounds = plan.stages > 1 && stage < 2 && asks_again(1, plan);
    return plan.stages - stage + (has_rounds ? kRoundsMax : 0);
}

/// Replies at once: every pair is far, or none.
Engine idle_engine(bool& is_far) noexcept {
    const auto run = [](void* self, std::span<const Query>,
                        std::span<QueryResult> results) noexcept {
        const Proof proof = *static_cast<bool*>(self) ? Proof::far : Proof::not_proven;
        std::fill(results.begin(), results.end(),
                  QueryResult{.status = QueryStatus::ok, .proof = proof});
    };
    return {.self = &is_far, .run = run};
}

/// An engine on a GPU that replies at once. Its first call leaves `open` pairs open; from call
/// `far_from` on all queries are far, so that the cycle casts the rays that proven pairs need.
struct IdleGpu {
    std::uint32_t tasks = 0, open = 0, far_from = 0;  // far_from: calls before it
    std::uint32_t calls = 0;

    void answer(std::span<QueryResult> results) noexcept {
        const std::size_t count = results.size() - std::min<std::size_t>(results.size(), 2);
        for (std::size_t i = 0; i < results.size(); ++i) {
            const bool is_left = calls == 0 && i % std::max(tasks, 1U) >= open;
            const bool is_far = i < count ? calls >= far_from || is_left : i == count;
            results[i] = {.status = QueryStatus::ok,
                          .proof = is_far ? Proof::far : Proof::not_proven};
        }
        ++calls;
    }
    [[nodiscard]] Engine engine(bool poses_parts) noexcept {
        const auto run = [](void* self, std::span<const Query>,
                            std::span<QueryResult> results) noexcept {
            static_cast<IdleGpu*>(self)->answer(results);
        };
        Engine out{.self = this, .run = run, .prefers_batches = true};
        out.run_groups = [](void* self, std::span<const Query>, std::span<QueryResult> results,
                            std::span<GroupWork>) noexcept {
            static_cast<IdleGpu*>(self)->answer(results);
        };
        if (poses_parts) {
            out.parts_max = kBatchMax;
            out.run_parts = [](void* self, const PartQueries&, std::span<const Query>,
                               std::span<QueryResult> results, std::span<GroupWork>) noexcept {
                static_cast<IdleGpu*>(self)->answer(results);
            };
        }
        return out;
    }
};

/// A machine whose boxes stay open in every stage at full speed: it has no travel proofs, no
/// look-ahead path, and independent stops.
LoadedMachine endless(const LoadedMachine& loaded) {
    LoadedMachine out = loaded;
    out.machine.travel.proofs.clear();
    out.machine.guard.promise = StopPromise::independent;
    out.machine.can.look_ahead_samples = 0;
    return out;
}

/// The chain of a guard, from a snapshot to its decision.
class Chain {
  public:
    Chain(const Machine& machine, StopCertificate& certificate, const ContainmentTest& test)
        : machine_(machine), certificate_(certificate), test_(test) {}

    /// Two snapshots, the fewest that allow a proof: they give the widest boxes.
    void look_at(std::uint32_t position) noexcept {
        before_ = sampled_position(machine_, position);
        before_.tool = machine_.first_tool;
        before_.mode = machine_.tools.size() > 1 ? kModeToolChange : before_.mode;  // any of them
        now_ = before_;
        now_.sample = before_.sample + 1;
        const double period_s = static_cast<double>(machine_.can.sample_us) * 1e-6;
        for (std::size_t axis = 0; axis < machine_.axes.size(); ++axis) {
            const Axis& of = machine_.axes[axis];
            const double step = kFullSpeed * of.speed_max * period_s;
            const bool fits = of.unlimited || now_.position[axis] + step <= of.max;
            now_.position[axis] += fits ? step : -step;
        }
    }
    CycleTime run(const Engine& engine) noexcept {
        certificate_.note(before_, true);
        const double wall_us = us_of(CLOCK_MONOTONIC), cpu_us = us_of(CLOCK_THREAD_CPUTIME_ID);
        certificate_.note(now_, false);
        certificate_.prove(engine, test_);
        certificate_.keep();
        decision_ = judge(certificate_.cycle(), true, false);
        const double cpu_end_us = us_of(CLOCK_THREAD_CPUTIME_ID);
        return {us_of(CLOCK_MONOTONIC) - wall_us, cpu_end_us - cpu_us};
    }
    /// Makes the next cycle the first at its position: it tests every pair for containment.
    void forget() noexcept {
        bool is_far = false;
        static_cast<void>(run(idle_engine(is_far)));
    }
    /// Corners, nodes and triangles of all rays.
    [[nodiscard]] std::uint64_t ray_work() const noexcept {
        std::uint64_t sum = 0;
        for (const PairProof& proof : certificate_.cycle().proofs) {
            const ContainmentResult& rays = proof.containment_result;
            sum += std::uint64_t{rays.rays} + rays.nodes + rays.triangles;
        }
        return sum;
    }
    [[nodiscard]] std::uint32_t tasks() const noexcept {
        return static_cast<std::uint32_t>(certificate_.tasks().size());
    }

  private:
    const Machine& machine_;
    StopCertificate& certificate_;
    const ContainmentTest& test_;
    AxisSnapshot before_, now_;
    CycleResult decision_;
};

/// Moves the chain to the sampled position at which rays cost most.
void look_at_most_rays(Chain& chain) {
    std::uint64_t most = 0;
    std::uint32_t at = 0;
    for (std::uint32_t position = 0; position < kPositions; ++position) {
        chain.look_at(position);
        chain.forget();
        bool is_far = true;
        static_cast<void>(chain.run(idle_engine(is_far)));
        if (chain.ray_work() > most) {
            most = chain.ray_work();
            at = position;
        }
    }
    chain.look_at(at);
    chain.forget();
}

/// A machine whose boxes never end, and the chain of its guard where rays cost most. Not moved: the
/// parts refer to one another.
struct MeasuredMachine {
    LoadedMachine loaded;
    std::optional<CpuEngine> engine;
    std::optional<ContainmentTest> test;
    std::optional<StopCertificate> certificate;
    std::optional<Chain> chain;  // empty: the reason is in fault()

    MeasuredMachine(const LoadedMachine& from, const CyclePlan& plan)
        : loaded(endless(from)),
          engine(make_engine(loaded)),
          test(engine ? make_containment_test(loaded, *engine) : std::nullopt),
          certificate(make_stop_certificate(loaded, plan)) {
        if (test && certificate) {
            chain.emplace(loaded.machine, *certificate, *test);
            look_at_most_rays(*chain);
        }
    }
    MeasuredMachine(const MeasuredMachine&) = delete;
    MeasuredMachine& operator=(const MeasuredMachine&) = delete;

    [[nodiscard]] std::string_view fault() const noexcept {
        return !engine ? kNoLaneSet : !test ? kNoMemoryForContainment : kNoMemoryForProofs;
    }
};

CycleTime least_of(const CycleTime& a, const CycleTime& b) noexcept {
    return {std::min(a.wall_us, b.wall_us), std::min(a.cpu_us, b.cpu_us)};
}

/// Brings the caches into the state that the condition names.
void prepare(CacheCondition condition, ColdCaches& caches,
             std::span<const std::byte> trees) noexcept {
    if (condition == CacheCondition::warm) {
        return;
    }
    caches.write_through();
    ColdCaches::flush(trees);
    if (condition != CacheCondition::cold) {
        ColdCaches::flush_code();
    }
}

/// Measures repeats of a cycle, each from the cache state of the condition.
class Repeats {
  public:
    Repeats(Chain& chain, LongestCycle& cycle, ColdCaches& caches)
        : chain_(chain), cycle_(cycle), caches_(caches) {}

    void measure(CacheCondition condition, std::uint32_t groups, CycleLine& line) {
        std::optional<MemoryCopier> copier;
        if (condition == CacheCondition::beside_copier) {
            copier.emplace();
        }
        for (std::uint32_t group = 0; group < groups; ++group) {
            CycleTime least{1e12, 1e12};
            for (std::uint32_t i = 0; i < kCycleRepeats; ++i) {
                chain_.forget();
                prepare(condition, caches_, cycle_.trees());
                cycle_.begin();
                const CycleTime took = chain_.run(cycle_.engine());
                line.wall_us.push_back(took.wall_us);
                least = least_of(least, took);
            }
            line.least = {std::max(line.least.wall_us, least.wall_us),
                          std::max(line.least.cpu_us, least.cpu_us)};
        }
        line.work = cycle_.done();
    }

  private:
    Chain& chain_;
    LongestCycle& cycle_;
    ColdCaches& caches_;
};

std::vector<CycleShape> shapes_in(std::span<const CycleLayout> layouts, const CyclePlan& plan,
                                  std::uint32_t tasks, bool asks_twice) {
    std::vector<CycleShape> shapes;
    for (const CycleLayout layout : layouts) {
        for (CycleShape shape : cycle_shapes(plan, tasks, asks_twice)) {
            shape.layout = layout;
            shapes.push_back(shape);
        }
    }
    return shapes;
}

LongestCycle::Options longest_options(const Machine& machine, const CyclePlan& plan,
                                      std::size_t memory_bytes, LaneSet lanes) {
    const auto has_rechecks = [](const WorkLists& lists) { return lists.rechecks != 0; };
    return {.known_answer_mesh = known_answer_mesh_index(machine),
            .memory_bytes = memory_bytes,
            .is_float_only = std::none_of(plan.lists.begin(), plan.lists.end(), has_rechecks),
            .asks_first_part = asks_first_part(machine, plan),
            .lanes = lanes};
}

constexpr const char* kOtherWork = "internal error: the worst-case cycle did unexpected work";

/// Empty, or why this shape could not be measured.
std::string measure_shape(const CycleShape& shape, const Machine& machine,
                          const CycleMeasureOptions& options, Chain& chain, ColdCaches& caches,
                          CycleMeasurement& out) {
    std::string fault;
    const LongestCycle::Options made =
        longest_options(machine, out.plan, out.memory_bytes, options.lanes);
    std::optional<LongestCycle> cycle = LongestCycle::create(out.plan, shape, made, fault);
    if (!cycle) {  // lists of other shapes than the usual one do not fill every layout
        return shape.layout == CycleLayout::rows ? fault : std::string();
    }
    out.lanes = cycle->lanes();
    for (const CacheCondition condition : options.conditions) {
        CycleLine line{.shape = shape, .condition = condition};
        Repeats(chain, *cycle, caches).measure(condition, options.groups_of_repeats, line);
        const bool is_exact = shape.layout != CycleLayout::overflowing;
        if (cycle->is_other() || (is_exact && line.work != cycle->planned())) {
            return kOtherWork;
        }
        out.lines.push_back(std::move(line));
        if (out.lines.back().least.wall_us > out.longest_us()) {
            out.longest = out.lines.size() - 1;
        }
    }
    return {};
}

/// A constructed longest cycle: the CPU engine runs its first stages, and an idle GPU replies at
/// once to the later ones.
struct SharedCycle {
    std::uint32_t host_stages = 0;
    bool poses_parts = false;
    std::uint32_t far_from = 0;  // of the GPU's calls

    /// The least of some. Empty: the cycle did other work.
    [[nodiscard]] std::optional<double> least_us(Chain& chain, LongestCycle& cycle,
                                                 CacheCondition condition,
                                                 ColdCaches& caches) const {
        std::optional<MemoryCopier> copier;
        if (condition == CacheCondition::beside_copier) {
            copier.emplace();
        }
        const Engine host = cycle.engine();
        double least = 1e12;
        for (std::uint32_t i = 0; i < kCycleRepeats; ++i) {
            chain.forget();
            prepare(condition, caches, cycle.trees());
            cycle.begin();
            IdleGpu gpu{.tasks = 1, .open = 1, .far_from = far_from};
            Engine engine = gpu.engine(poses_parts);
            engine.host = {host_stages, host.self, host.run_groups};
            least = std::min(least, chain.run(engine).wall_us);
            if (!cycle.did_stages(host_stages)) {
                return std::nullopt;
            }
        }
        return least;
    }
};

/// Finds the longest of all shapes and of the stages that prove them, then measures that one under
/// every condition.
std::optional<double> measure_with_stages(MeasuredMachine& measured, const CyclePlan& plan,
                                          std::uint32_t host_stages, bool poses_parts,
                                          std::string& fault) {
    Chain& chain = *measured.chain;
    const Machine& machine = measured.loaded.machine;
    const LongestCycle::Options made =
        longest_options(machine, plan, measured.engine->memory().trees_bytes, LaneSet::widest);
    const std::uint32_t calls = calls_from(plan, host_stages);
    ColdCaches caches;
    CycleShape longest;
    SharedCycle cycle{.host_stages = host_stages, .poses_parts = poses_parts}, longest_cycle;
    double longest_us = 0;
    const auto take = [&](LongestCycle& constructed, CacheCondition condition) {
        const std::optional<double> us = cycle.least_us(chain, constructed, condition, caches);
        fault = us ? fault : kOtherWork;
        return us;
    };
    for (const CycleShape& shape :
         longest_shapes(plan, chain.tasks(), tries_longer(machine.can.permit_samples))) {
        std::optional<LongestCycle> constructed = LongestCycle::create(plan, shape, made, fault);
        if (!constructed && shape.layout == CycleLayout::rows) {
            return std::nullopt;
        }
        for (std::uint32_t far_from = calls < 3 ? calls - 1 : 1; far_from <= calls; ++far_from) {
            cycle.far_from = far_from;
            const std::optional<double> us =
                constructed ? take(*constructed, CacheCondition::code_cold) : 0.0;
            if (!us) {
                return std::nullopt;
            }
            if (*us > longest_us) {
                longest_us = *us;
                longest = shape;
                longest_cycle = cycle;
            }
        }
    }
    fault.clear();
    cycle = longest_cycle;
    std::optional<LongestCycle> constructed = LongestCycle::create(plan, longest, made, fault);
    for (const CacheCondition condition : kCacheConditions) {
        const std::optional<double> us = constructed ? take(*constructed, condition) : std::nullopt;
        if (!us) {
            return std::nullopt;
        }
        longest_us = std::max(longest_us, *us);
    }
    return longest_us;
}

}  // namespace

const char* name_of(CacheCondition condition) noexcept {
    constexpr const char* kNames[] = {"warm", "cold", "cold code", "with a memory copy running"};
    return kNames[static_cast<unsigned>(condition)];
}

std::vector<CycleShape> longest_shapes(const CyclePlan& plan, std::uint32_t tasks,
                                       bool asks_twice) {
    constexpr std::array kLongest{CycleLayout::rows, CycleLayout::even};
    return shapes_in(kLongest, plan, tasks, asks_twice);
}

std::optional<double> measure_host_us(const LoadedMachine& loaded, const CyclePlan& plan,
                                      std::uint32_t host_stages, bool poses_parts,
                                      std::string& fault) {
    MeasuredMachine measured(loaded, plan);
    if (!measured.chain) {
        fault = measured.fault();
        return std::nullopt;
    }
    Chain& chain = *measured.chain;
    if (host_stages != 0 && chain.tasks() != 0) {
        return measure_with_stages(measured, plan, host_stages, poses_parts, fault);
    }
    const auto least_us = [&](IdleGpu gpu, const auto& before) {
        double least = 1e12;
        for (std::uint32_t i = 0; i < kCycleRepeats; ++i) {
            chain.forget();
            before();
            IdleGpu now = gpu;
            least = std::min(least, chain.run(now.engine(poses_parts)).wall_us);
        }
        return least;
    };
    // A call does not have most queries when most pairs are open, and proven pairs cast rays.
    IdleGpu longest;
    double longest_us = 0;
    const std::uint32_t tasks = chain.tasks();
    for (const CycleShape& shape :
         cycle_shapes(plan, tasks, tries_longer(measured.loaded.machine.can.permit_samples))) {
        for (std::uint32_t far_from = 1; far_from <= calls_from(plan, 0); ++far_from) {
            const IdleGpu gpu{.tasks = tasks, .open = shape.open, .far_from = far_from};
            const double us = least_us(gpu, [] {});
            if (us > longest_us) {
                longest = gpu;
                longest_us = us;
            }
        }
    }
    ColdCaches caches;
    for (const CacheCondition condition : kCacheConditions) {
        std::optional<MemoryCopier> copier;
        if (condition == CacheCondition::beside_copier) {
            copier.emplace();
        }
        longest_us =
            std::max(longest_us, least_us(longest, [&] { prepare(condition, caches, {}); }));
    }
    return longest_us;
}

std::optional<CycleMeasurement> measure_cycle(const LoadedMachine& loaded, const CyclePlan& plan,
                                              const CycleMeasureOptions& options,
                                              std::string& fault) {
    MeasuredMachine measured(loaded, plan);
    if (!measured.chain) {
        fault = measured.fault();
        return std::nullopt;
    }
    Chain& chain = *measured.chain;
    CycleMeasurement out;
    out.plan = plan;
    out.tasks = chain.tasks();
    out.memory_bytes = measured.engine->memory().trees_bytes;
    out.posing = {1e12, 1e12};
    bool is_far = false;
    for (std::uint32_t i = 0; i < kCycleRepeats; ++i) {
        out.posing = least_of(out.posing, chain.run(idle_engine(is_far)));
    }
    if (out.tasks == 0) {  // no pair, no query
        out.lines.push_back({.shape = {.tasks = 0}, .least = out.posing, .wall_us = {}});
        return out;
    }
    ColdCaches caches;
    for (const CycleShape& shape :
         options.shapes.empty()
             ? shapes_in(kCycleLayouts, plan, out.tasks,
                         tries_longer(measured.loaded.machine.can.permit_samples))
             : options.shapes) {
        fault = measure_shape(shape, measured.loaded.machine, options, chain, caches, out);
        if (!fault.empty()) {
            return std::nullopt;
        }
    }
    return out;
}

}  // namespace axg
