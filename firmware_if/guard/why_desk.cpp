// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/guard/why_desk.hpp"

#include <cmath>

namespace axg {
namespace {

/// Whether more distance between the pair would remove this reason.
bool is_about_distance(StopReason reason) noexcept {
    return reason == StopReason::contact || reason == StopReason::predicted ||
           reason == StopReason::capacity;
}

bool is_before(std::uint32_t a, std::uint32_t b) noexcept {
    return static_cast<std::int32_t>(a - b) < 0;
}

}  // namespace

std::optional<PairWhy> pair_why(const Machine& machine, const Engine& engine,
                                const RefusedCycle& cycle, PairQueries& room) noexcept {
    const UnprovenPair& unproven = cycle.unproven;
    if (engine.run == nullptr || cycle.pair == kNoIndex || !is_about_distance(cycle.reason) ||
        unproven.is_blind) {
        return std::nullopt;
    }
    PairWhy out;
    if (unproven.is_known) {
        out = {.tool = unproven.tool,
               .is_whole = unproven.is_whole,
               .is_list_full = is_overflow(unproven.result.status),
               .is_jog = unproven.is_jog,
               .distances = pair_distances(machine, engine, unproven)};
    } else {
        const auto query = cycle.reason == StopReason::predicted
                               ? std::nullopt
                               : pose_query(machine, cycle.snapshot, cycle.pair, room);
        if (!query) {
            return std::nullopt;
        }
        out = {.is_pose = true,
               .is_list_full = cycle.reason == StopReason::capacity,
               .distances = pose_distances(engine, *query)};
    }
    return std::isfinite(out.distances.need.sum_mm()) ? std::optional(out) : std::nullopt;
}

WhyDesk::WhyDesk(const Machine& machine, Engine engine)
    : machine_(machine), engine_(engine), room_(std::make_unique<PairQueries>()) {}

void WhyDesk::note(const LiveResult& live_result, const GuardChain& chain) noexcept {
    if (live_result.kind != LiveQuery::Kind::snapshot) {
        return;
    }
    const CycleResult& result = live_result.result;
    // The first of several stops in a row is the one that the guard obeyed; a reset ends the row.
    const bool goes_on = was_stop_ && live_result.epoch == stop_epoch_;
    was_stop_ = result.is_stop;
    stop_epoch_ = live_result.epoch;
    if (result.has_permit || result.pair == kNoIndex) {
        return;
    }
    RefusedCycle cycle = chain.refused(result);
    cycle.query = live_result.number;
    withheld_.write(cycle);
    const std::uint32_t in_force = stop_in_force_.load(std::memory_order_relaxed);
    if (result.is_stop && !goes_on && (in_force == 0 || in_force != written_stop_)) {
        written_stop_ = cycle.query;
        stops_.write(cycle);
    }
}

void WhyDesk::read(Newest<RefusedCycle>& from, Known& known) noexcept {
    if (from.take(known.cycle)) {
        known.is_computed = false;
    }
}

const std::optional<PairWhy>& WhyDesk::why_of(Known& known) noexcept {
    if (!known.is_computed) {
        known.why = pair_why(machine_, engine_, known.cycle, *room_);
        known.is_computed = true;
    }
    return known.why;
}

GuardWhy WhyDesk::why(std::uint32_t stop, const WithheldPermit& withheld) noexcept {
    read(stops_, known_stop_);
    read(withheld_, known_withheld_);
    GuardWhy out;
    if (stop != 0 && known_stop_.cycle.query == stop) {
        out.stop = why_of(known_stop_);
    }
    const RefusedCycle& newest = known_withheld_.cycle;
    // Cycles continue during this call: a newer one with the same pair and reason will do.
    const bool is_same = withheld.why == WithheldPermit::Why::not_proven &&
                         withheld.pair != kNoIndex && newest.pair == withheld.pair &&
                         newest.reason == withheld.reason;
    if (is_same && newest.query != 0 && !is_before(newest.query, withheld.query)) {
        out.withheld = why_of(known_withheld_);
    }
    return out;
}

}  // namespace axg
