// SPDX-License-Identifier: Apache-2.0
// Where the axes may be from the newest sample to standstill, for a permit that is valid for n
// samples. Every kind of reach gives boxes of this form, and what proves them does not ask for the
// kind: each axis by itself (independent_reach.hpp), along the path that the board announces
// (path_reach.hpp), and one axis in a jog (jog.hpp).
#pragma once

#include <cstdint>
#include <span>

#include "core/reach/joint_box.hpp"

namespace axg {

enum class ReachKind : std::uint8_t { independent, path, jog };

struct Reach {
    ReachKind kind = ReachKind::independent;
    bool is_known = false;  // false: too few samples, or too short a path
    JointBox box{};         // of all positions
    // Boxes that together hold every position: the children of piece i are 2 i + 1 and 2 i + 2,
    // piece 0 is `box`. Empty: `box` alone.
    std::span<const JointBox> pieces{};
    std::uint64_t until = 0;  // path: the last sample whose command lies in the boxes

    [[nodiscard]] bool is_known_path() const noexcept {
        return is_known && kind == ReachKind::path;
    }
};

}  // namespace axg
