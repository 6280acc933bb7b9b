// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/board_test/board_player.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/guard/monitor.hpp"
#include "firmware_if/protocol/guard_frames.hpp"

namespace axg {

namespace {

constexpr int kAttempts = 3;
constexpr std::int64_t kSecondUs = 1'000'000;
constexpr std::int64_t kListenUs = 5 * kSecondUs;  // for samples and a session
constexpr std::int64_t kAgreeUs = 2 * kSecondUs;   // for four hashes
constexpr std::int64_t kWindowUs = 300'000;        // of a fault that must have no effect
constexpr std::int64_t kTurnUs = 20'000;           // longer than an axis rests where it turns
constexpr std::int64_t kLateUs = 10'000;           // of the whole guard
constexpr std::int64_t kLapseSamples = 20;         // until every permit on its way has ended
constexpr double kStampS = 300e-6;                 // between stamps of two frames of this computer

}  // namespace

BoardPlayer::BoardPlayer(const Machine& machine, const BoardTestOptions& options)
    : machine_(machine),
      options_(options),
      receiver_(machine, {.refuse_local = !options.accepts_local}),
      handshake_(machine.can, options.hashes),
      record_(machine),
      watch_(machine, options.cap),
      rest_(machine) {
    choose_cases();
}

/// Cases that do not apply to the machine, or were not chosen, become findings at once.
void BoardPlayer::choose_cases() {
    const double period_s = machine_.can.sample_us * 1e-6;
    const double samples = machine_.can.permit_samples.most;
    const double wanted = 4 + std::ceil(seen_reaction_s(machine_) / period_s);
    for (const BoardCase& one : board_cases()) {
        BoardFinding finding{one.name, one.rule, one.demands, Outcome::not_tested, "", 0, one.mend};
        const bool is_first = findings_.size() < kFirstCases;
        if (!is_first && !options_.only.empty() && options_.only != one.name) {
            finding.found = "not chosen";
        } else if (one.need == CaseNeed::jog && !options_.has_jog) {
            finding.found = "no jog: pass --jog if a person can select one";
        } else if (one.need == CaseNeed::cap && options_.cap == CapPromise::none) {
            finding.found = "the board has no cap: pass --cap";
        } else if (one.need == CaseNeed::hashes && !handshake_.is_wanted()) {
            finding.found = "the machine file has no hashes_in and hashes_out";
        } else if (one.need == CaseNeed::more_samples && samples < wanted) {
            finding.found = fmt::format(
                "can.permit_samples {} is too short to judge (minimum {:.0f})", samples, wanted);
        } else if (one.need == CaseNeed::samples_above && samples >= kPermitSamplesMax) {
            finding.found = "n has no larger value";
        } else {
            cases_.push_back(&one);
        }
        findings_.push_back(std::move(finding));
    }
}

std::string BoardPlayer::unplayed() const {
    const auto finding =
        std::find_if(findings_.begin(), findings_.end(),
                     [this](const BoardFinding& one) { return one.name == options_.only; });
    return finding == findings_.end() ? std::string() : finding->found;
}

PermitWord BoardPlayer::good_word() const noexcept {
    return mode_ == kModeJog ? PermitWord::jog : PermitWord::run;
}

std::uint8_t BoardPlayer::good_samples() const noexcept {
    const BoardCase* const one = current();
    const bool is_own = one != nullptr && one->samples_before >= 0;
    return is_own ? static_cast<std::uint8_t>(one->samples_before)
                  : machine_.can.permit_samples.most;
}

bool BoardPlayer::is_jog_case() const noexcept {
    return current() != nullptr && current()->start == CaseStart::jogging;
}

bool BoardPlayer::is_brake_case() const noexcept {
    return current() != nullptr && (current()->demand == CaseDemand::brakes_at_end ||
                                    current()->demand == CaseDemand::brakes_at_once);
}

double BoardPlayer::stop_seconds_max() const noexcept {
    double longest = 0;
    for (const Axis& axis : machine_.axes) {
        const double ramp_s = has_jerk_limit(axis) ? axis.stopping_min / axis.jerk_max : 0;
        longest = std::max(longest, axis.speed_max / axis.stopping_min + ramp_s);
    }
    return 2 * (longest + seen_reaction_s(machine_)) + kWindowUs * 1e-6;
}

void BoardPlayer::enter(Stage stage) {
    stage_ = stage;
    entered_us_ = now_us_;
    entered_sample_ = record_.is_empty() ? 0 : record_.newest().number;
    if (stage == Stage::arm) {
        task_ = is_jog_case() ? PersonTask::arm_jog : PersonTask::arm;
    } else {
        task_ = PersonTask::nothing;
    }
    const bool has_ended = stage == Stage::closing && abandoned_.empty();
    if ((stage == Stage::settle || stage == Stage::arm || has_ended) && !has_resumed_ &&
        !rest_.is_on()) {
        rest_.begin(entered_sample_, 0,
                    kLapseSamples * machine_.can.sample_us * 1e-6 + seen_reaction_s(machine_), {});
    }
}

void BoardPlayer::interrupt(const std::string& why) {
    if (stage_ != Stage::closing && stage_ != Stage::over) {
        abandon(why);
    }
}

void BoardPlayer::abandon(std::string why) {
    abandoned_ = std::move(why);
    waiting_.clear();
    enter(Stage::closing);
}

void BoardPlayer::end_case(Outcome outcome, std::string found, std::int64_t at_us) {
    if (current() == nullptr || is_judged_) {
        return;
    }
    is_judged_ = true;
    for (BoardFinding& finding : findings_) {
        if (finding.name == current()->name) {
            finding.outcome = outcome;
            finding.found = std::move(found);
            finding.at_us = at_us;
            return;
        }
    }
}

void BoardPlayer::begin_case() {
    is_judged_ = is_late_ = has_resumed_ = false;
    rest_.end();
    steady_samples_ = 0;
    event_us_.reset();
    cap_ = kPermitCapNone;
    handshake_.begin(now_us_);
    enter(Stage::agree);
}

/// Plays a case without a result again, kAttempts times in all.
void BoardPlayer::next_case() {
    if (!is_judged_ && ++attempts_ < kAttempts) {
        enter(Stage::arm);
        return;
    }
    if (!is_judged_) {
        end_case(Outcome::unclear, unclear_);
    }
    if (case_ == 0 && findings_.front().outcome != Outcome::passed) {
        abandon("no result without motion at a steady speed: " + findings_.front().found);
        return;
    }
    attempts_ = 0;
    ++case_;
    if (current() == nullptr) {
        enter(Stage::closing);
        return;
    }
    enter(Stage::arm);
}

// --- Frames out ------------------------------------------------------------------------------

void BoardPlayer::send(const CanFrame& frame, std::int64_t due_us) {
    CanFrame waiting = frame;
    waiting.time_us = due_us;
    const auto after = std::upper_bound(
        waiting_.begin(), waiting_.end(), due_us,
        [](std::int64_t wanted, const CanFrame& one) { return wanted < one.time_us; });
    waiting_.insert(after, waiting);
}

void BoardPlayer::send_stop(bool is_long) {
    CanFrame frame = encode_stop(machine_.can, now_us_);
    frame.length_bytes = is_long ? 8 : frame.length_bytes;
    send(frame, now_us_);
}

void BoardPlayer::send_good() {
    PermitEdit good;
    good.samples = good_samples();
    if (cap_ != kPermitCapNone && stage_ == Stage::fault) {
        good.cap = cap_;
        good.mask = cap_mask_;
    }
    send_pair(good, true);
}

/// Sends a permit for the newest sample, or for the older one of the edit. No effect while the
/// receiver has no session for it.
void BoardPlayer::send_pair(const PermitEdit& edit, bool is_good) {
    const auto back = static_cast<std::uint8_t>(edit.echo_back % kSyncCounterMax);
    const auto echo = static_cast<std::uint8_t>(
        (sync_counter_ + kSyncCounterMax - back - 1) % kSyncCounterMax + 1);
    const std::optional<SampleSession> session = receiver_.session_of(echo);
    if (!session) {
        return;
    }
    live_ = static_cast<std::uint8_t>(live_ + edit.live_step);
    Permit permit{.word = good_word(),
                  .sync_counter = echo,
                  .live_counter = live_,
                  .known_answer_signature = kKnownAnswerSignature,
                  .samples = machine_.can.permit_samples.most,
                  .nonce = edit.is_former_nonce ? former_nonce_ : nonce_,
                  .lap = session->lap};
    permit = edited(permit, edit);
    const std::int64_t period_us = machine_.can.sample_us;
    const std::int64_t latched_us = record_.newest().latched_us;
    const std::int64_t end_us = latched_us + permit.samples * period_us;
    const std::int64_t due_us =
        edit.is_too_late ? std::max(latched_us + kLateUs, end_us + period_us / 2) : now_us_;
    const PairFrames frames = edit.shape == PairShape::again
                                  ? last_good_
                                  : frames_of(machine_.can, permit, edit.shape, due_us);
    for (std::uint32_t i = 0; i < frames.count; ++i) {
        send(frames.frames[i], std::max(frames.frames[i].time_us, now_us_));
    }
    if (edit.shape == PairShape::interleaved) {
        ++live_;
    }
    watch_.on_permit(permit);
    if (is_good) {
        last_good_ = frames;
        last_good_sample_ = record_.newest().number;
    }
    sent_end_us_[permit.live_counter] = end_us;
}

void BoardPlayer::send_fault() {
    const BoardCase& one = *current();
    const PermitEdit& edit = one.edit;
    const std::uint64_t nth = played_++;
    const std::uint64_t gap = std::uint64_t{good_samples()} + 5;
    const bool is_all_good =
        one.need == CaseNeed::cap || one.event != CaseEvent::none || (edit.is_gap && nth >= gap);
    const bool is_its_turn = nth % edit.cycle == edit.cycle - 1 && !(edit.is_once && nth > 0);
    if (!is_all_good && is_its_turn) {
        send_pair(edit, false);
    } else if (is_all_good || !(edit.is_alone || edit.is_once)) {
        send_good();
    }
}

void BoardPlayer::play_event() {
    const CanLayout& can = machine_.can;
    switch (current()->event) {
        case CaseEvent::none:
            break;
        case CaseEvent::stop_frame:
        case CaseEvent::long_stop_frame:
            send_stop(current()->event == CaseEvent::long_stop_frame);
            break;
        case CaseEvent::stop_word: {
            PermitEdit stop;
            stop.word = static_cast<std::uint8_t>(PermitWord::stop);
            stop.samples = 0;
            send_pair(stop, false);
            break;
        }
        case CaseEvent::other_hash:
            send(encode_hash(can.hashes_out_id, {3, options_.hashes.of[3] ^ 1U}, now_us_), now_us_);
            break;
    }
}

bool BoardPlayer::take(std::int64_t now_us, CanFrame& out) {
    if (waiting_.empty() || waiting_.front().time_us > now_us) {
        return false;
    }
    out = waiting_.front();
    out.time_us = now_us;
    waiting_.pop_front();
    return true;
}

std::int64_t BoardPlayer::next_due_us() const noexcept {
    const std::int64_t frame_us = waiting_.empty() ? INT64_MAX : waiting_.front().time_us;
    if (stage_ == Stage::closing) {
        return std::min({frame_us, heartbeat_us_, stop_us_});
    }
    return is_over() ? frame_us : std::min({frame_us, heartbeat_us_, handshake_.next_due_us()});
}

// --- Frames in -------------------------------------------------------------------------------

void BoardPlayer::on_time(std::int64_t now_us) {
    if (!has_time_) {
        has_time_ = true;
        heartbeat_us_ = entered_us_ = now_us;
    }
    now_us_ = std::max(now_us_, now_us);
    if (is_over()) {
        return;
    }
    if (now_us_ >= heartbeat_us_) {
        heartbeat_us_ = now_us_ + kHeartbeatPeriodUs;
        send(encode_guard_heartbeat(machine_.can, GuardHeartbeat::running, now_us_), now_us_);
    }
    if (stage_ == Stage::closing) {
        step_closing();
        note_fault(receiver_.on_time(now_us_));
        return;
    }
    if (now_us_ >= handshake_.next_due_us()) {
        const CanFrame hash = handshake_.next(now_us_);
        const bool is_wrong_now =
            stage_ == Stage::fault && current()->event == CaseEvent::other_hash;
        if (!is_wrong_now) {
            send(hash, now_us_);
        }
    }
    if (stage_ == Stage::listen && since_us() > kListenUs) {
        abandon_listening();
    } else if (!record_.is_empty() && now_us_ - record_.newest().latched_us > kSecondUs) {
        abandon("the samples ended: the board or the bus is off");
    } else if (stage_ == Stage::arm && since_us() > options_.person_us_max) {
        abandon("the board was not armed: no new nonce in its session frames");
    }
    note_fault(receiver_.on_time(now_us_));
}

void BoardPlayer::abandon_listening() {
    if (has_nonce_ && receiver_.state() == ReceiverState::valid) {
        watch_.fail(Watched::braking, now_us_,
                    "axes move without a permit, and stop frames do not stop them");
        abandon("the board moves, and no stop frame stops it");
    } else if (!heard_.empty()) {
        abandon("no valid samples within 5 s: " + heard_);
    } else if (record_.is_empty()) {
        abandon("no samples within 5 s: check the interface and the machine file");
    } else if (has_nonce_) {
        abandon("no valid samples within 5 s: some are lost or late");
    } else {
        abandon("no session frame within 5 s: the board sends no session");
    }
}

/// Acknowledges each fault: receiver and test continue.
void BoardPlayer::note_fault(const ReceiverEvent& event) {
    if (event.kind == ReceiverEvent::Kind::fault) {
        // Also while listening: with a wrong period no rule can be judged.
        if (stage_ != Stage::listen || event.fault == ReceiverFault::sync_period) {
            watch_.on_fault(event, receiver_.counters().measured_period_ns);
        } else if (event.severity == Severity::stop) {
            heard_ = fault_row(event.fault).meaning;
        }
    }
    if (receiver_.state() == ReceiverState::invalid) {
        receiver_.acknowledge();
    }
}

/// Uses the echo's time as the time at which the frame was on the bus.
void BoardPlayer::on_own(const CanFrame& frame) {
    const BoardCase* const one = current();
    const bool is_stop_word =
        frame.id == machine_.can.permit_id + 1 &&
        frame.data[0] == static_cast<std::uint8_t>(~static_cast<unsigned>(PermitWord::stop));
    if (stage_ == Stage::fault && one != nullptr && !event_us_ &&
        (one->event == CaseEvent::stop_word ? is_stop_word : frame.id == machine_.can.stop_id)) {
        event_us_ = frame.time_us;
        due_ = {.sample = record_.newest().number,
                .later_s = static_cast<double>(frame.time_us - record_.newest().latched_us) * 1e-6,
                .stamp_s = kStampS};
        if (is_brake_case()) {
            begin_rest();
        }
    }
    const bool is_to_move = stage_ == Stage::good || (stage_ == Stage::fault && one != nullptr &&
                                                      one->demand == CaseDemand::goes_on);
    if (is_to_move && frame.id == machine_.can.permit_id + 1) {
        // The board may have stopped because this computer was late.
        const std::int64_t end_us = sent_end_us_[static_cast<std::uint8_t>(~frame.data[2])];
        is_late_ =
            is_late_ || frame.time_us >= end_us || (end_us_ != 0 && frame.time_us >= end_us_);
        end_us_ = std::max(end_us_, end_us);
    }
}

void BoardPlayer::on_frame(const CanFrame& frame, bool is_own) {
    on_time(frame.time_us);
    if (is_over()) {
        return;
    }
    if (is_own) {
        on_own(frame);
        return;
    }
    if (frame.id == machine_.can.stop_id && !frame.error && !frame.extended) {
        interrupt(
            fmt::format("another sender sent the stop frame 0x{:03X}: the cause of the board's "
                        "stop is ambiguous",
                        frame.id));
    }
    if (handshake_.on_frame(frame) == Handshake::Heard::different) {
        watch_.fail(Watched::hash_answers, frame.time_us,
                    fmt::format("{}: found 0x{:08X}, expected 0x{:08X}",
                                kHashPartNames[handshake_.theirs().part], handshake_.theirs().hash,
                                handshake_.ours(handshake_.theirs().part)));
    }
    Session session;
    if (frame.id == machine_.can.session_in_id &&
        decode_session(frame.id, frame, session) == FrameStatus::ok) {
        if (has_nonce_ && session.nonce != nonce_ && stage_ != Stage::listen) {
            watch_.on_new_nonce(session.nonce, frame.time_us);
        }
        watch_.on_session(session, frame.time_us);
    }
    const ReceiverEvent event = receiver_.on_frame(frame);
    note_fault(event);
    if (event.kind == ReceiverEvent::Kind::snapshot) {
        on_sample(event);
    }
}

void BoardPlayer::note_nonce(std::int64_t time_us) {
    const std::optional<SampleSession> session = receiver_.session_of(sync_counter_);
    if (!session || (has_nonce_ && session->nonce == nonce_)) {
        return;
    }
    const bool is_first = !has_nonce_;
    former_nonce_ = nonce_;
    nonce_ = session->nonce;
    has_nonce_ = true;
    if (is_first) {
        return;
    }
    if (stage_ == Stage::arm) {
        return;  // step_arm() goes on
    }
    watch_.fail(Watched::new_nonce, time_us, "a new nonce without a request to arm");
}

void BoardPlayer::on_sample(const ReceiverEvent& event) {
    sync_counter_ = event.sync_counter;
    mode_ = event.snapshot.mode;
    record_.add(event.snapshot);
    const std::uint32_t nonce_before = nonce_;
    note_nonce(event.time_us);
    if (stage_ != Stage::listen) {
        const bool is_stop = stage_ == Stage::settle || (stage_ == Stage::fault && is_brake_case());
        watch_.on_sample(event, record_, is_stop && !record_.rests(kTurnUs));
        watch_mode();
        watch_rest();
        if (watch_.is_unusable() && stage_ != Stage::closing) {
            abandon("no judgement from these samples: correct rule 1 first");
            return;
        }
    }
    switch (stage_) {
        case Stage::listen:
            step_listen();
            break;
        case Stage::arm:
            if (has_nonce_ && nonce_ != nonce_before) {
                waiting_.clear();
                begin_case();
            } else {
                step_arm();
            }
            break;
        case Stage::agree:
            if (handshake_.has_agreed() || since_us() > kAgreeUs) {
                if (handshake_.is_wanted()) {
                    watch_.note(Watched::hash_answers);
                }
                if (!handshake_.has_agreed()) {
                    watch_.fail(Watched::hash_answers, now_us_, "not all four answered within 2 s");
                }
                end_us_ = 0;
                enter(Stage::good);
                if (current()->start == CaseStart::resting) {
                    begin_fault();
                }
            }
            break;
        case Stage::good:
            step_good();
            break;
        case Stage::fault:
            step_fault();
            break;
        case Stage::control:
            step_control();
            break;
        case Stage::settle:
            step_settle();
            break;
        case Stage::probe:
            step_probe();
            break;
        case Stage::closing:
        case Stage::over:
            break;
    }
}

}  // namespace axg
