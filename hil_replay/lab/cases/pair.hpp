// SPDX-License-Identifier: Apache-2.0
// One pair of closed triangles, mm, and the possible verdicts of a method: a touch is an
// intersection.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/vec3.hpp"

namespace axg::lab {

template <class T>
struct Pair {
    Vec3<T> a[3], b[3];
};

enum class Verdict : std::uint8_t { undecided = 0, separated, intersecting, rejected };

/// Judges `count` pairs. distances_mm: null to skip the distances.
template <class T>
using JudgePairs = void (*)(const Pair<T>* pairs, std::size_t count, Verdict* verdicts,
                            double* distances_mm);

}  // namespace axg::lab
