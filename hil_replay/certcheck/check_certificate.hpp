// SPDX-License-Identifier: Apache-2.0
// The judge: what a certificate claims of a model is proven, or where it is not.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace axg::certcheck {

struct Outcome {
    int exit_code;  // 0 proven, 10 refused, 12 not readable
    std::string text;
};

struct NamedBytes {
    std::string name;
    std::span<const std::uint8_t> bytes;
};

/// @param positions CSV whose head names every axis: mm, degrees; without bytes none is looked up
[[nodiscard]] Outcome check_certificate(const NamedBytes& model, const NamedBytes& certificate,
                                        const NamedBytes& positions);

}  // namespace axg::certcheck
