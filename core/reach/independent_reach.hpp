// SPDX-License-Identifier: Apache-2.0
// The reach of each axis by itself: any motion within its limits until the latest start of braking,
// then its own stop.
// Claim: every position from the newest sample to standstill is in the box. Proof:
// docs/theory/certificate.md, "How far an axis can go". Tests: stop_reach_test,
// stoppable_approach_test.
#pragma once

#include <array>
#include <cstdint>

#include "core/reach/reach.hpp"
#include "core/reach/sampled_motion.hpp"

namespace axg {

/// @param samples  n of the permit
/// @param speeds  [axes] mm/s or rad/s, an enforced cap; no bound if above the axis' largest speed
[[nodiscard]] Reach independent_reach(const Machine& machine, const SampledMotion& motion,
                                      std::uint32_t samples,
                                      const std::array<double, kAxesMax>& speeds) noexcept;

}  // namespace axg
