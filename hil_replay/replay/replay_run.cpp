// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/replay/replay_run.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace axg {

void CountTable::add(std::uint32_t count) noexcept {
    ++cycles[std::min<std::size_t>(count, cycles.size() - 1)];
}

std::uint32_t CountTable::at_share(double share) const noexcept {
    const double all = static_cast<double>(std::accumulate(cycles.begin(), cycles.end(), 0ULL));
    double seen = 0;
    std::uint32_t count = 0;
    for (; count + 1 < cycles.size(); ++count) {
        seen += static_cast<double>(cycles[count]);
        if (seen >= share * all) {
            break;
        }
    }
    return count;
}

ReplayRun::ReplayRun(const Machine& machine, Engine engine, const ContainmentTest& containment_test,
                     const ReplayOptions& options, std::function<void(const ReplayCycle&)> observe)
    : chain_(machine, engine, containment_test, options.stop_certificate, options.speed_advisory,
             options.margin_advisory),
      options_(options),
      observe_(std::move(observe)),
      pairs_(machine.pairs.size()) {}

bool ReplayRun::on_frame(const CanFrame& frame) {
    ++frame_count_;
    const ReceiverEvent event = chain_.receive(frame);
    if (event.kind == ReceiverEvent::Kind::snapshot) {
        cycle(event);
    } else if (event.kind == ReceiverEvent::Kind::fault && event.severity == Severity::stop) {
        note_stop(chain_.lose_input(), event.time_us, event.fault);
        in_episode_ = false;  // each is an event of its own, not a state that lasts
        if (options_.keep_going) {
            chain_.acknowledge();
        }
    }
    return options_.keep_going || !state().is_stopped;
}

std::int64_t ReplayRun::evaluate(PairTimes& pair_ns) {
    const EvaluationClock clock{options_.now_ns, options_.clock};
    const std::int64_t start = clock.now();
    chain_.evaluate(clock);
    const std::int64_t spent_ns = clock.now() - start;
    std::copy(chain_.pair_ns().begin(), chain_.pair_ns().end(), pair_ns.begin());
    return spent_ns;
}

void ReplayRun::cycle(const ReceiverEvent& event) {
    PairTimes pair_ns, again_ns;
    const std::int64_t first_ns = evaluate(pair_ns);
    std::int64_t spent_ns = first_ns;
    const std::int64_t deadline_ns = options_.deadline_us * 1000;
    for (int i = 0; i < kLateRepeats && spent_ns > deadline_ns; ++i) {
        const std::int64_t repeated_ns = evaluate(again_ns);
        if (repeated_ns < spent_ns) {
            spent_ns = repeated_ns;
            pair_ns = again_ns;
        }
    }
    interrupted_ += first_ns > deadline_ns && spent_ns <= deadline_ns ? 1 : 0;
    note_pairs(pair_ns);
    const CycleResult result = chain_.decide(event.state == ReceiverState::valid);
    note_proofs(result);
    note_withheld(result, event.state == ReceiverState::valid);
    note_time(spent_ns, event.snapshot);
    note_stop(result, event.snapshot.arrived_us, ReceiverFault::none);
    chain_.update_advisories();
    note_clearance_levels();
    if (observe_) {
        observe_({event.snapshot, chain_.pair_queries(), chain_.results(),
                  chain_.containment_results(), result, event.sync_counter,
                  chain_.stop_certificate(), spent_ns, chain_.margin_advisory()});
    }
}

void ReplayRun::note_pairs(const PairTimes& pair_ns) {
    const std::span<const ContainmentResult> containment_results = chain_.containment_results();
    for (std::uint32_t i = 0; i < containment_results.size(); ++i) {
        PairStatistics& pair = pairs_[chain_.pair_queries().pair[i]];
        if (!chain_.pair_ns().empty()) {
            pair.time.add(pair_ns[i]);
        }
        pair.not_proven += containment_results[i].containment == Containment::none ? 0 : 1;
    }
}

void ReplayRun::note_proofs(const CycleResult& result) {
    if (!is_stoppable()) {
        return;
    }
    const StopCertificate& certificate = *chain_.stop_certificate();
    std::uint32_t last = kNoIndex;  // a pair with several tools counts once
    for (const PairProof& proof : certificate.cycle().proofs) {
        const bool proven = proof.surfaces.proof == JointBoxProof::proven &&
                            proof.containment_result.containment == Containment::none;
        if (!proven && proof.pair != last) {
            ++pairs_[proof.pair].not_proven;
            last = proof.pair;
        }
    }
    ProofStatistics& all = *proofs_;
    all.queries.add(certificate.work().queries);
    all.rounds.add(certificate.work().rounds);
    all.queries_most = std::max(all.queries_most, certificate.work().queries);
    all.rounds_most = std::max(all.rounds_most, certificate.work().rounds);
    all.withheld += !result.has_permit && !state().is_stopped ? 1 : 0;
}

void ReplayRun::note_withheld(const CycleResult& result, bool ready) {
    const bool is_settled = is_stoppable() && chain_.stop_certificate()->cycle().is_settled;
    if (result.has_permit || state().is_stopped || !ready || !is_settled) {
        return;
    }
    if (withheld_.samples++ == 0) {
        withheld_.reason = result.reason;
        withheld_.pair = result.pair;
        withheld_.time_us = chain_.snapshot().arrived_us;
        withheld_.snapshot = chain_.snapshot();
    }
}

void ReplayRun::note_clearance_levels() {
    if (!has_clearance_levels()) {
        return;
    }
    const MarginAdvisory& advisory = *chain_.margin_advisory();
    ClearanceLevel worst = ClearanceLevel::clear;
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
        const ClearanceLevel level = advisory.clearance_levels()[i].level;
        pairs_[i].slow += level == ClearanceLevel::slow ? 1 : 0;
        pairs_[i].warn += level == ClearanceLevel::warn ? 1 : 0;
        worst = std::min(worst, level);
    }
    clearance_levels_->slow += worst == ClearanceLevel::slow ? 1 : 0;
    clearance_levels_->warn += worst == ClearanceLevel::warn ? 1 : 0;
    clearance_levels_->queries.add(advisory.queries());
    clearance_levels_->queries_most = std::max(clearance_levels_->queries_most, advisory.queries());
}

void ReplayRun::note_time(std::int64_t spent_ns, const AxisSnapshot& snapshot) {
    cycles_.add(spent_ns);
    overruns_ += spent_ns > options_.deadline_us * 1000 ? 1 : 0;
    const auto end = slowest_.begin() + static_cast<std::ptrdiff_t>(slow_count_);
    const auto at = std::find_if(slowest_.begin(), end, [spent_ns](const SlowCycle& slow) {
        return spent_ns > slow.spent_ns;
    });
    if (at == slowest_.end()) {
        return;  // eight slower ones are known
    }
    slow_count_ = std::min(slow_count_ + 1, kSlowCyclesKept);
    std::move_backward(at, slowest_.begin() + static_cast<std::ptrdiff_t>(slow_count_) - 1,
                       slowest_.begin() + static_cast<std::ptrdiff_t>(slow_count_));
    *at = {spent_ns, snapshot};
}

void ReplayRun::note_stop(const CycleResult& result, std::int64_t time_us, ReceiverFault fault) {
    // Not proven before the first permit: it was withheld, and nothing was withdrawn.
    const bool is_stop = result.reason != StopReason::none && state().is_stopped;
    if (!is_stop) {
        in_episode_ = false;
        return;
    }
    const bool is_input = result.reason == StopReason::input;  // no sample, so none of an episode
    if (in_episode_ && !is_input) {
        if (stop_count_ <= kStopsKept) {
            ++stops_[stop_count_ - 1].samples;
        }
        return;
    }
    in_episode_ = true;
    if (++stop_count_ <= kStopsKept) {
        stops_[stop_count_ - 1] = {.reason = result.reason,
                                   .pair = result.pair,
                                   .fault = fault,
                                   .time_us = time_us,
                                   .snapshot = chain_.snapshot(),
                                   .samples = 1};
    }
}

}  // namespace axg
