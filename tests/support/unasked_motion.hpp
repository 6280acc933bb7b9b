// SPDX-License-Identifier: Apache-2.0
// Motion of a board on the bench that no permit covers (bench_board.hpp).
#pragma once

#include "tests/support/broken_rule.hpp"

namespace axg::test {

struct UnaskedMotion {
    double x_mm_s = 0, y_mm_s = 0;
};

/// @param after_s  since the program was stopped; below 0: it was not, since the last arming
inline UnaskedMotion unasked_motion(Broken broken, double after_s, bool rests) {
    const auto within = [after_s](double from_s, double to_s) {
        return after_s >= from_s && after_s < to_s ? 1.0 : 0.0;
    };
    switch (broken) {
        case Broken::moves_another_axis:
            return {.y_mm_s = 60 * within(0, 2)};
        case Broken::jerks_another_axis:
            return {.y_mm_s = 150 * within(0, 0.04)};
        case Broken::creeps_on_another:
            return {.y_mm_s = 2 * within(0, 20)};
        case Broken::moves_later:
            return {.y_mm_s = 60 * within(0.6, 1.5)};
        case Broken::resumes_later:
            return {.y_mm_s = 60 * within(3, 4)};
        case Broken::moves_after_the_last:
            return {.y_mm_s = 60 * within(1.8, 1e9)};  // a person arms sooner
        case Broken::moves_without_arming:
            return {.x_mm_s = 20};
        case Broken::never_rests:
            return {.x_mm_s = rests ? 3 * within(0, 1e9) : 0};
        default:
            return {};
    }
}

}  // namespace axg::test
