// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/plan/plan_measure.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "core/certificate/pair_queries.hpp"
#include "core/reach/motion_history.hpp"
#include "firmware_if/setup/choose_engine.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "firmware_if/setup/travel_sample.hpp"
#include "hil_replay/replay/replay_run.hpp"
#include "hil_replay/trace/trace_base.hpp"
#include "hil_replay/trace/trace_period.hpp"

namespace axg {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::uint32_t kHalvings = 24;

double us_since(Clock::time_point start) {
    return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

std::int64_t steady_ns(void* /*clock*/) noexcept {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch())
        .count();
}

bool is_far(const QueryResult& result) {
    return result.status == QueryStatus::ok && result.proof == Proof::far;
}

/// Passes queries on, and notes the work of the results.
struct WatchedEngine {
    Engine engine;
    ModelWork work{};

    [[nodiscard]] Engine watched() {
        Engine out{this, [](void* self, std::span<const Query> queries,
                            std::span<QueryResult> results) noexcept {
                       static_cast<WatchedEngine*>(self)->run(queries, results);
                   }};
        out.prefers_batches = engine.prefers_batches;
        if (engine.run_groups != nullptr) {
            out.run_groups = [](void* self, std::span<const Query> queries,
                                std::span<QueryResult> results,
                                std::span<GroupWork> groups) noexcept {
                auto& watched = *static_cast<WatchedEngine*>(self);
                watched.engine(queries, results, groups);
                watched.note(results, groups);
            };
        }
        if (engine.run_parts != nullptr) {
            out.parts_max = engine.parts_max;
            out.run_parts = [](void* self, const PartQueries& parts, std::span<const Query> queries,
                               std::span<QueryResult> results,
                               std::span<GroupWork> groups) noexcept {
                auto& watched = *static_cast<WatchedEngine*>(self);
                watched.engine.run_parts(watched.engine.self, parts, queries, results, groups);
                watched.note(results);
            };
        }
        out.host = {engine.host.stages, this,
                    [](void* self, std::span<const Query> queries, std::span<QueryResult> results,
                       std::span<GroupWork> groups) noexcept {
                        auto& watched = *static_cast<WatchedEngine*>(self);
                        const Engine::Host& host = watched.engine.host;
                        host.run_groups(host.self, queries, results, groups);
                        watched.note(results, groups);
                    }};
        return out;
    }
    void run(std::span<const Query> queries, std::span<QueryResult> results) noexcept {
        engine(queries, results);
        note(results);
    }
    /// Ignores a first part queried alone: if its share is too small, the stage queries it again.
    void note(std::span<const QueryResult> results, std::span<const GroupWork> groups) noexcept {
        if (groups.size() != 1 || groups[0].share != kFirstPartShare) {
            note(results);
        }
    }
    void note(std::span<const QueryResult> results) noexcept {
        work.queries = std::max(work.queries, static_cast<std::uint32_t>(results.size()));
        for (const QueryResult& result : results) {
            work.node_pairs = std::max(work.node_pairs, result.node_pairs);
            work.triangle_pairs = std::max(work.triangle_pairs, result.triangle_pairs);
            work.rechecks = std::max(work.rechecks, result.rechecks);
            work.over_capacity += result.status == QueryStatus::ok ? 0 : 1;
        }
    }
};

void keep_least(std::vector<double>& us, std::size_t place, double spent_us) {
    if (place == us.size()) {
        us.push_back(spent_us);
    } else {
        us[place] = std::min(us[place], spent_us);
    }
}

/// Contact mode at one position: whether all pairs are far. Appends the verdict of each
/// pair to `each`; the caller sets the position.
class ContactQuery {
  public:
    ContactQuery(const Machine& machine, const Engine& engine)
        : machine_(machine), engine_(engine), results_(kQueriesMax) {}

    bool is_clear(const AxisSnapshot& snapshot, std::vector<PairVerdict>* each = nullptr) {
        make_contact_queries(machine_, snapshot, *pair_queries_);
        const std::uint32_t count =
            pair_queries_->status == SnapshotStatus::ok ? pair_queries_->count : 0;
        engine_({pair_queries_->queries.data(), count}, {results_.data(), count});
        bool all = pair_queries_->status == SnapshotStatus::ok;
        for (std::uint32_t i = 0; i < count; ++i) {
            all = all && is_far(results_[i]);
            if (each != nullptr) {
                each->push_back({0, pair_queries_->pair[i], is_far(results_[i])});
            }
        }
        return all;
    }

  private:
    const Machine& machine_;
    Engine engine_;
    std::unique_ptr<PairQueries> pair_queries_ = std::make_unique<PairQueries>();
    std::vector<QueryResult> results_;
};

AxisSnapshot snapshot_between(const LinearApproach& approach, double share) {
    AxisSnapshot snapshot;
    snapshot.axis_count = static_cast<std::uint32_t>(approach.clear.size());
    for (std::size_t i = 0; i < approach.clear.size(); ++i) {
        snapshot.position[i] =
            approach.clear[i] + share * (approach.stopped[i] - approach.clear[i]);
    }
    return snapshot;
}

/// The share of the way at which a stop comes, to 2^-kHalvings; clear at the returned share.
double stop_share(const LinearApproach& approach, ContactQuery& contact) {
    if (!contact.is_clear(snapshot_between(approach, 0))) {
        return 0;
    }
    double clear = 0, stopped = 1;
    for (std::uint32_t i = 0; i < kHalvings; ++i) {
        const double middle = 0.5 * (clear + stopped);
        (contact.is_clear(snapshot_between(approach, middle)) ? clear : stopped) = middle;
    }
    return clear;
}

void measure_contact(const Machine& machine, const ModelScene& scene, const Engine& engine,
                     ModelMeasurement& out) {
    ContactQuery contact(machine, engine);
    std::vector<double> us;
    for (std::uint32_t pass = 0; pass < scene.passes; ++pass) {
        for (std::uint32_t i = 0; i < scene.positions; ++i) {
            const AxisSnapshot snapshot = sampled_position(machine, i);
            const Clock::time_point start = Clock::now();
            (void)contact.is_clear(snapshot);
            keep_least(us, i, us_since(start));
        }
    }
    for (std::uint32_t i = 0; i < scene.positions; ++i) {
        const std::size_t first = out.verdicts.contact.size();
        (void)contact.is_clear(sampled_position(machine, i), &out.verdicts.contact);
        for (std::size_t k = first; k < out.verdicts.contact.size(); ++k) {
            out.verdicts.contact[k].position = i;
        }
    }
    for (const LinearApproach& approach : scene.approaches) {
        out.verdicts.stop_share.push_back(stop_share(approach, contact));
    }
    out.contact = times_of(std::move(us));
}

CertificateVerdict verdict_of(const StopCycle& cycle, const AxisSnapshot& snapshot) {
    CertificateVerdict out{.is_proven = cycle.status == SnapshotStatus::ok,
                           .sample = snapshot.sample};
    for (const PairProof& proof : cycle.proofs) {
        if (proof.surfaces.proof != JointBoxProof::proven) {
            out.is_proven = false;
            out.open.push_back(proof.pair);
        }
    }
    if (!out.is_proven) {
        out.axes.assign(snapshot.position.begin(), snapshot.position.begin() + snapshot.axis_count);
    }
    return out;
}

/// Measures the certificate of a machine at rest at each position, for all samples of the history.
void measure_rest(const Machine& machine, const ModelScene& scene, const Engine& engine,
                  const ContainmentTest& containment_test, StopCertificate& certificate,
                  ModelMeasurement& out) {
    std::vector<double> us;
    for (std::uint32_t pass = 0; pass < scene.passes; ++pass) {
        for (std::uint32_t i = 0; i < scene.positions; ++i) {
            AxisSnapshot snapshot = sampled_position(machine, i);
            for (snapshot.sample = 1; snapshot.sample <= kSamplesKept; ++snapshot.sample) {
                snapshot.latched_us += machine.can.sample_us;
                certificate.note(snapshot, snapshot.sample == 1);
            }
            const Clock::time_point start = Clock::now();
            certificate.prove(engine, containment_test);
            keep_least(us, i, us_since(start));
            out.work.queries = std::max(out.work.queries, certificate.work().queries);
            if (pass == 0) {
                out.verdicts.rest.push_back(verdict_of(certificate.cycle(), snapshot));
            }
        }
    }
    out.rest = times_of(std::move(us));
}

bool measure_trace(LoadedMachine loaded, const ModelScene& scene, const Engine& engine,
                   const ContainmentTest& containment_test, ModelMeasurement& out,
                   std::string& fault) {
    if (fault = take_trace_shape(scene.trace, {}, loaded.machine).fault; !fault.empty()) {
        return false;
    }
    std::vector<double> us;
    for (std::uint32_t pass = 0; pass < scene.passes; ++pass) {
        std::optional<StopCertificate> certificate = make_stop_certificate(loaded);
        const std::unique_ptr<TraceReader> trace = open_trace(scene.trace, {}, fault);
        if (!certificate || !trace) {
            fault = certificate ? fault : std::string(kNoMemoryForProofs);
            return false;
        }
        std::size_t place = 0;
        const auto observe = [&](const ReplayCycle& cycle) {
            keep_least(us, place++, static_cast<double>(cycle.spent_ns) * 1e-3);
            out.work.queries = std::max(out.work.queries, cycle.stop_certificate->work().queries);
            if (pass == 0) {
                out.verdicts.trace.push_back(
                    verdict_of(cycle.stop_certificate->cycle(), cycle.snapshot));
            }
        };
        ReplayOptions options;
        options.parts.stop_certificate = &*certificate;
        options.deadline_us = loaded.machine.deadline_us;
        options.keep_going = true;
        options.clock.now_ns = &steady_ns;
        ReplayRun run(loaded.machine, engine, containment_test, options, observe);
        CanFrame frame;
        while (trace->next(frame) && run.on_frame(frame)) {
        }
        if (!trace->error().empty()) {
            fault = trace->error();
            return false;
        }
    }
    out.trace = times_of(std::move(us));
    return true;
}

}  // namespace

CycleTimes times_of(std::vector<double> cycle_us) {
    if (cycle_us.empty()) {
        return {};
    }
    std::sort(cycle_us.begin(), cycle_us.end());
    const auto at = [&](double share) {
        return cycle_us[static_cast<std::size_t>(
            std::ceil(share * static_cast<double>(cycle_us.size() - 1)))];
    };
    return {cycle_us.size(), at(0.5), at(0.99), cycle_us.back()};
}

std::vector<LinearApproach> find_approaches(const LoadedMachine& loaded, std::uint32_t positions) {
    std::vector<LinearApproach> out;
    std::optional<CpuEngine> engine = make_engine(loaded);
    if (!engine) {
        return out;
    }
    const Machine& machine = loaded.machine;
    ContactQuery contact(machine, engine->engine());
    for (std::uint32_t i = 0; i + 1 < positions; ++i) {
        const AxisSnapshot from = sampled_position(machine, i);
        AxisSnapshot to = sampled_position(machine, i + 1);
        double square = 0;
        for (std::size_t k = 0; k < machine.axes.size(); ++k) {
            const bool is_linear = machine.axes[k].kind == AxisKind::linear;
            to.position[k] = is_linear ? to.position[k] : from.position[k];
            square += (to.position[k] - from.position[k]) * (to.position[k] - from.position[k]);
        }
        const bool from_clear = contact.is_clear(from);
        if (square > 0 && from_clear != contact.is_clear(to)) {
            const AxisSnapshot &clear = from_clear ? from : to, &stopped = from_clear ? to : from;
            const std::size_t axes = machine.axes.size();
            out.push_back({{clear.position.begin(), clear.position.begin() + axes},
                           {stopped.position.begin(), stopped.position.begin() + axes},
                           std::sqrt(square)});
        }
    }
    return out;
}

bool measure_model(const LoadedMachine& loaded, const ModelScene& scene, bool on_gpu,
                   ModelMeasurement& out, std::string& fault) {
    std::optional<CpuEngine> cpu = make_engine(loaded);
    const std::optional<ContainmentTest> containment_test =
        cpu ? make_containment_test(loaded, *cpu) : std::nullopt;
    std::optional<StopCertificate> certificate = make_stop_certificate(loaded);
    std::optional<CudaEngine> gpu =
        on_gpu ? make_gpu_engine(loaded, fault, scene.multiprocessors) : std::nullopt;
    if (!containment_test || !certificate) {
        fault = !cpu                ? kNoLaneSet
                : !containment_test ? kNoMemoryForContainment
                                    : kNoMemoryForProofs;
        return false;
    }
    if (on_gpu && !gpu) {
        return false;
    }
    out.device = gpu ? name_of(gpu->device()) : "one core, " + std::string(cpu->lanes());
    out.memory_bytes = containment_test->size_bytes() +
                       (gpu ? gpu->memory().device_bytes() + gpu->memory().pinned_bytes
                            : cpu->memory().total_bytes());
    // The constructed longest cycle of the machine's plan, as admission measures it.
    const std::optional<MeasuredGpuCycle> longest =
        gpu ? measure_gpu_cycle(loaded, cycle_demand(loaded.machine, true), gpu->tree_levels(),
                                scene.multiprocessors, fault)
            : std::nullopt;
    if (gpu && !longest) {
        return false;
    }
    out.longest_us = longest ? longest->us() : out.longest_us;
    WatchedEngine watch{.engine = gpu ? with_host(gpu->engine(), *cpu, longest->host_stages)
                                      : cpu->engine()};
    measure_contact(loaded.machine, scene, watch.watched(), out);
    if (loaded.machine.guard.promise == StopPromise::independent) {
        measure_rest(loaded.machine, scene, watch.watched(), *containment_test, *certificate, out);
    }
    if (!scene.trace.empty() &&
        !measure_trace(loaded, scene, watch.watched(), *containment_test, out, fault)) {
        return false;
    }
    watch.work.queries = std::max(watch.work.queries, out.work.queries);
    out.work = watch.work;
    if (gpu && gpu->fault() != nullptr) {
        fault = gpu->fault();
        return false;
    }
    return true;
}

}  // namespace axg
