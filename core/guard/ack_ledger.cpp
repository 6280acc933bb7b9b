// SPDX-License-Identifier: Apache-2.0
#include "core/guard/ack_ledger.hpp"

#include <algorithm>

#include "core/base/assert.hpp"

namespace axg {

AxisCaps caps_of_permit(std::uint8_t cap, std::uint8_t mask) noexcept {
    constexpr std::size_t kLastBit = 7;
    AxisCaps caps{};
    for (std::size_t axis = 0; axis < caps.size(); ++axis) {
        const bool is_bound = ((mask >> std::min(axis, kLastBit)) & 1U) != 0;
        caps[axis] = is_bound ? cap : kCapRapid;
    }
    return caps;
}

AxisCaps higher_caps(const AxisCaps& a, const AxisCaps& b) noexcept {
    AxisCaps caps{};
    std::transform(a.begin(), a.end(), b.begin(), caps.begin(),
                   [](std::uint8_t one, std::uint8_t other) { return std::max(one, other); });
    return caps;
}

void AckLedger::note_sent(std::uint8_t live_counter, const AxisCaps& caps) noexcept {
    const bool is_next = static_cast<std::uint8_t>(newest_ + 1) == live_counter;
    if (newest_ == 0 || !is_next) {
        clear();
        newest_ = first_ = oldest_ = kKept + live_counter;
    } else {
        ++newest_;
        AxisCaps& out = kept_[newest_ % kKept];
        const std::uint64_t leaves = newest_ - kKept;
        if (leaves >= oldest_) {
            const std::uint64_t nibble = leaves % kNibbles;
            const bool is_first = forgotten_last_[nibble] < oldest_;
            forgotten_[nibble] = is_first ? out : higher_caps(forgotten_[nibble], out);
            forgotten_last_[nibble] = leaves;
        }
    }
    kept_[newest_ % kKept] = caps;
}

AckedCaps AckLedger::note_ack(std::optional<std::uint8_t> nibble) noexcept {
    if (!nibble) {
        return {};
    }
    AXG_ASSERT(*nibble < kNibbles);
    const std::uint64_t ahead = (*nibble + kNibbles - oldest_ % kNibbles) % kNibbles;
    if (newest_ == 0 || oldest_ + ahead > newest_) {
        return {.status = AckStatus::unknown};
    }
    oldest_ += ahead;
    AckedCaps acked{.status = AckStatus::known, .caps = {}};
    if (forgotten_last_[*nibble] >= oldest_) {
        acked.caps = forgotten_[*nibble];
    }
    const std::uint64_t kept_from = std::max(first_, newest_ - kKept + 1);
    std::uint64_t at = oldest_;
    if (at < kept_from) {
        at += (kept_from - at + kNibbles - 1) / kNibbles * kNibbles;
    }
    for (; at <= newest_; at += kNibbles) {
        acked.caps = higher_caps(acked.caps, kept_[at % kKept]);
    }
    return acked;
}

AckedCaps AckLedger::note_recent_ack(std::optional<std::uint8_t> nibble,
                                     std::uint64_t lost) noexcept {
    const std::uint64_t back = kNibbles - 1 + lost;
    if (newest_ > back) {
        oldest_ = std::max(oldest_, newest_ - back);
    }
    return note_ack(nibble);
}

AxisCaps AckLedger::highest_from(std::uint64_t number) const noexcept {
    if (number < first_ || newest_ - number >= kKept) {
        return rapid_caps();
    }
    AxisCaps caps{};
    for (std::uint64_t at = number; at <= newest_; ++at) {
        caps = higher_caps(caps, kept_[at % kKept]);
    }
    return caps;
}

/// Returns the highest caps of every permit from the oldest one on that any of the last samples
/// names.
AxisCaps AckLedger::highest_in(std::uint64_t samples) const noexcept {
    std::uint64_t oldest = samples <= named_.size() ? newest_ : 0;
    for (std::uint64_t i = 0; i < std::min<std::uint64_t>(samples, named_.size()); ++i) {
        oldest = std::min(oldest, named_[(samples_ + named_.size() - 1 - i) % named_.size()]);
    }
    return oldest == 0 ? rapid_caps() : highest_from(oldest);
}

CapFacts AckLedger::note_sample(std::optional<std::uint8_t> nibble, std::uint64_t lost,
                                std::uint32_t age_samples) noexcept {
    const bool is_same = nibble && last_ == nibble;
    const AckedCaps acked = is_same ? note_ack(nibble) : note_recent_ack(nibble, lost);
    last_ = nibble;
    const bool is_known = acked.status == AckStatus::known;
    named_[samples_++ % named_.size()] = is_known ? oldest_ : 0;
    const bool has_age = age_samples != 0;
    return {.status = acked.status,
            .acked = !is_known ? rapid_caps()
                     : has_age ? highest_in(1 + age_samples)
                               : acked.caps,
            .since = highest_in(kSamples + age_samples)};
}

}  // namespace axg
