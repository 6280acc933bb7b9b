// SPDX-License-Identifier: Apache-2.0
// The n for which the guard steers an enforced cap. If it is the least n of the machine file, the
// certificate proves it with the whole plan of a cycle.
#pragma once

#include <algorithm>

#include "core/certificate/permit_ladder.hpp"

namespace axg {

/// n that loses few permits by chance: the search for such a cap proves this n, and the certificate
/// tries it if it does not prove samples_work.
inline constexpr std::uint8_t kSamplesSteered = 6;
[[nodiscard]] constexpr std::uint8_t samples_steered(PermitSamples range) noexcept {
    return std::max(range.least, std::min(kSamplesSteered, samples_work(range)));
}

}  // namespace axg
