// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/motion/motion_sampler.hpp"

#include <algorithm>
#include <cmath>

namespace axg {

MotionSampler::MotionSampler(const Program& program, const MotionLimits& limits,
                             const MotionOptions& options)
    : program_(program), limits_(limits), options_(options), window_(limits.smooth_steps, 0) {
    current_.position = program.start;
    current_.tool = program.start_tool;
}

bool MotionSampler::next(MotionSample& out) {
    if (!has_started_) {
        has_started_ = true;
        out = current_;
        return true;
    }
    while (!is_running_ && standing_steps_ == 0) {
        if (!begin_move()) {
            return false;
        }
    }
    ++current_.index;
    if (is_running_) {
        step_run(current_);
    } else {
        current_.is_moving = false;
        --standing_steps_;
    }
    out = current_;
    return true;
}

/// Returns false after the last move.
bool MotionSampler::begin_move() {
    if (move_ >= program_.moves.size()) {
        return false;
    }
    const Move& move = program_.moves[move_];
    current_.line = move.line;
    if (move.kind == MoveKind::dwell) {
        standing_steps_ =
            static_cast<std::uint64_t>(std::llround(std::max(0.0, move.dwell_s) / kMotionStepS));
        ++move_;
    } else if (move.kind == MoveKind::coordinates) {
        ++move_;
    } else if (move.kind == MoveKind::tool_change) {
        current_.tool = move.tool;
        standing_steps_ = 1;  // one sample shows the change even if no axis moves
        ++move_;
    } else {
        begin_run();
    }
    return true;
}

void MotionSampler::begin_run() {
    build_run(program_, move_, limits_, options_, run_);
    plan_run(run_, limits_, cells_);
    move_ += run_.move_count;
    ++run_count_;
    blend_count_ += static_cast<std::uint32_t>(
        std::count_if(run_.pieces.begin(), run_.pieces.end(),
                      [](const Piece& piece) { return piece.kind == PieceKind::blend; }));
    clock_.begin(&cells_);
    if (axis_shares_ != nullptr) {
        planned_.begin(&run_, limits_, &cells_);
    } else if (speed_share_ != nullptr) {
        plan_rapid(run_, limits_, rapids_);
        capped_.begin(&cells_, &rapids_);
    }
    free_mm_ = 0;
    std::fill(window_.begin(), window_.end(), 0);
    window_sum_ = 0;
    slot_ = 0;
    piece_ = 0;
    curve_.enter(program_, run_.pieces.front(), limits_);
    is_running_ = true;
}

double MotionSampler::step_capped() {
    const bool is_planned = axis_shares_ != nullptr;
    lost_steps_ += (is_planned ? planned_.is_at_end() : capped_.is_at_end()) ? 0 : 1;
    const double reached_mm =
        is_planned ? planned_.step(*axis_shares_) : capped_.step(*speed_share_);
    while (!clock_.is_at_end() && free_mm_ < reached_mm) {
        free_mm_ = clock_.step();
        --lost_steps_;
    }
    return reached_mm;
}

void MotionSampler::step_run(MotionSample& out) {
    // At the end the distance is the run's exact length: the profile's sum has rounding errors.
    const double reached_mm = is_capped() ? step_capped() : clock_.step();
    const bool is_at_end = axis_shares_ != nullptr   ? planned_.is_at_end()
                           : speed_share_ != nullptr ? capped_.is_at_end()
                                                     : clock_.is_at_end();
    const std::int64_t distance =
        is_at_end ? run_.length
                  : std::min(run_.length,
                             static_cast<std::int64_t>(std::llround(reached_mm * kPathUnitsPerMm)));
    window_sum_ += distance - window_[slot_];
    window_[slot_] = distance;
    slot_ = slot_ + 1 == window_.size() ? 0 : slot_ + 1;
    const Wide steps = limits_.smooth_steps;
    out.is_moving = true;
    if (window_sum_ >= steps * run_.length) {
        const Move& last = program_.moves[run_.first_move + run_.move_count - 1];
        out.position = axes_after(program_, last);
        out.line = last.line;
        is_running_ = false;
        return;
    }
    while (window_sum_ >= steps * (run_.pieces[piece_].start + run_.pieces[piece_].length)) {
        curve_.enter(program_, run_.pieces[++piece_], limits_);
    }
    const Piece& piece = run_.pieces[piece_];
    const double along_mm = static_cast<double>(window_sum_ - steps * piece.start) *
                            (kMmPerPathUnit / limits_.smooth_steps);
    curve_.position(along_mm, out.position);
    out.line = line_at(program_, piece, along_mm);
}

}  // namespace axg
