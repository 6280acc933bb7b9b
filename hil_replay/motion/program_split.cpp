// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/motion/program_split.hpp"

#include <cmath>

#include "core/base/sincos.hpp"

namespace axg {

Program split_by_axis(const Program& program, const Machine& machine) {
    Program split;
    split.start = program.start;
    split.start_tool = program.start_tool;
    AxisPositions position = program.start;
    for (const Move& move : program.moves) {
        if (move.kind != MoveKind::line && move.kind != MoveKind::arc) {
            split.moves.push_back(move);
            continue;
        }
        const auto travel = [&](std::size_t axis) {  // one degree counts as one mm, as for paths
            const double unit = machine.axes[axis].kind == AxisKind::rotary ? 180.0 / kPi : 1.0;
            return std::abs(move.target[axis] - position[axis]) * unit;
        };
        double total = 0;
        for (std::size_t axis = 0; axis < machine.axes.size(); ++axis) {
            total += travel(axis);
        }
        Move step = move;
        step.kind = MoveKind::line;
        step.is_exact = true;
        step.arc = Arc{};
        step.target = position;
        for (std::size_t axis = 0; axis < machine.axes.size(); ++axis) {
            if (move.target[axis] == position[axis]) {
                continue;
            }
            if (move.feed_kind == FeedKind::inverse) {
                step.feed = move.feed * total / travel(axis);
            }
            step.target[axis] = move.target[axis];
            split.moves.push_back(step);
        }
        position = move.target;
    }
    return split;
}

}  // namespace axg
