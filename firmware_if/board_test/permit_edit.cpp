// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/board_test/permit_edit.hpp"

namespace axg {

namespace {

constexpr std::int64_t kOrderUs = 200;  // between two frames whose order is not that of their ids
constexpr std::uint32_t kNonceMax = 0xFFFFFF;

void add(PairFrames& to, CanFrame frame, std::int64_t due_us) noexcept {
    frame.time_us = due_us;
    to.frames[to.count++] = frame;
}

Permit next_of(Permit permit) noexcept {
    ++permit.live_counter;
    return permit;
}

}  // namespace

Permit edited(const Permit& permit, const PermitEdit& edit) noexcept {
    Permit out = permit;
    out.lap = static_cast<std::uint16_t>(permit.lap - edit.lap_back);
    out.nonce = (permit.nonce ^ edit.nonce_xor) & kNonceMax;
    out.known_answer_signature ^= edit.answer_xor;
    out.word = edit.word != 0 ? static_cast<PermitWord>(edit.word) : permit.word;
    out.samples = edit.samples >= 0
                      ? static_cast<std::uint8_t>(edit.samples)
                      : static_cast<std::uint8_t>(permit.samples + (edit.is_samples_above ? 1 : 0));
    out.cap = edit.cap;
    out.mask = edit.mask;
    out.level = edit.level;
    return out;
}

PairFrames frames_of(const CanLayout& can, const Permit& permit, PairShape shape,
                     std::int64_t now_us) noexcept {
    PairFrames out;
    auto [plain, inverted] = encode_any_permit(can, permit, now_us);
    switch (shape) {
        case PairShape::silence:
        case PairShape::again:  // the player sends its stored pair
            break;
        case PairShape::plain_only:
            add(out, plain, now_us);
            break;
        case PairShape::inverted_first:
            add(out, inverted, now_us);
            add(out, plain, now_us + kOrderUs);
            break;
        case PairShape::one_bit:
            inverted.data[permit.live_counter % 8U] ^=
                static_cast<std::uint8_t>(1U << (permit.live_counter / 8U % 8U));
            add(out, plain, now_us);
            add(out, inverted, now_us);
            break;
        case PairShape::of_another:
            add(out, plain, now_us);
            add(out, encode_any_permit(can, next_of(permit), now_us)[1], now_us);
            break;
        case PairShape::late:
            add(out, plain, now_us);
            add(out, inverted, now_us + can.sample_us + can.sample_us / 4);
            break;
        case PairShape::interleaved: {
            const auto other = encode_any_permit(can, next_of(permit), now_us);
            add(out, plain, now_us);
            add(out, other[0], now_us);
            add(out, inverted, now_us + kOrderUs);
            add(out, other[1], now_us + kOrderUs);
            break;
        }
        case PairShape::short_frames:
            plain.length_bytes = inverted.length_bytes = 7;
            [[fallthrough]];
        case PairShape::pair:
            add(out, plain, now_us);
            add(out, inverted, now_us);
            break;
    }
    return out;
}

}  // namespace axg
