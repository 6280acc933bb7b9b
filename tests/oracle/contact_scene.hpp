// SPDX-License-Identifier: Apache-2.0
// A machine with its surfaces, poses in which it touches itself and poses in which it is clear, as
// CGAL judges them. mm, rad.
#pragma once

#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/base/sincos.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "firmware_if/setup/loaded_machine.hpp"
#include "tests/oracle/cgal_judge.hpp"
#include "tests/support/between.hpp"

namespace axg::test {

using Random = std::mt19937_64;
using Positions = std::array<double, kAxesMax>;

inline constexpr double kFarMm = 45;  // how far the judge looks for a clear pose
inline const std::vector<std::string> kMachines{"paper-trunnion", "spindle-tilting",
                                                "table-spindle-tilting"};

/// A machine with its surfaces, and poses in which it touches itself.
struct ContactScene {
    explicit ContactScene(LoadedMachine machine_and_meshes)
        : loaded(std::move(machine_and_meshes)),
          engine(make_engine(loaded)),
          containment_test(make_containment_test(loaded, *engine)),
          judge(loaded.machine, loaded.meshes) {}

    LoadedMachine loaded;
    std::optional<CpuEngine> engine;
    std::optional<ContainmentTest> containment_test;
    CgalJudge judge;
    std::vector<Positions> clear, touching;

    Machine& machine() { return loaded.machine; }
    std::span<const double> of(const Positions& p) const {
        return {p.data(), loaded.machine.axes.size()};
    }
};

inline Positions random_pose(Random& random, const Machine& machine) {
    Positions pose{};
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const Axis& axis = machine.axes[i];
        const double share = between(random, 0.05, 0.95);
        pose[i] = axis.unlimited ? kPi * (2 * share - 1) : axis.min + (axis.max - axis.min) * share;
    }
    return pose;
}

/// Every margin is made `margin_mm`. Null: the machine file was not read.
inline std::unique_ptr<ContactScene> make_contact_scene(Random& random, const std::string& name,
                                                        double margin_mm) {
    LoadedMachine loaded;
    const std::string file = std::string(AXG_SOURCE_DIR) + "/config/machines/" + name + ".yaml";
    if (!load(file, "", loaded, stderr)) {
        return nullptr;
    }
    for (Pair& pair : loaded.machine.pairs) {
        pair.margin_mm = margin_mm;
    }
    auto scene = std::make_unique<ContactScene>(std::move(loaded));
    for (int i = 0; i < 4000 && (scene->clear.size() < 30 || scene->touching.size() < 60); ++i) {
        const Positions pose = random_pose(random, scene->machine());
        const Judgement judged = scene->judge.judge(scene->of(pose), kFarMm);
        if (judged.touches) {
            scene->touching.push_back(pose);
        } else if (judged.clear_mm >= kFarMm) {
            scene->clear.push_back(pose);
        }
    }
    return scene;
}

/// On the way from the touching pose to the clear one, the first place that is `clear_mm` away.
inline Positions begin_near(ContactScene& scene, const Positions& touching, const Positions& clear,
                            double clear_mm) {
    Positions at = clear;
    for (int k = 1; k <= 60; ++k) {
        for (std::size_t i = 0; i < scene.machine().axes.size(); ++i) {
            at[i] = touching[i] + (clear[i] - touching[i]) * k / 60;
        }
        if (scene.judge.judge(scene.of(at), clear_mm + 1).clear_mm > clear_mm) {
            break;
        }
    }
    return at;
}

/// Distances up to this are exact in judged_mm.
inline constexpr double kJudgedMm = 6;

inline void set_margins(Machine& machine, double margin_mm) {
    for (Pair& pair : machine.pairs) {
        pair.margin_mm = margin_mm;
    }
}

/// The least distance of all pairs, exact up to kJudgedMm.
inline double judged_mm(ContactScene& scene, const Positions& at) {
    set_margins(scene.machine(), kJudgedMm);
    return scene.judge.judge(scene.of(at), kJudgedMm).clear_mm;
}

/// Between a pose that touches and one that is clear, about as near as wanted.
inline Positions place_near(Random& random, ContactScene& scene, double clear_mm) {
    const Positions& touching = scene.touching[random() % scene.touching.size()];
    const Positions& clear = scene.clear[random() % scene.clear.size()];
    double low = 0, high = 1;
    Positions at = clear;
    for (int k = 0; k < 25; ++k) {
        const double middle = 0.5 * (low + high);
        for (std::size_t i = 0; i < scene.machine().axes.size(); ++i) {
            at[i] = touching[i] + (clear[i] - touching[i]) * middle;
        }
        (judged_mm(scene, at) > clear_mm ? high : low) = middle;
    }
    return at;
}

}  // namespace axg::test
