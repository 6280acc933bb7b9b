// SPDX-License-Identifier: Apache-2.0
// The true path of a drive, judged beside the guard: does a pair touch anywhere on it, and not only
// where the axes rest? Every instant that it is shown, by the certified test at no margin.
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
    /// `machine`, and what `engine` and `containment_test` stand on, must outlive it.
    PathJudge(const Machine& machine, const Engine& engine, const ContainmentTest& containment_test)
        : machine_(machine), engine_(engine), containment_test_(containment_test) {}

    /// The true axes, mm and rad, in order of time; `tool` is in the spindle.
    void look(std::int64_t time_us, std::span<const AxisMotion> axes, std::uint16_t tool);

    /// The first one; empty: none.
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
