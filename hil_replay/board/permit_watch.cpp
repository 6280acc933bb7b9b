// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/board/permit_watch.hpp"

#include "core/guard/monitor.hpp"

namespace axg {

namespace {

/// SCT and SRVT in periods of this board.
PermitTimes times_of(const CanLayout& layout) noexcept {
    return {.period_max_us = 4 * std::int64_t{layout.sample_us},
            .twin_max_us = 2 * std::int64_t{layout.sample_us}};
}

}  // namespace

PermitWatch::PermitWatch(const CanLayout& layout, bool is_jogging, std::int64_t permit_us) noexcept
    : layout_(layout),
      checker_(layout, times_of(layout)),
      holds_us_(permit_us != 0 ? permit_us
                               : std::int64_t{layout.permit_samples} * layout.sample_us),
      is_jogging_(is_jogging) {
    latched_us_.fill(INT64_MIN);
}

void PermitWatch::on_frame(const CanFrame& frame) noexcept {
    if (decode_stop(layout_, frame) == GuardFrameStatus::ok) {
        stopped_us_ = stopped_us_ == kNever ? frame.time_us : stopped_us_;
        return;
    }
    const PermitChecker::Result result = checker_.on_frame(frame);
    if (result.is_permit) {
        on_permit(result.permit, frame.time_us);
    } else if (result.fault != PermitFault::none) {
        ++refused_;
    }
}

void PermitWatch::on_permit(const Permit& permit, std::int64_t now_us) noexcept {
    if (permit.word == PermitWord::stop) {
        // Before the first permit this word says "not yet": nothing moves that could be stopped.
        stopped_us_ = stopped_us_ == kNever && permits_ > 0 ? now_us : stopped_us_;
        return;
    }
    const std::int64_t latched_us = latched_us_[permit.sync_counter];
    const bool is_known = latched_us != INT64_MIN;
    const bool is_too_late = is_moving_ && now_us >= valid_until_us_;
    const bool is_for_this = (permit.word == PermitWord::jog) == is_jogging_;
    if (permit.known_answer_signature != kKnownAnswerSignature || !is_for_this || !is_known ||
        is_too_late || latched_us + holds_us_ <= now_us) {
        ++refused_;
        return;
    }
    ++permits_;
    if (latched_us > certified_us_) {
        certified_us_ = latched_us;
        speed_cap_ = permit.speed_cap;
        is_slow_ = permit.word == PermitWord::slow;
        valid_until_us_ = latched_us + holds_us_;
    }
}

}  // namespace axg
