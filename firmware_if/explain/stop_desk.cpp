// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/explain/stop_desk.hpp"

#include <cmath>
#include <utility>

#include "firmware_if/explain/format_escapes.hpp"

namespace axg {
namespace {

std::string body_name(const Machine& machine, std::uint32_t index, std::uint32_t tool) {
    const Body& body = machine.bodies[index];
    return body.is_tool && tool < machine.tools.size()
               ? body.name + " (tool " + std::to_string(machine.tools[tool].number) + ")"
               : body.name;
}

/// Mm or rad. A jog out is found again for axes that moved more; noise of encoders is less.
constexpr double kMoved = 0.01;

bool has_moved(const Machine& machine, const AxisSnapshot& from, const AxisSnapshot& to) noexcept {
    bool moved = from.tool != to.tool;
    for (std::size_t axis = 0; axis < machine.axes.size(); ++axis) {
        moved = moved || !(std::abs(to.position[axis] - from.position[axis]) <= kMoved);
    }
    return moved;
}

}  // namespace

StopInForce stop_in_force(const GuardNode& live) noexcept {
    return {.cause = live.guard().cause,
            .reason = live.reason(),
            .pair = live.pair(),
            .query = live.stop_query(),
            .is_confirmed = live.guard().is_confirmed};
}

StopDesk::StopDesk(const LoadedMachine& loaded, const CpuEngine& engine,
                   const ContainmentTest& containment_test, std::string file)
    : loaded_(loaded),
      containment_test_(containment_test),
      file_(std::move(file)),
      engine_(CpuEngine::over_trees(engine.trees(), loaded.machine.capacities)),
      why_(loaded.machine, engine_ ? engine_->engine() : Engine{}) {}

void StopDesk::note(const LiveResult& live_result, const GuardChain& chain) noexcept {
    why_.note(live_result, chain);
    if (live_result.kind == LiveQuery::Kind::snapshot) {
        const AxisSnapshot& snapshot = chain.snapshot();
        tool_.store(snapshot.tool);
        unknown_tool_.store(live_result.result.reason == StopReason::tool ? snapshot.tool : -1);
        newest_.write(snapshot);
    }
}

WhyFacts StopDesk::facts_of(const PairWhy& why, std::uint32_t pair) const {
    const Machine& machine = loaded_.machine;
    return {.cause = why.is_list_full ? WhyCause::capacity
                     : why.is_pose    ? WhyCause::margin
                                      : WhyCause::not_proven,
            .a = body_name(machine, machine.pairs[pair].a, why.tool),
            .b = body_name(machine, machine.pairs[pair].b, why.tool),
            .is_of_stop = !why.is_pose,
            .available_mm = why.distances.available_mm,
            .needed_mm = why.distances.need.sum_mm(),
            .margin_mm = why.distances.need.margin_mm};
}

const std::string& StopDesk::ways_out(const StopInForce& stop) {
    if (left_query_ != stop.query || has_moved(loaded_.machine, left_, snapshot_)) {
        left_query_ = stop.query;
        left_ = snapshot_;
        ways_out_ = format_escapes(
            loaded_.machine, find_escapes(loaded_, engine_->engine(), containment_test_, snapshot_),
            Detail::brief);
    }
    return ways_out_;
}

StopView StopDesk::view(const StopInForce& stop) {
    const std::lock_guard lock(reading_);
    const Machine& machine = loaded_.machine;
    StopView out;
    out.account.cause = stop.cause;
    out.account.reason = stop.reason;
    out.account.file = file_;
    const bool has_pair = stop.cause == GuardFault::verdict && stop.pair < machine.pairs.size();
    if (has_pair) {
        out.account.a = machine.bodies[machine.pairs[stop.pair].a].name;
        out.account.b = machine.bodies[machine.pairs[stop.pair].b].name;
        out.why = why_.why(stop.query, {}).stop;
    }
    if (out.why) {
        out.account.why = facts_of(*out.why, stop.pair);
    }
    if (const std::int32_t tool = unknown_tool_.load(); tool >= 0) {
        out.account.unknown_tool = static_cast<std::uint16_t>(tool);
        return out;  // no way out is proven with it
    }
    has_snapshot_ = newest_.take(snapshot_) || has_snapshot_;
    if (has_pair && engine_ && has_snapshot_ && stop.is_confirmed) {
        out.account.ways_out = ways_out(stop);
    }
    return out;
}

std::optional<std::uint16_t> StopDesk::tool() const noexcept {
    const std::int32_t tool = tool_.load();
    return tool < 0 ? std::nullopt : std::optional(static_cast<std::uint16_t>(tool));
}

std::optional<PairWhy> StopDesk::withheld(const WithheldPermit& withheld) noexcept {
    const std::lock_guard lock(reading_);
    return why_.why(0, withheld).withheld;
}

}  // namespace axg
