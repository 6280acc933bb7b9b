// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/trace/added_session.hpp"

#include "firmware_if/protocol/permit_frames.hpp"

namespace axg {

std::optional<CanFrame> AddedSession::behind(const CanFrame& frame) noexcept {
    const bool is_plain = !frame.extended && !frame.remote && !frame.error && !frame.fd;
    const std::uint8_t counter = frame.data[0];
    if (!is_plain || frame.id != sync_id_ || frame.length_bytes != 1 || counter < 1 ||
        counter > kSyncCounterMax) {
        return std::nullopt;
    }
    constexpr std::uint32_t kFirstNonce = 0x5E5510, kNonces = 0x100'0000;
    const std::uint32_t sent = sent_++;
    return encode_session(session_id_,
                          {.nonce = (kFirstNonce + sent) % kNonces,
                           .sync_counter = counter,
                           .counter = static_cast<std::uint8_t>(sent & 15U)},
                          frame.time_us);
}

}  // namespace axg
