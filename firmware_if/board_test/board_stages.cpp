// SPDX-License-Identifier: Apache-2.0
// The stages of a case, and the result of each.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/reach/stop_limits.hpp"
#include "firmware_if/board_test/board_player.hpp"

namespace axg {

namespace {

constexpr std::int64_t kSecondUs = 1'000'000;
constexpr std::int64_t kMoveUs = 10 * kSecondUs;  // for a steady speed
constexpr std::int64_t kSteadyUs = 100'000;
constexpr std::int64_t kWindowUs = 300'000;  // of a fault that must have no effect
constexpr std::int64_t kCapUs = 1'500'000;   // to slow down
constexpr std::int64_t kRestUs = 150'000;
constexpr std::int64_t kProbeUs = kSecondUs;
constexpr std::int64_t kQuietUs = 20 * kSecondUs;  // a person walks over
constexpr std::int64_t kCloseUs = kSecondUs;
constexpr std::int64_t kStopEveryUs = 20'000;
constexpr std::int64_t kStillUs = 60'000;          // a stop is over
constexpr std::int64_t kSettleUs = 3 * kSecondUs;  // then a stop frame, then the end
constexpr std::int64_t kHashUs = 50'000;           // from one wrong hash to the next

constexpr std::uint8_t kAllAxes = 0xFF;
constexpr const char* kLateHere = "this host sent permits too late: see axguardd doctor";

/// The bit of the permit that binds this axis.
std::uint8_t mask_of(std::uint32_t axis) noexcept {
    return static_cast<std::uint8_t>(1U << std::min(axis, 7U));
}

}  // namespace

/// Checks that the board's mode reports motion while axes move, and none while they rest.
void BoardPlayer::watch_mode() {
    const bool is_steady = stage_ == Stage::good && steady_samples_ > 0;
    const bool is_jog = mode_ == kModeJog;
    if (is_steady) {
        watch_.note(Watched::mode);
        if (mode_ == kModeStandstill) {
            watch_.fail(Watched::mode, now_us_, "mode 0 while axes move");
        }
    }
    if (stage_ == Stage::arm && since_us() > kRestUs && since_us() < quiet_us() &&
        mode_ == kModeMoving && !is_jog && record_.rests(kRestUs)) {
        watch_.fail(Watched::mode, now_us_, "mode 1 while all axes rest");
    }
}

void BoardPlayer::step_listen() {
    if (!has_nonce_ || receiver_.state() != ReceiverState::valid || since_us() < kRestUs) {
        return;
    }
    send_stop(false);  // ends any earlier arming: only a person can arm again
    if (record_.rests(kRestUs)) {
        handshake_.begin(now_us_);
        enter(Stage::arm);
    }
}

void BoardPlayer::step_arm() {
    const bool is_other_case = is_jog_case() != (mode_ == kModeJog);
    if (since_us() < quiet_us()) {
        return;
    }
    rest_.end();
    if (!has_resumed_ && !is_other_case) {
        send_good();  // a person may have armed it with the nonce of before
    }
    if (const std::uint32_t axis = record_.left_place(entered_sample_); axis != kNoIndex) {
        watch_.fail(Watched::new_nonce, now_us_,
                    fmt::format("{} moves with the previous nonce", machine_.axes[axis].name));
        abandon("the board moved without a new nonce: its arming cannot be detected");
    }
}

/// Time without permits while a person arms: an axis that moves then moves without arming.
std::int64_t BoardPlayer::quiet_us() const noexcept {
    return std::min(kQuietUs, options_.person_us_max / 2);
}

/// Watches the rest of the axes from the due instant of this case on.
void BoardPlayer::begin_rest() {
    const double board_s = std::max(seen_reaction_s(machine_), lapse_s_.value_or(0));
    const double jitter_s = sample_errors(machine_, 0, 0).latch_jitter_s;
    rest_.begin(due_.sample, due_.later_s, board_s + due_.stamp_s + jitter_s, steady_);
}

void BoardPlayer::watch_rest() {
    const std::optional<RestFault> fault = rest_.on_sample(record_);
    if (!fault) {
        return;
    }
    watch_.fail(fault->rule, now_us_, fault->words);
    if (fault->rule != Watched::resume) {
        return;
    }
    has_resumed_ = true;
    if (stage_ == Stage::arm) {
        abandon("the board moved before it was armed");
    }
}

void BoardPlayer::step_good() {
    const std::vector<SteadyAxis> steady = steady_axes(machine_, record_);
    steady_samples_ = steady.empty() ? 0 : steady_samples_ + 1;
    if (static_cast<std::int64_t>(steady_samples_) * machine_.can.sample_us >= kSteadyUs) {
        begin_fault();
        return;
    }
    if (since_us() <= kMoveUs) {
        send_good();
        return;
    }
    const bool has_moved = record_.left_place(entered_sample_) != kNoIndex;
    if (is_late_) {
        unclear_ = kLateHere;
    } else if (has_moved) {
        unclear_ = "it moved, but not for 100 ms at a steady speed, fast enough to judge";
    } else {
        end_case(Outcome::failed, "it did not move with usable permits");
    }
    enter(Stage::settle);
}

void BoardPlayer::begin_fault() {
    steady_ = steady_axes(machine_, record_);
    const std::int64_t period_us = machine_.can.sample_us;
    const auto samples = static_cast<double>(good_samples());
    due_ = {.sample = last_good_sample_,
            .later_s = samples * static_cast<double>(period_us) * 1e-6,
            .stamp_s = 0};
    played_ = 0;
    if (current()->need == CaseNeed::cap && !steady_.empty()) {
        const SteadyAxis& first = steady_.front();
        const double half = 0.5 * std::abs(first.speed) / machine_.axes[first.axis].speed_max;
        const bool is_hold = current()->demand == CaseDemand::holds;
        const bool is_one_axis = options_.cap == CapPromise::per_axis && !is_hold;
        cap_ = is_hold ? std::uint8_t{0}
                       : static_cast<std::uint8_t>(std::clamp(half * kPermitCapNone, 1.0, 249.0));
        cap_mask_ = is_one_axis ? mask_of(first.axis) : kAllAxes;
    }
    enter(Stage::fault);
    if (current()->demand == CaseDemand::brakes_at_end) {
        begin_rest();
    }
    if (current()->event == CaseEvent::stop_word) {
        play_event();
    } else {
        if (current()->event != CaseEvent::none) {
            play_event();
        }
        send_fault();
    }
}

void BoardPlayer::step_fault() {
    const BoardCase& one = *current();
    if (one.event == CaseEvent::other_hash &&
        played_ % static_cast<std::uint64_t>(
                      std::max<std::int64_t>(kHashUs / machine_.can.sample_us, 1)) ==
            0) {
        play_event();
    }
    send_fault();
    const std::uint32_t left = record_.left_place(entered_sample_);
    const std::int64_t window_us = std::max(kWindowUs, std::int64_t{40} * machine_.can.sample_us);
    if (is_brake_case()) {
        const bool is_due = static_cast<double>(since_us()) * 1e-6 > stop_seconds_max();
        if (is_due || (since_us() > kStillUs + std::llround(due_.later_s * 1e6) + 20'000 &&
                       record_.rests(kStillUs))) {
            judge_stop(is_due);
            enter(Stage::settle);
        }
    } else if (one.demand == CaseDemand::rests) {
        if (left != kNoIndex) {
            end_case(Outcome::failed, fmt::format("{} moves", machine_.axes[left].name), now_us_);
            waiting_.clear();
            enter(Stage::settle);
        } else if (since_us() >= window_us) {
            waiting_.clear();
            handshake_.begin(now_us_);
            enter(Stage::control);
        }
    } else if (one.demand == CaseDemand::goes_on) {
        if (since_us() >= window_us) {
            const bool moves = !record_.rests(kStillUs);
            if (!moves && is_late_) {
                unclear_ = kLateHere;
            } else {
                end_case(
                    moves ? Outcome::passed : Outcome::failed,
                    moves ? fmt::format("moved on for {} ms", window_us / 1000) : "it came to rest",
                    moves ? 0 : now_us_);
            }
            enter(Stage::settle);
        }
    } else if (since_us() >= kCapUs) {
        judge_cap();
    }
}

void BoardPlayer::judge_stop(bool is_over_due) {
    const BoardCase& one = *current();
    if (one.demand == CaseDemand::brakes_at_once && !event_us_) {
        unclear_ = "the frame was not on the bus";
        return;
    }
    const std::vector<AxisStop> stops = stops_of(machine_, record_, steady_, due_);
    if (stops.empty()) {
        unclear_ = "no axis had a steady speed";
        return;
    }
    const double reaction_s = longest_reaction_s(machine_, stops);
    const bool is_lapse = case_ < kFirstCases;
    const double board_s = seen_reaction_s(machine_);
    // A board that is too slow in the lapse is too slow in every case: judges other rules by that.
    const bool is_slow = lapse_s_.value_or(0) > board_s;
    const double allowed_s =
        is_lapse || !is_slow ? board_s : *lapse_s_ + machine_.can.sample_us * 1e-6;
    const char* const what = one.demand == CaseDemand::brakes_at_once ? "the frame" : "the end";
    const bool is_in_time = reaction_s <= allowed_s;
    const std::string turned = reversal_of(machine_, stops);
    if (!turned.empty() && !are_steady(stops)) {
        unclear_ = "the program reversed an axis at that moment: load one with longer moves";
        return;
    }
    if (reaction_s == kNoReaction && !is_over_due) {
        unclear_ =
            "an axis was faster than before on the way to rest: samples jitter by more than "
            "guard.latch_jitter_us, or the program accelerated";
        return;
    }
    if (reaction_s < 1) {
        if (is_lapse) {
            lapse_s_ = reaction_s;
        }
        if (is_in_time || is_lapse) {
            reaction_s_ = std::max(reaction_s_, reaction_s);
            stops_.insert(stops_.end(), stops.begin(), stops.end());
        }
    }
    watch_.note(Watched::braking);
    if (!turned.empty() && is_in_time && !is_over_due &&
        machine_.guard.stop_reversal == StopReversal::none) {
        watch_.fail(Watched::braking, now_us_, turned);
    }
    if (is_in_time) {
        end_case(
            Outcome::passed,
            fmt::format(
                "braked with a reaction time of {:.2f} ms after {}, allowed {:.2f} ms{}",
                reaction_s * 1e3, what, board_s * 1e3,
                machine_.can.latched_age.most_us == 0 ? "" : ", with the age of the positions"));
        return;
    }
    const auto over = overshoot_of(machine_, stops, allowed_s);
    const std::int64_t at_us = record_.at(due_.sample).latched_us +
                               std::llround((due_.later_s + (over ? over->seconds : 0)) * 1e6);
    end_case(Outcome::failed,
             fmt::format("{}; {}", over ? over->words : "",
                         reaction_s < 1 && !is_over_due
                             ? fmt::format("braked {:.2f} ms after {}, allowed {:.2f} ms",
                                           reaction_s * 1e3, what, allowed_s * 1e3)
                             : "it kept moving"),
             at_us);
}

void BoardPlayer::judge_cap() {
    const std::uint64_t now = record_.newest().number;
    const std::uint64_t back = std::min<std::uint64_t>(40, now - record_.samples().front().number);
    for (std::uint32_t i = 0; i < machine_.axes.size(); ++i) {
        if ((cap_mask_ & mask_of(i)) == 0) {
            continue;
        }
        const double most =
            machine_.axes[i].speed_max * cap_ / kPermitCapNone * 1.02 +
            record_.resolution(i) / (static_cast<double>(back) * machine_.can.sample_us * 1e-6);
        const double speed = std::abs(record_.speed(i, now - back, now));
        if (speed > most || watch_.acked_cap(i) > cap_) {
            end_case(Outcome::failed,
                     speed > most ? fmt::format("{} is still faster than {}/250",
                                                machine_.axes[i].name, cap_)
                                  : fmt::format("no sample acknowledges the cap {}/250", cap_),
                     now_us_);
            cap_ = kPermitCapNone;
            enter(Stage::settle);
            return;
        }
    }
    const bool is_hold = current()->demand == CaseDemand::holds;
    const std::uint8_t cap = std::exchange(cap_, kPermitCapNone);
    if (is_hold) {
        enter(Stage::control);
        return;
    }
    end_case(Outcome::passed, fmt::format("slower than {}/250, and acknowledged", cap));
    enter(Stage::settle);
}

void BoardPlayer::step_control() {
    send_good();
    if (record_.left_place(entered_sample_) != kNoIndex) {
        end_case(Outcome::passed, "at rest; it moved as soon as permits were good");
        enter(Stage::settle);
    } else if (since_us() > 3 * kSecondUs) {
        end_case(Outcome::failed, "at rest, also with valid permits afterwards", now_us_);
        enter(Stage::settle);
    }
}

void BoardPlayer::step_settle() {
    if (record_.rests(kRestUs) && since_us() > kRestUs) {
        has_resumed_ ? next_case() : enter(Stage::probe);
        return;
    }
    if (since_us() > 2 * kSettleUs) {
        watch_.fail(Watched::braking, now_us_, "an axis does not rest, not even at a stop frame");
        abandon("the board does not stop, not even at a stop frame");
    } else if (since_us() > kSettleUs) {
        send_stop(false);
    }
}

void BoardPlayer::step_probe() {
    send_good();
    watch_.note(Watched::resume);
    const std::uint32_t axis = record_.left_place(entered_sample_);
    if (axis != kNoIndex && !has_resumed_) {
        watch_.fail(
            Watched::resume, now_us_,
            fmt::format("{} moves again after {}", machine_.axes[axis].name, current()->name));
        has_resumed_ = true;
    }
    if (has_resumed_) {
        rest_.end();
        enter(Stage::settle);
    } else if (since_us() > kProbeUs) {
        next_case();
    }
}

/// Sends stop frames for the whole time after a complete test: no axis may move any more.
void BoardPlayer::step_closing() {
    const bool has_samples =
        !record_.is_empty() &&
        now_us_ - record_.newest()
                      .latched_us<kStillUs&& static_cast<std::int64_t>(record_.newest().number -
                                                                       entered_sample_) *
                                  machine_.can.sample_us>
                          kStillUs;
    const bool rests = has_samples && record_.rests(kStillUs);
    if (since_us() >= kCloseUs || (rests && !abandoned_.empty())) {
        if (has_samples && !rests) {
            abandoned_ += abandoned_.empty() ? "" : "; ";
            abandoned_ += "axes still move after one second of stop frames";
        }
        stage_ = Stage::over;
    } else if (now_us_ >= stop_us_) {
        stop_us_ = now_us_ + kStopEveryUs;
        send_stop(false);
    }
}

BoardTestResult BoardPlayer::result() const {
    BoardTestResult out{findings_, abandoned_, stops_, reaction_s_, watch_.sync()};
    for (BoardFinding& finding : out.findings) {
        if (finding.outcome == Outcome::not_tested && finding.found.empty()) {
            finding.outcome = Outcome::unclear;
            finding.found = "not run: the test ended before";
        }
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(Watched::count); ++i) {
        const auto watched = static_cast<Watched>(i);
        const WatchedRule& rule = watched_rule(watched);
        const WatchedState& state = watch_.of(watched);
        BoardFinding finding{rule.name, rule.rule,   rule.demands, Outcome::not_tested,
                             "",        state.at_us, rule.mend};
        if (state.faults > 0) {
            finding.outcome = Outcome::failed;
            finding.found = fmt::format(
                "{}{}", state.found,
                state.faults > 1 ? fmt::format(" ({} times)", state.faults) : std::string());
        } else if (state.is_judged) {
            finding.outcome = Outcome::passed;
            finding.found = "kept throughout";
        } else {
            finding.found = "no occasion";
        }
        out.findings.push_back(std::move(finding));
    }
    for (const UnseenRule& rule : unseen_rules()) {
        out.findings.push_back({rule.name, rule.rule, "", Outcome::not_tested, rule.why, 0, ""});
    }
    return out;
}

}  // namespace axg
