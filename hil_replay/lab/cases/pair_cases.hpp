// SPDX-License-Identifier: Apache-2.0
// Pairs of triangles made to break a test of them, mm: contacts of every kind at gaps down to the
// last bit, each of the seventeen axes as the only one that separates, thin, parallel, coplanar,
// without area, tiny, subnormal, large, far from the origin, and typical of machines. A pair
// depends only on (category, seed, index): the same bits from every compiler and processor.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/pose.hpp"
#include "hil_replay/lab/cases/pair.hpp"

namespace axg::lab {

/// A vertex p of a is at pose * p in b's frame, with the matrix exactly as given.
struct PosedPair {
    Pair<float> pair;
    Pose pose;
};

[[nodiscard]] std::size_t pair_category_count() noexcept;
[[nodiscard]] const char* pair_category_name(std::size_t category) noexcept;

/// The one of the seventeen axes that alone separates the pairs of this category while their gap
/// is small: 0 and 1 the normals of a and b, 2 + 3 i + j the product of a's edge i and
/// b's edge j, 11 + i and 14 + j the in-plane normals of those edges. -1: no such promise.
[[nodiscard]] int pair_category_axis(std::size_t category) noexcept;

/// Precondition: category < pair_category_count(). T is float or double; in double the gaps are
/// finer. All coordinates are finite and at most 2e5.
template <class T>
[[nodiscard]] Pair<T> make_pair_case(std::size_t category, std::uint64_t seed,
                                     std::uint64_t index) noexcept;
extern template Pair<float> make_pair_case(std::size_t, std::uint64_t, std::uint64_t) noexcept;
extern template Pair<double> make_pair_case(std::size_t, std::uint64_t, std::uint64_t) noexcept;

/// The float pair with a on a body at a random pose: a is rounded in the frame of that body.
[[nodiscard]] PosedPair make_posed_case(std::size_t category, std::uint64_t seed,
                                        std::uint64_t index) noexcept;

}  // namespace axg::lab
