// SPDX-License-Identifier: Apache-2.0
// Every kind of bits that is no number: infinities, quiet and signalling NaN of either sign, with
// the smallest and the largest payload. For the tests of the doors where numbers enter.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace axg::test {

inline constexpr std::array<std::uint32_t, 10> kNotFiniteFloatBits{
    0x7f800000U, 0xff800000U,                            // infinities
    0x7fc00000U, 0xffc00000U, 0x7fc00001U, 0x7fffffffU,  // quiet
    0x7f800001U, 0xff800001U, 0x7fbfffffU, 0x7fa00000U   // signalling
};

inline constexpr std::array<std::uint64_t, 10> kNotFiniteDoubleBits{
    0x7ff0000000000000U, 0xfff0000000000000U,                                            //
    0x7ff8000000000000U, 0xfff8000000000000U, 0x7ff8000000000001U, 0x7fffffffffffffffU,  //
    0x7ff0000000000001U, 0xfff0000000000001U, 0x7ff7ffffffffffffU, 0x7ff4000000000000U};

inline float float_of(std::uint32_t bits) {
    return std::bit_cast<float>(bits);
}
inline double double_of(std::uint64_t bits) {
    return std::bit_cast<double>(bits);
}

}  // namespace axg::test
