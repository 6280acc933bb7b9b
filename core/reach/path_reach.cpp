// SPDX-License-Identifier: Apache-2.0
#include "core/reach/path_reach.hpp"

#include <utility>

#include "core/reach/stop_limits.hpp"

namespace axg {

PathReach::PathReach(const Machine& machine, LookAheadPath path, Arena arena) noexcept
    : machine_(&machine), path_(std::move(path)), arena_(std::move(arena)) {}

std::optional<PathReach> PathReach::create(const Machine& machine, const PathOptions& options) {
    auto path = LookAheadPath::create(machine, options);
    Arena arena(Arena::size_bytes<JointBox>(kPathPieces));
    if (!path || !arena.ok()) {
        return std::nullopt;
    }
    PathReach made(machine, std::move(*path), std::move(arena));
    made.pieces_ = made.arena_.take<JointBox>(kPathPieces);
    made.arena_.seal();
    return made;
}

void PathReach::note_path(const PathPoints& points) noexcept {
    took_back_ = !path_.note_path(points) || took_back_;
}

void PathReach::note(const AxisSnapshot& snapshot, bool is_first, bool is_jogging) noexcept {
    if (is_first || is_jogging) {
        path_.clear();
        took_back_ = took_back_ && !is_jogging;
    }
    has_left_ = took_back_ || !path_.keeps_to(snapshot);
    took_back_ = false;
    if (has_left_) {
        path_.clear();
    }
}

Reach PathReach::reach(std::uint64_t sample, std::uint32_t samples) noexcept {
    Reach out{.kind = ReachKind::path};
    const double free_s = free_seconds(*machine_, samples);
    double periods = free_s * 1e6 / machine_->can.sample_us;
    if (machine_->guard.promise == StopPromise::path_keeping) {
        const PathStretch stretch = path_.stretch(sample, free_s);
        if (!stretch.is_known) {
            return out;
        }
        path_.cut(sample, stretch.end, pieces_.first<kPathPieces>());
        out.pieces = pieces_;
        periods = stretch.end;
    } else {
        if (!path_.reach(sample, free_s, pieces_.first<kReachPieces>())) {
            return out;
        }
        out.pieces = pieces_.first<kReachPieces>();
    }
    out.is_known = true;
    out.box = out.pieces[0];
    out.until = sample + static_cast<std::uint64_t>(periods);
    return out;
}

}  // namespace axg
