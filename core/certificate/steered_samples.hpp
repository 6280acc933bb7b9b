// SPDX-License-Identifier: Apache-2.0
// What an enforced cap is steered for. Where it is the least of the machine file, the
// certificate proves it with all that a cycle has.
#pragma once

#include <algorithm>

#include "core/certificate/permit_ladder.hpp"

namespace axg {

/// n that loses few permits by chance: the search of such a cap proves this, and the certificate
/// tries it where it does not prove samples_work.
inline constexpr std::uint8_t kSamplesSteered = 6;
[[nodiscard]] constexpr std::uint8_t samples_steered(PermitSamples range) noexcept {
    return std::max(range.least, std::min(kSamplesSteered, samples_work(range)));
}

}  // namespace axg
