// SPDX-License-Identifier: Apache-2.0
// The stop in force as a person needs it, for axg_guard_explain: the pair's distances, an unknown
// tool, and the ways out once the axes rest. The engine is the desk's own, so that a cycle may run
// in another thread meanwhile.
#pragma once

#include <atomic>
#include <cstdint>
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

    /// The thread that processes, in phase stopped. Cost: milliseconds and memory in the first call
    /// of a stop, and in the first one after the axes came to rest.
    [[nodiscard]] StopView view(const GuardNode& live);

  private:
    [[nodiscard]] WhyFacts facts_of(const PairWhy& why, std::uint32_t pair) const;

    const LoadedMachine& loaded_;
    const ContainmentTest& containment_test_;
    std::string file_;
    std::optional<CpuEngine> engine_;  // empty: memory ran out, and there are no distances
    WhyDesk why_;
    std::atomic<std::int32_t> unknown_tool_{-1};  // of the newest sample; -1: the file has its tool
    Newest<AxisSnapshot> newest_;
    AxisSnapshot snapshot_;
    bool has_snapshot_ = false;
    std::int64_t stop_us_ = -1;  // of the stop that `ways_out_` is for; -1: none
    std::string ways_out_;
};

}  // namespace axg
