// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/guard/standstill_watch.hpp"

#include <algorithm>

namespace axg {

StandstillRules standstill_rules(const Machine& machine) noexcept {
    return standstill_rules(machine, axis_units(machine));
}

std::string standstill_refusal(const Machine& machine) {
    if (standstill_rules(machine).window_samples != kNeverStands) {
        return {};
    }
    std::string missing;
    for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
        const auto is_velocity = [i](const CanSignal& signal) {
            return signal.role == SignalRole::velocity && signal.axis == i;
        };
        const auto& signals = machine.can.signals;
        if (wire_of(machine.can).rest == RestReport::speeds &&
            std::none_of(signals.begin(), signals.end(), is_velocity)) {
            missing += (missing.empty() ? "" : ", ") + machine.axes[i].name;
        }
    }
    return missing.empty()
               ? "axes: no stop can be confirmed: an endless axis may turn round between two "
                 "samples. Lower its speed_deg_s or can.sample_us."
               : "can.drives: no stop can be confirmed without the velocity of every axis "
                 "(missing: " +
                     missing + "). Map object 0x606C and add the key velocity.";
}

StandstillWatch::StandstillWatch(const Machine& machine, ReceiverOptions options,
                                 const StandstillRules& rules, std::int64_t after_us) noexcept
    : receiver_(machine, options),
      rules_(rules),
      look_ahead_samples_(machine.can.look_ahead_samples) {
    begin(after_us);
}

void StandstillWatch::begin(std::int64_t after_us) noexcept {
    after_us_ = after_us;
    begin_standstill(state_, after_us);
}

void StandstillWatch::on_frame(const CanFrame& frame) noexcept {
    const ReceiverEvent event = receiver_.on_frame(frame);
    switch (event.kind) {
        case ReceiverEvent::Kind::none:
            break;
        case ReceiverEvent::Kind::look_ahead:
            note_path(event.look_ahead);
            break;
        case ReceiverEvent::Kind::snapshot:
            // Before VALID the heartbeat may be missing, and the clock may count samples anew.
            if (event.state == ReceiverState::valid) {
                if (event.snapshot.mode != kModeStandstill) {
                    said_since_ = event.snapshot.sample + 1;
                }
                note_standstill(state_, rules_, event.snapshot,
                                has_still_path(event.snapshot.sample));
            }
            break;
        case ReceiverEvent::Kind::fault:
            if (event.severity == Severity::stop) {
                receiver_.acknowledge();
                has_path_ = is_path_still_ = false;
                said_since_ = 0;  // samples may be counted anew
                begin_standstill(state_, after_us_);
            }
            break;
    }
}

std::uint32_t StandstillWatch::contradicted_axis() const noexcept {
    // Twice the window: its parts reach back a little further than it does, into a jog that ended.
    const std::uint64_t since = std::max(state_.since, said_since_);
    const bool is_said = rules_.is_reported && state_.has_sample &&
                         state_.newest >= since + 2 * rules_.window_samples;
    return is_said ? moving_axis() : kNoIndex;
}

void StandstillWatch::note_path(const PathPoints& points) noexcept {
    is_path_still_ =
        has_path_ && points.position == points.before && points.position == path_.position;
    path_ = points;
    has_path_ = true;
    if (!is_path_still_) {
        begin_standstill(state_, after_us_);
    }
}

/// A path that has ended is no evidence of rest now. Its frame may come after those of its sample.
bool StandstillWatch::has_still_path(std::uint64_t sample) const noexcept {
    return look_ahead_samples_ == 0 || (is_path_still_ && path_.sample + rules_.gap_samples_max >=
                                                              sample + look_ahead_samples_);
}

}  // namespace axg
