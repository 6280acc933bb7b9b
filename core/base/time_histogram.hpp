// SPDX-License-Identifier: Apache-2.0
// Times in fixed memory: 32 equal buckets an octave, exact least, most and sum. A share (p99) is
// the upper end of its bucket, so never too small and at most 1/32 too large.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace axg {

class TimeHistogram {
  public:
    void add(std::int64_t ns) noexcept {
        const auto value = static_cast<std::uint64_t>(ns > 0 ? ns : 0);
        least_ = count_ == 0 || ns < least_ ? ns : least_;
        most_ = count_ == 0 || ns > most_ ? ns : most_;
        sum_ += ns;
        ++count_;
        ++buckets_[bucket_of(value)];
    }
    [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
    [[nodiscard]] std::int64_t least_ns() const noexcept { return least_; }
    [[nodiscard]] std::int64_t most_ns() const noexcept { return most_; }
    [[nodiscard]] double mean_ns() const noexcept {
        return count_ == 0 ? 0 : static_cast<double>(sum_) / static_cast<double>(count_);
    }
    /// The time that `share` of all (0 to 1) do not exceed.
    [[nodiscard]] std::int64_t at_share_ns(double share) const noexcept {
        const auto wanted =
            static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(count_)));
        std::uint64_t seen = 0;
        for (std::size_t i = 0; i < buckets_.size(); ++i) {
            seen += buckets_[i];
            if (seen >= wanted && seen > 0) {
                const std::int64_t end = end_of(i);
                return end < most_ ? end : most_;
            }
        }
        return most_;
    }
    /// visit(end of the bucket in ns, count) for every bucket that is not empty, in order of time.
    template <typename Visit>
    void for_each_bucket(Visit&& visit) const {
        for (std::size_t i = 0; i < buckets_.size(); ++i) {
            if (buckets_[i] != 0) {
                visit(end_of(i), buckets_[i]);
            }
        }
    }

  private:
    static constexpr unsigned kSteps = 32;  // linear steps an octave
    static std::size_t bucket_of(std::uint64_t ns) noexcept {
        if (ns < kSteps) {
            return static_cast<std::size_t>(ns);
        }
        const auto octave = static_cast<unsigned>(std::bit_width(ns)) - 6U;  // 32..63 -> 0
        return kSteps + octave * kSteps + static_cast<std::size_t>((ns >> octave) - kSteps);
    }
    static std::int64_t end_of(std::size_t bucket) noexcept {
        if (bucket < kSteps) {
            return static_cast<std::int64_t>(bucket);
        }
        const auto octave = static_cast<unsigned>(bucket / kSteps) - 1U;
        const std::uint64_t step = kSteps + bucket % kSteps;
        return static_cast<std::int64_t>(((step + 1) << octave) - 1);
    }

    std::array<std::uint64_t, kSteps * 60> buckets_{};
    std::uint64_t count_ = 0;
    std::int64_t least_ = 0, most_ = 0, sum_ = 0;
};

}  // namespace axg
