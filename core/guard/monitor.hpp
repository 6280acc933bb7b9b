// SPDX-License-Identifier: Apache-2.0
// One cycle's decision as a pure function: same inputs, same outputs, on any machine. It stores no
// state: the guard latches a stop until a person clears it (core/guard/guard_state.hpp).
#pragma once

#include <cstdint>
#include <span>

#include "core/certificate/pair_queries.hpp"
#include "core/certificate/stop_certificate.hpp"
#include "core/collision/containment.hpp"
#include "core/collision/engine.hpp"
#include "core/guard/advisories.hpp"
#include "core/guard/cap_control.hpp"

namespace axg {

enum class StopReason : std::uint8_t {
    none = 0,
    contact,       // a pair not proven farther apart than its margin
    contained,     // a part of one body is inside the other
    predicted,     // a pair without a proof of its margin to standstill
    capacity,      // a fixed list of the engine overflowed: not proven
    engine,        // a result is missing or refused
    known_answer,  // the engine got a query with a known answer wrong
    tool,          // a tool number without a slot
    snapshot,      // positions that can not be placed
    left_path,     // the axes are not on the look-ahead path
    input,         // the receiver gave up (see its fault)
    left_jog,      // the axes left the jog that the board reports
    left_travel,   // the axes are beyond the travel that the model was reduced for
    left_limits,   // an axis broke a declared limit: CycleResult::limit
    left_cap,      // the board broke its promise of a cap: CycleResult::cap_fact
    own_stop,      // the board stops by itself, or an axis only seems to: CycleResult::limit
};
inline constexpr StopReason kStopReasonLast = StopReason::own_stop;
[[nodiscard]] const char* to_text(StopReason reason) noexcept;

/// Whether CycleResult::limit holds details.
[[nodiscard]] constexpr bool has_limit(StopReason reason) noexcept {
    return reason == StopReason::left_limits || reason == StopReason::own_stop;
}

/// How a board breaks its promise of a cap (docs/reference/board.md, "The cap").
enum class CapBreak : std::uint8_t {
    none = 0,
    too_fast,          // an axis came farther than any cap in force allows
    not_acknowledged,  // an order to slow down, without ack for cap_answer_seconds
    unknown_permit,    // the sample names a permit that was not sent
};
[[nodiscard]] const char* to_text(CapBreak kind) noexcept;
struct CapFact {
    CapBreak kind = CapBreak::none;
    std::uint32_t axis = kNoIndex;  // too_fast
};

/// Zeroed memory has no permit.
struct CycleResult {
    bool has_permit = false;
    bool is_stop = false;  // no permit, and earlier permits are withdrawn
    StopReason reason = StopReason::none;
    std::uint32_t pair = kNoIndex;  // Machine::pairs, for contact, contained, predicted, capacity
                                    // and engine
    std::uint32_t not_proven = 0;   // pairs not proven this cycle, stopped or not
    std::uint16_t known_answer_signature = 0;
    std::uint8_t samples = 0;  // n of the permit: the proof holds for this validity
    LimitFact limit{};         // for left_limits and own_stop
    bool is_jog = false;       // proof and permit are only for one axis in one direction
    // With guard.cap: the cap that the permit orders, and that its proof used.
    bool has_cap = false, is_held = false;  // held: for so long that a person must be notified
    CapOrder cap_order{};
    CapFact cap_fact{};       // for left_cap
    Advisories advisories{};  // not by judge: the caller adds them
};

/// @param pair_queries  the queries of this cycle
/// @param results  [pair_queries.count + 2] results of the queries, known-answer test last; may be
/// empty if pair_queries.status is not ok
/// @param containment_results  [pair_queries.count] whether one body of the pair is inside the
/// other; may be empty too
/// @param ready    the receiver trusts its snapshots (VALID): no permit without
[[nodiscard]] CycleResult judge(const PairQueries& pair_queries,
                                std::span<const QueryResult> results,
                                std::span<const ContainmentResult> containment_results,
                                bool ready) noexcept;

/// The same for a certificate: every pair proven to standstill, or a stop. If the guard is not
/// armed, there is no permit to withdraw: a missing proof only withholds the permit, unless the
/// board still reports motion.
/// @param is_armed  a permit of this cycle would be sent
[[nodiscard]] CycleResult judge(const StopCycle& cycle, bool ready, bool is_armed) noexcept;

}  // namespace axg
