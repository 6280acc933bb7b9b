// SPDX-License-Identifier: Apache-2.0
// A motion board and its axes: follows a commanded motion while the guard's permit is in force,
// latches and sends the true positions every period, and brakes when it must: each axis by itself,
// or along its path, as the machine file promises. It shares no code of motion or timing with the
// guard. mm and s, or rad and s; instants in us of the board's own clock.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include "core/machine/configuration_hashes.hpp"
#include "core/machine/machine.hpp"
#include "core/reach/jog.hpp"
#include "firmware_if/protocol/axis_frames.hpp"
#include "hil_replay/board/axis_cap_keeper.hpp"
#include "hil_replay/board/axis_motion.hpp"
#include "hil_replay/board/axis_shares.hpp"
#include "hil_replay/board/commanded_path.hpp"
#include "hil_replay/board/past_motion.hpp"
#include "hil_replay/board/permit_watch.hpp"

namespace axg {

inline constexpr std::int64_t kBoardStartUs = 1'000'000;  // of the first sample

struct BoardOptions {
    std::uint64_t seed = 1;
    std::int64_t tick_us = 1000;           // of the commanded motion; divides the sample period
    std::int64_t reaction_us_max = 1000;   // t_board: drawn up to this for each stop
    std::int64_t latch_jitter_us_max = 0;  // of a sample's instant, either way
    ValueAge latched_age{};  // of each position at its latch: least, most, or drawn between
    double deceleration_factor_max = 2;  // drawn from 1 to this times the guaranteed one
    double jerk_factor_max = 4;          // the same of the jerk
    std::int64_t permit_us = 0;          // of a permit on the board's timer; 0: n T
    bool is_homed = true;
    std::uint16_t tool = 0;        // in the spindle at the start; 0: Machine::first_tool
    JogMove jog{};                 // one axis, one direction, under jog permits; none: no jog
    ConfigurationHashes hashes{};  // of the machine that the board was configured for
    // Bounds all axes by the cap of the permits. The motion reads the bound at every tick, as a
    // share of their largest speeds, and obeys it within `cap_smooth_s` seconds of averaging.
    CapPromise cap = CapPromise::none;
    double* speed_share = nullptr;      // both null: the board obeys no cap, whatever `cap` is
    AxisShares* axis_shares = nullptr;  // in place of `speed_share`: a cap for each axis
    double cap_smooth_s = 0;
    double slow_share = 1;  // under a permit with the word slow
    CapFault cap_fault = CapFault::none;
};

enum class BoardState : std::uint8_t {
    waiting = 0,  // for the first permit
    moving,
    braking,
    stopped,   // at rest after a stop; only a person lets it move again
    finished,  // at rest at the end of the motion
};
[[nodiscard]] const char* to_text(BoardState state) noexcept;

enum class BoardStop : std::uint8_t { none, permit_ran_out, guard_said_stop, person_said_stop };
[[nodiscard]] const char* to_text(BoardStop stop) noexcept;

struct BoardStopRecord {
    BoardStop why = BoardStop::none;
    std::int64_t asked_us = 0;      // the permit's end, or the arrival of the stop
    std::int64_t brake_us = 0;      // asked_us and the reaction
    std::int64_t certified_us = 0;  // the newest sample with a permit, when the stop was noted
    std::int64_t rest_us = 0;
};

/// The true axes at one instant, for a judge. Never on the wire.
using AxisObserver = std::function<void(std::int64_t time_us, std::span<const AxisMotion>)>;

class MotionBoard {
  public:
    /// `machine` must outlive it. `start`: positions at rest.
    MotionBoard(const Machine& machine, std::span<const double> start, CommandedMotion motion,
                const BoardOptions& options);

    /// Calls `observe` every `every_us` of motion, and when the axes reach standstill.
    void watch(AxisObserver observe, std::int64_t every_us);

    /// Instant of the next sample.
    [[nodiscard]] std::int64_t next_latch_us() const noexcept { return next_us_; }
    /// Moves the axes up to the sample's instant and latches them.
    /// @return  its frames, `time_us` when each is ready; valid until the next call. Empty: the
    ///     positions do not fit the frames (see encode_status())
    [[nodiscard]] std::span<const CanFrame> latch();
    /// The same if the guard sends SYNC: one with this counter ended at `ended_us`, at most half a
    /// period after next_latch_us(). The returned frames contain no SYNC.
    [[nodiscard]] std::span<const CanFrame> latch_on_sync(std::uint8_t counter,
                                                          std::int64_t ended_us);
    /// The guard's SYNC did not arrive: the axes move on, and the board latches no sample.
    void pass_without_sync();
    /// Processes a frame of the guard. It must not end before the last sample.
    void on_frame(const CanFrame& frame) { watch_.on_frame(frame); }
    /// Outputs the immediate reply to that frame: the board's own hash of the part. False: none.
    [[nodiscard]] bool take_answer(std::int64_t now_us, CanFrame& out) {
        return watch_.take_hash(now_us, out);
    }
    /// A person ends the motion, at an instant that is not before the last sample.
    void stop_by_person(std::int64_t now_us) noexcept {
        person_us_ = person_us_ == kNever ? now_us : person_us_;
    }
    /// A person acknowledges a stop that arrived while the board waited: motion may still begin,
    /// with a later permit. Version 2: no effect while the guard still sends stop, because each
    /// arming needs a nonce. Precondition: state is waiting.
    void acknowledge_stop() noexcept;

    [[nodiscard]] BoardState state() const noexcept { return state_; }
    [[nodiscard]] bool is_at_rest() const noexcept {
        return state_ == BoardState::stopped || state_ == BoardState::finished;
    }
    [[nodiscard]] const BoardStopRecord& stop() const noexcept { return stop_; }
    [[nodiscard]] const PermitWatch& permits() const noexcept { return watch_; }
    /// PermitWatch::library
    [[nodiscard]] axg_board& library() noexcept { return watch_.library(); }
    [[nodiscard]] std::span<const AxisMotion> axes() const noexcept {
        return {axes_.data(), machine_.axes.size()};
    }
    [[nodiscard]] std::uint16_t tool() const noexcept { return tool_; }
    /// Line of the program that the axes follow; 0: none.
    [[nodiscard]] std::uint32_t line() const noexcept { return line_; }
    [[nodiscard]] std::uint64_t samples() const noexcept { return sample_; }
    [[nodiscard]] std::int64_t moving_since_us() const noexcept { return moving_since_us_; }
    [[nodiscard]] EncodeResult encode_status() const noexcept { return encoded_; }
    /// With an enforced cap: the cap in force, 1/250 of rapid, and how many checks of the speeds
    /// found an axis faster.
    [[nodiscard]] std::uint8_t kept_cap() const noexcept { return kept_cap_; }
    [[nodiscard]] std::uint64_t cap_breaches() const noexcept { return cap_breaches_; }

  private:
    [[nodiscard]] bool keeps_cap() const noexcept {
        return options_.cap != CapPromise::none &&
               (options_.speed_share != nullptr || options_.axis_shares != nullptr);
    }
    void note_speeds() noexcept;
    void keep_cap();
    std::span<const CanFrame> latch_now(std::uint8_t counter);
    void begin_if_permitted();
    void set_next_latch();
    void advance(std::int64_t until_us);
    void advance_part(std::int64_t until_us);
    void advance_noted(std::int64_t until_us);
    [[nodiscard]] std::int64_t first_stop_us() const noexcept;
    void note_stop();
    void begin_braking();
    void drive(std::int64_t until_us);
    void follow(std::int64_t until_us);
    void brake_for(std::int64_t until_us);
    [[nodiscard]] bool has_settled(std::int64_t now_us) const noexcept;
    void set_from_path(double commanded_us, std::int64_t now_us);
    [[nodiscard]] double off_path(std::size_t axis, std::int64_t now_us) const noexcept;
    void settle(std::int64_t now_us);
    [[nodiscard]] double latched_position(std::uint32_t axis);
    [[nodiscard]] AxisSnapshot snapshot_now(std::int64_t nominal_us, std::int64_t latched_us);
    [[nodiscard]] double between(double low, double high);

    const Machine& machine_;
    CommandedMotion motion_;
    BoardOptions options_;
    std::mt19937_64 random_;
    AxisEncoder encoder_;
    PermitWatch watch_;
    EncodeResult encoded_;
    std::array<CanFrame, kFramesPerSnapshotMax> frames_{};

    BoardState state_ = BoardState::waiting;
    BoardStopRecord stop_;
    AxisMotions axes_{};              // at now_us_
    std::optional<PastMotion> past_;  // if positions have an age
    std::array<Brake, kAxesMax> brakes_{};
    // With a look-ahead path, axes_ is the commanded position plus the following error.
    std::optional<CommandedPath> path_;
    std::array<double, kAxesMax> off_before_{}, off_after_{};  // a stop begins
    AxisMotion rate_{};                                        // s of the path since braking began
    Brake rate_brake_;
    std::int64_t now_us_ = kBoardStartUs, tick_ends_us_ = kBoardStartUs;
    std::int64_t moving_since_us_ = INT64_MIN, person_us_ = kNever;
    std::uint16_t tool_ = 0;
    std::uint32_t line_ = 0;

    std::uint64_t sample_ = 0;
    std::int64_t nominal_us_ = kBoardStartUs, next_us_ = kBoardStartUs;
    std::array<double, kAxesMax> sent_{};
    std::uint16_t sent_tool_ = 0;

    std::vector<double> shares_;  // commanded, while they may act
    std::size_t share_slot_ = 0, late_slot_ = 0;
    double fastest_ = 0;  // largest share_in_stop() of any axis since the last sample
    std::uint8_t kept_cap_ = 0;
    std::uint64_t cap_breaches_ = 0;
    std::vector<double> late_shares_;
    std::optional<AxisCapKeeper> axis_caps_;

    AxisObserver observe_;
    std::int64_t observe_every_us_ = 0;
};

}  // namespace axg
