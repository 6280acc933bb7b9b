// SPDX-License-Identifier: Apache-2.0
// The reach along the path that the board announces: up to a stop, after which each axis brakes by
// itself, or through the stop, if the board keeps to its path (StopPromise::path_keeping).
// Claim: every position from the newest sample to standstill is in one of the pieces, or the axes
// have left the path. Proof: docs/theory/certificate.md, "Look-ahead path". Tests: path_reach_test,
// stop_certificate_path_test.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/arena.hpp"
#include "core/reach/look_ahead_path.hpp"
#include "core/reach/reach.hpp"

namespace axg {

class PathReach {
  public:
    /// `machine` must outlive it. Empty: out of memory, or the board announces no path.
    [[nodiscard]] static std::optional<PathReach> create(const Machine& machine,
                                                         const PathOptions& options);

    void note_path(const PathPoints& points) noexcept;
    /// @param is_jogging  a jog is not part of a path
    void note(const AxisSnapshot& snapshot, bool is_first, bool is_jogging) noexcept;
    /// The axes left the path, or the board changed it, by the newest snapshot.
    [[nodiscard]] bool has_left() const noexcept { return has_left_; }

    /// The pieces hold until the next call. Not known: the path is too short.
    [[nodiscard]] Reach reach(std::uint64_t sample, std::uint32_t samples) noexcept;

    [[nodiscard]] const LookAheadPath& path() const noexcept { return path_; }
    [[nodiscard]] std::size_t memory_bytes() const noexcept {
        return arena_.size() + path_.memory_bytes();
    }

  private:
    PathReach(const Machine& machine, LookAheadPath path, Arena arena) noexcept;

    const Machine* machine_;
    LookAheadPath path_;
    Arena arena_;
    std::span<JointBox> pieces_;
    bool has_left_ = false;   // by the newest snapshot, or by a path frame before it
    bool took_back_ = false;  // by a path frame since the newest snapshot
};

}  // namespace axg
