// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/board/permit_watch.hpp"

#include <algorithm>
#include <iterator>

namespace axg {

namespace {

// Consecutive nonces: their checksums differ, as the library requires.
constexpr std::uint32_t kFirstNonce = 0x5EED00;
// Library time minus board time, so that the library counts enough rest before the board's time
// begins.
constexpr std::int64_t kPowerUpUs = 10'000'000;
constexpr std::int64_t kQuietPeriods = 2;  // without a stop of the guard

std::uint64_t library_us(std::int64_t board_us) noexcept {
    return static_cast<std::uint64_t>(std::max<std::int64_t>(board_us + kPowerUpUs, 0));
}

std::int64_t board_us(std::uint64_t library_us) noexcept {
    return static_cast<std::int64_t>(library_us) - kPowerUpUs;
}

/// Converts a frame to the library's type.
axg_board_can_frame library_frame(const CanFrame& frame) noexcept {
    axg_board_can_frame out{};
    out.id = frame.id;
    out.is_fd = frame.fd;
    out.length = frame.length_bytes;
    std::copy_n(frame.data.begin(), frame.length_bytes, std::begin(out.data));
    return out;
}

CanFrame board_frame(const axg_board_can_frame& made, std::int64_t now_us) noexcept {
    CanFrame out;
    out.id = made.id;
    out.length_bytes = made.length;
    out.time_us = now_us;
    std::copy_n(std::begin(made.data), made.length, out.data.begin());
    return out;
}

/// Returns n of a permit from its inverted twin.
std::uint8_t n_of(const CanFrame& twin) noexcept {
    return static_cast<std::uint8_t>((twin.data[7] ^ 0xFFU) >> 4U);
}

}  // namespace

PermitWatch::PermitWatch(const CanLayout& layout, bool is_jogging, std::int64_t permit_us,
                         const ConfigurationHashes& hashes, CapPromise cap) noexcept
    : layout_(layout),
      hashes_(hashes),
      cap_(cap),
      has_true_timer_(permit_us == 0),
      holds_us_(permit_us != 0 ? permit_us
                               : std::int64_t{layout.permit_samples.least} * layout.sample_us),
      is_jogging_(is_jogging) {
    power_up();
    arm(0);
}

/// MotionBoard handles frames and axes: the library only judges permits and hashes.
void PermitWatch::power_up() noexcept {
    axg_board_options options{};
    options.period_us = layout_.sample_us;
    options.permit_samples_max = layout_.permit_samples.most;
    options.axis_count = AXG_BOARD_AXES_MAX;
    options.cap_kind = cap_ == CapPromise::none ? AXG_BOARD_CAP_IGNORED : AXG_BOARD_CAP_ENFORCED;
    options.permit_id = layout_.permit_id;
    options.stop_id = layout_.stop_id;
    options.hashes_id = layout_.hashes_out_id;
    std::copy(hashes_.of.begin(), hashes_.of.end(), std::begin(options.hashes));
    nonce_ = kFirstNonce;
    [[maybe_unused]] const bool is_good = axg_board_power_up(&board_, &options, nonce_, 0);
    axg_board_change(&board_, is_jogging_, 0);
}

void PermitWatch::arm(std::int64_t now_us) noexcept {
    [[maybe_unused]] const axg_board_arming done =
        axg_board_arm(&board_, ++nonce_, library_us(now_us));
}

void PermitWatch::on_latch(std::uint8_t sync_counter, std::int64_t latched_us) noexcept {
    lap_ = static_cast<std::uint16_t>(lap_ + (sync_counter < newest_sync_ ? 1 : 0));
    newest_sync_ = sync_counter;
    const axg_board_sample sample{library_us(latched_us), lap_, sync_counter};
    [[maybe_unused]] const bool is_next = axg_board_latch(&board_, &sample);
}

bool PermitWatch::take_session(std::int64_t now_us, CanFrame& out) noexcept {
    const auto data_id = static_cast<std::uint16_t>(layout_.session_in_id);
    axg_board_can_frame made{};
    if (!axg_board_is_session_due(&board_, library_us(now_us)) ||
        !axg_board_encode_session(&board_, {layout_.session_in_id, data_id}, library_us(now_us),
                                  &made)) {
        return false;
    }
    out = board_frame(made, now_us);
    return true;
}

bool PermitWatch::take_hash(std::int64_t now_us, CanFrame& out) noexcept {
    if (owed_part_ == kNothingOwed) {
        return false;
    }
    axg_board_can_frame made{};
    [[maybe_unused]] const bool is_part = axg_board_encode_hash(
        &board_, layout_.hashes_in_id, static_cast<std::uint8_t>(owed_part_), &made);
    owed_part_ = kNothingOwed;
    out = board_frame(made, now_us);
    return true;
}

std::uint8_t PermitWatch::ack_flags() const noexcept {
    if (is_jogging_) {
        return 0;
    }
    axg_board_says says{};
    says.is_homed = true;
    return axg_board_flags(&board_, &says);
}

std::uint8_t PermitWatch::ordered_cap(std::int64_t now_us) noexcept {
    const axg_board_motion motion = axg_board_may_move(&board_, library_us(now_us));
    return *std::min_element(std::begin(motion.ordered.of), std::end(motion.ordered.of));
}

CapGroups PermitWatch::ordered_caps(std::int64_t now_us) noexcept {
    const axg_board_motion motion = axg_board_may_move(&board_, library_us(now_us));
    CapGroups caps{};
    std::copy(std::begin(motion.ordered.of), std::end(motion.ordered.of), caps.begin());
    return caps;
}

CapGroups PermitWatch::keep_caps(const CapGroups& wanted, std::int64_t now_us) noexcept {
    axg_board_caps caps{};
    std::copy(wanted.begin(), wanted.end(), std::begin(caps.of));
    const axg_board_caps kept = axg_board_keeps(&board_, &caps, library_us(now_us));
    CapGroups out{};
    std::copy(std::begin(kept.of), std::end(kept.of), out.begin());
    return out;
}

std::uint8_t PermitWatch::keep_cap(std::uint8_t wanted, std::int64_t now_us) noexcept {
    axg_board_caps caps{};
    std::fill(std::begin(caps.of), std::end(caps.of), wanted);
    return axg_board_keeps(&board_, &caps, library_us(now_us)).of[0];
}

void PermitWatch::begin(std::int64_t now_us) noexcept {
    is_moving_ = true;
    if (has_true_timer_) {
        axg_board_moves(&board_, true, library_us(now_us));
    }
}

void PermitWatch::rest(std::int64_t now_us) noexcept {
    axg_board_moves(&board_, false, library_us(now_us));
}

void PermitWatch::acknowledge(std::int64_t now_us) noexcept {
    if (now_us - last_stop_us_ < kQuietPeriods * layout_.sample_us) {
        return;
    }
    arm(now_us);
    stopped_us_ = kNever;
    valid_until_us_ = certified_us_ = INT64_MIN;
}

void PermitWatch::on_frame(const CanFrame& frame) noexcept {
    if (frame.error || frame.extended || frame.remote) {
        return;
    }
    const axg_board_can_frame heard = library_frame(frame);
    const std::uint64_t now_us = library_us(frame.time_us);
    switch (axg_board_frame(&board_, &heard, now_us)) {
        case AXG_BOARD_HEARD_PERMIT:
            note_permit(now_us, n_of(frame));
            break;
        case AXG_BOARD_HEARD_STOP:
            note_stop(frame.time_us);
            break;
        case AXG_BOARD_HEARD_HASH:
            owed_part_ = frame.data[0];
            break;
        case AXG_BOARD_HEARD_HASH_DIFFERS:
            owed_part_ = frame.data[0];
            if (is_moving_) {  // the library stopped it
                note_stop(frame.time_us);
            }
            break;
        case AXG_BOARD_HEARD_REFUSED:
            ++refused_;
            break;
        default:
            break;
    }
}

void PermitWatch::note_stop(std::int64_t now_us) noexcept {
    stopped_us_ = stopped_us_ == kNever ? now_us : stopped_us_;
    last_stop_us_ = now_us;
}

void PermitWatch::note_permit(std::uint64_t now_us, std::uint8_t samples) noexcept {
    const axg_board_motion motion = axg_board_may_move(&board_, now_us);
    const axg_board_permit& last = board_.last;
    ++permits_;
    speed_cap_ = *std::min_element(std::begin(last.caps.of), std::end(last.caps.of));
    samples_ = samples;
    is_slow_ = last.word == AXG_BOARD_WORD_SLOW;
    // Does not count: one of the first two after arming, or one that ends before an older one.
    if (!motion.may_move || motion.end_us != last.end_us) {
        return;
    }
    valid_until_us_ = board_us(motion.end_us);
    certified_us_ = valid_until_us_ - std::int64_t{samples} * layout_.sample_us;
    valid_until_us_ = has_true_timer_ ? valid_until_us_ : certified_us_ + holds_us_;
}

}  // namespace axg
