// SPDX-License-Identifier: Apache-2.0
// Why the guard stopped, or withholds the permit, in distances. The engine thread leaves a copy of
// each cycle without a permit when its result is out; the status thread computes from the copies,
// with an engine of its own. The bus thread stores one number.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>

#include "core/collision/engine.hpp"
#include "core/guard/distance_need.hpp"
#include "core/machine/machine.hpp"
#include "firmware_if/guard/guard_chain.hpp"
#include "firmware_if/guard/guard_node.hpp"
#include "firmware_if/guard/newest.hpp"

namespace axg {

/// Distances of one pair that was not proven.
struct PairWhy {
    std::uint32_t tool = kNoIndex;  // Machine::tools; kNoIndex: none in this proof
    bool is_pose = false;           // contact mode: the sampled pose alone, without motion
    bool is_whole = false;          // need.until_braking_mm is the whole reach
    bool is_list_full = false;      // of the engine, in that proof
    bool is_jog = false;            // need.margin_mm is the floor of the jog
    PairDistances distances;
};
/// Empty: not about the distance of a pair, or not available.
struct GuardWhy {
    std::optional<PairWhy> stop, withheld;
};

/// Empty: the cycle is not about the distance of a pair, or had too little data on the motion.
/// @param room  for the queries of a pose
[[nodiscard]] std::optional<PairWhy> pair_why(const Machine& machine, const Engine& engine,
                                              const RefusedCycle& cycle,
                                              PairQueries& room) noexcept;

class WhyDesk {
  public:
    /// `machine` must outlive it, and so must `engine`, which no other thread may use.
    /// @param engine  without a function every result is empty
    WhyDesk(const Machine& machine, Engine engine);

    /// The engine thread, when the result is out. No allocation.
    /// Cost: a few copies of RefusedCycle, and those only without a permit.
    void note(const LiveResult& live_result, const GuardChain& chain) noexcept;

    /// The bus thread: the query whose verdict is the stop in force; 0: none.
    void set_stop(std::uint32_t query) noexcept {
        stop_in_force_.store(query, std::memory_order_relaxed);
    }

    /// The status thread. No allocation.
    /// @param stop  the query passed to set_stop()
    [[nodiscard]] GuardWhy why(std::uint32_t stop, const WithheldPermit& withheld) noexcept;

  private:
    /// A cycle, and its distances once they were computed.
    struct Known {
        RefusedCycle cycle;
        bool is_computed = false;
        std::optional<PairWhy> why;
    };
    void read(Newest<RefusedCycle>& from, Known& known) noexcept;
    [[nodiscard]] const std::optional<PairWhy>& why_of(Known& known) noexcept;

    const Machine& machine_;
    Engine engine_;
    Newest<RefusedCycle> stops_, withheld_;
    std::atomic<std::uint32_t> stop_in_force_{0};
    // The engine thread's: the result before, and the query that it wrote last as a stop.
    bool was_stop_ = false;
    std::uint32_t stop_epoch_ = 0, written_stop_ = 0;
    // The status thread's.
    Known known_stop_, known_withheld_;
    std::unique_ptr<PairQueries> room_;
};

}  // namespace axg
