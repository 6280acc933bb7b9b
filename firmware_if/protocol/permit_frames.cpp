// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/protocol/permit_frames.hpp"

#include <algorithm>

#include "core/base/assert.hpp"
#include "firmware_if/protocol/sealed_frame.hpp"
#include "firmware_if/protocol/wire.hpp"

namespace axg {
namespace {

using detail::get_little;
using detail::put_little;

constexpr std::uint8_t kSessionVersion = 1;
constexpr std::uint8_t kFrameBytes = 8;

/// Bytes 3 and 4: a CRC over the other bytes, nonce and lap, in one with the known-answer result.
std::uint16_t answer_of(const std::uint8_t* data, const Permit& permit) noexcept {
    std::array<std::uint8_t, 11> covered{data[0], data[1], data[2], data[5], data[6], data[7]};
    put_little(covered.data() + 6, permit.nonce, 3);
    put_little(covered.data() + 9, permit.lap, 2);
    return static_cast<std::uint16_t>(permit.known_answer_signature ^ crc16_ccitt(covered));
}

}  // namespace

Permit permit_of(const CycleResult& result, std::uint8_t live_counter,
                 std::uint8_t sync_counter) noexcept {
    constexpr std::uint8_t kAllAxes = 0xFF;
    constexpr auto kClear = static_cast<unsigned>(ClearanceLevel::clear);
    Permit permit;
    permit.sync_counter = sync_counter;
    permit.live_counter = live_counter;
    permit.known_answer_signature = result.known_answer_signature;
    if (!result.has_permit) {
        return permit;
    }
    const Advisories& advisories = result.advisories;
    permit.word = result.is_jog                                        ? PermitWord::jog
                  : advisories.clearance_level <= ClearanceLevel::slow ? PermitWord::slow
                                                                       : PermitWord::run;
    // 0 would be hold: a board that obeys it would wait in place for ever.
    permit.cap = std::max<std::uint8_t>(advisories.speed_cap, 1);
    permit.mask = permit.cap < kPermitCapNone ? kAllAxes : std::uint8_t{0};
    if (result.has_cap) {  // the cap of the proof
        permit.cap = result.cap_order.cap;
        permit.mask = result.cap_order.mask;
    }
    permit.samples = result.samples;
    permit.level =
        static_cast<std::uint8_t>(kClear - static_cast<unsigned>(advisories.clearance_level));
    return permit;
}

std::array<CanFrame, 2> encode_permit(const CanLayout& layout, const Permit& permit,
                                      std::int64_t time_us) noexcept {
    AXG_ASSERT(permit.samples <= kPermitSamplesMax && permit.level <= 3);
    AXG_ASSERT(permit.cap <= kPermitCapNone);
    return encode_any_permit(layout, permit, time_us);
}

std::array<CanFrame, 2> encode_any_permit(const CanLayout& layout, const Permit& permit,
                                          std::int64_t time_us) noexcept {
    const bool has_cap = permit.word == PermitWord::run || permit.word == PermitWord::slow;
    CanFrame plain;
    plain.id = layout.permit_id;
    plain.length_bytes = kFrameBytes;
    plain.time_us = time_us;
    std::uint8_t* const data = plain.data.data();
    data[0] = static_cast<std::uint8_t>(permit.word);
    data[1] = permit.sync_counter;
    data[2] = permit.live_counter;
    data[5] = has_cap ? permit.cap : kPermitCapNone;
    data[6] = has_cap ? permit.mask : std::uint8_t{0};
    data[7] = static_cast<std::uint8_t>(permit.samples << 4U | permit.level);
    put_little(data + 3, answer_of(data, permit), 2);
    CanFrame twin = plain;
    twin.id = layout.permit_id + 1;
    for (std::size_t i = 0; i < kFrameBytes; ++i) {
        twin.data[i] = static_cast<std::uint8_t>(~plain.data[i]);
    }
    return {plain, twin};
}

CanFrame encode_session(std::uint32_t id, const Session& session, std::int64_t time_us) noexcept {
    CanFrame frame;
    frame.id = id;
    frame.length_bytes = kFrameBytes;
    frame.time_us = time_us;
    std::uint8_t* const data = frame.data.data();
    data[1] = static_cast<std::uint8_t>(kSessionVersion << 4U | session.counter);
    data[2] = session.sync_counter;
    put_little(data + 3, session.lap, 2);
    put_little(data + 5, session.nonce, 3);
    data[0] = detail::seal_of(frame);
    return frame;
}

FrameStatus decode_session(std::uint32_t id, const CanFrame& frame, Session& out) noexcept {
    const FrameStatus status = detail::check_sealed(id, frame);
    if (status != FrameStatus::ok) {
        return status;
    }
    const std::uint8_t* const data = frame.data.data();
    if (data[1] >> 4U != kSessionVersion || data[2] < 1 || data[2] > kSyncCounterMax) {
        return FrameStatus::bad_format;
    }
    out = {.nonce = static_cast<std::uint32_t>(get_little(data + 5, 3)),
           .lap = static_cast<std::uint16_t>(get_little(data + 3, 2)),
           .sync_counter = data[2],
           .counter = static_cast<std::uint8_t>(data[1] & 0x0FU)};
    return FrameStatus::ok;
}

}  // namespace axg
