// SPDX-License-Identifier: Apache-2.0
// Random numbers of the tests that draw whole machines and programs.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

namespace axg::test {

class Dice {
  public:
    explicit Dice(std::uint64_t seed) : engine_(seed) {}
    double in(double low, double high) {
        return low + (high - low) * std::uniform_real_distribution<double>(0, 1)(engine_);
    }
    /// As likely between 1 and 10 as between 10 and 100.
    double magnitude(double low, double high) { return low * std::pow(high / low, in(0, 1)); }
    bool chance(double share) { return in(0, 1) < share; }

  private:
    std::mt19937_64 engine_;
};

}  // namespace axg::test
