// SPDX-License-Identifier: Apache-2.0
// SHA-256 (FIPS 180-4) of bytes in pieces.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace axg::certcheck {

using Digest = std::array<std::uint8_t, 32>;

class Sha256 {
  public:
    void add(std::span<const std::uint8_t> bytes);
    [[nodiscard]] Digest finish();

  private:
    void block(const std::uint8_t* bytes);

    std::array<std::uint32_t, 8> state_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                        0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
    std::array<std::uint8_t, 64> rest_{};
    std::size_t rest_bytes_ = 0;
    std::uint64_t size_bytes_ = 0;
};

[[nodiscard]] inline Digest sha256(std::span<const std::uint8_t> bytes) {
    Sha256 sum;
    sum.add(bytes);
    return sum.finish();
}

}  // namespace axg::certcheck
