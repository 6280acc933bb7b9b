// SPDX-License-Identifier: Apache-2.0
// Judges the true path of a drive independently of the guard: whether a pair touches anywhere on
// it, not only at rest. Applies the certified test with distance 0 to every instant it receives.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/certificate/pair_queries.hpp"
#include "core/collision/containment.hpp"
#include "core/collision/engine.hpp"
#include "core/machine/machine.hpp"
#include "hil_replay/board/motion_board.hpp"

namespace axg {

/// Two surfaces that are not proven apart, or one body inside the other.
struct PathContact {
    std::uint32_t pair = kNoIndex;
    std::int64_t time_us = 0;
    AxisSnapshot snapshot;
};

[[nodiscard]] constexpr double seconds_after_start(const PathContact& contact) noexcept {
    return static_cast<double>(contact.time_us - kBoardStartUs) * 1e-6;
}

class PathJudge {
  public:
    /// `machine`, `containment_test` and the data behind it and `engine` must outlive it.
    PathJudge(const Machine& machine, const Engine& engine, const ContainmentTest& containment_test)
        : machine_(machine), engine_(engine), containment_test_(containment_test) {}

    /// Tests the true axes, mm and rad, with `tool` in the spindle. Call in order of time.
    void look(std::int64_t time_us, std::span<const AxisMotion> axes, std::uint16_t tool);

    /// The first contact; empty: none.
    [[nodiscard]] const std::optional<PathContact>& contact() const noexcept { return contact_; }
    [[nodiscard]] std::uint64_t instants() const noexcept { return instants_; }

  private:
    const Machine& machine_;
    Engine engine_;
    const ContainmentTest& containment_test_;
    std::unique_ptr<PairQueries> pair_queries_ = std::make_unique<PairQueries>();
    std::vector<QueryResult> results_;
    std::vector<ContainmentResult> contained_;
    std::optional<PathContact> contact_;
    std::uint64_t instants_ = 0;
};

}  // namespace axg
