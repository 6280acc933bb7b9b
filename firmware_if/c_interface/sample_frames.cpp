// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/c_interface/sample_frames.hpp"

#include <algorithm>

#include "core/base/finite.hpp"
#include "firmware_if/protocol/permit_frames.hpp"

namespace axg {
namespace {

constexpr double kRadPerDeg = 0x1.1df46a2529d39p-6;
constexpr std::uint32_t kNonceMax = 0xFFFFFF;
constexpr std::uint8_t kSessionCounters = 16;

std::uint16_t lap_of(std::uint64_t number) noexcept {
    return static_cast<std::uint16_t>(number / kSyncCounterMax);
}

}  // namespace

bool takes_samples(const Machine& machine) noexcept {
    return is_native(machine.can) && machine.can.look_ahead_samples == 0;
}

SampleFrames::SampleFrames(const Machine& machine) noexcept
    : encoder_(machine, {.says_session = false}),
      takes_samples_(axg::takes_samples(machine)),
      tool_max_(wire_of(machine.can).tool_most) {}

/// As a board has to: at once, every 100 ms, and with each lap and nonce.
void SampleFrames::put_session(const axg_sample& sample, std::uint32_t& count) noexcept {
    const std::uint32_t id = encoder_.frame_set().session_id;
    const std::uint16_t lap = lap_of(sample.number);
    const bool is_due = !has_session_ || nonce_ != sample.nonce || lap_ != lap ||
                        sample.latched_us - session_us_ >= kSessionPeriodUs;
    if (id == 0 || !is_due) {
        return;
    }
    frames_[count++] = encode_session(id,
                                      {.nonce = sample.nonce,
                                       .lap = lap,
                                       .sync_counter = sync_counter_of(sample.number),
                                       .counter = session_counter_},
                                      0);
    session_counter_ = static_cast<std::uint8_t>((session_counter_ + 1U) % kSessionCounters);
    has_session_ = true;
    nonce_ = sample.nonce;
    lap_ = lap;
    session_us_ = sample.latched_us;
}

std::span<const CanFrame> SampleFrames::encode(const axg_sample& sample,
                                               std::int64_t now_us) noexcept {
    const AxisFrameSet& set = encoder_.frame_set();
    const bool is_sound = takes_samples_ && sample.axis_count == set.axis_count &&
                          sample.nonce <= kNonceMax && sample.tool <= tool_max_ &&
                          sample.latched_us <= now_us &&
                          std::all_of(std::begin(sample.reserved), std::end(sample.reserved),
                                      [](std::uint8_t byte) { return byte == 0; });
    if (!is_sound) {
        return {};
    }
    AxisSnapshot snapshot;
    snapshot.latched_us = sample.latched_us;
    snapshot.sample = sample.number;
    snapshot.axis_count = sample.axis_count;
    snapshot.tool = sample.tool;
    snapshot.mode = sample.mode;
    snapshot.flags = sample.flags;
    for (std::uint32_t i = 0; i < sample.axis_count; ++i) {
        if (!is_finite(sample.position[i])) {
            return {};
        }
        const bool is_rotary = set.axes[i].kind == AxisKind::rotary;
        snapshot.position[i] = sample.position[i] * (is_rotary ? kRadPerDeg : 1.0);
    }
    const EncodeResult encoded = encoder_.encode(snapshot, frames_);
    if (encoded.status != EncodeStatus::ok) {
        return {};
    }
    std::uint32_t count = encoded.frame_count;
    put_session(sample, count);
    for (std::uint32_t i = 1; i < count; ++i) {
        frames_[i].time_us = now_us;
    }
    return std::span(frames_).first(count);
}

}  // namespace axg
