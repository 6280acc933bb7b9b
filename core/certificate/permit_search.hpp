// SPDX-License-Identifier: Apache-2.0
// The n of each permit: every cycle proves the least n of the machine file and tries one longer n
// beside it, which the ladder chooses.
// Claim: the proofs of the cycle hold for the n that it takes. Proof: docs/theory/certificate.md,
// "The certificate": a longer permit covers every motion of a shorter one. Tests:
// stop_certificate_test (SamplesAreTriedFromALadder...).
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/certificate/permit_ladder.hpp"
#include "core/certificate/steered_samples.hpp"

namespace axg {

class PermitSearch {
  public:
    /// @param keeps_cap  an enforced cap: it falls where samples_work is not proven
    PermitSearch(PermitSamples range, bool keeps_cap) noexcept
        : range_(range),
          keeps_cap_(keeps_cap),
          samples_(range.least),
          ladder_{.samples = keeps_cap ? samples_work(range) : range.most},
          next_(ladder_) {}

    /// A cycle begins anew, which `keep` has not ended.
    void begin() noexcept {
        samples_ = range_.least;
        is_longer_proven_ = false;
        next_ = ladder_;
    }
    [[nodiscard]] bool tries_longer() const noexcept { return axg::tries_longer(range_); }
    [[nodiscard]] std::uint32_t least() const noexcept { return range_.least; }
    [[nodiscard]] std::uint32_t longer() const noexcept { return ladder_.samples; }
    /// @param are_all_proven  for the longer n; the permit is as long as the shortest of all pairs
    void take(bool are_all_proven) noexcept {
        is_longer_proven_ = are_all_proven;
        samples_ = are_all_proven ? ladder_.samples : range_.least;
        if (!keeps_cap_) {
            next_ = ladder_.next(range_, are_all_proven);
        } else {
            next_ = ladder_.next({range_.least, samples_work(range_)}, are_all_proven);
            next_.samples = std::max(next_.samples, samples_steered(range_));
        }
    }
    void keep() noexcept { ladder_ = next_; }

    /// n of the last cycle.
    [[nodiscard]] std::uint8_t samples() const noexcept { return samples_; }
    [[nodiscard]] bool is_longer_proven() const noexcept { return is_longer_proven_; }

  private:
    PermitSamples range_;
    bool keeps_cap_;
    std::uint8_t samples_;
    bool is_longer_proven_ = false;
    PermitLadder ladder_, next_;  // of this cycle and of the next
};

}  // namespace axg
