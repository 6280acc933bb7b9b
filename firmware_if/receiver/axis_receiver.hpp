// SPDX-License-Identifier: Apache-2.0
// Frames in, coherent axis snapshots out; everything else is a fault with one name and one
// reaction. Fed frame by frame and by a clock tick; bounded work, no allocation, no clock.
// Rules and fault table: docs/reference/protocol.md.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/machine/axis_snapshot.hpp"
#include "firmware_if/protocol/axis_frames.hpp"
#include "firmware_if/protocol/e2e.hpp"
#include "firmware_if/receiver/arrival_anchor.hpp"
#include "firmware_if/receiver/period_watch.hpp"
#include "firmware_if/receiver/receiver_faults.hpp"
#include "firmware_if/receiver/session_watch.hpp"
#include "firmware_if/receiver/snapshot_check.hpp"

namespace axg {

// The leaky count of lost samples tolerates one in four for ever, but not one in three; twenty in a
// row stop at once.
inline constexpr std::uint32_t kLossWeight = 3;  // added by a lost sample; a good one subtracts 1
inline constexpr std::uint32_t kLossLimit = 60;

// A board sends its session every 100 ms: two lost in a row are tolerated.
inline constexpr std::int64_t kSessionTimeoutUs = 300'000;

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

/// The CRC of a permit covers these: the board's nonce, and the lap of the sample.
struct SampleSession {
    std::uint32_t nonce = 0;
    std::uint16_t lap = 0;

    friend constexpr bool operator==(const SampleSession&, const SampleSession&) = default;
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

/// The fault of a frame with this decoder status.
[[nodiscard]] ReceiverFault fault_of(FrameStatus status) noexcept;

static_assert(kAxisFramesMax < 64, "a bit for each frame of a snapshot");

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
        const bool are_shown =
            shows_sync_period_ && (shows_sender_period_ || set_.format != CanFormat::fd);
        return are_shown || options_.period != PeriodUse::proven || !measures_period_;
    }
    /// Treats the period as shown, for a recording that begins in the middle.
    void suppose_period() noexcept { shows_sync_period_ = shows_sender_period_ = true; }

    /// Session of the newest sample with this SYNC counter, one of the last 240. Empty: the board
    /// has sent no session, or the last one is older than kSessionTimeoutUs.
    [[nodiscard]] std::optional<SampleSession> session_of(std::uint8_t sync_counter) const noexcept;
    /// SYNC counter of the newest sample; 0: there was none.
    [[nodiscard]] std::uint8_t newest_sync_counter() const noexcept {
        return has_last_ ? last_sync_counter_ : std::uint8_t{0};
    }

    [[nodiscard]] ReceiverState state() const noexcept { return state_; }
    /// The fault that made it INVALID; none if it is not.
    [[nodiscard]] ReceiverFault stop_cause() const noexcept { return stop_cause_; }
    [[nodiscard]] const ReceiverCounters& counters() const noexcept { return counters_; }

  private:
    struct Slot {
        SequenceCheck sequence;
        std::array<std::uint8_t, 64> payload{};  // of the last frame used
    };
    struct SyncStamp {
        std::uint8_t counter = 0;  // 0: none
        std::int64_t time_us = 0;
    };
    struct Latch {
        bool is_known = false;
        std::int64_t time_us = 0;
        std::uint8_t sync_counter = 0;
        std::int64_t base_us = 0;  // sync_base_us_ if this sample is used
    };

    /// Frames of the drives after one SYNC (format cia402).
    struct DriveGroup {
        bool is_open = false;     // process data may come
        bool is_suspect = false;  // a frame of an earlier group may still be on its way
        std::int64_t sync_us = 0;
        std::uint8_t sync_counter = 0;  // 0: SYNC is empty
        std::uint32_t steps = 0;        // periods since the last snapshot
        bool has_sync = false;          // the two above are of a SYNC that came
    };

    void advance_clock(std::int64_t time_us) noexcept;
    void forget() noexcept;
    ReceiverEvent event() const noexcept;
    ReceiverEvent fault(ReceiverFault kind, std::uint32_t frame_id = 0,
                        std::uint32_t axis = kNoIndex) noexcept;
    ReceiverEvent check_clock() noexcept;
    ReceiverEvent on_error_frame(const CanFrame& frame) noexcept;
    ReceiverEvent on_sync(const CanFrame& frame) noexcept;
    ReceiverEvent on_heartbeat(const CanFrame& frame) noexcept;
    ReceiverEvent on_drive_sync(const CanFrame& frame) noexcept;
    ReceiverEvent on_axis_frame(const CanFrame& frame, std::uint32_t slot) noexcept;
    ReceiverEvent on_look_ahead_frame(const CanFrame& frame) noexcept;
    ReceiverEvent on_session_frame(const CanFrame& frame) noexcept;
    void number_sample(std::uint8_t sync_counter) noexcept;
    [[nodiscard]] bool is_flood() noexcept;
    ReceiverEvent check_counter(const CanFrame& frame, std::uint8_t counter, Slot& known) noexcept;
    ReceiverEvent assemble(const AxisFrameContent& content, std::uint32_t slot,
                           std::uint32_t frame_id) noexcept;
    ReceiverEvent assemble_signals(const AxisFrameContent& content, std::uint32_t slot,
                                   std::uint32_t frame_id) noexcept;
    ReceiverEvent assemble_drives(const AxisFrameContent& content, std::uint32_t slot,
                                  const CanFrame& frame) noexcept;
    void begin_set(std::uint8_t sample_index) noexcept;
    void add_to_set(const AxisFrameContent& content, std::uint32_t slot) noexcept;
    [[nodiscard]] bool is_complete() const noexcept;
    ReceiverEvent finish(const AxisFrameContent& content, std::uint32_t frame_id) noexcept;
    ReceiverEvent deliver(Latch latch, std::uint32_t steps, std::uint32_t frame_id) noexcept;
    [[nodiscard]] Latch latch_of(std::uint8_t sample_index, std::uint32_t steps) noexcept;
    /// sender_clock or sync_period; none: the sample may be used.
    [[nodiscard]] ReceiverFault judge_sender_clock(std::uint32_t sender_us, Latch& latch) noexcept;
    [[nodiscard]] bool is_period_wrong(PeriodWatch& watch, std::int64_t steps,
                                       std::int64_t stamp_us) noexcept;
    [[nodiscard]] Latch dated(std::int64_t stamp_us, std::uint8_t sync_counter,
                              std::uint32_t steps) const noexcept;
    [[nodiscard]] bool is_native() const noexcept {
        return set_.format == CanFormat::classical || set_.format == CanFormat::fd;
    }
    [[nodiscard]] bool is_heartbeat_fresh() const noexcept;
    void count_loss(std::uint32_t lost) noexcept;

    AxisFrameSet set_;
    SnapshotCheck check_;
    ReceiverOptions options_;
    std::int64_t stale_after_us_ = 0;
    std::int64_t heartbeat_timeout_us_ = 0;
    std::int64_t sync_window_us_ = 0;
    std::uint32_t index_modulus_ = 16;
    std::uint8_t init_snapshots_ = 2;

    ReceiverState state_ = ReceiverState::invalid;
    ReceiverFault stop_cause_ = ReceiverFault::none;
    ReceiverCounters counters_;
    std::int64_t now_us_ = INT64_MIN;

    std::array<Slot, kAxisFramesMax> slots_{};
    Slot look_ahead_slot_;
    SequenceCheck sync_sequence_;
    std::array<SyncStamp, 16> sync_stamps_{};
    SyncStamp last_sync_;
    std::int64_t heartbeat_us_ = 0;

    std::int64_t window_us_ = INT64_MIN;  // start of the period in which frames are counted
    std::uint32_t window_frames_ = 0;
    bool has_heartbeat_ = false;

    Slot session_slot_;
    SessionWatch session_;
    std::int64_t session_us_ = 0;    // of the last session frame that agreed
    std::uint64_t sync_sample_ = 0;  // counts as SYNC does: its counter is that of the last sample

    PeriodWatch sync_period_;    // by SYNC; format signals: by arrival
    PeriodWatch sender_period_;  // format fd: by the sender's clock
    bool measures_period_ = true;
    // By SYNC and by the sender's clock, which may be wrong by as much as the period.
    bool shows_sync_period_ = false, shows_sender_period_ = false;

    DriveGroup drives_;
    ArrivalAnchor arrivals_;           // format signals
    std::uint32_t arrival_steps_ = 0;  // periods since the last snapshot
    std::uint64_t seen_ = 0;           // bit per axis frame of the set being assembled; 0: none is
    std::int64_t set_first_us_ = 0;
    AxisSnapshot snapshot_;  // being assembled
    std::array<std::int64_t, kAxesMax> raw_{};

    std::uint8_t set_index_ = 0;
    bool has_last_ = false;
    std::uint8_t last_index_ = 0;
    std::uint8_t last_sync_counter_ = 0;
    std::uint32_t loss_level_ = 0;
    std::int64_t last_latched_us_ = 0;
    std::int64_t sync_base_us_ = 0;  // of the last snapshot: its SYNC, without what a queue added
    std::uint64_t last_sample_ = 0;
    bool has_history_ = false;  // a snapshot was handed out, before an acknowledge perhaps
    std::uint8_t good_in_row_ = 0;
    std::uint8_t estimates_ = 0;
    bool has_sender_ = false;
    std::uint8_t sender_index_ = 0;  // of the sample that the sender's clock dated last
    std::uint32_t last_sender_us_ = 0;
    std::int64_t sender_offset_us_ = 0;   // smallest (our clock - sender's clock) seen, leaking
    std::int64_t sender_elapsed_us_ = 0;  // sender's clock, unwrapped
};

}  // namespace axg
