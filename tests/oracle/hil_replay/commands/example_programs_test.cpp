// SPDX-License-Identifier: Apache-2.0
// The example programs do what their names say, judged by distances that share no code with the
// engines: the clean ones keep every pair apart, the demo drives the cutter into the plate and into
// nothing else, and the near ones come close without a contact.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <memory>
#include <sstream>

#include "config/compiled/compiled_machine.hpp"
#include "config/mesh/load_meshes.hpp"
#include "core/machine/kinematics.hpp"
#include "hil_replay/gcode/gcode_reader.hpp"
#include "hil_replay/motion/motion_sampler.hpp"
#include "tests/support/surface_distance.hpp"

namespace axg {
namespace {

constexpr std::uint64_t kStepsBetweenLooks = 200;  // 20 ms: 1.3 mm of tool path
constexpr double kLookMm = 5.0;                    // distances beyond do not matter here

struct Closest {
    std::vector<double> distance_mm;      // [pairs], kLookMm where farther
    std::vector<double> first_contact_s;  // [pairs], negative where none
    double all_axes_moving_s = 0;         // until the first contact
    double end_s = 0;
};

class Watch {
  public:
    explicit Watch(const std::string& machine_name) {
        const std::string folder = std::string(AXG_SOURCE_DIR) + "/config/machines";
        for (const ConfigFault& fault :
             load_machine(folder + "/" + machine_name + ".yaml", machine)) {
            ADD_FAILURE() << to_string(fault);
        }
        for (const ConfigFault& fault : load_meshes(machine, folder, meshes_)) {
            ADD_FAILURE() << to_string(fault);
        }
        for (const Mesh& mesh : meshes_.bodies) {
            bodies_.push_back(tree_of(mesh));
        }
        for (const Mesh& mesh : meshes_.tools) {
            tools_.push_back(tree_of(mesh));
        }
        placed_.resize(machine.bodies.size());
    }

    [[nodiscard]] Closest follow(const std::string& program_name) {
        std::ifstream file(std::string(AXG_SOURCE_DIR) + "/hil_replay/programs/" + program_name);
        std::stringstream text;
        text << file.rdbuf();
        GcodeOptions options;
        options.start = default_start(machine);
        const GcodeResult reading = read_gcode(text.str(), machine, options);
        for (const ProgramFault& fault : reading.faults) {
            ADD_FAILURE() << program_name << ":" << fault.line << ": " << fault.message;
        }
        EXPECT_FALSE(reading.program.moves.empty());
        const MotionLimits limits = make_motion_limits(machine);
        const MotionOptions motion;
        MotionSampler sampler(reading.program, limits, motion);
        Closest closest;
        closest.distance_mm.assign(machine.pairs.size(), kLookMm);
        closest.first_contact_s.assign(machine.pairs.size(), -1);
        MotionSample sample, before;
        bool has_hit = false;
        while (sampler.next(sample)) {
            if (sample.index % kStepsBetweenLooks == 0) {
                has_hit = look(sample, closest) || has_hit;
                closest.all_axes_moving_s += !has_hit && all_differ(sample, before) ? 0.02 : 0;
                before = sample;
            }
        }
        closest.end_s = static_cast<double>(sample.index) * kMotionStepS;
        return closest;
    }

    Machine machine;

  private:
    using Tree = std::unique_ptr<test::DistanceTree>;

    static Tree tree_of(const Mesh& mesh) {
        return mesh.triangles.empty() ? nullptr
                                      : std::make_unique<test::DistanceTree>(mesh.triangles);
    }

    [[nodiscard]] bool all_differ(const MotionSample& a, const MotionSample& b) const {
        for (std::size_t i = 0; i < machine.axes.size(); ++i) {
            if (a.position[i] == b.position[i]) {
                return false;
            }
        }
        return true;
    }

    const test::DistanceTree* surface(std::uint32_t body, std::uint16_t tool, Pose& pose) const {
        pose = placed_[body];
        if (!machine.bodies[body].is_tool) {
            return bodies_[body].get();
        }
        for (std::size_t i = 0; i < machine.tools.size(); ++i) {
            if (machine.tools[i].number == tool) {
                pose = compose(pose, machine.tools[i].at);
                return tools_[i].get();
            }
        }
        return nullptr;
    }

    /// True when some pair touches.
    bool look(const MotionSample& sample, Closest& closest) {
        place_bodies(machine, {sample.position.data(), machine.axes.size()}, placed_);
        bool has_contact = false;
        for (std::size_t i = 0; i < machine.pairs.size(); ++i) {
            Pose pose_a, pose_b;
            const auto* a = surface(machine.pairs[i].a, sample.tool, pose_a);
            const auto* b = surface(machine.pairs[i].b, sample.tool, pose_b);
            if (a == nullptr || b == nullptr) {
                ADD_FAILURE() << "a pair without a surface, tool " << sample.tool;
                continue;
            }
            const double distance =
                test::surface_distance(*a, *b, relative_pose(pose_a, pose_b), kLookMm);
            closest.distance_mm[i] = std::min(closest.distance_mm[i], distance);
            if (distance == 0 && closest.first_contact_s[i] < 0) {
                closest.first_contact_s[i] = static_cast<double>(sample.index) * kMotionStepS;
            }
            has_contact = has_contact || distance == 0;
        }
        return has_contact;
    }

    MachineMeshes meshes_;
    std::vector<Tree> bodies_, tools_;
    std::vector<Pose> placed_;
};

class CleanProgram : public testing::TestWithParam<std::array<const char*, 2>> {};

TEST_P(CleanProgram, KeepsEveryPairApart) {
    Watch watch(GetParam()[0]);
    const Closest closest = watch.follow(GetParam()[1]);
    for (std::size_t i = 0; i < watch.machine.pairs.size(); ++i) {
        const Pair& pair = watch.machine.pairs[i];
        EXPECT_GT(closest.distance_mm[i], pair.margin_mm + 1)
            << watch.machine.bodies[pair.a].name << "-" << watch.machine.bodies[pair.b].name;
    }
    EXPECT_GT(closest.all_axes_moving_s, 10.0);
}

INSTANTIATE_TEST_SUITE_P(Examples, CleanProgram,
                         testing::Values(std::array{"paper-trunnion", "paper-trunnion-clean.ngc"},
                                         std::array{"spindle-tilting", "spindle-tilting.ngc"},
                                         std::array{"table-spindle-tilting",
                                                    "table-spindle-tilting.ngc"}),
                         [](const auto& example) {
                             std::string name = example.param[0];
                             std::replace(name.begin(), name.end(), '-', '_');
                             return name;
                         });

class NearProgram : public testing::TestWithParam<std::array<const char*, 2>> {};

TEST_P(NearProgram, ComesCloseAndKeepsItsMargins) {
    Watch watch(GetParam()[0]);
    const Closest closest = watch.follow(GetParam()[1]);
    double least_mm = kLookMm;
    for (std::size_t i = 0; i < watch.machine.pairs.size(); ++i) {
        const double beyond_mm = closest.distance_mm[i] - watch.machine.pairs[i].margin_mm;
        EXPECT_GE(beyond_mm, 0.2) << watch.machine.bodies[watch.machine.pairs[i].a].name << "-"
                                  << watch.machine.bodies[watch.machine.pairs[i].b].name;
        least_mm = std::min(least_mm, beyond_mm);
    }
    EXPECT_LT(least_mm, 0.5) << "not near enough to tell anything";
}

INSTANTIATE_TEST_SUITE_P(Examples, NearProgram,
                         testing::Values(std::array{"paper-trunnion", "paper-trunnion-near.ngc"},
                                         std::array{"table-spindle-tilting",
                                                    "table-spindle-tilting-near.ngc"}),
                         [](const auto& example) {
                             std::string name = example.param[0];
                             std::replace(name.begin(), name.end(), '-', '_');
                             return name;
                         });

TEST(DemoProgram, MeetsThePlateWithTheCutterAlone) {
    Watch watch("paper-trunnion");
    const Closest closest = watch.follow("paper-trunnion-demo.ngc");
    for (std::size_t i = 0; i < watch.machine.pairs.size(); ++i) {
        const Pair& pair = watch.machine.pairs[i];
        const std::string name =
            watch.machine.bodies[pair.a].name + "-" + watch.machine.bodies[pair.b].name;
        if (name == "cutter-c") {
            EXPECT_GT(closest.first_contact_s[i], 10.0);
            EXPECT_LT(closest.first_contact_s[i], closest.end_s - 0.5);
        } else {
            EXPECT_LT(closest.first_contact_s[i], 0) << name;
            EXPECT_EQ(closest.distance_mm[i], kLookMm) << name << " comes nowhere near";
        }
    }
    EXPECT_GT(closest.all_axes_moving_s, 10.0) << "before the contact";
}

}  // namespace
}  // namespace axg
