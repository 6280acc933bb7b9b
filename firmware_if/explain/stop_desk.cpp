// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/explain/stop_desk.hpp"

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

}  // namespace

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

StopView StopDesk::view(const GuardNode& live) {
    const Machine& machine = loaded_.machine;
    StopView out;
    out.account.cause = live.guard().cause;
    out.account.reason = live.reason();
    out.account.file = file_;
    const std::uint32_t pair = live.pair();
    const bool has_pair = live.guard().cause == GuardFault::verdict && pair < machine.pairs.size();
    if (has_pair) {
        out.account.a = machine.bodies[machine.pairs[pair].a].name;
        out.account.b = machine.bodies[machine.pairs[pair].b].name;
        out.why = why_.why(live.stop_query(), {}).stop;
    }
    if (out.why) {
        out.account.why = facts_of(*out.why, pair);
    }
    if (const std::int32_t tool = unknown_tool_.load(); tool >= 0) {
        out.account.unknown_tool = static_cast<std::uint16_t>(tool);
        return out;  // no way out is proven with it
    }
    has_snapshot_ = newest_.take(snapshot_) || has_snapshot_;
    if (has_pair && engine_ && has_snapshot_ && live.guard().is_confirmed) {
        if (stop_us_ != live.phase_us()) {
            stop_us_ = live.phase_us();
            ways_out_ = format_escapes(
                machine, find_escapes(loaded_, engine_->engine(), containment_test_, snapshot_),
                Detail::brief);
        }
        out.account.ways_out = ways_out_;
    }
    return out;
}

}  // namespace axg
