// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/board/motion_board.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/guard/advisories.hpp"

namespace axg {

namespace {

constexpr double kSecondsPerUs = 1e-6;
constexpr double kStandstillCounts = 0.05;  // a sample; a slower axis counts as at rest
constexpr double kOffChangesUs = 5000;      // time in which a stop changes the following error

/// Direction (1, -1) into which the acceleration reverses an axis while the jerk removes it; 0: no
/// reversal.
int turning_way(const AxisMotion& axis, double jerk) noexcept {
    const double a = axis.acceleration;
    const bool turns = axis.speed * a < 0 && a * a > 2 * jerk * std::abs(axis.speed);
    return !turns ? 0 : a > 0 ? 1 : -1;
}

}  // namespace

const char* to_text(BoardState state) noexcept {
    switch (state) {
        case BoardState::waiting:
            return "waiting";
        case BoardState::moving:
            return "moving";
        case BoardState::braking:
            return "braking";
        case BoardState::stopped:
            return "stopped";
        case BoardState::finished:
            return "finished";
    }
    return "unknown";
}

const char* to_text(BoardStop stop) noexcept {
    switch (stop) {
        case BoardStop::none:
            return "none";
        case BoardStop::permit_ran_out:
            return "permit_ran_out";
        case BoardStop::guard_said_stop:
            return "guard_said_stop";
        case BoardStop::person_said_stop:
            return "person_said_stop";
    }
    return "unknown";
}

MotionBoard::MotionBoard(const Machine& machine, std::span<const double> start,
                         CommandedMotion motion, const BoardOptions& options)
    : machine_(machine),
      motion_(std::move(motion)),
      options_(options),
      random_(options.seed),
      encoder_(machine, {.says_session = false}),
      watch_(machine.can, options.jog.axis != kNoIndex, options.permit_us, options.hashes,
             options.speed_share != nullptr || options.axis_shares != nullptr ? options.cap
                                                                              : CapPromise::none),
      tool_(options.tool == 0 ? machine.first_tool : options.tool),
      sent_tool_(tool_) {
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        axes_[i].position = sent_[i] = start[i];
    }
    if (options_.latched_age.most_us != 0) {
        past_.emplace(options_.latched_age.most_us);
        past_->note(now_us_, axes_);
    }
    const double period_s = machine.can.sample_us * kSecondsPerUs;
    // A share set now acts on commands that the axes follow later.
    options_.cap_smooth_s += machine.can.look_ahead_samples * period_s;
    shares_.resize(2 + static_cast<std::size_t>(std::ceil(options_.cap_smooth_s / period_s)), 0.0);
    late_shares_.resize(static_cast<std::size_t>(kCapLateUs / machine.can.sample_us) + 1, 1.0);
    if (keeps_cap() && options_.axis_shares != nullptr) {
        axis_caps_.emplace(machine, *options.axis_shares,
                           CapKeeping{options_.cap_smooth_s, options.cap_fault});
    } else if (keeps_cap()) {
        *options_.speed_share = 0;
    }
    if (machine.can.look_ahead_samples == 0) {
        return;
    }
    path_.emplace(machine, start, std::move(motion_), options.tick_us);
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        // Half of the draws use the largest following error; a stop changes it to a second draw.
        const double most = machine.axes[i].following_error;
        for (double* off : {&off_before_[i], &off_after_[i]}) {
            const bool is_most = random_() % 2 == 0;
            *off = is_most ? std::copysign(most, between(-1, 1)) : between(-most, most);
        }
    }
    set_from_path(0, now_us_);
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        sent_[i] = axes_[i].position;
    }
}

double MotionBoard::off_path(std::size_t axis, std::int64_t now_us) const noexcept {
    const bool is_braking = state_ == BoardState::braking;
    const double since_us = is_braking ? static_cast<double>(now_us - stop_.brake_us) : 0;
    const double share = std::clamp(since_us / kOffChangesUs, 0.0, 1.0);
    return off_before_[axis] + share * (off_after_[axis] - off_before_[axis]);
}

/// Sets the axes to the path at the commanded instant plus the following error.
void MotionBoard::set_from_path(double commanded_us, std::int64_t now_us) {
    const AxisMotions commanded = path_->at(commanded_us);
    for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
        axes_[i] = commanded[i];
        axes_[i].position += off_path(i, now_us);
    }
}

void MotionBoard::watch(AxisObserver observe, std::int64_t every_us) {
    observe_ = std::move(observe);
    observe_every_us_ = every_us;
}

double MotionBoard::between(double low, double high) {
    return low + (high - low) * static_cast<double>(random_() >> 11U) * 0x1p-53;
}

std::int64_t MotionBoard::first_stop_us() const noexcept {
    return std::min({watch_.valid_until_us(), watch_.stopped_us(), person_us_});
}

void MotionBoard::acknowledge_stop() noexcept {
    watch_.acknowledge(next_us_);
}

/// Records the first stop (permit end, guard or person) before the axes move past it: a sample's
/// frames arrive after the last instant to which the axes moved.
void MotionBoard::note_stop() {
    stop_.asked_us = first_stop_us();
    stop_.why = watch_.stopped_us() == stop_.asked_us ? BoardStop::guard_said_stop
                : person_us_ == stop_.asked_us        ? BoardStop::person_said_stop
                                                      : BoardStop::permit_ran_out;
    // Half of the stops use the longest reaction: the worst case does not depend on luck.
    const auto reaction_max = static_cast<double>(options_.reaction_us_max);
    const double reaction_us = random_() % 2 == 0 ? reaction_max : between(0, reaction_max);
    stop_.brake_us = stop_.asked_us + static_cast<std::int64_t>(reaction_us);
    stop_.certified_us = watch_.certified_us();
}

void MotionBoard::begin_braking() {
    state_ = BoardState::braking;
    if (machine_.guard.promise == StopPromise::path_keeping) {
        stop_.brake_us = now_us_;
        rate_ = {.position = 0, .speed = 1};
        rate_brake_ = path_->gentlest_stop(static_cast<double>(now_us_));
        const bool is_soft = random_() % 2 == 0;
        rate_brake_.deceleration *= is_soft ? 1 : between(1, options_.deceleration_factor_max);
        rate_brake_.jerk *= is_soft ? 1 : between(1, options_.jerk_factor_max);
        return;
    }
    for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
        const Axis& axis = machine_.axes[i];
        // Some axes brake as softly as they may while others brake hard: half of each draw.
        const bool is_soft = random_() % 2 == 0;
        brakes_[i].deceleration =
            axis.stopping_min * (is_soft ? 1 : between(1, options_.deceleration_factor_max));
        brakes_[i].jerk = axis.jerk_max * (is_soft ? 1 : between(1, options_.jerk_factor_max));
        const bool may_turn = machine_.guard.stop_reversal == StopReversal::jerk_limited;
        brakes_[i].way = may_turn ? turning_way(axes_[i], brakes_[i].jerk) : 0;
    }
}

/// Follows the commanded motion, tick by tick; no braking begins before `until_us`.
void MotionBoard::drive(std::int64_t until_us) {
    const std::size_t count = machine_.axes.size();
    while (now_us_ < until_us && state_ == BoardState::moving) {
        if (now_us_ == tick_ends_us_) {
            const MotionTick tick = motion_({axes_.data(), count});
            tool_ = tick.tool;
            line_ = tick.line;
            tick_ends_us_ = now_us_ + options_.tick_us;
            if (tick.is_over) {
                state_ = BoardState::finished;
                break;
            }
        }
        const std::int64_t to_us = std::min(until_us, tick_ends_us_);
        const double seconds = static_cast<double>(to_us - now_us_) * kSecondsPerUs;
        for (std::size_t i = 0; i < count; ++i) {
            axes_[i] = moved_on(axes_[i], seconds);
        }
        now_us_ = to_us;
        note_speeds();
    }
}

void MotionBoard::note_speeds() noexcept {
    if (!keeps_cap()) {
        return;
    }
    if (axis_caps_) {
        cap_breaches_ += axis_caps_->note(axes()) ? 0U : 1U;
        return;
    }
    double fastest = 0;
    for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
        fastest = std::max(fastest, share_in_stop(machine_.axes[i], axes_[i]));
    }
    fastest_ = std::max(fastest_, fastest);
    cap_breaches_ += fastest * kSpeedCapRapid > kept_cap_ + kCapCounts ? 1U : 0U;
}

/// Called once a period, between motion and latch. Slows down if ordered, acknowledges the permit
/// once no axis is faster or will be by earlier commands, and speeds up if allowed.
void MotionBoard::keep_cap() {
    // A stop along the path runs through commands that are older than the newest share.
    const bool is_behind =
        state_ == BoardState::braking && machine_.guard.promise == StopPromise::path_keeping;
    if (!keeps_cap() || is_behind) {
        return;
    }
    if (axis_caps_) {
        axis_caps_->keep(watch_, watch_.is_slow() ? options_.slow_share : 1, next_us_);
        kept_cap_ = axis_caps_->least_kept();
        if (state_ == BoardState::moving) {
            note_speeds();
        }
        return;
    }
    const bool is_true = options_.cap_fault == CapFault::none;
    const std::uint8_t ordered = watch_.ordered_cap(next_us_);
    const double commanded = *std::max_element(shares_.begin(), shares_.end());
    const double counts = std::ceil(std::max(fastest_, commanded) * kSpeedCapRapid - kCapCounts);
    const double least = is_true ? std::clamp(counts, 0.0, double{kSpeedCapRapid}) : 0;
    const std::uint8_t wanted = std::max(ordered, static_cast<std::uint8_t>(least));
    kept_cap_ = watch_.keep_cap(wanted, next_us_);
    double share = kCapShare * std::min(kept_cap_, ordered) / kSpeedCapRapid;
    late_shares_[late_slot_++ % late_shares_.size()] = share;
    if (options_.cap_fault == CapFault::late) {
        share = *std::max_element(late_shares_.begin(), late_shares_.end());
    } else if (options_.cap_fault == CapFault::half) {
        share = std::min(1.0, 2 * share);
    } else if (options_.cap_fault == CapFault::ignores) {
        share = 1;
    }
    share = std::min(share, watch_.is_slow() ? options_.slow_share : 1);
    shares_[share_slot_++ % shares_.size()] = share;
    *options_.speed_share = share;
    fastest_ = 0;
    if (state_ == BoardState::moving) {
        note_speeds();
    }
}

/// Does the same as drive(), along commands that were computed before.
void MotionBoard::follow(std::int64_t until_us) {
    const auto until = static_cast<double>(until_us);
    set_from_path(until, until_us);
    const MotionTick tick = path_->tick_at(until);
    tool_ = tick.tool;
    line_ = tick.line;
    path_->forget_before(until);
    if (path_->is_over(until)) {
        state_ = BoardState::finished;
    }
    now_us_ = until_us;
    note_speeds();
}

void MotionBoard::brake_for(std::int64_t until_us) {
    const double seconds = static_cast<double>(until_us - now_us_) * kSecondsPerUs;
    if (machine_.guard.promise != StopPromise::path_keeping) {
        for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
            brake(axes_[i], brakes_[i], seconds);
        }
        return;
    }
    brake(rate_, rate_brake_, seconds);
    const double since_us = rate_.position / kSecondsPerUs;
    set_from_path(static_cast<double>(stop_.brake_us) + since_us, until_us);
    for (std::size_t i = 0; i < machine_.axes.size() && has_settled(until_us); ++i) {
        axes_[i] = {.position = axes_[i].position};
    }
}

/// A path may contain rests, so the stop along it ends when its rate is 0 and no error changes.
bool MotionBoard::has_settled(std::int64_t now_us) const noexcept {
    if (machine_.guard.promise != StopPromise::path_keeping) {
        return std::all_of(axes().begin(), axes().end(), is_resting);
    }
    return is_resting(rate_) && static_cast<double>(now_us - stop_.brake_us) >= kOffChangesUs;
}

/// Ends the stop once all axes are at rest.
void MotionBoard::settle(std::int64_t now_us) {
    if (has_settled(now_us)) {
        state_ = BoardState::stopped;
        stop_.rest_us = now_us;
    }
}

void MotionBoard::advance_part(std::int64_t until_us) {
    if (state_ == BoardState::moving && stop_.why == BoardStop::none &&
        first_stop_us() < until_us) {
        note_stop();
    }
    if (state_ == BoardState::moving) {
        const bool has_stop = stop_.why != BoardStop::none;
        const std::int64_t brake_us = has_stop ? std::max(stop_.brake_us, now_us_) : kNever;
        const std::int64_t drive_us = std::min(until_us, brake_us);
        path_ ? follow(drive_us) : drive(drive_us);
        if (state_ == BoardState::moving && now_us_ == brake_us && brake_us < until_us) {
            begin_braking();
        }
    }
    if (state_ == BoardState::braking) {
        brake_for(until_us);
        note_speeds();
        settle(until_us);
    }
    now_us_ = until_us;
}

/// Advances in parts of at most kPastPartUs if the board sends past positions, and notes each.
void MotionBoard::advance_noted(std::int64_t until_us) {
    while (past_ && now_us_ < until_us) {
        advance_part(std::min(until_us, now_us_ + kPastPartUs));
        past_->note(now_us_, axes_);
    }
    if (now_us_ < until_us) {
        advance_part(until_us);
    }
}

void MotionBoard::advance(std::int64_t until_us) {
    while (observe_ && !is_at_rest() && state_ != BoardState::waiting && now_us_ < until_us) {
        const std::int64_t to_us = std::min(until_us, now_us_ + observe_every_us_);
        advance_noted(to_us);
        observe_(now_us_, axes());
    }
    advance_noted(until_us);
    if (is_at_rest()) {
        watch_.rest(now_us_);
    }
}

/// Draws the position's age: the largest, the least or one between, each in a third of the draws.
double MotionBoard::latched_position(std::uint32_t axis) {
    if (!past_) {
        return axes_[axis].position;
    }
    const ValueAge age = options_.latched_age;
    const double drawn = between(-1, 2);
    const auto age_us = static_cast<std::int64_t>(age.least_us + std::clamp(drawn, 0.0, 1.0) *
                                                                     (age.most_us - age.least_us));
    return past_->position(now_us_ - age_us, axis);
}

AxisSnapshot MotionBoard::snapshot_now(std::int64_t nominal_us, std::int64_t latched_us) {
    AxisSnapshot snapshot;
    snapshot.sample = sample_;
    snapshot.latched_us = nominal_us;  // end of SYNC; the positions are those of now_us_
    snapshot.arrived_us = latched_us;
    snapshot.axis_count = static_cast<std::uint32_t>(machine_.axes.size());
    snapshot.tool = tool_;
    snapshot.flags = options_.is_homed ? 0 : kFlagNotHomed;
    snapshot.mode = kModeStandstill;
    for (std::uint32_t i = 0; i < snapshot.axis_count; ++i) {
        snapshot.position[i] = latched_position(i);
        const double step = std::abs(axes_[i].position - sent_[i]);
        sent_[i] = axes_[i].position;
        if (step >= kStandstillCounts * encoder_.frame_set().axes[i].unit) {
            snapshot.mode = kModeMoving;
        }
    }
    snapshot.mode = tool_ != sent_tool_ ? kModeToolChange : snapshot.mode;
    snapshot.flags |= watch_.ack_flags();
    if (options_.jog.axis != kNoIndex && !is_at_rest()) {  // a stop ends the jog
        put_jog(options_.jog, snapshot);
    }
    sent_tool_ = tool_;
    return snapshot;
}

std::span<const CanFrame> MotionBoard::latch() {
    return latch_now(sync_counter_of(sample_));
}

std::span<const CanFrame> MotionBoard::latch_on_sync(std::uint8_t counter, std::int64_t ended_us) {
    nominal_us_ = next_us_ = ended_us;
    const std::span<const CanFrame> frames = latch_now(counter);
    return frames.empty() ? frames : frames.subspan(1);
}

void MotionBoard::pass_without_sync() {
    begin_if_permitted();
    advance(next_us_);
    keep_cap();
    set_next_latch();
}

void MotionBoard::begin_if_permitted() {
    if (state_ != BoardState::waiting || watch_.valid_until_us() <= next_us_ ||
        watch_.stopped_us() != kNever) {
        return;
    }
    watch_.begin(next_us_);
    now_us_ = tick_ends_us_ = moving_since_us_ = next_us_;
    state_ = BoardState::moving;
    if (path_) {  // points sent before this sample remain valid
        path_->begin(nominal_us_ + machine_.can.look_ahead_samples * machine_.can.sample_us);
    }
}

void MotionBoard::set_next_latch() {
    nominal_us_ += machine_.can.sample_us;
    const auto jitter = static_cast<double>(options_.latch_jitter_us_max);
    next_us_ = nominal_us_ + (jitter > 0 ? static_cast<std::int64_t>(between(-jitter, jitter)) : 0);
}

std::span<const CanFrame> MotionBoard::latch_now(std::uint8_t counter) {
    const std::int64_t period_us = machine_.can.sample_us;
    const std::int64_t look_ahead_us = machine_.can.look_ahead_samples * period_us;
    begin_if_permitted();
    advance(next_us_);
    keep_cap();
    watch_.on_latch(counter, next_us_);
    PathPoints look_ahead;
    if (path_) {
        const AxisMotions last = path_->at(static_cast<double>(nominal_us_ + look_ahead_us)),
                          before = path_->at(
                              static_cast<double>(nominal_us_ + look_ahead_us - period_us));
        for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
            look_ahead.position[i] = last[i].position;
            look_ahead.before[i] = before[i].position;
        }
    }
    encoded_ = encoder_.encode(snapshot_now(nominal_us_, next_us_), frames_,
                               path_ ? &look_ahead : nullptr);
    if (encoded_.status != EncodeStatus::ok) {
        return {};
    }
    for (std::uint32_t i = 0; i < encoded_.frame_count; ++i) {
        CanFrame& frame = frames_[i];
        const bool is_sync = frame.id == encoder_.frame_set().sync_id;
        // SYNC begins early enough to end at the sample's instant if the wire is free.
        frame.time_us = is_sync ? nominal_us_ - bus_time_us(frame, 1'000'000) : next_us_;
    }
    const bool has_session = watch_.take_session(next_us_, frames_[encoded_.frame_count]);
    ++sample_;
    set_next_latch();
    return {frames_.data(), encoded_.frame_count + (has_session ? 1U : 0U)};
}

}  // namespace axg
