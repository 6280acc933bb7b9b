// SPDX-License-Identifier: Apache-2.0
// Random numbers that are the same from every compiler and processor: integer arithmetic, and only
// those floating-point operations that IEEE 754 rounds exactly. No distribution of <random>: their
// results differ between libraries. Source: splitmix64 (Steele, Lea, Flood 2014).
#pragma once

#include <cstdint>

namespace axg::lab {

class Draw {
  public:
    explicit Draw(std::uint64_t seed) : state_(seed) {}
    std::uint64_t bits() {
        std::uint64_t z = (state_ += 0x9e3779b97f4a7c15U);
        z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
        z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
        return z ^ (z >> 31U);
    }
    double unit() { return static_cast<double>(bits() >> 11U) * 0x1p-53; }
    double between(double low, double high) { return low + (high - low) * unit(); }
    std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(bits() % n); }
    double sign() { return (bits() & 1U) == 0 ? 1.0 : -1.0; }

  private:
    std::uint64_t state_;
};

}  // namespace axg::lab
