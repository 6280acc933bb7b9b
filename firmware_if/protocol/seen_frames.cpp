// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/protocol/seen_frames.hpp"

#include "core/certificate/joint_box_proof.hpp"
#include "firmware_if/protocol/sealed_frame.hpp"
#include "firmware_if/protocol/wire.hpp"

namespace axg {
namespace {

using detail::get_little;

constexpr std::uint8_t kPermitBytes = 8, kHintsBytes = 5, kStatusVersion = 1;

bool has_shape(const CanFrame& frame, std::uint32_t id, std::uint8_t bytes) noexcept {
    return !frame.error && !frame.extended && !frame.remote && !frame.fd && frame.raw_dlc == 0 &&
           frame.id == id && frame.length_bytes == bytes;
}

bool is_action(std::uint8_t byte) noexcept {
    return byte == static_cast<std::uint8_t>(OperatorAction::none) ||
           byte == static_cast<std::uint8_t>(OperatorAction::reset) ||
           byte == static_cast<std::uint8_t>(OperatorAction::arm);
}

bool is_sound(const Permit& permit) noexcept {
    const bool is_stop = permit.word == PermitWord::stop;
    const bool has_word = is_stop || permit.word == PermitWord::run ||
                          permit.word == PermitWord::slow || permit.word == PermitWord::jog;
    return has_word && permit.cap <= kPermitCapNone && permit.level <= 3 &&
           permit.sync_counter >= 1 && permit.sync_counter <= kSyncCounterMax &&
           (permit.samples == 0) == is_stop;
}

}  // namespace

std::optional<SeenPermit> read_permit(const CanLayout& layout, const CanFrame& plain,
                                      const CanFrame& twin) noexcept {
    if (!has_shape(plain, layout.permit_id, kPermitBytes) ||
        !has_shape(twin, layout.permit_id + 1, kPermitBytes)) {
        return std::nullopt;
    }
    const std::uint8_t* const data = plain.data.data();
    for (std::size_t i = 0; i < kPermitBytes; ++i) {
        if ((data[i] ^ twin.data[i]) != 0xFF) {
            return std::nullopt;
        }
    }
    SeenPermit seen;
    seen.permit.word = static_cast<PermitWord>(data[0]);
    seen.permit.sync_counter = data[1];
    seen.permit.live_counter = data[2];
    seen.permit.known_answer_signature = kKnownAnswerSignature;
    seen.permit.cap = data[5];
    seen.permit.mask = data[6];
    seen.permit.samples = static_cast<std::uint8_t>(data[7] >> 4U);
    seen.permit.level = static_cast<std::uint8_t>(data[7] & 0x0FU);
    seen.answer = static_cast<std::uint16_t>(get_little(data + 3, 2));
    return is_sound(seen.permit) ? std::optional(seen) : std::nullopt;
}

std::uint16_t answer_of(const CanLayout& layout, const Permit& permit) noexcept {
    const CanFrame plain = encode_any_permit(layout, permit, 0)[0];
    return static_cast<std::uint16_t>(get_little(plain.data.data() + 3, 2));
}

std::optional<Hints> read_hints(const CanLayout& layout, const CanFrame& frame) noexcept {
    if (!has_shape(frame, layout.hints_id, kHintsBytes)) {
        return std::nullopt;
    }
    const std::uint8_t* const data = frame.data.data();
    return Hints{.sync_counter = data[0],
                 .pair = static_cast<std::uint16_t>(get_little(data + 1, 2)),
                 .distance_10um = static_cast<std::uint16_t>(get_little(data + 3, 2))};
}

std::optional<OperatorStatus> read_operator_status(const CanLayout& layout,
                                                   const CanFrame& frame) noexcept {
    const auto& data = frame.data;
    if (detail::check_sealed(layout.operator_out_id, frame) != FrameStatus::ok ||
        data[1] >> 4U != kStatusVersion || data[2] >= kGuardPhases || !is_action(data[3]) ||
        data[4] >= kOperatorRefusals) {
        return std::nullopt;
    }
    return OperatorStatus{.phase = static_cast<GuardPhase>(data[2]),
                          .action = static_cast<OperatorAction>(data[3]),
                          .refusal = static_cast<OperatorRefusal>(data[4]),
                          .counter = static_cast<std::uint8_t>(data[1] & 0x0FU),
                          .nonce = static_cast<std::uint32_t>(get_little(data.data() + 5, 3))};
}

}  // namespace axg
