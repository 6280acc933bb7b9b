// SPDX-License-Identifier: Apache-2.0
// The test of a board: the cases one after the other, by frames in and frames out. A person arms
// the board before each case. No clock: times are those of the frames. No cycle: it allocates.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "core/machine/configuration_hashes.hpp"
#include "core/machine/machine.hpp"
#include "firmware_if/board_test/board_cases.hpp"
#include "firmware_if/board_test/board_watch.hpp"
#include "firmware_if/board_test/case_judge.hpp"
#include "firmware_if/board_test/motion_record.hpp"
#include "firmware_if/board_test/rest_watch.hpp"
#include "firmware_if/protocol/handshake.hpp"
#include "firmware_if/receiver/axis_receiver.hpp"

namespace axg {

struct BoardTestOptions {
    ConfigurationHashes hashes{};
    CapPromise cap = CapPromise::none;
    bool has_jog = false;  // a person can choose one
    bool accepts_local = false;
    std::string only{};                        // this case, after the first ones; empty: all
    std::int64_t person_us_max = 120'000'000;  // to arm the board
};

enum class Outcome : std::uint8_t {
    not_tested = 0,
    passed,
    failed,
    unclear,  // played, without a result
};

struct BoardFinding {
    std::string name;
    int rule = 0;
    std::string demands;
    Outcome outcome = Outcome::not_tested;
    std::string found;
    std::int64_t at_us = 0;  // of the frame that shows it; 0: none does
    std::string mend;
};

struct BoardTestResult {
    std::vector<BoardFinding> findings;
    std::string abandoned;        // why the test ended early; empty: it did not
    std::vector<AxisStop> stops;  // of cases that passed
    double reaction_s = 0;        // the longest of them
    SyncFigures sync;
};

/// Present task of the person at the board.
enum class PersonTask : std::uint8_t { nothing = 0, arm, arm_jog };

class BoardPlayer {
  public:
    /// `machine` must outlive it. Precondition: its frames are classical or fd.
    BoardPlayer(const Machine& machine, const BoardTestOptions& options);

    /// A frame of the bus in order of arrival; `is_own`: the echo of one that was sent.
    void on_frame(const CanFrame& frame, bool is_own);
    void on_time(std::int64_t now_us);
    /// Ends the test early: stop frames until the axes rest, or for one second.
    void interrupt(const std::string& why);
    /// The next frame to send now. False: none is due.
    [[nodiscard]] bool take(std::int64_t now_us, CanFrame& out);
    /// The earliest instant at which on_time() or take() has work to do.
    [[nodiscard]] std::int64_t next_due_us() const noexcept;

    /// Why the case `only` cannot be played; empty: it can, or none is chosen.
    [[nodiscard]] std::string unplayed() const;

    [[nodiscard]] PersonTask task() const noexcept { return task_; }
    /// The case that is played, or comes next; null: none.
    [[nodiscard]] const BoardCase* current() const noexcept {
        return case_ < cases_.size() ? cases_[case_] : nullptr;
    }
    [[nodiscard]] bool is_over() const noexcept { return stage_ == Stage::over; }
    /// Precondition: is_over(). Cases in the order of the table, then watched rules, then rules
    /// that no frame shows.
    [[nodiscard]] BoardTestResult result() const;

  private:
    enum class Stage : std::uint8_t {
        listen,   // until samples and session are there
        arm,      // a person has to
        agree,    // about the hashes
        good,     // until the axes are at a steady speed
        fault,    // the fault of the case
        control,  // good again: now it has to move
        settle,   // nothing is sent, until all axes rest
        probe,    // good permits for a stopped board
        closing,  // stop frames, and nothing else
        over,
    };

    void choose_cases();
    void enter(Stage stage);
    void abandon(std::string why);
    void abandon_listening();
    void begin_case();
    void end_case(Outcome outcome, std::string found, std::int64_t at_us = 0);
    void next_case();

    void on_sample(const ReceiverEvent& event);
    void note_fault(const ReceiverEvent& event);
    void note_nonce(std::int64_t time_us);
    void step_listen();
    void step_arm();
    void step_good();
    void step_fault();
    void step_control();
    void step_settle();
    void step_probe();
    void step_closing();
    void watch_rest();
    void begin_rest();
    [[nodiscard]] std::int64_t quiet_us() const noexcept;
    void judge_stop(bool is_over_due);
    void judge_cap();
    void watch_mode();
    void begin_fault();
    void play_event();

    void send(const CanFrame& frame, std::int64_t due_us);
    void send_good();
    void send_fault();
    void send_pair(const PermitEdit& edit, bool is_good);
    void send_stop(bool is_long);
    void on_own(const CanFrame& frame);
    [[nodiscard]] PermitWord good_word() const noexcept;
    [[nodiscard]] std::uint8_t good_samples() const noexcept;
    [[nodiscard]] std::int64_t since_us() const noexcept { return now_us_ - entered_us_; }
    [[nodiscard]] bool is_jog_case() const noexcept;
    [[nodiscard]] bool is_brake_case() const noexcept;
    [[nodiscard]] double stop_seconds_max() const noexcept;

    const Machine& machine_;
    BoardTestOptions options_;
    AxisReceiver receiver_;
    Handshake handshake_;
    MotionRecord record_;
    BoardWatch watch_;
    RestWatch rest_;

    std::vector<const BoardCase*> cases_;
    std::vector<BoardFinding> findings_;
    std::size_t case_ = 0;
    int attempts_ = 0;     // of this case
    std::string unclear_;  // why the last one showed nothing
    Stage stage_ = Stage::listen;
    PersonTask task_ = PersonTask::nothing;
    std::int64_t now_us_ = 0, entered_us_ = 0, heartbeat_us_ = 0, stop_us_ = 0;
    std::uint64_t entered_sample_ = 0;
    bool has_time_ = false, is_judged_ = false, is_late_ = false;
    std::string abandoned_;
    std::string heard_;             // the last fault of the frames before the first case
    std::deque<CanFrame> waiting_;  // in order of time

    std::uint32_t nonce_ = 0, former_nonce_ = 0;
    bool has_nonce_ = false, has_resumed_ = false;
    std::uint8_t mode_ = 0, live_ = 0;
    std::uint8_t sync_counter_ = 0;  // of the newest sample
    std::uint64_t played_ = 0;       // permits since the fault began
    PairFrames last_good_;
    std::uint64_t last_good_sample_ = 0;
    std::array<std::int64_t, 256> sent_end_us_{};  // of permits, by live counter
    std::int64_t end_us_ = 0;  // E, of those that were on the bus since arming; 0: none was
    std::uint64_t steady_samples_ = 0;
    std::vector<SteadyAxis> steady_;
    StopInstant due_;
    std::optional<std::int64_t> event_us_;  // on the bus
    std::uint8_t cap_mask_ = 0xFF;
    std::uint8_t cap_ = kPermitCapNone;  // of the cases cap and hold
    bool is_mode_wrong_ = false;

    std::vector<AxisStop> stops_;
    double reaction_s_ = 0;
    std::optional<double> lapse_s_;  // reaction of the case lapse
};

}  // namespace axg
