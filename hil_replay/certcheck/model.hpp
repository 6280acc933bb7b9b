// SPDX-License-Identifier: Apache-2.0
// The machine as the proofs see it: M.model, read whole and checked for sense.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hil_replay/certcheck/box_tree.hpp"
#include "hil_replay/certcheck/interval.hpp"

namespace axg::certcheck {

constexpr int kAxesMax = 16;
constexpr int kBodiesMax = 32;
// |position| <= 2^42 units, and what widens it is bounded: all sums fit.
constexpr std::int64_t kPositionMax = std::int64_t{1} << 42;

struct Axis {
    std::string name;
    bool is_rotary;
    double unit;  // mm or rad of one unit, a power of two
    double speed, acceleration, jerk, stopping;
    std::int64_t following;
    double within;
};

struct Body {
    std::string name;
    int parent, axis;
    Vector direction, pivot;  // direction: of length 1
    int has_surface;          // 2: carries the tool
};

struct Surface {
    std::string name;
    BoxTree tree;
    Vector middle{};
    double radius = 0;  // no corner is farther from the middle
};

struct Task {
    int body[2], tool;
    Pose at[2];
    std::uint32_t surface[2], whole[2];
    double margin, error;
};

struct Exclusion {
    int body[2];
    std::string reason;
};

struct Model {
    bool is_independent, has_free_jerk, turns_round;
    std::vector<Axis> axes;
    std::vector<Body> bodies;
    std::vector<Surface> surfaces;
    std::vector<std::string> tools;
    std::vector<Task> tasks;
    std::vector<Exclusion> exclusions;
};

/// @throws Refusal; 10 also where two bodies with a surface are neither in a task nor excluded
[[nodiscard]] Model read_model(const std::string& file, std::span<const std::uint8_t> bytes);

}  // namespace axg::certcheck
