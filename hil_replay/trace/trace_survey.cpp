// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/trace/trace_survey.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/sincos.hpp"

namespace axg {
namespace {

/// The least value that so large a share of the sorted list does not exceed.
std::int64_t at_share(const std::vector<std::int64_t>& sorted, double share) {
    const auto rank =
        static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size()) - 1e-9));
    return sorted[std::max<std::size_t>(rank, 1) - 1];
}

}  // namespace

TraceSurvey::TraceSurvey(const Machine* machine)
    : machine_(machine),
      receiver_(machine == nullptr ? Machine{} : *machine,
                {.takes_jumps = true, .period = PeriodUse::ignored}) {
    if (machine != nullptr) {
        limits_.emplace(*machine);
    }
}

void TraceSurvey::add(const CanFrame& frame) {
    first_us_ = frame_count_ == 0 ? frame.time_us : first_us_;
    last_us_ = std::max(frame_count_ == 0 ? frame.time_us : last_us_, frame.time_us);
    ++frame_count_;
    // The id of an error frame holds the kind of error, and is no identifier.
    const IdKey key{frame.error, frame.extended, frame.remote, frame.fd,
                    frame.error ? 0 : frame.id};
    Times& times = ids_[key];
    IdSurvey& survey = times.survey;
    if (survey.frames++ == 0) {
        survey.first_us = frame.time_us;
    } else {
        const std::int64_t period_us = frame.time_us - survey.last_us;
        times.periods_us.push_back(period_us);
        if (period_us > survey.longest_us) {
            survey.longest_us = period_us;
            survey.longest_at_us = survey.last_us;
        }
    }
    survey.last_us = frame.time_us;
    survey.bytes_min = std::min(survey.bytes_min, frame.length_bytes);
    survey.bytes_max = std::max(survey.bytes_max, frame.length_bytes);
    if (machine_ == nullptr) {
        return;
    }
    const ReceiverEvent event = receiver_.on_frame(frame);
    if (event.kind == ReceiverEvent::Kind::snapshot) {
        add_snapshot(event.snapshot);
        limits_->add(event.snapshot, event.state != ReceiverState::valid);
    } else if (event.kind == ReceiverEvent::Kind::fault && event.severity == Severity::stop) {
        receiver_.acknowledge();  // a guard would have stopped; here the rest is of interest, too
    }
    snapshots_.counters = receiver_.counters();
}

void TraceSurvey::add_snapshot(const AxisSnapshot& snapshot) {
    for (std::uint32_t i = 0; i < snapshot.axis_count; ++i) {
        AxisSurvey& axis = snapshots_.axes[i];
        const double value = snapshot.position[i];
        const bool is_first = snapshots_.snapshots == 0;
        axis.least = is_first ? value : std::min(axis.least, value);
        axis.most = is_first ? value : std::max(axis.most, value);
        axis.last = value;
        const double seconds =
            static_cast<double>(snapshot.latched_us - last_snapshot_.latched_us) * 1e-6;
        if (!is_first && seconds > 0) {
            double step = value - last_snapshot_.position[i];
            // An endless axis is given within one turn: it went the short way round.
            step = machine_->axes[i].unlimited ? std::remainder(step, 2 * kPi) : step;
            axis.speed_max = std::max(axis.speed_max, std::abs(step) / seconds);
        }
    }
    if (std::find(snapshots_.tools.begin(), snapshots_.tools.end(), snapshot.tool) ==
        snapshots_.tools.end()) {
        snapshots_.tools.push_back(snapshot.tool);
    }
    ++snapshots_.snapshots;
    snapshots_.samples_lost = receiver_.counters().samples_lost;
    last_snapshot_ = snapshot;
}

std::map<IdKey, IdSurvey> TraceSurvey::ids() const {
    std::map<IdKey, IdSurvey> out;
    for (const auto& [key, times] : ids_) {
        IdSurvey& survey = out[key] = times.survey;
        if (times.periods_us.empty()) {
            continue;
        }
        std::vector<std::int64_t> sorted = times.periods_us;
        std::sort(sorted.begin(), sorted.end());
        survey.period_us_median = at_share(sorted, 0.5);
        survey.period_us_p1 = at_share(sorted, 0.01);
        survey.period_us_p99 = at_share(sorted, 0.99);
        const std::int64_t longest_regular_us =
            kGapPeriods * std::max<std::int64_t>(survey.period_us_median, 1);
        survey.gaps = static_cast<std::uint64_t>(
            sorted.end() - std::upper_bound(sorted.begin(), sorted.end(), longest_regular_us));
    }
    return out;
}

std::string name_of(const IdKey& key) {
    if (key.is_error) {
        return "error";
    }
    return fmt::format(fmt::runtime(key.is_extended ? "{:08X}" : "{:03X}"), key.id) +
           (key.is_fd ? " fd" : "") + (key.is_remote ? " remote" : "");
}

double per_second(const IdSurvey& survey) {
    const double seconds = static_cast<double>(survey.last_us - survey.first_us) * 1e-6;
    return seconds > 0 ? static_cast<double>(survey.frames - 1) / seconds : 0.0;
}

double shown_value(const Axis& axis, double value) {
    return axis.kind == AxisKind::rotary ? value * 180 / kPi : value;
}

}  // namespace axg
