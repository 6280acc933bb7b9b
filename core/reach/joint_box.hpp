// SPDX-License-Identifier: Apache-2.0
// An interval of positions for each axis: the form in which every reach enters a proof.
#pragma once

#include <array>

#include "core/base/limits.hpp"

namespace axg {

/// centre +- half, mm or rad, in Machine::axes order. half >= 0.
struct JointBox {
    std::array<double, kAxesMax> centre{}, half{};
};

}  // namespace axg
