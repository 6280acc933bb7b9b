// SPDX-License-Identifier: Apache-2.0
// Frames in, coherent axis snapshots out; everything else is a fault with one name and one
// reaction. Common to all formats; set-up makes the assembler of the format (assembler.hpp). Fed
// frame by frame and by a clock tick; bounded work, no allocation, no clock. Rules and fault table:
// docs/reference/protocol.md. Tests: tests/unit/firmware_if/receiver/README.md.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/machine/axis_snapshot.hpp"
#include "firmware_if/protocol/axis_frames.hpp"
#include "firmware_if/receiver/assembler.hpp"
#include "firmware_if/receiver/frame_gate.hpp"
#include "firmware_if/receiver/period_watch.hpp"
#include "firmware_if/receiver/received_samples.hpp"
#include "firmware_if/receiver/receiver_faults.hpp"
#include "firmware_if/receiver/session_watch.hpp"
#include "firmware_if/receiver/snapshot_check.hpp"

namespace axg {

// The leaky count of lost samples tolerates one in four for ever, but not one in three; twenty in a
// row stop at once.
inline constexpr std::uint32_t kLossWeight = 3;  // added by a lost sample; a good one subtracts 1
inline constexpr std::uint32_t kLossLimit = 60;

/// INVALID ends only by acknowledge(). Only VALID allows a permit.
enum class ReceiverState : std::uint8_t { invalid = 0, init, valid };
[[nodiscard]] const char* to_text(ReceiverState state) noexcept;

struct ReceiverEvent {
    enum class Kind : std::uint8_t { none, snapshot, fault, look_ahead };
    Kind kind = Kind::none;
    ReceiverFault fault = ReceiverFault::none;
    Severity severity = Severity::ignore;
    ReceiverState state = ReceiverState::invalid;  // after the call
    std::uint8_t sync_counter = 0;  // snapshot: SYNC counter of its sample, the permit's echo
    std::uint32_t axis = kNoIndex;  // fault: the axis concerned, if one is
    std::uint32_t frame_id = 0;     // fault: the frame that showed it; 0: the clock did
    std::int64_t time_us = 0;
    std::uint32_t samples_lost = 0;  // snapshot: samples missing between the last one and this
    AxisSnapshot snapshot;           // valid for kind snapshot
    PathPoints look_ahead;  // valid for kind look_ahead: samples counted as in the snapshots
};

struct ReceiverCounters {
    std::uint64_t frames = 0;           // all frames seen
    std::uint64_t foreign = 0;          // frames with ids that are not ours
    std::uint64_t snapshots = 0;        // handed out
    std::uint64_t look_ahead = 0;       // frames of the look-ahead path handed out
    std::uint64_t late = 0;             // of those, complete only after the period had passed
    std::uint64_t samples_lost = 0;     // never handed out, between snapshots
    std::uint64_t estimated = 0;        // snapshots whose SYNC was lost: latch instant extrapolated
    std::uint64_t clock_steps = 0;      // frames whose stamp was before the clock
    std::uint64_t ignored_invalid = 0;  // frames that came while INVALID
    // The mean period of the last window that proved or refuted the declared one; 0: none did.
    std::int64_t measured_period_ns = 0;
    std::array<std::uint64_t, kReceiverFaults> faults{};

    [[nodiscard]] std::uint64_t of(ReceiverFault fault) const noexcept {
        return faults[static_cast<std::size_t>(fault)];
    }
};

/// Sums of two receivers that ran one after the other.
[[nodiscard]] ReceiverCounters operator+(ReceiverCounters a, const ReceiverCounters& b) noexcept;

/// How the receiver judges the board's period (rule 6).
enum class PeriodUse : std::uint8_t {
    supposed = 0,  // a period shown to be wrong stops: for a trace, read with its own period
    proven,        // also, VALID waits until it is shown to be right: for a guard
    ignored,       // for programs that read only positions
};

struct ReceiverOptions {
    bool refuse_local = false;  // live: a frame of ours sent from this host is a second sender
    bool takes_jumps = false;   // for measuring speeds: rule 8 checks only the travel
    PeriodUse period = PeriodUse::supposed;
};

/// Whether any stamp of the layout measures the board's period; false if the guard sends SYNC.
[[nodiscard]] bool measures_period(const CanLayout& can) noexcept;
/// Terms by which the stamps of SYNC, or arrivals, prove or refute the period.
[[nodiscard]] PeriodTerms sync_terms(const Machine& machine) noexcept;
/// For lists of unmeasured promises: the promise about the period; empty: it is measured.
[[nodiscard]] std::string_view unmeasured_period(const CanLayout& can) noexcept;

class AxisReceiver {
  public:
    explicit AxisReceiver(const Machine& machine, ReceiverOptions options = {}) noexcept;

    /// One frame, in order of arrival; its stamp also drives the clock, as on_time() does.
    /// Snapshots are handed out in INIT and VALID. Endless axes are in [0, one turn).
    /// Constant cost: at most one snapshot a frame.
    [[nodiscard]] ReceiverEvent on_frame(const CanFrame& frame) noexcept;

    /// The clock without a frame: time reveals silence, never an arrival.
    [[nodiscard]] ReceiverEvent on_time(std::int64_t now_us) noexcept;

    /// A person acknowledges: INVALID becomes INIT, and all references are cleared.
    void acknowledge() noexcept;

    /// Whether a window has shown since the last acknowledge that the period is right. Also true if
    /// nothing measures the period, or if `period` is not `proven`.
    [[nodiscard]] bool is_period_shown() const noexcept {
        return !rules_.needs_period || (samples_.by_sync.is_shown && samples_.by_sender.is_shown);
    }
    /// Treats the period as shown, for a recording that begins in the middle.
    void suppose_period() noexcept {
        samples_.by_sync.is_shown = samples_.by_sender.is_shown = true;
    }

    /// Session of the newest sample with this SYNC counter, one of the last 240. Empty: the board
    /// has sent no session, or the last one is older than kSessionTimeoutUs.
    [[nodiscard]] std::optional<SampleSession> session_of(
        std::uint8_t sync_counter) const noexcept {
        return session_.of(sync_counter, samples_);
    }
    /// SYNC counter of the newest sample; 0: there was none.
    [[nodiscard]] std::uint8_t newest_sync_counter() const noexcept {
        return samples_.last.is_known ? samples_.last.sync_counter : std::uint8_t{0};
    }

    [[nodiscard]] ReceiverState state() const noexcept { return state_; }
    /// The fault that made it INVALID; none if it is not.
    [[nodiscard]] ReceiverFault stop_cause() const noexcept { return stop_cause_; }
    [[nodiscard]] const ReceiverCounters& counters() const noexcept { return counters_; }

  private:
    /// As a machine file states them.
    struct Rules {
        std::int64_t stale_after_us = 0;
        std::uint8_t init_snapshots = 2;
        bool refuse_local = false;
        bool needs_period = false;  // VALID waits until the period is shown
    };
    /// Frames without positions; their order counts where ids coincide.
    enum class Kind : std::uint8_t { sync, heartbeat, session, look_ahead, none };
    struct Losses {
        std::uint32_t level = 0;
        std::uint8_t good_in_row = 0;
    };

    void advance_clock(std::int64_t time_us) noexcept;
    void forget() noexcept;
    ReceiverEvent event() const noexcept;
    /// A fault with its reaction; none: no event.
    ReceiverEvent fault(ReceiverFault kind, std::uint32_t frame_id = 0,
                        std::uint32_t axis = kNoIndex) noexcept;
    ReceiverEvent check_clock() noexcept;
    ReceiverEvent on_error_frame(const CanFrame& frame) noexcept;
    ReceiverEvent on_heartbeat(const CanFrame& frame) noexcept;
    ReceiverEvent on_session_frame(const CanFrame& frame) noexcept;
    ReceiverEvent on_axis_frame(const CanFrame& frame, std::uint32_t slot) noexcept;
    ReceiverEvent on_look_ahead_frame(const CanFrame& frame) noexcept;
    ReceiverEvent conclude(const Assembly& assembly, std::uint32_t frame_id) noexcept;
    ReceiverEvent deliver(const Latch& latch, std::uint32_t steps, std::uint32_t frame_id) noexcept;
    void count_loss(std::uint32_t lost) noexcept;

    AxisFrameSet set_;
    Rules rules_;
    std::array<std::uint32_t, 4> ids_{};  // by Kind; kNoIndex: the format has none
    SnapshotCheck check_;
    // Of each axis frame; the last one is of the look-ahead path.
    std::array<LastFrame, kAxisFramesMax + 1> last_frames_{};
    SessionLaps session_;
    HeartbeatWatch heartbeat_;
    FloodWindow flood_;
    ReceivedSamples samples_;
    Assembler assembler_;
    Losses losses_;

    ReceiverState state_ = ReceiverState::invalid;
    ReceiverFault stop_cause_ = ReceiverFault::none;
    ReceiverCounters counters_;
};

}  // namespace axg
