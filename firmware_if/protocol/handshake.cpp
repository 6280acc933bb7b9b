// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/protocol/handshake.hpp"

#include "firmware_if/protocol/wire.hpp"

namespace axg {
namespace {

constexpr std::uint8_t kRuleVersion = 1;  // of what goes into the hashes
constexpr std::uint8_t kHashFrameBytes = 8;

}  // namespace

CanFrame encode_hash(std::uint32_t id, HashFrame content, std::int64_t time_us) noexcept {
    CanFrame frame;
    frame.time_us = time_us;
    frame.id = id;
    frame.length_bytes = kHashFrameBytes;
    frame.data[0] = content.part;
    frame.data[1] = kRuleVersion;
    detail::put_little(frame.data.data() + 4, content.hash, 4);
    return frame;
}

bool decode_hash(const CanFrame& frame, HashFrame& out) noexcept {
    const auto& data = frame.data;
    if (frame.length_bytes != kHashFrameBytes || frame.fd || frame.extended || frame.remote ||
        frame.error || data[0] >= kHashParts || data[1] != kRuleVersion || data[2] != 0 ||
        data[3] != 0) {
        return false;
    }
    out = {.part = data[0],
           .hash = static_cast<std::uint32_t>(detail::get_little(data.data() + 4, 4))};
    return true;
}

void Handshake::begin(std::int64_t now_us) noexcept {
    if (!is_wanted()) {
        return;
    }
    agreed_ = 0;
    is_asking_ = true;
    has_told_ = false;
    begun_us_ = next_us_ = now_us;
}

CanFrame Handshake::next(std::int64_t now_us) noexcept {
    do {  // one is left, or nothing would be due
        part_ = static_cast<std::uint8_t>((part_ + 1U) % kHashParts);
    } while ((agreed_ & (1U << part_)) != 0);
    next_us_ = now_us + kRepeatUs;
    return encode_hash(out_id_, {.part = part_, .hash = hashes_.of[part_]}, now_us);
}

bool Handshake::is_overdue(std::int64_t now_us) noexcept {
    const bool is_overdue = next_due_us() != INT64_MAX && now_us - begun_us_ > kWaitUs;
    const bool is_new = is_overdue && !has_told_;
    has_told_ = has_told_ || is_overdue;
    return is_new;
}

Handshake::Heard Handshake::on_frame(const CanFrame& frame) noexcept {
    HashFrame heard;
    if (!is_wanted() || frame.id != in_id_ || !decode_hash(frame, heard)) {
        return Heard::nothing;
    }
    if (heard.hash != hashes_.of[heard.part]) {
        agreed_ &= ~(1U << heard.part);
        theirs_ = heard;
        return Heard::different;
    }
    agreed_ |= is_asking_ ? 1U << heard.part : 0U;
    return Heard::equal;
}

}  // namespace axg
