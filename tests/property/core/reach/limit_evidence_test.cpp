// SPDX-License-Identifier: Apache-2.0
// Axes that keep every limit, with emergency stops in between, seen as badly as the machine file
// allows (errors, rounding, jitter, a period that is off, lost samples), never show a broken limit;
// axes that break one do; and without a stop of the board's own none is ever seen. Wrong rules,
// made here, fail. AXG_COUNT: healthy samples.
#include "core/reach/limit_evidence.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/base/sincos.hpp"
#include "hil_replay/board/axis_motion.hpp"
#include "tests/support/count.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/triangle_cases.hpp"

namespace axg::test {
namespace {

using Random = std::mt19937_64;

/// A machine of one axis, its count on the wire, and its true period.
struct Case {
    Machine machine;
    std::array<double, 1> count{};
    double period_s = 0;
    bool is_jerk_limited = false;
};

Case random_case(Random& random) {
    constexpr std::uint32_t kPeriodsUs[] = {250, 500, 1000, 1000, 1000, 1000, 2000, 5000};
    Case c;
    c.is_jerk_limited = (random() & 1U) != 0;
    const bool is_rotary = random() % 4 == 0;
    const double size = is_rotary ? 0.02 : 1.0;
    Axis axis;
    axis.unlimited = is_rotary;
    axis.kind = is_rotary ? AxisKind::rotary : AxisKind::linear;
    axis.speed_max = size * std::exp2(between(random, 5, 10));
    axis.acceleration_max = size * 1000 * std::exp2(between(random, 0, 3.3));
    axis.jerk_max = size * 20'000 * std::exp2(between(random, 0, 3.3));
    axis.stopping_min = axis.acceleration_max * between(random, 0.4, 1.0);
    axis.position_error = size * 1e-3 * std::max(0.0, between(random, -1, 5));
    c.count[0] = size * 1e-4 * std::exp2(between(random, 0, 4));
    c.machine.axes.push_back(axis);
    c.machine.can.sample_us = kPeriodsUs[random() % 8];
    c.machine.guard.latch_jitter_s = std::max(0.0, between(random, -1, 1)) * 1e-4;
    c.machine.guard.free_jerk_limited = c.is_jerk_limited;
    c.period_s = 1e-6 * c.machine.can.sample_us * (1 + between(random, -0.01, 0.01));
    return c;
}

/// An axis that races at random within its limits, and stops at random harder than these.
class HealthyAxis {
  public:
    /// @param stops_itself  false: no stop is harder than free motion
    HealthyAxis(Random& random, const Case& c, bool stops_itself)
        : random_(random), case_(c), stops_itself_(stops_itself) {
        axis_.position = between(random, -100, 100);
    }

    /// The motion of one period begins.
    void begin_period() {
        if (stop_.jerk > 0) {
            periods_at_rest_ += is_resting(axis_) ? 1 : 0;
            if (periods_at_rest_ * case_.period_s > rest_s_) {
                stop_ = {};
            }
            return;
        }
        if (stops_itself_ && random_() % 400 == 0) {
            begin_stop();
            return;
        }
        const Axis& of = case_.machine.axes[0];
        const double period = case_.period_s;
        if (random_() % 16 == 0) {
            wanted_ = std::clamp(between(random_, -1.5, 1.5), -1.0, 1.0) * of.acceleration_max;
        }
        double next = wanted_;
        if (case_.is_jerk_limited) {
            const double step = of.jerk_max * period, a = axis_.acceleration;
            next = std::clamp(next, a - step, a + step);
            next = keeps_speed(next) ? next : a - std::clamp(a, -step, step);
            axis_.jerk = (next - a) / period;
        } else {
            axis_.acceleration = keeps_speed(next) ? next : 0;
        }
    }
    void end_period() {
        axis_ = state_at(case_.period_s);
        delay_s_ = 0;
    }

    [[nodiscard]] double position_at(double seconds) const { return state_at(seconds).position; }
    [[nodiscard]] std::uint64_t stops() const { return stops_; }

  private:
    [[nodiscard]] AxisMotion state_at(double seconds) const {
        if (stop_.jerk == 0) {
            return moved_on(axis_, seconds);
        }
        const double before = std::min(seconds, delay_s_);
        AxisMotion axis = moved_on(axis_, before);
        brake(axis, stop_, seconds - before);
        return axis;
    }
    /// Whether the acceleration can still be taken back below the largest speed after it.
    [[nodiscard]] bool keeps_speed(double next) const {
        const Axis& of = case_.machine.axes[0];
        const double period = case_.period_s;
        const bool limited = case_.is_jerk_limited;
        const double mean = limited ? 0.5 * (axis_.acceleration + next) : next;
        const double late = limited ? next * std::fabs(next) / (2 * of.jerk_max) : 0;
        // Taken back in whole periods.
        const double rounding = limited ? of.jerk_max * period * period / 2 : 0;
        const double speed = axis_.speed + mean * period;
        return std::max(std::fabs(speed), std::fabs(speed + late)) + rounding <= of.speed_max;
    }
    /// By at least what is guaranteed, and up to five times as hard; then rest for 16 strides.
    void begin_stop() {
        const Axis& of = case_.machine.axes[0];
        ++stops_;
        stop_ = {.deceleration = of.stopping_min * std::exp2(between(random_, 0, 2.3)),
                 .jerk = of.jerk_max * std::exp2(between(random_, 0, 6))};
        // Until then the acceleration is taken back, or the speed could become too large.
        const double step = of.jerk_max * case_.period_s;
        axis_.jerk = case_.is_jerk_limited
                         ? -std::clamp(axis_.acceleration, -step, step) / case_.period_s
                         : 0;
        axis_.acceleration = case_.is_jerk_limited ? axis_.acceleration : 0;
        delay_s_ = case_.period_s * between(random_, 1e-6, 1);
        const double stride_s = std::max(1e-3, 1e-6 * case_.machine.can.sample_us) * 1.01;
        rest_s_ = stride_s * (16 + std::max(0.0, between(random_, -40, 40)));
        periods_at_rest_ = 0;
        wanted_ = 0;
    }

    Random& random_;
    const Case& case_;
    bool stops_itself_;
    AxisMotion axis_;
    Brake stop_{};        // jerk 0: none is on
    double delay_s_ = 0;  // of a stop that begins within this period
    double rest_s_ = 0, periods_at_rest_ = 0, wanted_ = 0;
    std::uint64_t stops_ = 0;
};

struct Watched {
    std::uint64_t samples = 0, stops = 0, excused = 0;
    std::uint64_t resting = 0;  // samples whose count is that of the sample before
    bool has_machine_stop = false;
    LimitFact fact;
};

/// What the guard sees of a healthy axis, until it is said to have broken a limit.
/// @param axis  begin_period(), position_at(), end_period(), stops()
template <class Motion>
Watched watch_healthy(Random& random, const Case& c, const LimitRules& rules, std::uint64_t samples,
                      Motion axis) {
    const Axis& of = c.machine.axes[0];
    const double jitter_s = c.machine.guard.latch_jitter_s, count = c.count[0];
    const double bias = (random() & 1U) != 0 ? 1 : -1;
    MotionHistory history;
    LimitWatch watch;
    Watched out;
    double before = 0;
    for (std::uint64_t k = 0; k < samples; ++k) {
        axis.begin_period();
        const std::uint64_t dice = random();
        if (dice % 100 != 0) {
            const double late =
                (dice & 0x100U) != 0 ? ((dice & 0x200U) != 0 ? 1.0 : 0.0) : between(random, 0, 1);
            const double off = (dice & 0x400U) != 0 ? bias * ((dice & 0x800U) != 0 ? 1 : -1)
                                                    : between(random, -1, 1);
            AxisSnapshot snapshot;
            snapshot.sample = 100'000 + k;
            snapshot.axis_count = 1;
            const double at = axis.position_at(late * jitter_s) + off * of.position_error;
            snapshot.position[0] = std::round(at / count) * count;
            if (of.unlimited) {
                snapshot.position[0] -= 2 * kPi * std::floor(snapshot.position[0] / (2 * kPi));
            }
            note_snapshot(history, snapshot, rules.stride);
            out.fact = note_limits(watch, rules, snapshot, history);
            out.excused += watch.stops[0].is_on ? 1 : 0;
            out.has_machine_stop = out.has_machine_stop || watch.machine_stop.is_on;
            out.resting += snapshot.position[0] == before ? 1 : 0;
            before = snapshot.position[0];
        }
        axis.end_period();
        ++out.samples;
        if (out.fact.kind != LimitKind::none) {
            break;
        }
    }
    out.stops = axis.stops();
    return out;
}

void expect_healthy(const Case& c, const Watched& watched) {
    const Axis& axis = c.machine.axes[0];
    EXPECT_EQ(watched.fact.kind, LimitKind::none)
        << to_text(watched.fact.kind) << " " << watched.fact.measured << " beside "
        << watched.fact.declared << " at sample " << watched.fact.sample << "; v " << axis.speed_max
        << " a " << axis.acceleration_max << " j " << axis.jerk_max << " d " << axis.stopping_min
        << " e " << axis.position_error << " count " << c.count[0] << " jitter "
        << c.machine.guard.latch_jitter_s << " T " << c.machine.can.sample_us << " limited "
        << c.is_jerk_limited << " endless " << axis.unlimited;
}

TEST(LimitEvidence, AHealthyAxisShowsNoBrokenLimit) {
    Random random(printed_seed(20261210));
    const auto samples = count_from_environment(1'000'000);
    constexpr std::uint64_t kSamplesAnAxis = 5000;
    Watched all;
    while (all.samples < samples && !testing::Test::HasFailure()) {
        const Case c = random_case(random);
        const Watched one = watch_healthy(random, c, limit_rules(c.machine, c.count),
                                          kSamplesAnAxis, HealthyAxis(random, c, true));
        expect_healthy(c, one);
        all.samples += one.samples;
        all.stops += one.stops;
        all.excused += one.excused;
    }
    std::printf("%llu samples, %llu stops, %llu samples of stops harder than free motion\n",
                static_cast<unsigned long long>(all.samples),
                static_cast<unsigned long long>(all.stops),
                static_cast<unsigned long long>(all.excused));
    if (samples >= 1'000'000) {
        EXPECT_GT(all.stops, all.samples / 2000);
        EXPECT_GT(all.excused, all.samples / 100);
    }
}

/// An axis that sticks and slips, or turns round through its backlash: it rests for a while, and
/// jumps on with its full acceleration and deceleration.
class SlippingAxis {
  public:
    SlippingAxis(Random& random, const Case& c) : random_(random), case_(c) {
        const Axis& of = c.machine.axes[0];
        // From slips that no count shows to such as many counts do.
        rise_s_ = std::sqrt(c.count[0] / of.acceleration_max) * std::exp2(between(random, -2, 4));
        rise_s_ = std::min(rise_s_, 0.9 * of.speed_max / of.acceleration_max);
        rest_s_ = rise_s_ * std::exp2(between(random, -3, 3));
        way_ = 1;
    }
    void begin_period() {}
    void end_period() { now_s_ += case_.period_s; }
    [[nodiscard]] std::uint64_t stops() const { return 0; }
    [[nodiscard]] double position_at(double seconds) {
        const double a = case_.machine.axes[0].acceleration_max, t = now_s_ + seconds;
        for (; t >= began_s_ + 2 * rise_s_ + rest_s_; began_s_ += 2 * rise_s_ + rest_s_) {
            position_ += way_ * a * rise_s_ * rise_s_;
            way_ = random_() % 8 == 0 ? -way_ : way_;
        }
        const double since = std::clamp(t - began_s_, 0.0, 2 * rise_s_);
        const double rising = std::min(since, rise_s_), falling = since - rising;
        return position_ +
               way_ * a * (0.5 * rising * rising + rise_s_ * falling - 0.5 * falling * falling);
    }

  private:
    Random& random_;
    const Case& case_;
    double rise_s_ = 0, rest_s_ = 0, way_ = 1, began_s_ = 0, now_s_ = 0, position_ = 0;
};

/// As random_case: slow, and with counts as coarse as a tenth of a millimetre.
Case random_slow_case(Random& random) {
    Case c = random_case(random);
    Axis& axis = c.machine.axes[0];
    c.count[0] *= std::exp2(between(random, 0, 8));
    axis.speed_max *= std::exp2(between(random, -6, 0));
    return c;
}

// Counts that rest at low speed, stick and slip, and turn round look like a frozen encoder.
TEST(LimitEvidence, WithoutAStopOfTheBoardsOwnNoneIsSeen) {
    Random random(printed_seed(20261130));
    const auto samples = count_from_environment(1'000'000);
    constexpr std::uint64_t kSamplesAnAxis = 5000;
    std::uint64_t seen = 0, resting = 0, false_stops = 0;
    for (std::uint64_t n = 0; seen < samples && !testing::Test::HasFailure(); ++n) {
        Case c = random_slow_case(random);
        const bool slips = n % 3 == 0;
        if (slips) {  // its jerk has no limit
            c.is_jerk_limited = c.machine.guard.free_jerk_limited = false;
        }
        const LimitRules rules = limit_rules(c.machine, c.count);
        const Watched one =
            slips ? watch_healthy(random, c, rules, kSamplesAnAxis, SlippingAxis(random, c))
                  : watch_healthy(random, c, rules, kSamplesAnAxis, HealthyAxis(random, c, false));
        expect_healthy(c, one);
        EXPECT_FALSE(one.has_machine_stop)
            << (slips ? "slips" : "races") << ", count " << c.count[0] << " v "
            << c.machine.axes[0].speed_max << " a " << c.machine.axes[0].acceleration_max;
        seen += one.samples;
        resting += one.resting;
        false_stops += one.has_machine_stop ? 1 : 0;
    }
    std::printf("%llu samples, %llu with a count that rests, %llu axes with a stop\n",
                static_cast<unsigned long long>(seen), static_cast<unsigned long long>(resting),
                static_cast<unsigned long long>(false_stops));
    if (samples >= 100'000) {
        EXPECT_GT(resting, seen / 10) << "too lively to tell anything";
    }
}

/// Of 200 healthy axes, how many are said to have broken a limit by these rules.
template <class Change>
unsigned accused(Change change) {
    Random random(20261211);
    unsigned count = 0;
    for (unsigned n = 0; n < 200; ++n) {
        const Case c = random_case(random);
        LimitRules rules = limit_rules(c.machine, c.count);
        change(rules);
        const Watched one = watch_healthy(random, c, rules, 2000, HealthyAxis(random, c, true));
        count += one.fact.kind != LimitKind::none ? 1 : 0;
    }
    return count;
}

TEST(LimitEvidenceAblations, EachPartIsNeeded) {
    EXPECT_EQ(accused([](LimitRules&) {}), 0U);
    const unsigned no_jitter =
        accused([](LimitRules& rules) { rules.axes[0].errors.latch_jitter_s = 0; });
    const unsigned two_for_four =
        accused([](LimitRules& rules) { rules.weights.acceleration = 2; });
    const unsigned four_for_eight = accused([](LimitRules& rules) { rules.weights.jerk = 4; });
    const unsigned no_stop = accused([](LimitRules& rules) { rules.axes[0].stop_strides = 0; });
    std::printf("accused of 200: %u by e for e', %u by 2 for 4, %u by 4 for 8, %u without stops\n",
                no_jitter, two_for_four, four_for_eight, no_stop);
    EXPECT_GT(no_jitter, 10U);
    EXPECT_GT(two_for_four, 10U);
    EXPECT_GT(four_for_eight, 10U);
    EXPECT_GT(no_stop, 100U);
}

/// The paper's machine: how many samples until an acceleration that is too large is found, of an
/// axis that begins at rest between two samples; 0: not within 20.
std::uint64_t samples_until_found(Random& random, double share, double during_s) {
    Case c;
    Axis axis;
    axis.speed_max = 500;
    axis.acceleration_max = 4000;
    axis.jerk_max = 50'000;
    axis.stopping_min = 3500;
    axis.position_error = 1e-3;
    c.machine.axes.push_back(axis);
    c.count[0] = 1e-3;
    const LimitRules rules = limit_rules(c.machine, c.count);
    const double way = (random() & 1U) != 0 ? 1 : -1, start = between(random, -100, 100);
    MotionHistory history;
    LimitWatch watch;
    const double phase = between(random, 0, 1e-3);
    for (std::uint64_t k = 0; k <= 60; ++k) {
        const double t = std::max(0.0, static_cast<double>(k) * 1e-3 + phase - 40e-3);
        const double fast = std::min(t, during_s);
        const double a = share * 4000;
        const double moved = 0.5 * a * fast * fast + a * fast * (t - fast);
        const double off = std::clamp(between(random, -2, 2), -1.0, 1.0) * 5e-4;
        AxisSnapshot snapshot;
        snapshot.sample = k;
        snapshot.axis_count = 1;
        snapshot.position[0] = std::round((start + way * moved + off) * 1e3) / 1e3;
        note_snapshot(history, snapshot, 1);
        if (note_limits(watch, rules, snapshot, history).kind != LimitKind::none) {
            return k - 39;
        }
    }
    return 0;
}

TEST(LimitEvidence, ABrokenLimitIsFoundInTime) {
    Random random(printed_seed(20261212));
    std::uint64_t slowest = 0, slowest_of_five = 0;
    for (int n = 0; n < 2000; ++n) {
        const std::uint64_t tenth = samples_until_found(random, 1.1, 20e-3);
        const std::uint64_t five = samples_until_found(random, 5, 20e-3);
        EXPECT_NE(tenth, 0U);
        EXPECT_NE(five, 0U);
        slowest = std::max(slowest, tenth);
        slowest_of_five = std::max(slowest_of_five, five);
    }
    std::printf("1.1 times the acceleration found within %u samples, 5 times within %u\n",
                static_cast<unsigned>(slowest), static_cast<unsigned>(slowest_of_five));
    EXPECT_LE(slowest, 20U);
    EXPECT_LE(slowest_of_five, 4U);
    EXPECT_EQ(samples_until_found(random, 1.0, 20e-3), 0U);
}

}  // namespace
}  // namespace axg::test
