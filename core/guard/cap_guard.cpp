// SPDX-License-Identifier: Apache-2.0
#include "core/guard/cap_guard.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/assert.hpp"
#include "core/base/sincos.hpp"

namespace axg {
namespace {

// Periods of loss and delay on the way of an order and of its acknowledgement.
constexpr double kAnswerPeriods = 15;

double speed_of(const Axis& axis, std::uint8_t cap) noexcept {
    return capped_speed(axis, cap / double{kCapRapid});
}

}  // namespace

double cap_answer_seconds(const Machine& machine) noexcept {
    double slowest_s = 0;
    for (const Axis& axis : machine.axes) {
        const double ramp_s = has_jerk_limit(axis) ? axis.acceleration_max / axis.jerk_max : 0;
        slowest_s = std::max(slowest_s, axis.speed_max / axis.acceleration_max + ramp_s);
    }
    // A planner that averages its commands has half of the acceleration.
    // The axes follow what the board announced before the order.
    const double periods = kAnswerPeriods + machine.can.look_ahead_samples;
    return machine.guard.cap_lead_s + 2 * slowest_s + periods * machine.can.sample_us * 1e-6 +
           age_seconds(machine).most;
}

std::uint32_t age_samples(const Machine& machine) noexcept {
    if (machine.can.latched_age.most_us == 0) {
        return 0;
    }
    const double shortest_s = machine.can.sample_us * 1e-6 * (1 - kPeriodShare);
    const double most_s = age_seconds(machine).most + machine.guard.latch_jitter_s;
    return static_cast<std::uint32_t>(std::ceil(most_s / shortest_s));
}

AxisCaps CapGuard::bound_caps(const CapOrder& order) const noexcept {
    return higher_caps(facts_.acked, caps_of_permit(order.cap, order.mask));
}

/// Whether an acknowledged cap is above the order: the board still slows down.
bool CapGuard::is_above() const noexcept {
    const AxisCaps ordered = caps_of_permit(order().cap, order().mask);
    bool is_any = false;
    for (std::size_t i = 0; i < machine_->axes.size(); ++i) {
        is_any = is_any || facts_.acked[i] > ordered[i];
    }
    return is_any;
}

bool CapGuard::asks_raise() const noexcept {
    return facts_.status == AckStatus::known && control_.asks(latched_us_);
}

/// Whether the axis moved farther since `before` than any cap allows that may have been in force.
bool CapGuard::is_too_fast(std::uint32_t axis, const Seen& before) const noexcept {
    const Axis& of = machine_->axes[axis];
    const Seen& last = seen_[(seen_count_ - 1) % kSeen];
    const double speed = speed_of(of, facts_.since[axis]);
    const double time_s =
        static_cast<double>(last.sample - before.sample) * machine_->can.sample_us * 1e-6;
    const double jitter_s = sample_errors(*machine_, axis, 0).latch_jitter_s;
    const double most = speed * (time_s * (1 + kPeriodShare) + jitter_s) + 2 * error_[axis];
    double way = std::fabs(last.position[axis] - before.position[axis]);
    if (of.unlimited) {
        way = std::fabs(way - 2 * kPi * std::round(way / (2 * kPi)));
        return most < 0.99 * kPi && way > most;
    }
    return way > most;
}

/// Checks 1, 4 and 16 periods: over a longer time, the errors of two samples hide less.
void CapGuard::watch_speeds() noexcept {
    const std::uint64_t newest = seen_count_ - 1;
    for (const std::uint64_t back : {1U, 4U, kSeen - 1}) {
        for (std::uint32_t i = 0; back <= newest && i < machine_->axes.size(); ++i) {
            if (facts_.since[i] < kCapRapid && is_too_fast(i, seen_[(newest - back) % kSeen])) {
                broken_ = {.kind = CapBreak::too_fast, .axis = i};
                return;
            }
        }
    }
}

/// Checks the time limit of an order to slow down; each further order restarts it.
void CapGuard::watch_answer() noexcept {
    const double waited_s = static_cast<double>(latched_us_ - fell_us_) * 1e-6;
    if (broken_.kind == CapBreak::none && is_above() && waited_s > cap_answer_seconds(*machine_)) {
        broken_ = {.kind = CapBreak::not_acknowledged};
    }
}

void CapGuard::note(const AxisSnapshot& snapshot, const CapFacts& facts, bool is_first,
                    const std::array<double, kAxesMax>& error) noexcept {
    if (!is_on()) {
        return;
    }
    facts_ = facts;
    // No record contains axes that the machine lacks: a replay must choose the same order.
    std::fill(facts_.acked.begin() + static_cast<std::ptrdiff_t>(machine_->axes.size()),
              facts_.acked.end(), kCapRapid);
    latched_us_ = snapshot.latched_us;
    error_ = error;
    seen_count_ = is_first ? 0 : seen_count_;
    seen_[seen_count_++ % kSeen] = {.sample = snapshot.sample, .position = snapshot.position};
    if (facts.status == AckStatus::unknown) {
        broken_ = {.kind = CapBreak::unknown_permit};
    } else if (broken_.kind == CapBreak::none) {
        watch_speeds();
    }
}

void CapGuard::bound(StopCertificate& certificate) const noexcept {
    if (!is_on()) {
        return;
    }
    std::array<double, kAxesMax> speeds{};
    const auto speeds_at = [&](const AxisCaps& caps) {
        for (std::size_t i = 0; i < machine_->axes.size(); ++i) {
            speeds[i] = speed_of(machine_->axes[i], caps[i]);
        }
        return std::span<const double>(speeds.data(), machine_->axes.size());
    };
    certificate.bound_speeds(speeds_at(bound_caps(order())));
    if (asks_raise()) {
        const CapOrder& asked = control_.asked();
        certificate.ask_raise(
            speeds_at(higher_caps(bound_caps(order()), caps_of_permit(asked.cap, asked.mask))));
    }
}

void CapGuard::note_fall(const CapOrder& before) noexcept {
    const AxisCaps was = caps_of_permit(before.cap, before.mask);
    const AxisCaps is = caps_of_permit(order().cap, order().mask);
    fell_us_ = higher_caps(was, is) != is ? latched_us_ : fell_us_;
}

void CapGuard::set_order(const CapOrder& order) noexcept {
    const CapOrder before = control_.order();
    control_.set_order(order);
    note_fall(before);  // the board's time limit starts with this order, too
}

/// Orders only proven caps: the bounds of the proof were no lower.
void CapGuard::order_next(const StopCycle& cycle, const CapWish* wish) noexcept {
    const CapOrder before = order();
    const bool is_asked = asks_raise();
    AxisCaps proven = bound_caps(before);
    if (is_asked && cycle.is_longer_proven) {
        const CapOrder& asked = control_.asked();
        proven = higher_caps(proven, caps_of_permit(asked.cap, asked.mask));
    }
    const bool is_slowing = is_above();
    const CapOrder next =
        control_.update({.sample_us = latched_us_,
                         .wish = wish != nullptr ? *wish : CapWish{.best = before},
                         .is_proven = is_asked || is_slowing || cycle.is_longer_proven,
                         .is_slowing = is_slowing,
                         .is_asked = is_asked,
                         .proven = proven});
    AXG_ASSERT(higher_caps(proven, bound_caps(next)) == proven);
    note_fall(before);
}

void CapGuard::judge(const StopCycle& cycle, const CapWish* wish, bool is_armed,
                     CycleResult& result) noexcept {
    if (!is_on()) {
        return;
    }
    if (!is_armed) {  // no more orders: from the next proof on, every axis is at rapid
        result.has_permit = result.has_permit && order().cap == kCapRapid;
        control_ = CapControl();
    } else if (!cycle.is_jog) {
        watch_answer();
        if (broken_.kind != CapBreak::none && !result.is_stop) {
            result.has_permit = false;
            result.is_stop = true;
            result.reason = StopReason::left_cap;
            result.pair = kNoIndex;
            result.cap_fact = broken_;
        }
        if (result.has_permit && cycle.is_settled) {
            order_next(cycle, wish);
        }
    }
    broken_ = {};
    result.has_cap = true;
    result.cap_order = order();
    result.is_held = is_armed && control_.is_held(latched_us_);
}

}  // namespace axg
