// SPDX-License-Identifier: Apache-2.0
#include "core/guard/speed_advisory.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/base/assert.hpp"
#include "core/certificate/steered_samples.hpp"
#include "core/guard/order_list.hpp"
#include "core/machine/cycle_plan.hpp"

namespace axg {

double cap_lead_seconds(const Machine& machine) noexcept {
    double half_turn_s = 0;
    for (const Axis& axis : machine.axes) {
        half_turn_s = std::max(half_turn_s, axis.acceleration_max / axis.jerk_max);
    }
    return machine.guard.cap_lead_s + half_turn_s;
}

namespace {

constexpr std::uint32_t kFeeds = 8;  // tried in one call
constexpr std::uint32_t kRise = 8;   // a cap may rise to twice its value and this
using Feeds = std::array<std::uint32_t, kFeeds>;
using AxisRanges = std::array<AxisRange, kAxesMax>;

/// Mirrors the motion of an axis: its way forwards becomes the way back.
AxisRange mirrored(const AxisRange& now) noexcept {
    return {-now.high,
            -now.low,
            -now.speed_high,
            -now.speed_low,
            -now.acceleration_high,
            -now.acceleration_low};
}

struct Going {
    double way, speed, acceleration;
};

/// Motion of an axis that goes on for a time as now, and is then no faster than `fastest`. An
/// acceleration lasts up to that speed; a deceleration eases off at the axis' jerk, and does not
/// reverse the axis. A faster axis goes on until it obeys its cap.
Going go_on(double speed, double acceleration, double jerk, double fastest, double time) noexcept {
    if (speed < 0) {
        const double end = std::clamp(speed + acceleration * time, -fastest, 0.0);
        return {0, end, end < 0 && end > -fastest ? acceleration : 0};
    }
    if (acceleration < 0) {
        const double t = std::min(time, -acceleration / jerk);
        const double end = speed + t * (acceleration + 0.5 * jerk * t);
        if (end <= 0) {
            return {0.5 * speed * speed / -acceleration, 0, 0};
        }
        const double easing = t * (speed + t * (0.5 * acceleration + t * jerk / 6));
        const double way = easing + end * (time - t);
        return end < fastest ? Going{way, end, acceleration + jerk * t} : Going{way, fastest, 0};
    }
    const double most = std::max(speed, fastest);
    const double uncapped = speed + acceleration * time;
    const double end = std::min(uncapped, most);
    const double capped_s = uncapped > most ? (uncapped - most) / acceleration : 0;
    const double way = 0.5 * (speed + end) * (time - capped_s) + most * capped_s;
    // The acceleration falls to 0 before the speed reaches the cap.
    const double room = std::max(0.0, fastest - end);
    return {way, std::min(end, fastest), std::min(acceleration, std::sqrt(2 * jerk * room))};
}

/// How far forwards an axis gets that goes on for `lead_s` and then stops as the certificate
/// allows. A later sample will bound its speed and acceleration no worse than this one does.
double capped_distance(const AxisLimits& limits, const AxisRange& now, double fastest,
                       double lead_s, double free_s) noexcept {
    const double speed = 0.5 * (now.speed_low + now.speed_high);
    const double acceleration = 0.5 * (now.acceleration_low + now.acceleration_high);
    const Going end = go_on(speed, acceleration, limits.jerk_max, fastest, lead_s);
    const double slack =
        0.5 * (now.speed_high - now.speed_low) + kPeriodShare * std::fabs(end.speed - speed);
    const double unknown = 0.5 * (now.acceleration_high - now.acceleration_low);
    return end.way + forward_reach(limits, end.speed - slack, end.speed + slack, free_s,
                                   end.acceleration + unknown);
}

AxisRanges ranges_of(const Machine& machine, const StopCertificate& certificate,
                     AxisRange (StopCertificate::*range_of)(std::uint32_t)
                         const noexcept) noexcept {
    AxisRanges ranges;
    for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
        ranges[i] = (certificate.*range_of)(i);
    }
    return ranges;
}

JointBox capped_box(const Machine& machine, const AxisRanges& ranges, double share) noexcept {
    const double free_s = free_seconds(machine, machine.can.permit_samples.least);
    const double lead_s = cap_lead_seconds(machine);
    JointBox box;
    for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
        const Axis& axis = machine.axes[i];
        const AxisRange& now = ranges[i];
        AxisLimits limits = stop_limits(machine, i);
        // The axis can not follow a cap that falls faster than this.
        limits.stopping_min = std::min(limits.stopping_min, limits.acceleration_max);
        const double speed = share * axis.speed_max;
        double low = now.low - capped_distance(limits, mirrored(now), speed, lead_s, free_s);
        double high = now.high + capped_distance(limits, now, speed, lead_s, free_s);
        if (machine.guard.travel_enforced && !axis.unlimited) {
            low = std::max(low, std::min(axis.min, now.low));
            high = std::min(high, std::max(axis.max, now.high));
        }
        box.centre[i] = 0.5 * (low + high);
        box.half[i] = std::max(high - box.centre[i], box.centre[i] - low);
    }
    return box;
}

double share_of(std::uint32_t feed) noexcept {
    return static_cast<double>(feed) / kSpeedCapRapid;
}

/// Returns the value of a range that is nearest to 0; 0 if the range contains 0.
double certain(double low, double high) noexcept {
    return low > 0 ? low : high < 0 ? high : 0;
}

constexpr double kOrderLead = 2;

struct AxisFuture {
    double fastest = 0;  // by the order
    double growth = 1;   // OrderTried::growth
    double lead_s = 0, free_s = 0;
};

/// Computes the reach of an axis from its place at the time when the order comes into force. The
/// proof with the present order covers the way to that place.
void put_place(AxisLimits limits, const AxisRange& now, const AxisFuture& future, double& low,
               double& high) noexcept {
    const double middle = 0.5 * (now.speed_low + now.speed_high);
    const double known = certain(now.acceleration_low, now.acceleration_high);
    const double sign = middle < 0 || (middle == 0 && known < 0) ? -1 : 1;
    const double speed = sign * middle;
    Going end = go_on(speed, sign * known, limits.jerk_max, future.fastest, future.lead_s);
    const double most = std::min(future.fastest, future.growth * speed);
    const double faster = std::min(most, speed + limits.acceleration_max * future.lead_s);
    if (future.growth > 1 && faster > end.speed) {
        end = {0.5 * (speed + faster) * future.lead_s, faster,
               faster < most ? limits.acceleration_max : 0};
    }
    const double slack =
        0.5 * (now.speed_high - now.speed_low) + kPeriodShare * std::fabs(end.speed - speed);
    const double unknown = 0.5 * (now.acceleration_high - now.acceleration_low);
    const double then = sign * end.speed, pull = sign * end.acceleration;
    limits.speed_max = std::min(limits.speed_max, future.fastest);
    high = now.high + sign * end.way +
           forward_reach(limits, then - slack, then + slack, future.free_s, pull + unknown);
    low = now.low + sign * end.way -
          forward_reach(limits, -then - slack, -then + slack, future.free_s, unknown - pull);
}

/// Time from an order to slow down until the board acknowledges it: a planner averages its speed
/// for as long as the softest axis needs to reverse its acceleration. Longer leads cost more time.
/// An order waits for kCapPatience cycles.
double order_lead_seconds(const Machine& machine) noexcept {
    return kOrderLead * cap_lead_seconds(machine) + kCapPatience * machine.can.sample_us * 1e-6;
}

JointBox ordered_box(const Machine& machine, const AxisRanges& ranges,
                     const OrderTried& tried) noexcept {
    const AxisCaps caps = caps_of_permit(tried.order.cap, tried.order.mask);
    const double free_s = free_seconds(machine, samples_steered(machine.can.permit_samples));
    JointBox box;
    for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
        const Axis& axis = machine.axes[i];
        double low = 0, high = 0;
        put_place(stop_limits(machine, i), ranges[i],
                  {.fastest = share_of(caps[i]) * axis.speed_max,
                   .growth = tried.growth,
                   .lead_s = order_lead_seconds(machine),
                   .free_s = free_s},
                  low, high);
        if (machine.guard.travel_enforced && !axis.unlimited) {
            low = std::max(low, std::min(axis.min, ranges[i].low));
            high = std::min(high, std::max(axis.max, ranges[i].high));
        }
        box.centre[i] = 0.5 * (low + high);
        box.half[i] = std::max(0.0, high - box.centre[i]);
    }
    return box;
}

OrderList orders_about(const Machine& machine, const AxisRanges& ranges,
                       const CapOrder& order) noexcept {
    std::array<double, kAxesMax> uses{};
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const double speed = 0.5 * std::fabs(ranges[i].speed_low + ranges[i].speed_high);
        uses[i] = kSpeedCapRapid * speed / machine.axes[i].speed_max;
    }
    return list_orders({uses.data(), machine.axes.size()}, order,
                       machine.guard.cap == CapPromise::per_axis);
}

std::uint32_t fastest_after(std::uint32_t last) noexcept {
    return std::min(kSpeedCapRapid, 2 * last + kRise);
}

/// Feeds to try after a cap of `last`, the fastest first: close to it, and far.
/// @return  how many
std::uint32_t feeds_about(std::uint32_t last, Feeds& out) noexcept {
    const std::uint32_t most = fastest_after(last);
    const Feeds wanted{most,     last + (most - last) / 4, last + 1 + last / 64,
                       last,     last - last / 32,         last - last / 8,
                       last / 2, std::max(1U, last / 8)};
    std::uint32_t count = 0;
    for (const std::uint32_t feed : wanted) {
        if (feed > 0 && feed <= most && (count == 0 || feed < out[count - 1])) {
            out[count++] = feed;
        }
    }
    return count;
}

}  // namespace

JointBox capped_reach(const Machine& machine, const StopCertificate& certificate,
                      double share) noexcept {
    return capped_box(machine, ranges_of(machine, certificate, &StopCertificate::now), share);
}

std::optional<SpeedAdvisory> SpeedAdvisory::create(const Machine& machine) {
    const std::uint32_t pairs = stop_tasks(machine);
    const bool is_ordered = machine.guard.cap != CapPromise::none;
    const std::uint32_t tasks = pairs * (is_ordered ? kOrdersTried : kFeeds);
    const std::uint32_t queries = queries_of(cycle_plan(machine, pairs));
    auto prover = JointBoxProver::create(
        machine, tasks,
        {.rounds = is_ordered ? kOrderRounds : kAdvisoryRounds, .queries = queries});
    Arena arena(Arena::size_bytes<JointBoxTask>(tasks) + Arena::size_bytes<JointBoxResult>(tasks) +
                Arena::size_bytes<std::uint32_t>(pairs));
    if (!prover || !arena.ok()) {
        return std::nullopt;
    }
    SpeedAdvisory advisory(machine, std::move(*prover), std::move(arena));
    advisory.tasks_ = advisory.arena_.take<JointBoxTask>(tasks);
    advisory.results_ = advisory.arena_.take<JointBoxResult>(tasks);
    advisory.open_ = advisory.arena_.take<std::uint32_t>(pairs);
    advisory.arena_.seal();
    return advisory;
}

void SpeedAdvisory::prove(const Engine& engine, std::uint32_t tasks,
                          const JointBoxSpend& spend) noexcept {
    queries_count_ += prover_.prove(engine, tasks_.first(tasks), results_, spend).queries;
}

void SpeedAdvisory::update(const Engine& engine, const StopCertificate& certificate,
                           std::uint32_t queries) noexcept {
    queries_count_ = 0;
    const std::uint32_t last = cap_;
    cap_ = 0;
    const StopCycle cycle = certificate.cycle();
    is_known_ = cycle.status == SnapshotStatus::ok && cycle.is_settled && !cycle.is_jog;
    if (is_known_ && certificate.tasks().size() <= queries) {
        cap_ = search(engine, certificate, last, queries);
    }
}

/// Returns the fastest proven feed of those tried; 0: none. The box of a faster feed contains that
/// of a slower one, so a proof of a pair with the fastest holds for all.
std::uint8_t SpeedAdvisory::search(const Engine& engine, const StopCertificate& certificate,
                                   std::uint32_t last, std::uint32_t queries) noexcept {
    const std::span<const JointBoxTask> pairs = certificate.tasks();
    AXG_ASSERT(pairs.size() <= open_.size());
    const AxisRanges ranges = ranges_of(*machine_, certificate, &StopCertificate::now);
    Feeds feeds{};
    const std::uint32_t feed_count = feeds_about(last, feeds);
    const JointBox widest = capped_box(*machine_, ranges, share_of(feeds[0]));
    const std::uint32_t open = prove_widest(engine, widest, pairs, queries);
    if (open == 0) {
        return static_cast<std::uint8_t>(feeds[0]);
    }
    queries -= queries_count_;
    // Without a query for each, the search skips the fastest.
    const std::uint32_t first = feed_count - std::min(feed_count, queries / open);
    std::uint32_t tasks = 0;
    for (std::uint32_t feed = first; feed < feed_count; ++feed) {
        const JointBox box = capped_box(*machine_, ranges, share_of(feeds[feed]));
        for (std::uint32_t i = 0; i < open; ++i) {
            put(tasks++, pairs[open_[i]], box);
        }
    }
    prove(engine, tasks, {.queries = queries});
    for (std::uint32_t feed = first; feed < feed_count; ++feed) {
        if (are_proven((feed - first) * open, open)) {
            return static_cast<std::uint8_t>(feeds[feed]);
        }
    }
    return 0;
}

void SpeedAdvisory::put(std::uint32_t at, const JointBoxTask& pair, const JointBox& box) noexcept {
    tasks_[at] = pair;
    tasks_[at].box = box;
    tasks_[at].pieces = {};
}

bool SpeedAdvisory::are_proven(std::uint32_t first, std::uint32_t count) const noexcept {
    const auto of = results_.subspan(first, count);
    return std::all_of(of.begin(), of.end(), [](const JointBoxResult& result) {
        return result.proof == JointBoxProof::proven;
    });
}

/// Makes one query a pair: a proof holds for every box inside. Returns how many stay open.
std::uint32_t SpeedAdvisory::prove_widest(const Engine& engine, const JointBox& widest,
                                          std::span<const JointBoxTask> pairs,
                                          std::uint32_t queries) noexcept {
    const auto count = static_cast<std::uint32_t>(pairs.size());
    for (std::uint32_t i = 0; i < count; ++i) {
        put(i, pairs[i], widest);
    }
    prove(engine, count, {.rounds = 1, .queries = queries});
    std::uint32_t open = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        if (results_[i].proof != JointBoxProof::proven) {
            open_[open++] = i;
        }
    }
    return open;
}

void SpeedAdvisory::update_order(const Engine& engine, const StopCertificate& certificate,
                                 std::uint32_t queries, const CapOrder& order) noexcept {
    queries_count_ = 0;
    const StopCycle cycle = certificate.cycle();
    is_known_ = cycle.status == SnapshotStatus::ok && cycle.is_settled && !cycle.is_jog;
    wish_ = {.best = {.cap = kCapCrawl, .mask = kMaskOfAll},
             .is_kept_fine = false,
             .is_any_proven = false};
    if (is_known_ && certificate.tasks().size() <= queries) {
        wish_ = search_orders(engine, certificate, queries, order);
    }
    cap_ = wish_.is_any_proven ? wish_.best.cap : std::uint8_t{0};
}

/// Returns the first proven order, which costs least, and whether the last order is proven.
CapWish SpeedAdvisory::search_orders(const Engine& engine, const StopCertificate& certificate,
                                     std::uint32_t queries, const CapOrder& order) noexcept {
    const std::span<const JointBoxTask> pairs = certificate.tasks();
    AXG_ASSERT(pairs.size() <= open_.size());
    // An order cannot slow down announced motion.
    const AxisRanges ranges = ranges_of(*machine_, certificate, &StopCertificate::announced);
    const OrderList list = orders_about(*machine_, ranges, order);
    const OrderTried rapid{.growth = list.is_slowed ? kAnyGrowth : 1};
    const std::uint32_t open =
        prove_widest(engine, ordered_box(*machine_, ranges, rapid), pairs, queries);
    if (open == 0) {
        return {};
    }
    queries -= queries_count_;
    // Without a query for each, the search skips those that cost least.
    const std::uint32_t first = list.count - std::min(list.count, queries / open);
    std::uint32_t tasks = 0;
    for (std::uint32_t at = first; at < list.count; ++at) {
        const JointBox box = ordered_box(*machine_, ranges, list.of[at]);
        for (std::uint32_t i = 0; i < open; ++i) {
            put(tasks++, pairs[open_[i]], box);
        }
    }
    prove(engine, tasks, {.queries = queries});
    CapWish wish{.best = {.cap = kCapCrawl, .mask = kMaskOfAll},
                 .is_kept_fine = false,
                 .is_any_proven = false};
    for (std::uint32_t at = first; at < list.count; ++at) {
        if (!are_proven((at - first) * open, open)) {
            continue;
        }
        const CapOrder& proven = list.of[at].order;
        wish.best = wish.is_any_proven ? wish.best : proven;
        wish.is_any_proven = true;
        wish.is_kept_fine =
            wish.is_kept_fine || is_within(order, caps_of_permit(proven.cap, proven.mask));
    }
    return wish;
}

}  // namespace axg
