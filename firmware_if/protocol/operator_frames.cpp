// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/protocol/operator_frames.hpp"

#include "firmware_if/protocol/sealed_frame.hpp"
#include "firmware_if/protocol/wire.hpp"

namespace axg {
namespace {

using detail::get_little;
using detail::put_little;

constexpr std::uint8_t kVersion = 1;

bool is_action(std::uint8_t byte) noexcept {
    return byte == static_cast<std::uint8_t>(OperatorAction::reset) ||
           byte == static_cast<std::uint8_t>(OperatorAction::arm);
}

bool is_step(std::uint8_t byte) noexcept {
    return byte == static_cast<std::uint8_t>(OperatorStep::request) ||
           byte == static_cast<std::uint8_t>(OperatorStep::confirm);
}

}  // namespace

CanFrame encode_operator_status(const CanLayout& layout, const OperatorStatus& status,
                                std::int64_t time_us) noexcept {
    CanFrame frame;
    frame.id = layout.operator_out_id;
    frame.length_bytes = detail::kSealedBytes;
    frame.time_us = time_us;
    frame.data[1] = static_cast<std::uint8_t>(kVersion << 4U | (status.counter & 0x0FU));
    frame.data[2] = static_cast<std::uint8_t>(status.phase);
    frame.data[3] = static_cast<std::uint8_t>(status.action);
    frame.data[4] = static_cast<std::uint8_t>(status.refusal);
    put_little(frame.data.data() + 5, status.nonce, 3);
    frame.data[0] = detail::seal_of(frame);
    return frame;
}

FrameStatus decode_operator_message(const CanLayout& layout, const CanFrame& frame,
                                    OperatorMessage& out) noexcept {
    const FrameStatus status = detail::check_sealed(layout.operator_in_id, frame);
    if (status != FrameStatus::ok) {
        return status;
    }
    const auto& data = frame.data;
    if (data[1] >> 4U != kVersion || !is_action(data[2]) || !is_step(data[3]) || data[4] > 1) {
        return FrameStatus::bad_format;
    }
    out = {.action = static_cast<OperatorAction>(data[2]),
           .step = static_cast<OperatorStep>(data[3]),
           .stands = data[4] == 1,
           .counter = static_cast<std::uint8_t>(data[1] & 0x0FU),
           .nonce = static_cast<std::uint32_t>(get_little(data.data() + 5, 3))};
    return FrameStatus::ok;
}

}  // namespace axg
