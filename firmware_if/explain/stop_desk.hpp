// SPDX-License-Identifier: Apache-2.0
// The stop in force as a person needs it: the pair's distances, an unknown tool, and the ways out
// once the axes rest. The engine is the desk's own, so that a cycle may run in another thread
// meanwhile.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>

#include "core/collision/containment.hpp"
#include "core/collision/cpu_engine.hpp"
#include "firmware_if/explain/why_sentences.hpp"
#include "firmware_if/guard/guard_chain.hpp"
#include "firmware_if/guard/guard_node.hpp"
#include "firmware_if/guard/newest.hpp"
#include "firmware_if/guard/why_desk.hpp"
#include "firmware_if/setup/loaded_machine.hpp"

namespace axg {

/// State of a guard that a thread needs to explain its stop.
struct StopInForce {
    GuardFault cause = GuardFault::none;
    StopReason reason = StopReason::none;
    std::uint32_t pair = kNoIndex;
    std::uint32_t query = 0;    // GuardNode::stop_query
    bool is_confirmed = false;  // the axes rest since
};
[[nodiscard]] StopInForce stop_in_force(const GuardNode& live) noexcept;

struct StopView {
    StopAccount account;
    std::optional<PairWhy> why;
};

class StopDesk {
  public:
    /// `loaded`, `engine` and `containment_test` must outlive it.
    /// @param file  name of the machine file
    StopDesk(const LoadedMachine& loaded, const CpuEngine& engine,
             const ContainmentTest& containment_test, std::string file);

    /// The thread of the engine, when the result is out. No allocation.
    void note(const LiveResult& live_result, const GuardChain& chain) noexcept;
    /// The thread that processes, after each turn. No allocation.
    void set_stop(const GuardNode& live) noexcept { why_.set_stop(live.stop_query()); }

    /// Any thread may call it in phase stopped. Cost: milliseconds and memory in the first call of
    /// a stop, in the first one at rest, and in each one that finds the axes elsewhere.
    [[nodiscard]] StopView view(const StopInForce& stop);
    /// Tool number of the newest sample; empty: there was none.
    [[nodiscard]] std::optional<std::uint16_t> tool() const noexcept;
    /// Any thread may call it: distances of a withheld permit. No allocation.
    [[nodiscard]] std::optional<PairWhy> withheld(const WithheldPermit& withheld) noexcept;

  private:
    [[nodiscard]] WhyFacts facts_of(const PairWhy& why, std::uint32_t pair) const;
    [[nodiscard]] const std::string& ways_out(const StopInForce& stop);

    const LoadedMachine& loaded_;
    const ContainmentTest& containment_test_;
    std::string file_;
    std::optional<CpuEngine> engine_;  // empty: memory ran out, and there are no distances
    WhyDesk why_;
    std::atomic<std::int32_t> tool_{-1};          // of the newest sample; -1: none yet
    std::atomic<std::int32_t> unknown_tool_{-1};  // of the newest sample; -1: the file has its tool
    Newest<AxisSnapshot> newest_;
    std::mutex reading_;  // no thread with a deadline takes it
    AxisSnapshot snapshot_;
    bool has_snapshot_ = false;
    std::uint32_t left_query_ = 0;  // of the stop that `ways_out_` is for; 0: none
    AxisSnapshot left_;             // where they lead out of
    std::string ways_out_;
};

}  // namespace axg
