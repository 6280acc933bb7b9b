// SPDX-License-Identifier: Apache-2.0
// Writes a scene folder: a machine's bodies along random five-axis motions, most of them free but
// near. A motion starts where an approach along one linear axis came to a drawn distance (the
// distance itself is a safe step, so that no approach tunnels), and turns and moves all axes a
// little; poses in contact are kept up to a quota, so that every contact is a light one.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "config/compiled/compiled_machine.hpp"
#include "config/mesh/load_meshes.hpp"
#include "core/base/sincos.hpp"
#include "core/machine/kinematics.hpp"
#include "tests/support/scene.hpp"
#include "tests/support/surface_distance.hpp"

namespace {

using namespace axg;
using axg::test::DistanceTree;
using axg::test::Scene;

constexpr double kNearMm = 20.0;    // the closest checked pair of a near pose
constexpr double kReportMm = 50.0;  // what the summary counts as near
constexpr double kStepMm = 80.0;    // longest step of an approach: farther is not measured
constexpr double kContactShare = 0.05;
constexpr int kPosesPerMotion = 10;

struct Options {
    std::string machine, out, focus, mesh_root;
    std::uint32_t poses = 2000;
    std::uint64_t seed = 1;
    bool near = false;
};

/// mt19937_64 is the same everywhere; the distributions of <random> are not, so they are ours.
class Random {
  public:
    explicit Random(std::uint64_t seed) : bits_(seed) {}
    double unit() { return static_cast<double>(bits_() >> 11U) * 0x1p-53; }
    double between(double low, double high) { return low + (high - low) * unit(); }
    std::size_t below(std::size_t n) { return static_cast<std::size_t>(bits_() % n); }

  private:
    std::mt19937_64 bits_;
};

struct PosedMachine {
    Machine machine;
    std::vector<std::uint32_t> body_of;  // scene body -> machine body
    std::vector<DistanceTree> trees;     // [scene bodies]
    Scene scene;                         // bodies and pairs; poses are added
    std::optional<std::size_t> focus;    // index of the pair that most approaches are to end at
};

std::vector<Pose> place(const PosedMachine& posed, const std::vector<double>& position) {
    std::vector<Pose> placed(posed.machine.bodies.size());
    place_bodies(posed.machine, position, placed);
    std::vector<Pose> out;
    for (const std::uint32_t body : posed.body_of) {
        Pose pose = placed[body];
        if (posed.machine.bodies[body].is_tool) {
            for (const Tool& tool : posed.machine.tools) {
                pose = tool.number == posed.machine.first_tool ? compose(pose, tool.at) : pose;
            }
        }
        out.push_back(pose);
    }
    return out;
}

double pair_distance(const PosedMachine& posed, const std::vector<Pose>& placed, std::size_t pair,
                     double cap_mm) {
    const auto& p = posed.scene.pairs[pair];
    return surface_distance(posed.trees[p.a], posed.trees[p.b],
                            relative_pose(placed[p.a], placed[p.b]), cap_mm);
}

double least_distance(const PosedMachine& posed, const std::vector<double>& position,
                      double cap_mm) {
    const std::vector<Pose> placed = place(posed, position);
    double least = cap_mm;
    for (std::size_t pair = 0; pair < posed.scene.pairs.size() && least > 0; ++pair) {
        least = pair_distance(posed, placed, pair, least);
    }
    return least;
}

std::pair<double, double> travel(const Axis& axis) {
    return axis.unlimited ? std::pair{-kPi, kPi} : std::pair{axis.min, axis.max};
}

std::vector<double> random_position(const PosedMachine& posed, Random& random) {
    std::vector<double> position;
    for (const Axis& axis : posed.machine.axes) {
        const auto [low, high] = travel(axis);
        position.push_back(random.between(low, high));
    }
    return position;
}

/// A free position whose closest checked pair is about `target_mm` apart: from a random position
/// along one linear axis. Empty when the draw met nothing or began in contact.
std::optional<std::vector<double>> approach(const PosedMachine& posed, Random& random,
                                            double target_mm) {
    std::vector<std::size_t> linear;
    for (std::size_t i = 0; i < posed.machine.axes.size(); ++i) {
        if (posed.machine.axes[i].kind == AxisKind::linear) {
            linear.push_back(i);
        }
    }
    std::vector<double> position = random_position(posed, random);
    const std::size_t axis = linear[random.below(linear.size())];
    const double sign = random.unit() < 0.5 ? -1 : 1;
    const auto [low, high] = travel(posed.machine.axes[axis]);
    double distance = least_distance(posed, position, kStepMm);
    if (distance <= 0) {
        return std::nullopt;
    }
    while (distance > target_mm + 0.01) {
        position[axis] += sign * (distance - target_mm);
        if (position[axis] < low || position[axis] > high) {
            return std::nullopt;
        }
        distance = least_distance(posed, position, kStepMm);
    }
    return position;
}

bool pair_is_nearest(const PosedMachine& posed, const std::vector<double>& position,
                     std::size_t pair) {
    const std::vector<Pose> placed = place(posed, position);
    return pair_distance(posed, placed, pair, kNearMm + 1) <=
           least_distance(posed, position, kNearMm) + 0.02;
}

std::vector<double> approach_until_found(const PosedMachine& posed, Random& random) {
    constexpr int kTriesMax = 200000;
    const bool focused = posed.focus.has_value() && random.unit() < 0.95;
    for (int tries = 0; tries < kTriesMax; ++tries) {
        const double target = kNearMm * random.unit() * random.unit();
        const auto position = approach(posed, random, target);
        if (position && (!focused || pair_is_nearest(posed, *position, *posed.focus))) {
            return *position;
        }
    }
    std::fprintf(stderr,
                 "make_scene: %d approaches found no such pose: do the checked pairs meet "
                 "inside the travel?\n",
                 kTriesMax);
    std::exit(1);
}

void add_pose(PosedMachine& posed, const std::vector<double>& position) {
    const std::vector<Pose> placed = place(posed, position);
    posed.scene.placed.insert(posed.scene.placed.end(), placed.begin(), placed.end());
    ++posed.scene.pose_count;
}

/// Up to kPosesPerMotion poses from `start` on, at most 12 mm and 4 degrees of each axis away.
void add_near_motion(PosedMachine& posed, Random& random, const std::vector<double>& start,
                     std::uint32_t pose_count, std::uint32_t& contacts) {
    std::vector<double> step;
    for (const Axis& axis : posed.machine.axes) {
        const double most = axis.kind == AxisKind::linear ? 12.0 : 4.0 * kPi / 180.0;
        step.push_back(random.between(-most, most) / kPosesPerMotion);
    }
    std::vector<double> position = start;
    for (int i = 0; i < kPosesPerMotion && posed.scene.pose_count < pose_count; ++i) {
        for (std::size_t axis = 0; axis < position.size() && i > 0; ++axis) {
            const auto [low, high] = travel(posed.machine.axes[axis]);
            position[axis] = std::clamp(position[axis] + step[axis], low, high);
        }
        const double distance = least_distance(posed, position, kNearMm);
        const bool contact = distance <= 0;
        if (distance >= kNearMm ||
            (contact && contacts + 1 > kContactShare * (posed.scene.pose_count + 1))) {
            return;  // moved away, or contacts enough: the next motion
        }
        contacts += contact ? 1 : 0;
        add_pose(posed, position);
    }
}

void add_poses(PosedMachine& posed, const Options& options) {
    Random random{options.seed};
    std::uint32_t contacts = 0;
    while (posed.scene.pose_count < options.poses) {
        if (options.near) {
            add_near_motion(posed, random, approach_until_found(posed, random), options.poses,
                            contacts);
            continue;
        }
        const std::vector<double> from = random_position(posed, random);
        const std::vector<double> to = random_position(posed, random);
        for (int i = 0; i < kPosesPerMotion && posed.scene.pose_count < options.poses; ++i) {
            std::vector<double> position = from;
            for (std::size_t axis = 0; axis < position.size(); ++axis) {
                position[axis] += (to[axis] - from[axis]) * i / kPosesPerMotion;
            }
            add_pose(posed, position);
        }
    }
}

void print_summary(const PosedMachine& posed, const Options& options) {
    std::printf("%u poses, %zu bodies, seed %llu\n", posed.scene.pose_count,
                posed.scene.bodies.size(), static_cast<unsigned long long>(options.seed));
    std::printf("%-24s %14s %10s\n", "pair", "within 50 mm", "contact");
    for (std::size_t pair = 0; pair < posed.scene.pairs.size(); ++pair) {
        int near = 0;
        int contact = 0;
        for (std::uint32_t pose = 0; pose < posed.scene.pose_count; ++pose) {
            const auto first = posed.scene.placed.begin() +
                               static_cast<std::ptrdiff_t>(pose * posed.scene.bodies.size());
            const std::vector<Pose> placed(
                first, first + static_cast<std::ptrdiff_t>(posed.scene.bodies.size()));
            const double distance = pair_distance(posed, placed, pair, kReportMm);
            near += distance < kReportMm ? 1 : 0;
            contact += distance <= 0 ? 1 : 0;
        }
        std::printf("%-24s %12.1f %% %8.1f %%\n", posed.scene.pairs[pair].name.c_str(),
                    100.0 * near / posed.scene.pose_count,
                    100.0 * contact / posed.scene.pose_count);
    }
}

[[noreturn]] void stop_with_faults(const std::vector<ConfigFault>& faults) {
    for (const ConfigFault& fault : faults) {
        std::fprintf(stderr, "%s\n", to_string(fault).c_str());
    }
    std::exit(3);
}

PosedMachine load(const Options& options) {
    PosedMachine posed;
    if (const auto faults = load_machine(options.machine, posed.machine); !faults.empty()) {
        stop_with_faults(faults);
    }
    MachineMeshes meshes;
    const std::string beside = std::filesystem::path(options.machine).parent_path().string();
    const std::string root = options.mesh_root.empty() ? beside : options.mesh_root;
    if (const auto faults = load_meshes(posed.machine, root, meshes); !faults.empty()) {
        stop_with_faults(faults);
    }
    std::vector<std::uint32_t> scene_body(posed.machine.bodies.size(), kNoIndex);
    for (std::uint32_t i = 0; i < posed.machine.bodies.size(); ++i) {
        const Body& body = posed.machine.bodies[i];
        Mesh mesh = meshes.bodies[i];
        for (std::size_t t = 0; body.is_tool && t < posed.machine.tools.size(); ++t) {
            mesh =
                posed.machine.tools[t].number == posed.machine.first_tool ? meshes.tools[t] : mesh;
        }
        if (mesh.triangles.empty()) {
            continue;
        }
        mesh.name = body.name;
        scene_body[i] = static_cast<std::uint32_t>(posed.body_of.size());
        posed.body_of.push_back(i);
        posed.trees.emplace_back(mesh.triangles);
        posed.scene.bodies.push_back(std::move(mesh));
    }
    for (const Pair& pair : posed.machine.pairs) {
        const std::uint32_t a = scene_body[pair.a];
        const std::uint32_t b = scene_body[pair.b];
        if (a == kNoIndex || b == kNoIndex) {
            continue;
        }
        const std::string name = posed.scene.bodies[a].name + "-" + posed.scene.bodies[b].name;
        if (name == options.focus) {
            posed.focus = posed.scene.pairs.size();
        }
        posed.scene.pairs.push_back({name, a, b});
    }
    if (!options.focus.empty() && !posed.focus) {
        std::fprintf(stderr, "make_scene: no pair is called %s\n", options.focus.c_str());
        std::exit(2);
    }
    return posed;
}

Options parse(int argc, char** argv) {
    Options options;
    const auto usage = [](const char* argument) {
        std::fprintf(stderr,
                     "make_scene: what is '%s'?\nusage: axg_make_scene MACHINE.yaml OUT_DIR "
                     "[--poses N] [--seed S] [--near] [--focus A-B] [--mesh-root DIR]\n",
                     argument);
        std::exit(2);
    };
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        const bool has_value = i + 1 < argc;
        if (argument == "--near") {
            options.near = true;
        } else if (argument == "--poses" && has_value) {
            options.poses = static_cast<std::uint32_t>(std::strtoul(argv[++i], nullptr, 10));
        } else if (argument == "--seed" && has_value) {
            options.seed = std::strtoull(argv[++i], nullptr, 10);
        } else if (argument == "--focus" && has_value) {
            options.focus = argv[++i];
        } else if (argument == "--mesh-root" && has_value) {
            options.mesh_root = argv[++i];
        } else if (argument.rfind("--", 0) != 0 && options.machine.empty()) {
            options.machine = argument;
        } else if (argument.rfind("--", 0) != 0 && options.out.empty()) {
            options.out = argument;
        } else {
            usage(argv[i]);
        }
    }
    if (options.out.empty() || options.poses == 0) {
        usage(options.out.empty() ? "no OUT_DIR" : "--poses 0");
    }
    return options;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const Options options = parse(argc, argv);
        PosedMachine posed = load(options);
        add_poses(posed, options);
        write_scene(posed.scene, options.out);
        print_summary(posed, options);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "make_scene: %s\n", error.what());
        return 1;
    }
    return 0;
}
