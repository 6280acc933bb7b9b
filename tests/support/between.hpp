// SPDX-License-Identifier: Apache-2.0
// A random number of an interval, the same on every platform: std::uniform_real_distribution is
// not.
#pragma once

#include <random>

namespace axg::test {

/// In [low, high).
inline double between(std::mt19937_64& random, double low, double high) {
    return low + (high - low) * (static_cast<double>(random() >> 11U) * 0x1p-53);
}

}  // namespace axg::test
