// SPDX-License-Identifier: Apache-2.0
// The state of a guard for threads without its deadline: each requests a copy, and the bus thread,
// which reads one flag a turn, leaves it there.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <type_traits>

#include "core/guard/guard_state.hpp"
#include "firmware_if/guard/guard_node.hpp"
#include "firmware_if/guard/spsc_queue.hpp"
#include "firmware_if/receiver/axis_receiver.hpp"

namespace axg {

/// Names of the checks of an admission, in its order.
inline constexpr std::array kAdmissionNames{"system", "latency",      "engine",
                                            "cycle",  "known_answer", "memory"};

/// Verdict of the admission at the start, one bit a check in the order of kAdmissionNames.
struct AdmissionGauge {
    bool is_fit = false;
    double margin = 0;
    std::uint32_t failed = 0;  // those that a person waived: there is no guard otherwise
};

/// The bus thread's copy of its state for other threads.
struct LiveView {
    GuardPhase phase = GuardPhase::stopped;
    GuardFault cause = GuardFault::none;
    LiveCounters counters;
    ReceiverCounters input;
    std::uint64_t frames_dropped = 0;
    std::int64_t time_us = 0, phase_us = 0;  // of this view; when the phase began
    StopReason reason = StopReason::none;    // of the newest stop, and its pair
    std::uint32_t pair = kNoIndex;
    std::uint32_t stop_query = 0;   // GuardNode::stop_query
    std::int32_t program_line = 0;  // of the control, at the stop; 0: not reported
    WithheldPermit withheld;
    bool stands = false, is_confirmed = false, has_session = false;
    std::optional<AdmissionGauge> admission;  // at the start; empty: there was none
    bool compares_hashes = true;
};
static_assert(std::is_trivially_copyable_v<LiveView>);

/// Between the bus thread and one other.
struct ViewExchange {
    std::atomic<bool> is_wanted{false};
    SpscQueue<LiveView, 2> views{};
};

/// Called by the bus thread once a turn.
/// @param view  creates the view; called only on a request
template <class MakeView>
void answer(ViewExchange& exchange, const MakeView& view) noexcept {
    if (exchange.is_wanted.exchange(false)) {
        // Full if the other thread timed out: it requests again.
        [[maybe_unused]] const bool is_pushed = exchange.views.push(view());
    }
}

}  // namespace axg
