// SPDX-License-Identifier: Apache-2.0
// A motion board on a bench, by the library for boards: a program that runs to and fro, a person
// who arms it, and one rule that it breaks. How it breaks it is put between the bus and the
// library: a frame that the board ought to refuse is made into one that the library takes.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <vector>

#include "core/machine/configuration_hashes.hpp"
#include "core/machine/machine.hpp"
#include "firmware_if/board/axguard_board.h"
#include "firmware_if/protocol/axis_frames.hpp"
#include "firmware_if/protocol/permit_frames.hpp"
#include "hil_replay/board/axis_motion.hpp"
#include "tests/support/broken_rule.hpp"
#include "tests/support/permit_bytes.hpp"
#include "tests/support/unasked_motion.hpp"

namespace axg::test {

struct BenchOptions {
    Broken broken = Broken::nothing;
    ConfigurationHashes hashes;
    bool has_cap = false;
    double feed_mm_s = 100, half_way_mm = 100;  // of the program, on axis 0
    std::int64_t reaction_us = 1300;
    bool has_tool_change = true;    // once, at rest, before the third arming
    bool sends_old_values = false;  // positions of the SYNC before
};

class BenchBoard {
  public:
    BenchBoard(const Machine& machine, const BenchOptions& options)
        : machine_(machine), options_(options), set_(make_frame_set(machine)) {
        axg_board_options board{};
        board.period_us = machine.can.sample_us;
        board.jitter_us = 20;
        board.reaction_us = 2000;
        board.permit_samples_max =
            is(Broken::takes_samples_above) ? std::uint8_t{15} : machine.can.permit_samples.most;
        board.axis_count = static_cast<std::uint8_t>(machine.axes.size());
        for (std::size_t i = 0; i < machine.axes.size(); ++i) {
            board.endless_axes |=
                static_cast<std::uint16_t>(machine.axes[i].unlimited ? 1U << i : 0);
        }
        board.cap_kind = options.has_cap ? AXG_BOARD_CAP_ENFORCED : AXG_BOARD_CAP_IGNORED;
        board.permit_id = machine.can.permit_id;
        board.stop_id = machine.can.stop_id;
        board.hashes_id = is(Broken::moves_without_hashes) ? 0 : machine.can.hashes_out_id;
        std::copy(options.hashes.of.begin(), options.hashes.of.end(), std::begin(board.hashes));
        axg_board_power_up(&board_, &board, nonce_, 0);
    }

    [[nodiscard]] std::int64_t next_latch_us() const noexcept { return next_us_; }
    [[nodiscard]] bool is_at_rest() const noexcept { return state_ == State::resting; }

    /// A person: chooses a jog or none, and arms. False: the axes do not rest for long enough.
    bool arm(bool is_jog) {
        if (state_ != State::resting || now_us_ < rests_since_us_ + kRestUs) {
            return false;
        }
        if (is_jog != is_jogging_) {
            is_jogging_ = is_jog;
            axg_board_change(&board_, is_jog, library_us());
        }
        if (++armings_ == 3 && options_.has_tool_change) {
            tool_left_ = is(Broken::changes_tool_early) ? 3 : kToolSamples;
        }
        if (tool_left_ > 0 && !is(Broken::changes_tool_in_stop)) {
            return true;  // armed when the tool is there
        }
        arm_now();
        return true;
    }

    /// Frames of the next sample; `time_us` when each is ready.
    std::vector<CanFrame> latch() {
        advance(next_us_);
        step_tool();
        std::vector<CanFrame> out;
        sync_ = sync_counter_of(sample_);
        lap_ =
            static_cast<std::uint16_t>(is(Broken::counts_no_laps) ? 0 : sample_ / kSyncCounterMax);
        const axg_board_sample sample{library_us(),
                                      static_cast<std::uint16_t>(sample_ / kSyncCounterMax), sync_};
        axg_board_latch(&board_, &sample);
        put_samples(out);
        put_others(out);
        ++sample_;
        next_us_ += machine_.can.sample_us +
                    (is(Broken::period_is_long) ? machine_.can.sample_us * 3 / 100 : 0);
        return out;
    }

    /// A frame of the guard at its end on the wire; frames in answer.
    std::vector<CanFrame> hear(const CanFrame& frame) {
        advance(frame.time_us);
        std::vector<CanFrame> out;
        const bool is_stop = frame.id == machine_.can.stop_id;
        if (is_stop && (is(Broken::ignores_stop_frame) ||
                        (frame.length_bytes != 0 && is(Broken::ignores_long_stop_frame)))) {
            return out;
        }
        if (is_stop) {
            must_stop_ = true;
        }
        if (frame.id == machine_.can.permit_id) {
            hear_plain(frame);
        } else if (frame.id == machine_.can.permit_id + 1) {
            hear_inverted(frame);
        } else {
            const axg_board_heard heard = feed(frame);
            if (machine_.can.hashes_out_id != 0 && frame.id == machine_.can.hashes_out_id) {
                axg_board_can_frame answer{};
                (void)heard;
                axg_board_encode_hash(&board_, machine_.can.hashes_in_id, frame.data[0], &answer);
                answer.data[4] = static_cast<std::uint8_t>(
                    answer.data[4] ^ (is(Broken::answers_wrong_hash) ? 1U : 0U));
                out.push_back(made(answer));
            }
        }
        return out;
    }

  private:
    enum class State { resting, moving, doomed, braking };  // doomed: it reacts
    static constexpr std::int64_t kTickUs = 50, kRestUs = 30'000, kLibraryUs = 1'000'000;
    static constexpr int kToolSamples = 60;

    [[nodiscard]] bool is(Broken broken) const noexcept { return options_.broken == broken; }
    [[nodiscard]] std::uint64_t library_us() const noexcept {
        return static_cast<std::uint64_t>(now_us_ + kLibraryUs);
    }

    void arm_now() {
        const std::uint32_t before = board_.nonce;
        if (axg_board_arm(&board_, ++nonce_, library_us()) != AXG_BOARD_ARMING_DONE) {
            return;
        }
        former_nonce_ = before;
        must_stop_ = false;
        stopped_us_ = 0;
        if (is(Broken::keeps_nonce)) {
            board_.nonce = before;
        }
        board_.is_admitted = board_.is_admitted || is(Broken::moves_on_first_permit);
    }

    // --- Motion --------------------------------------------------------------------------------

    [[nodiscard]] bool may_move() {
        const bool may = axg_board_may_move(&board_, library_us()).may_move;
        if (is(Broken::goes_on_after_end) && state_ == State::moving) {
            return !must_stop_;
        }
        return may;
    }

    void tell(bool moves) {
        if (!is(Broken::ends_do_not_latch)) {
            axg_board_moves(&board_, moves, library_us());
        }
    }

    void advance(std::int64_t until_us) {
        while (now_us_ < until_us) {
            const std::int64_t to_us = std::min(until_us, now_us_ + kTickUs);
            tick(static_cast<double>(to_us - now_us_) * 1e-6);
            now_us_ = to_us;
        }
    }

    void tick(double seconds) {
        const bool may = may_move();
        if (state_ == State::resting && may) {
            state_ = State::moving;
            axis_.acceleration = axis_.jerk = 0;
            tell(true);
        } else if (state_ == State::moving && !may) {
            state_ = State::doomed;
            brake_us_ = now_us_ + (is(Broken::reacts_late) ? 6000 : options_.reaction_us);
        } else if (state_ == State::doomed && is(Broken::ends_do_not_latch) && may) {
            state_ = State::moving;
        }
        if (state_ == State::doomed && now_us_ >= brake_us_) {
            state_ = State::braking;
            stopped_us_ = now_us_;
            axis_.acceleration = 0;
            tool_left_ = is(Broken::changes_tool_in_stop) && armings_ == 2 ? 30 : tool_left_;
        }
        if (state_ == State::moving || state_ == State::doomed) {
            follow(seconds);
        } else if (state_ == State::braking) {
            stop(seconds, may);
        }
        move_unasked(seconds);
        if (state_ == State::resting && turn_left_mm_ > 0) {
            const double step = std::min(turn_left_mm_, 5 * seconds);
            axis_.position -= way_ * step;
            turn_left_mm_ -= step;
        }
    }

    void move_unasked(double seconds) {
        const double after_s =
            stopped_us_ == 0 ? -1 : static_cast<double>(now_us_ - stopped_us_) * 1e-6;
        const UnaskedMotion motion =
            unasked_motion(options_.broken, after_s, state_ == State::resting);
        axis_.position += motion.x_mm_s * seconds;
        other_mm_ += other_mm_ < 150 ? motion.y_mm_s * seconds : 0;
    }

    void stop(double seconds, bool may) {
        if (may && is(Broken::ends_do_not_latch)) {
            state_ = State::moving;
            return;
        }
        const Axis& axis = machine_.axes[0];
        const double share = is(Broken::brakes_softly) ? 0.5 : 1.2;
        brake(axis_, {.deceleration = share * axis.stopping_min, .jerk = axis.jerk_max}, seconds);
        if (!is_resting(axis_)) {
            return;
        }
        state_ = State::resting;
        rests_since_us_ = now_us_;
        turn_left_mm_ = is(Broken::turns_round) ? 0.5 : 0;
        tell(false);
    }

    /// To and fro, at the feed or what the cap leaves of it.
    void follow(double seconds) {
        const Axis& axis = machine_.axes[0];
        if (std::abs(axis_.position) > options_.half_way_mm && axis_.position * way_ > 0) {
            way_ = -way_;
        }
        const double feed = is_jogging_ ? 20 : options_.feed_mm_s;
        way_ = is_jogging_ ? 1 : way_;
        const double wanted = way_ * std::min(feed, bound() * axis.speed_max / 250);
        const double step = axis.acceleration_max * seconds * 0.9;
        axis_.speed += std::clamp(wanted - axis_.speed, -step, step);
        axis_.position += axis_.speed * seconds;
    }

    /// The cap that it keeps, and reports.
    [[nodiscard]] double bound() {
        if (!options_.has_cap) {
            return AXG_BOARD_CAP_NONE;
        }
        const axg_board_motion motion = axg_board_may_move(&board_, library_us());
        const std::uint8_t ordered = motion.ordered.of[0];
        if (ordered == 0 && is(Broken::hold_is_a_stop)) {
            axg_board_stop(&board_, library_us());
        }
        const double share = std::abs(axis_.speed) / machine_.axes[0].speed_max * 250;
        const auto has = static_cast<std::uint8_t>(std::min(250.0, std::ceil(share - 1e-9)));
        axg_board_caps wanted;
        const bool lies = is(Broken::acks_at_once);
        std::fill(std::begin(wanted.of), std::end(wanted.of),
                  lies ? ordered : std::max(ordered, has));
        const axg_board_caps keeps = axg_board_keeps(&board_, &wanted, library_us());
        return lies ? 250.0 : std::min<double>(ordered, keeps.of[0]);
    }

    /// Announced before the third arming; with the fault a tool comes in the stop.
    void step_tool() {
        if (tool_left_ > 0 && --tool_left_ == 0) {
            ++tool_;
            if (!is(Broken::changes_tool_in_stop)) {
                axg_board_change(&board_, is_jogging_, library_us());
                arm_now();
            }
        }
    }

    // --- Frames of the guard -------------------------------------------------------------------

    axg_board_heard feed(const CanFrame& frame) {
        axg_board_can_frame heard{};
        heard.id = frame.id;
        heard.is_fd = frame.fd;
        heard.length = frame.length_bytes;
        std::copy_n(frame.data.begin(), frame.length_bytes, std::begin(heard.data));
        return axg_board_frame(&board_, &heard, library_us());
    }

    void hear_plain(const CanFrame& frame) {
        if (is(Broken::ignores_inverted)) {
            hear_pair(frame, inverse_of(frame));
        } else if (is(Broken::takes_either_order) && has_inverted_ &&
                   inverse_of(frame).data == inverted_.data) {
            has_inverted_ = false;
            hear_pair(frame, inverted_);
        } else {
            former_plain_ = plain_;
            plain_ = frame;
            has_plain_ = true;
        }
    }

    void hear_inverted(const CanFrame& frame) {
        if (is(Broken::ignores_inverted)) {
            return;
        }
        if (!has_plain_) {
            inverted_ = frame;
            has_inverted_ = true;
            return;
        }
        has_plain_ = is(Broken::takes_interleaved);
        CanFrame plain = plain_, inverted = frame;
        if (is(Broken::takes_interleaved) && inverse_of(former_plain_).data == frame.data) {
            plain = former_plain_;
        }
        unsigned wrong = 0;
        for (std::size_t i = 0; i < 8; ++i) {
            const unsigned off = (plain.data[i] ^ inverted.data[i] ^ 0xFFU) & 0xFFU;
            wrong += static_cast<unsigned>(__builtin_popcount(off));
        }
        if ((is(Broken::takes_one_bit) && wrong == 1) ||
            (is(Broken::takes_twin_of_another) && wrong > 1)) {
            inverted = inverse_of(plain);
        }
        if (frame.time_us - plain.time_us > machine_.can.sample_us &&
            !is(Broken::takes_late_twin)) {
            return;
        }
        hear_pair(plain, inverted);
    }

    [[nodiscard]] const axg_board_record* record_of(std::uint8_t sync) const {
        for (const axg_board_record& record : board_.records) {
            if (record.is_kept && record.sample.sync == sync) {
                return &record;
            }
        }
        return nullptr;
    }

    [[nodiscard]] std::array<CanFrame, 2> sealed(Permit permit) const {
        const axg_board_record* const record = record_of(permit.sync_counter);
        permit.nonce = board_.nonce;
        permit.lap = record != nullptr ? record->sample.lap : std::uint16_t{0};
        return encode_any_permit(machine_.can, permit, now_us_);
    }

    /// Whether the pair would be right for another lap, nonce or answer.
    [[nodiscard]] bool is_right_for(const CanFrame& plain, int lap_off, std::uint32_t nonce,
                                    std::uint16_t answer_xor) const {
        Permit permit = read(plain);
        const axg_board_record* const record = record_of(permit.sync_counter);
        if (record == nullptr) {
            return false;
        }
        permit.nonce = nonce;
        permit.lap = static_cast<std::uint16_t>(record->sample.lap + lap_off);
        permit.known_answer_signature ^= answer_xor;
        return encode_any_permit(machine_.can, permit, 0)[0].data == plain.data;
    }

    /// The same of the word and of what follows the answer.
    bool bend_content(Permit& permit, CanFrame& plain, CanFrame& inverted) {
        bool is_bent = false;
        switch (options_.broken) {
            case Broken::takes_short_frames:
                is_bent = plain.length_bytes == 7;
                permit.samples = is_bent ? machine_.can.permit_samples.most : permit.samples;
                permit.level = is_bent ? std::uint8_t{0} : permit.level;
                plain.length_bytes = inverted.length_bytes = 8;
                break;
            case Broken::takes_any_word:
                is_bent = permit.word == static_cast<PermitWord>(0xA4);
                permit.word = is_bent ? PermitWord::run : permit.word;
                break;
            case Broken::takes_cap_251:
                is_bent = permit.cap > 250;
                permit.cap = is_bent ? std::uint8_t{250} : permit.cap;
                break;
            case Broken::takes_level_4:
                is_bent = permit.level > 3;
                permit.level = is_bent ? std::uint8_t{3} : permit.level;
                break;
            case Broken::takes_samples_0:
                is_bent = permit.samples == 0 && permit.word != PermitWord::stop;
                permit.samples = is_bent ? machine_.can.permit_samples.most : permit.samples;
                break;
            case Broken::refuses_slow:
                is_bent = permit.word == PermitWord::slow;
                permit.word = is_bent ? static_cast<PermitWord>(0xA4) : permit.word;
                break;
            case Broken::runs_on_jog:
                is_bent = permit.word == PermitWord::jog && !is_jogging_;
                permit.word = is_bent ? PermitWord::run : permit.word;
                break;
            case Broken::jogs_on_run:
                is_bent = permit.word == PermitWord::run && is_jogging_;
                permit.word = is_bent ? PermitWord::jog : permit.word;
                break;
            default:
                break;
        }
        return is_bent;
    }

    /// What the fault makes of a pair that the library would refuse.
    void bend(CanFrame& plain, CanFrame& inverted) {
        Permit permit = read(plain);
        const bool is_right = is_right_for(plain, 0, board_.nonce, 0);
        const auto step = static_cast<std::uint8_t>(permit.live_counter - board_.live);
        bool is_bent = false;
        switch (options_.broken) {
            case Broken::ends_from_arrival:
                is_bent = is_right;
                permit.sync_counter = is_right ? sync_ : permit.sync_counter;
                break;
            case Broken::takes_old_echo:
                board_.has_used = false;
                break;
            case Broken::takes_any_echo:
                is_bent = record_of(permit.sync_counter) == nullptr;
                permit.sync_counter = is_bent ? sync_ : permit.sync_counter;
                break;
            case Broken::takes_any_lap:
                is_bent = is_right_for(plain, -1, board_.nonce, 0);
                break;
            case Broken::takes_any_nonce:
                is_bent = is_right_for(plain, 0, board_.nonce ^ 1U, 0);
                break;
            case Broken::takes_former_nonce:
                is_bent = is_right_for(plain, 0, former_nonce_, 0);
                break;
            case Broken::takes_any_answer:
                is_bent = is_right_for(plain, 0, board_.nonce, 0x0100);
                break;
            case Broken::takes_live_again:
                board_.live = static_cast<std::uint8_t>(board_.live - (step == 0 ? 1 : 0));
                break;
            case Broken::takes_live_16:
                board_.live = static_cast<std::uint8_t>(board_.live + (step == 16 ? 1 : 0));
                break;
            case Broken::live_window_of_3:
                board_.live = static_cast<std::uint8_t>(board_.live - (step > 3 ? 40 : 0));
                break;
            default:
                is_bent = bend_content(permit, plain, inverted);
                break;
        }
        if (is_bent) {
            const auto pair = sealed(permit);
            plain.data = pair[0].data;
            inverted.data = pair[1].data;
        }
    }

    void hear_pair(CanFrame plain, CanFrame inverted) {
        if (inverse_of(plain).data == inverted.data) {
            bend(plain, inverted);
        }
        if (plain.data[0] == 0x5A && is(Broken::ignores_stop_word)) {
            return;
        }
        must_stop_ = must_stop_ || plain.data[0] == 0x5A;
        if (is(Broken::resumes_by_itself) && board_.phase != AXG_BOARD_ARMED && armings_ > 0 &&
            state_ == State::resting && now_us_ > rests_since_us_ + kRestUs) {
            board_.phase = AXG_BOARD_ARMED;
        }
        if (is(Broken::arms_by_itself) && board_.phase != AXG_BOARD_ARMED && armings_ > 0 &&
            state_ == State::resting && now_us_ > rests_since_us_ + kRestUs) {
            arm_now();
        }
        (void)feed(plain);
        const axg_board_heard heard = feed(inverted);
        if (heard == AXG_BOARD_HEARD_PERMIT && is(Broken::newest_end)) {
            board_.end_us = board_.last.end_us;
        }
    }

    // --- Frames of the board -------------------------------------------------------------------

    [[nodiscard]] CanFrame made(const axg_board_can_frame& from) const {
        CanFrame out;
        out.id = from.id;
        out.fd = from.is_fd;
        out.length_bytes = from.length;
        out.time_us = now_us_;
        std::copy_n(std::begin(from.data), from.length, out.data.begin());
        return out;
    }

    void put_samples(std::vector<CanFrame>& out) {
        axg_board_says says{};
        const bool moves = state_ != State::resting;
        says.mode = tool_left_ > 0 ? kModeToolChange
                    : is_jogging_  ? kModeJog
                    : moves        ? kModeMoving
                                   : kModeStandstill;
        // Held at cap 0 it stands, and says so.
        const bool is_wrong = is(Broken::says_it_stands) || axis_.speed == 0;
        says.mode = says.mode == kModeMoving && is_wrong ? kModeStandstill : says.mode;
        says.tool = tool_;
        says.is_homed = !is(Broken::is_not_homed);
        const CanFrame sync = encode_sync(set_.sync_id, sync_, now_us_);
        out.push_back(sync);
        out.back().time_us = now_us_ - bus_time_us(sync, 1'000'000);
        std::vector<std::int32_t> counts(machine_.axes.size(), 0);
        counts[0] = static_cast<std::int32_t>(std::lround(axis_.position / set_.axes[0].unit));
        counts[1] = static_cast<std::int32_t>(std::lround(other_mm_ / set_.axes[1].unit));
        if (options_.sends_old_values) {
            const std::array<std::int32_t, 2> now{counts[0], counts[1]};
            counts[0] = old_counts_[0];
            counts[1] = old_counts_[1];
            old_counts_ = now;
        }
        std::array<axg_board_axis_ids, AXG_BOARD_CLASSICAL_FRAMES_MAX> ids{};
        for (std::uint32_t i = 0; i < set_.frame_count; ++i) {
            ids[i] = {set_.ids[i], set_.data_ids[i]};
        }
        std::array<axg_board_can_frame, AXG_BOARD_CLASSICAL_FRAMES_MAX> frames{};
        const bool is_fd = set_.wire->format == CanFormat::fd;
        axg_board saved = board_;
        if (is(Broken::acks_without_promise)) {
            board_.options.cap_kind = AXG_BOARD_CAP_ENFORCED;
            board_.acked.is_given = true;
            board_.records[board_.newest_record].has_ack = true;
        } else if (is(Broken::never_acks)) {
            board_.records[board_.newest_record].has_ack = false;
        }
        const std::uint8_t count =
            is_fd ? axg_board_encode_fd(&board_, &says, counts.data(), ids[0], frames.data())
                  : axg_board_encode_classical(&board_, &says, counts.data(), ids.data(),
                                               frames.data());
        saved.axes_counter = board_.axes_counter;
        board_ = saved;
        if (is(Broken::loses_samples) && sample_ % 50 == 49) {
            return;
        }
        for (std::uint8_t i = 0; i < count; ++i) {
            out.push_back(made(frames[i]));
        }
    }

    void put_others(std::vector<CanFrame>& out) {
        if (now_us_ >= heartbeat_us_) {
            heartbeat_us_ = now_us_ + kHeartbeatPeriodUs;
            out.push_back(encode_heartbeat(set_.heartbeat_id, kHeartbeatOperational, now_us_));
        }
        const bool is_due = axg_board_is_session_due(&board_, library_us());
        const bool is_new = board_.has_session_changed || board_.nonce != said_nonce_;
        const bool is_held_back =
            is(Broken::session_is_rare) && !is_new && now_us_ < session_us_ + 200'000;
        if (!is_due || is_held_back) {
            return;
        }
        said_nonce_ = board_.nonce;
        session_us_ = now_us_;
        axg_board_can_frame session{};
        const auto data_id = static_cast<std::uint16_t>(machine_.can.session_in_id);
        axg_board_encode_session(&board_, {machine_.can.session_in_id, data_id}, library_us(),
                                 &session);
        CanFrame frame = made(session);
        if (is(Broken::counts_no_laps)) {
            frame = encode_session(
                frame.id,
                {board_.nonce, 0, sync_, static_cast<std::uint8_t>(session_counter_++ & 15U)},
                now_us_);
        }
        out.push_back(frame);
    }

    const Machine& machine_;
    BenchOptions options_;
    AxisFrameSet set_;
    axg_board board_{};
    std::uint32_t nonce_ = 0x5EED00, former_nonce_ = 0, said_nonce_ = 0;
    std::int64_t now_us_ = 0, next_us_ = 1000, heartbeat_us_ = 0, session_us_ = 0;
    std::int64_t brake_us_ = 0, rests_since_us_ = -kRestUs;
    std::uint64_t sample_ = 0;
    std::array<std::int32_t, 2> old_counts_{};  // of the sample before
    std::uint8_t sync_ = 1, session_counter_ = 0;
    std::uint16_t lap_ = 0, tool_ = 1;
    State state_ = State::resting;
    std::int64_t stopped_us_ = 0;
    double other_mm_ = 0;  // of Y
    bool is_jogging_ = false, must_stop_ = false;
    AxisMotion axis_{};
    double way_ = 1, turn_left_mm_ = 0;
    int armings_ = 0, tool_left_ = 0;
    CanFrame plain_, former_plain_, inverted_;
    bool has_plain_ = false, has_inverted_ = false;
};

}  // namespace axg::test
