// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/replay_run.hpp"

#include <algorithm>
#include <utility>

namespace axg {

ReplayRun::ReplayRun(const Machine& machine, Engine engine, const Solids& solids,
                     const ReplayOptions& options, std::function<void(const ReplayCycle&)> observe)
    : machine_(machine),
      engine_(engine),
      solids_(solids),
      options_(options),
      observe_(std::move(observe)),
      receiver_(machine),
      pairs_(machine.pairs.size()) {}

bool ReplayRun::on_frame(const CanFrame& frame) {
    ++frame_count_;
    const ReceiverEvent event = receiver_.on_frame(frame);
    if (event.kind == ReceiverEvent::Kind::picture) {
        cycle(event);
    } else if (event.kind == ReceiverEvent::Kind::fault && event.severity == Severity::stop) {
        note_stop(step_input_lost(state_), event.time_us, event.fault);
        in_episode_ = false;  // each is an event of its own, not a state that lasts
        if (options_.keep_going) {
            receiver_.acknowledge();
        }
    }
    return options_.keep_going || !state_.is_stopped;
}

std::int64_t ReplayRun::ask_all(const AxisPicture& picture, PairTimes& pair_ns) {
    const std::int64_t start = options_.now_ns(options_.clock);
    plan_contact(machine_, picture, plan_);
    std::int64_t before = options_.now_ns(options_.clock);
    for (std::uint32_t i = 0; plan_.status == PlanStatus::ok && i < plan_.count + 2; ++i) {
        engine_({&plan_.questions[i], 1}, {&answers_[i], 1});
        if (i < plan_.count) {
            solids_.ask({&plan_.questions[i], 1}, {&answers_[i], 1}, {&contained_[i], 1});
            const std::int64_t after = options_.now_ns(options_.clock);
            pair_ns[i] = after - before;
            before = after;
        }
    }
    return options_.now_ns(options_.clock) - start;
}

void ReplayRun::cycle(const ReceiverEvent& event) {
    last_picture_ = event.picture;
    PairTimes pair_ns, again_ns;
    const std::int64_t first_ns = ask_all(event.picture, pair_ns);
    std::int64_t spent_ns = first_ns;
    const std::int64_t deadline_ns = options_.deadline_us * 1000;
    for (int i = 0; i < kLateRepeats && spent_ns > deadline_ns; ++i) {
        const std::int64_t repeated_ns = ask_all(event.picture, again_ns);
        if (repeated_ns < spent_ns) {
            spent_ns = repeated_ns;
            pair_ns = again_ns;
        }
    }
    interrupted_ += first_ns > deadline_ns && spent_ns <= deadline_ns ? 1 : 0;
    const bool is_asked = plan_.status == PlanStatus::ok;
    for (std::uint32_t i = 0; is_asked && i < plan_.count; ++i) {
        PairStatistics& pair = pairs_[plan_.pair[i]];
        pair.time.add(pair_ns[i]);
        pair.not_proven += contained_[i].containment == Containment::none ? 0 : 1;
    }
    const std::span<const Answer> answers{answers_.data(), is_asked ? plan_.count + 2 : 0};
    const std::span<const ContainmentAnswer> solids{contained_.data(), is_asked ? plan_.count : 0};
    const CycleResult result =
        step(state_, plan_, answers, solids, event.state == ReceiverState::valid);
    note_time(spent_ns, event.picture);
    note_stop(result, event.picture.arrived_us, ReceiverFault::none);
    if (observe_) {
        observe_({event.picture, plan_, answers, solids, result, event.sync_counter});
    }
}

void ReplayRun::note_time(std::int64_t spent_ns, const AxisPicture& picture) {
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
    *at = {spent_ns, picture};
}

void ReplayRun::note_stop(const CycleResult& result, std::int64_t time_us, ReceiverFault fault) {
    if (result.reason == StopReason::none) {
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
                                   .picture = last_picture_,
                                   .samples = 1};
    }
}

}  // namespace axg
