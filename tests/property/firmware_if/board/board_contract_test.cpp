// SPDX-License-Identifier: Apache-2.0
// The contract of docs/reference/board.md end to end: an axis makes for a wall as hard as its
// limits let it, the guard certifies samples by the formula of its proof (stop_reach), and the
// library for boards alone decides until when the axis moves. The guard is killed at any moment,
// frames are lost and come late, a bus holds everything back for a lap, a recording is played back
// after arming. The true path must end short of the wall. With one rule of the board left out some
// approach must touch it, or a permit is used after its end. AXG_COUNT: approaches of the whole
// board; AXG_SEED: which.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <optional>
#include <vector>

#include "core/certificate/stop_certificate.hpp"
#include "firmware_if/board/axguard_board.h"
#include "firmware_if/protocol/e2e.hpp"
#include "firmware_if/protocol/guard_frames.hpp"
#include "firmware_if/protocol/permit_frames.hpp"
#include "hil_replay/board/approach_driver.hpp"
#include "tests/support/count.hpp"
#include "tests/support/dice.hpp"
#include "tests/support/motion_machine.hpp"
#include "tests/support/seed.hpp"

namespace axg::test {
namespace {

constexpr std::int64_t kNone = INT64_MAX, kTickUs = 1000;
constexpr std::uint32_t kArmedAt = 20;  // samples after power-up
constexpr std::uint32_t kLap = AXG_BOARD_SYNC_MAX;
constexpr double kWall = 0;

/// Which rule the board leaves out.
enum class Without {
    nothing,
    latch,  // the end counts from the arrival of the permit
    echo,   // the end is 4 ms after the pair, whatever n
    lap,    // in the answer
    nonce,  // in the answer
    late,   // permits after their end are used
};
/// What happens to the guard.
enum class Story { killed, held_for_a_lap, played_back };

struct Drawn {
    Machine machine;
    Story story = Story::killed;
    double start = 0, speed_share = 1;
    double clock = 1;                // true time in the board's time
    std::int64_t killed_us = kNone;  // sends no more
    std::int64_t response_us = 0, twin_us = 0;
    bool stops_in_silence = false;                         // its stop frame is lost
    double lost = 0, late = 0;                             // shares of frames and pairs
    std::int64_t held_from_us = kNone, held_until_us = 0;  // the bus lets nothing through
    std::uint64_t seed = 0;
};

Drawn draw_approach(Dice& dice, Story story, Without without) {
    Drawn out;
    out.story = story;
    out.machine = motion_test_machine();
    out.machine.axes.resize(1);
    Axis& axis = out.machine.axes[0];
    axis.speed_max = dice.in(50, 1000);
    axis.acceleration_max = dice.in(1000, 10'000);
    axis.jerk_max = dice.in(2e4, 2e5);
    axis.stopping_min = axis.acceleration_max * dice.in(0.5, 1);
    axis.position_error = 1e-3;
    out.machine.guard.board_reaction_s = std::floor(dice.in(0, 3000)) * 1e-6;
    out.machine.guard.latch_jitter_s = 20e-6;
    out.machine.guard.free_jerk_limited = dice.chance(0.5);
    const bool is_short = without == Without::echo;  // 4 ms are longer than n T
    out.machine.can.sample_us = is_short || dice.chance(0.5) ? 1000
                                : dice.chance(0.5)           ? 2000
                                                             : 5000;
    const auto samples =
        static_cast<std::uint8_t>(is_short || dice.chance(0.5) ? 3 : dice.in(4, 13));
    out.machine.can.permit_samples = {samples, samples};
    out.start = kWall - dice.in(2, 150);
    out.speed_share = dice.chance(0.5) ? 1 : dice.in(0.1, 1);
    out.clock = dice.in(1 - kPeriodShare, 1 + kPeriodShare);
    const auto period_us = static_cast<double>(out.machine.can.sample_us);
    out.response_us = static_cast<std::int64_t>(dice.in(0.4, 0.9) * period_us);
    out.twin_us = static_cast<std::int64_t>(dice.in(60, 300));
    if (story == Story::killed && dice.chance(0.5)) {
        out.killed_us = static_cast<std::int64_t>(dice.in(kArmedAt, kArmedAt + 200) * period_us);
    }
    out.stops_in_silence = dice.chance(0.7);
    out.lost = dice.chance(0.3) ? dice.in(0, 0.05) : 0;
    out.late = dice.chance(0.3) ? dice.in(0, 0.1) : 0;
    if (dice.chance(0.3)) {
        out.held_from_us = static_cast<std::int64_t>(dice.in(kArmedAt, kArmedAt + 100) * period_us);
        out.held_until_us =
            out.held_from_us + static_cast<std::int64_t>(dice.in(2, 40) * period_us);
    }
    out.seed = static_cast<std::uint64_t>(dice.in(0, 1e15));
    return out;
}

/// Certifies samples of one axis against the wall; after the first that it cannot, it stops.
class WallGuard {
  public:
    explicit WallGuard(const Machine& machine)
        : machine_(machine), errors_(sample_errors(machine, 0, 0)) {}

    /// Whether the sample has a permit.
    bool certifies(const AxisSnapshot& snapshot) {
        note_snapshot(history_, snapshot, history_stride(errors_.period_s));
        const AxisRange now = range_of(history_, 0, machine_.axes[0], errors_);
        const ReachRange reach =
            stop_reach(stop_limits(machine_, 0), now,
                       free_seconds(machine_, machine_.can.permit_samples.most));
        return reach.high < kWall;
    }
    std::array<CanFrame, 2> permit(std::uint32_t number, std::uint32_t nonce) {
        return encode_permit(machine_.can,
                             {.word = PermitWord::run,
                              .sync_counter = static_cast<std::uint8_t>(number % kLap + 1),
                              .live_counter = ++live_,
                              .known_answer_signature = kKnownAnswerSignature,
                              .samples = machine_.can.permit_samples.most,
                              .nonce = nonce,
                              .lap = static_cast<std::uint16_t>(number / kLap)},
                             0);
    }

  private:
    const Machine& machine_;
    SampleErrors errors_;
    MotionHistory history_;
    std::uint8_t live_ = 0;
};

/// Bytes 3 and 4 of a plain frame, as they are right for this nonce and lap.
std::uint16_t answer_for(const std::uint8_t* plain, std::uint32_t nonce, std::uint32_t lap) {
    const auto byte = [](std::uint32_t value, unsigned index) {
        return static_cast<std::uint8_t>(value >> 8U * index);
    };
    const std::array covered{plain[0],       plain[1],     plain[2],       plain[5],
                             plain[6],       plain[7],     byte(nonce, 0), byte(nonce, 1),
                             byte(nonce, 2), byte(lap, 0), byte(lap, 1)};
    return static_cast<std::uint16_t>(crc16_ccitt(covered) ^ kKnownAnswerSignature);
}

struct Waiting {
    std::int64_t at_us = 0;
    axg_board_can_frame frame{};
};

struct Tally {
    std::uint64_t approaches = 0, moved = 0, contacts = 0, used_late = 0, refused = 0;
    double least_mm = HUGE_VAL;
};

/// One axis, the library, and a wire from the guard to it. Instants are the board's.
class Run {
  public:
    Run(const Drawn& drawn, Without without, Tally& tally)
        : drawn_(drawn),
          without_(without),
          tally_(tally),
          dice_(drawn.seed),
          guard_(drawn.machine) {
        axis_.position = drawn.start;
    }

    void play() {
        if (drawn_.story == Story::played_back) {
            record();
        }
        power_up();
        for (number_ = 0; number_ < 1500 && !is_over(); ++number_) {
            sample();
            deliver_until(next_us());
        }
        ++tally_.approaches;
        tally_.moved += has_moved_ ? 1 : 0;
        tally_.contacts += axis_.position >= kWall ? 1 : 0;
        tally_.refused += board_.refused[AXG_BOARD_REFUSED_ANSWER];
        if (has_moved_) {
            tally_.least_mm = std::min(tally_.least_mm, kWall - axis_.position);
        }
    }

  private:
    [[nodiscard]] std::int64_t period_us() const { return drawn_.machine.can.sample_us; }
    [[nodiscard]] std::int64_t grid_us(std::uint32_t number) const {
        return begin_us_ + (number + 1) * period_us();
    }
    [[nodiscard]] std::int64_t next_us() const { return grid_us(number_ + 1) - 20; }
    [[nodiscard]] bool is_over() const {
        return axis_.position >= kWall || (brake_us_ != kNone && is_resting(axis_));
    }

    void power_up() {
        axg_board_options options{};
        options.period_us = static_cast<std::uint32_t>(period_us());
        options.jitter_us = 20;
        options.permit_samples_max = 15;
        options.axis_count = 1;
        options.permit_id = drawn_.machine.can.permit_id;
        options.stop_id = drawn_.machine.can.stop_id;
        begin_us_ = now_us_ + 1000;
        ASSERT_TRUE(axg_board_power_up(&board_, &options, draw_nonce(),
                                       static_cast<std::uint64_t>(begin_us_)));
    }
    std::uint32_t draw_nonce() { return static_cast<std::uint32_t>(dice_.in(0, 0xFFFFFF)); }

    void sample() {
        const std::int64_t at_us = grid_us(number_) - static_cast<std::int64_t>(dice_.in(0, 10));
        move_to(at_us);
        const axg_board_sample latched{static_cast<std::uint64_t>(at_us),
                                       static_cast<std::uint16_t>(number_ / kLap),
                                       static_cast<std::uint8_t>(number_ % kLap + 1)};
        ASSERT_TRUE(axg_board_latch(&board_, &latched));
        if (number_ == kArmedAt) {
            while (axg_board_arm(&board_, draw_nonce(), static_cast<std::uint64_t>(at_us)) !=
                   AXG_BOARD_ARMING_DONE) {
            }
        }
        if (drawn_.story == Story::played_back) {
            play_back();
        } else {
            hear_sample(at_us);
        }
    }
    /// The guard's side of a sample: a permit, nothing, or its stop.
    void hear_sample(std::int64_t latched_us) {
        AxisSnapshot snapshot;
        snapshot.sample = number_;
        snapshot.axis_count = 1;
        snapshot.position[0] = axis_.position + dice_.in(-1, 1) * 1e-3;
        const bool is_certified = guard_.certifies(snapshot);
        if (number_ <= kArmedAt || has_stopped_) {
            return;
        }
        const std::int64_t sent_us = latched_us + drawn_.response_us;
        if (is_certified) {
            has_permitted_ = true;
            send_pair(guard_.permit(number_, board_.nonce), sent_us);
        } else if (has_permitted_) {
            has_stopped_ = true;
            if (!drawn_.stops_in_silence) {
                send(encode_stop(drawn_.machine.can, 0), sent_us);
            }
        }
    }
    void send_pair(const std::array<CanFrame, 2>& pair, std::int64_t sent_us) {
        if (dice_.chance(drawn_.late)) {
            sent_us +=
                static_cast<std::int64_t>(dice_.in(0, 12) * static_cast<double>(period_us()));
        }
        send(pair[0], sent_us);
        send(pair[1], sent_us + drawn_.twin_us);
    }
    void send(const CanFrame& frame, std::int64_t sent_us) {
        if (sent_us - begin_us_ >= drawn_.killed_us || dice_.chance(drawn_.lost)) {
            return;
        }
        const bool is_held = drawn_.story == Story::held_for_a_lap;
        const std::int64_t since_us = sent_us - begin_us_;
        if (since_us >= drawn_.held_from_us && since_us < drawn_.held_until_us) {
            sent_us = begin_us_ + drawn_.held_until_us;  // one behind the other
        }
        Waiting made{.at_us = sent_us + (is_held ? kLap * period_us() : 0)};
        made.frame.id = frame.id;
        made.frame.length = frame.length_bytes;
        std::copy_n(frame.data.begin(), frame.length_bytes, made.frame.data);
        const auto place = std::upper_bound(
            waiting_.begin(), waiting_.end(), made.at_us,
            [](std::int64_t at_us, const Waiting& one) { return at_us < one.at_us; });
        waiting_.insert(place, made);
    }

    /// Permits of a session in which the axis stood, from power-up on.
    void record() {
        recorded_nonce_ = draw_nonce();
        for (number_ = kArmedAt + 1; number_ < 1500; ++number_) {
            for (const CanFrame& frame : guard_.permit(number_, recorded_nonce_)) {
                recorded_.push_back(frame);
            }
        }
    }
    void play_back() {
        const std::size_t at = 2 * std::size_t{number_ - std::min(number_, kArmedAt + 1)};
        if (number_ > kArmedAt && at + 1 < recorded_.size()) {
            send_pair({recorded_[at], recorded_[at + 1]}, grid_us(number_) + drawn_.response_us);
        }
    }

    /// Frames, ends of permits and the beginning of motion, in order.
    void deliver_until(std::int64_t until_us) {
        while (!is_over()) {
            const std::int64_t frame_us = waiting_.empty() ? kNone : waiting_.front().at_us;
            const std::int64_t end_us =
                is_moving_ && brake_us_ == kNone ? static_cast<std::int64_t>(board_.end_us) : kNone;
            const std::int64_t next = std::min(frame_us, end_us);
            if (next > until_us) {
                break;
            }
            move_to(next);
            if (end_us <= frame_us) {
                look();
                continue;
            }
            const axg_board_can_frame frame = waiting_.front().frame;
            waiting_.pop_front();
            hear(frame);
            look();
        }
        move_to(until_us);
    }
    /// What the board makes of this instant.
    void look() {
        const auto now_us = static_cast<std::uint64_t>(now_us_);
        const bool may_move = axg_board_may_move(&board_, now_us).may_move;
        if (may_move && !is_moving_ && brake_us_ == kNone) {
            axg_board_moves(&board_, true, now_us);
            is_moving_ = has_moved_ = true;
        } else if (!may_move && is_moving_ && brake_us_ == kNone) {
            const double reaction_s = drawn_.machine.guard.board_reaction_s;
            // The reaction is a time of the world, not of the board's timer.
            brake_us_ = now_us_ + static_cast<std::int64_t>(reaction_s * 1e6 / drawn_.clock);
        }
    }

    void hear(axg_board_can_frame frame) {
        const bool is_plain = frame.id == drawn_.machine.can.permit_id;
        if (is_plain && (without_ == Without::lap || without_ == Without::nonce)) {
            forgive(frame);
        }
        const auto now_us = static_cast<std::uint64_t>(now_us_);
        if (!is_plain && without_ == Without::latch) {  // as if latched as its permit came
            axg_board_record* const record = record_of(board_.plain[1]);
            if (record != nullptr) {
                record->sample.latched_us = now_us;
            }
        }
        if (!is_plain && forgiven_) {
            frame.data[3] = static_cast<std::uint8_t>(~board_.plain[3]);
            frame.data[4] = static_cast<std::uint8_t>(~board_.plain[4]);
        }
        const std::uint64_t before = board_.refused[AXG_BOARD_REFUSED_LATE];
        const axg_board_heard heard = axg_board_frame(&board_, &frame, now_us);
        if (heard == AXG_BOARD_HEARD_PERMIT) {
            if (without_ == Without::echo) {
                board_.end_us = now_us + 4000;
            }
            tally_.used_late += board_.last.end_us <= now_us ? 1 : 0;
        } else if (without_ == Without::late && board_.refused[AXG_BOARD_REFUSED_LATE] != before) {
            use_late();
        }
    }
    /// As the library would, were it not for that check.
    void use_late() {
        const axg_board_record* const record = record_of(board_.plain[1]);
        const std::uint64_t end_us =
            record->sample.latched_us +
            static_cast<std::uint64_t>((board_.plain[7] >> 4U) * period_us());
        board_.end_us = board_.has_end ? std::max(board_.end_us, end_us) : end_us;
        board_.has_end = true;
        tally_.used_late += end_us <= static_cast<std::uint64_t>(now_us_) ? 1 : 0;
    }
    axg_board_record* record_of(std::uint8_t echo) {
        for (axg_board_record& record : board_.records) {
            if (record.is_kept && record.sample.sync == echo) {
                return &record;
            }
        }
        return nullptr;
    }
    /// A board that leaves lap or nonce out of the answer takes what is right for another one.
    void forgive(axg_board_can_frame& plain) {
        forgiven_ = false;
        const axg_board_record* const record = record_of(plain.data[1]);
        if (record == nullptr) {
            return;
        }
        const std::uint32_t lap = record->sample.lap;
        const auto said = static_cast<std::uint16_t>(plain.data[3] | plain.data[4] << 8U);
        const bool is_of_before =
            without_ == Without::lap
                ? lap > 0 && said == answer_for(plain.data, board_.nonce, lap - 1)
                : said == answer_for(plain.data, recorded_nonce_, lap);
        if (is_of_before) {
            forgiven_ = true;
            const std::uint16_t right = answer_for(plain.data, board_.nonce, lap);
            plain.data[3] = static_cast<std::uint8_t>(right & 0xFFU);
            plain.data[4] = static_cast<std::uint8_t>(right >> 8U);
        }
    }

    /// The axis truly moves: free towards the wall, then braking no harder than it is promised.
    void move_to(std::int64_t until_us) {
        while (now_us_ < until_us) {
            const bool is_braking = now_us_ >= brake_us_;
            std::int64_t end_us = until_us;
            if (!is_braking) {
                end_us = std::min({end_us, brake_us_, tick_us_});
            }
            const double seconds = static_cast<double>(end_us - now_us_) * 1e-6 * drawn_.clock;
            const Axis& axis = drawn_.machine.axes[0];
            if (is_braking) {
                brake(axis_, {.deceleration = axis.stopping_min, .jerk = axis.jerk_max}, seconds);
            } else if (is_moving_) {
                axis_ = moved_on(axis_, seconds);
            }
            now_us_ = end_us;
            if (now_us_ == tick_us_) {
                tick_us_ += kTickUs;
                axis_.jerk = approach_jerk(axis, axis_, kWall + 500, drawn_.speed_share,
                                           kTickUs * 1e-6 * drawn_.clock);
            }
        }
    }

    const Drawn& drawn_;
    Without without_;
    Tally& tally_;
    Dice dice_;
    WallGuard guard_;
    axg_board board_{};
    AxisMotion axis_;
    std::deque<Waiting> waiting_;
    std::vector<CanFrame> recorded_;
    std::int64_t now_us_ = 0, begin_us_ = 0, tick_us_ = 0, brake_us_ = kNone;
    std::uint32_t number_ = 0, recorded_nonce_ = 0;
    bool is_moving_ = false, has_moved_ = false, has_permitted_ = false, has_stopped_ = false;
    bool forgiven_ = false;
};

Tally run(std::uint64_t seed, std::uint64_t count, Without without, Story story) {
    Dice dice(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < count && !testing::Test::HasFatalFailure(); ++i) {
        const Drawn drawn = draw_approach(dice, story, without);
        Run(drawn, without, tally).play();
    }
    return tally;
}

void print(const char* name, const Tally& t) {
    const auto count = [](std::uint64_t n) { return static_cast<unsigned long long>(n); };
    std::printf(
        "%-34s %7llu approaches, %7llu moved, %6llu touch, %6llu permits used after their "
        "end, least %.4f mm\n",
        name, count(t.approaches), count(t.moved), count(t.contacts), count(t.used_late),
        t.least_mm);
}

// Half of the guards are killed at a random instant; of the others the stop frame is mostly lost.
TEST(BoardContract, NoApproachTouchesAndWithoutARuleSomeDo) {
    const std::uint64_t seed = printed_seed(20261201);
    const std::uint64_t count = count_from_environment(2000);
    const Tally killed = run(seed, count, Without::nothing, Story::killed);
    print("guard killed", killed);
    const Tally held = run(seed, count / 8, Without::nothing, Story::held_for_a_lap);
    print("held for a lap", held);
    const Tally played = run(seed, count / 8, Without::nothing, Story::played_back);
    print("played back after arming", played);
    for (const Tally& whole : {killed, held, played}) {
        EXPECT_EQ(whole.contacts, 0U);
        EXPECT_EQ(whole.used_late, 0U);
    }
    EXPECT_EQ(held.moved + played.moved, 0U) << "nothing of another lap or session is obeyed";
    EXPECT_GT(held.refused, 0U);
    EXPECT_GT(played.refused, 0U);
    const std::uint64_t few =
        std::clamp<std::uint64_t>(count / 3, 666, 1000);  // fewer tell nothing
    const auto without = [&](const char* name, Without rule, Story story) {
        const Tally tally = run(seed + 1, few, rule, story);
        print(name, tally);
        return tally;
    };
    const Tally latch = without("the end counts from arrival", Without::latch, Story::killed);
    const Tally echo = without("the end is 4 ms after the pair", Without::echo, Story::killed);
    const Tally lap = without("no lap, held for a lap", Without::lap, Story::held_for_a_lap);
    const Tally nonce = without("no nonce, played back", Without::nonce, Story::played_back);
    const Tally late = without("late permits are used", Without::late, Story::killed);
    if (count >= 500) {
        constexpr const char* kWeak = "too weak to tell anything";
        EXPECT_GT(5 * killed.moved, 4 * killed.approaches) << kWeak;
        EXPECT_LT(killed.least_mm, 0.5) << kWeak;
        EXPECT_GT(latch.contacts, 0U) << kWeak;
        EXPECT_GT(echo.contacts, 0U) << kWeak;
        EXPECT_GT(lap.contacts, 0U) << kWeak;
        EXPECT_GT(nonce.contacts, 0U) << kWeak;
        EXPECT_GT(late.used_late, 0U) << kWeak;
    }
}

}  // namespace
}  // namespace axg::test
