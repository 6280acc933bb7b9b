// SPDX-License-Identifier: Apache-2.0
// Goal: what a certificate proves is true. Method: boxes drawn from certificates of the example
// programs, read back from their bytes. At random positions in them every pair keeps its margin, by
// a query of the engine; and in their middle the directions separate every two triangles by what
// the box needs, by plain arithmetic over all of them. Ablations: boxes without the motion within
// them, or the directions of another box, are not enough.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/machine/kinematics.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "hil_replay/certify/block_prover.hpp"
#include "hil_replay/certify/certificate_file.hpp"
#include "tests/support/count.hpp"
#include "tests/support/dice.hpp"
#include "tests/support/example_programs.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

const std::uint64_t kBoxSeed = test::printed_seed(57);

struct LeafBox {
    std::size_t task;
    UnitBox box;
    Directions directions;
};

/// A certificate's boxes, taken from its bytes.
struct CertifiedBoxes {
    explicit CertifiedBoxes(const test::Example& example) {
        EXPECT_TRUE(test::load_example(example.machine, loaded));
        const Program program = test::read_example(example.program, loaded.machine);
        const ChordPath planned = plan_chord_path(loaded.machine, program, {}, {}, {}).path;
        tasks = certify_tasks(loaded);
        engine.emplace(std::move(*make_engine(loaded)));
        const auto containment = make_containment_test(loaded, *engine);
        const ProgramProof proof =
            prove_program(loaded, tasks, planned, *engine, *containment, {.threads = 1});
        const auto read =
            read_certificate(certificate_file(loaded.machine, planned, proof, {}, "1"));
        path = read->path;
        const Tube tube(loaded.machine, path);
        for (std::size_t task = 0; task < read->tasks.size(); ++task) {
            take_task(tube, task, read->tasks[task]);
        }
    }

    void take_task(const Tube& tube, std::size_t task,
                   const std::vector<ProvenStretch>& stretches) {
        Directions before;
        std::size_t next = 0;
        for (const SegmentRange& piece : pieces_of(path, tasks.tasks[task].tool)) {
            std::uint64_t at = piece.first * kPartsOfSegment;
            for (; at < piece.end * kPartsOfSegment; ++next) {
                const PathInterval part{at, at + stretches[next].at.end};
                at = part.end;
                if (!stretches[next].is_hole) {
                    take_tree(task, tube.box(part), stretches[next].tree, before);
                }
            }
        }
        EXPECT_EQ(next, stretches.size());
    }

    void take_tree(std::size_t task, const UnitBox& whole, const std::string& tree,
                   Directions& before) {
        std::vector<UnitBox> open{whole};
        std::size_t byte = 0;
        while (!open.empty()) {
            const UnitBox box = open.back();
            open.pop_back();
            const auto tag = static_cast<std::uint8_t>(tree[byte++]);
            if (tag >= kCutTag) {
                open.push_back(half_of(box, tag - kCutTag, true));
                open.push_back(half_of(box, tag - kCutTag, false));
                continue;
            }
            if (tag > 0) {
                before.resize(tag);
                std::memcpy(before.data(), &tree[byte], tag * sizeof(Vec3f));
                byte += tag * sizeof(Vec3f);
            }
            boxes.push_back({task, box, before});
        }
        EXPECT_EQ(byte, tree.size());
    }

    LoadedMachine loaded;
    ChordPath path;
    CertifyTasks tasks;
    std::optional<CpuEngine> engine;
    std::vector<LeafBox> boxes;
};

class ProvenBoxesOf : public testing::TestWithParam<test::Example> {};

TEST_P(ProvenBoxesOf, KeepTheMarginAtEveryPosition) {
    CertifiedBoxes of(GetParam());
    const Machine& machine = of.loaded.machine;
    const Tube tube(machine, of.path);
    const BlockProver prover(machine, of.path, tube, of.engine->engine(), of.engine->trees());
    test::Dice dice(kBoxSeed);
    const std::uint64_t count = test::count_from_environment(40000, 4000);
    ASSERT_GT(of.boxes.size(), 50U);
    for (std::uint64_t k = 0; k < count; ++k) {
        const LeafBox& leaf =
            of.boxes[static_cast<std::size_t>(dice.in(0, static_cast<double>(of.boxes.size())))];
        const JointBox box = joint_box(machine, leaf.box);
        AxisPositions position{};
        for (std::size_t i = 0; i < machine.axes.size(); ++i) {
            const double at =
                dice.chance(0.5) ? std::copysign(1.0, dice.in(-1, 1)) : dice.in(-1, 1);
            position[i] = box.centre[i] + at * box.half[i];
        }
        const CertifyTask& task = of.tasks.tasks[leaf.task];
        const Query query = prover.query_at(task, position, task.task.margin_mm);
        QueryResult result;
        of.engine->run({&query, 1}, {&result, 1});
        ASSERT_EQ(result.proof, Proof::far) << k;
    }
}

/// Whether directions separate all triangles of a task in the middle of a box, and if not, how many
/// pairs of triangles stay open.
std::uint64_t open_pairs(const CertifyTask& task, const Pose& pose, double r_mm,
                         const Directions& directions) {
    const auto ends = [](const Triangle& t, const Pose& at, const Vec3f& e) {
        const Vec3d d = widen(e);
        const std::array<double, 3> along{dot(d, apply(at, widen(t.a))),
                                          dot(d, apply(at, widen(t.b))),
                                          dot(d, apply(at, widen(t.c)))};
        return std::pair(std::min({along[0], along[1], along[2]}),
                         std::max({along[0], along[1], along[2]}));
    };
    const auto &of_a = task.surface_a->triangles, &of_b = task.surface_b->triangles;
    std::vector<std::uint8_t> apart(of_a.size() * of_b.size());
    for (const Vec3f& e : directions) {
        const Vec3d d = widen(e);
        const double needed = r_mm * std::sqrt(dot(d, d));
        std::vector<double> low;
        for (const Triangle& t : of_b) {
            low.push_back(ends(t, {}, e).first);
        }
        for (std::size_t i = 0; i < of_a.size(); ++i) {
            const double high = ends(of_a[i], pose, e).second;
            for (std::size_t j = 0; j < of_b.size(); ++j) {
                if (low[j] - high > needed) {
                    apart[i * of_b.size() + j] = 1;
                }
            }
        }
    }
    return static_cast<std::uint64_t>(std::count(apart.begin(), apart.end(), 0));
}

TEST_P(ProvenBoxesOf, HaveDirectionsForAllTriangles) {
    const CertifiedBoxes of(GetParam());
    const Machine& machine = of.loaded.machine;
    test::Dice dice(kBoxSeed);
    std::uint64_t open_without_turn = 0;
    const std::uint64_t count = test::count_from_environment(60, 20);
    for (std::uint64_t k = 0; k < count; ++k) {
        const LeafBox& leaf =
            of.boxes[static_cast<std::size_t>(dice.in(0, static_cast<double>(of.boxes.size())))];
        const JointBoxTask& task = of.tasks.tasks[leaf.task].task;
        const JointBox box = joint_box(machine, leaf.box);
        std::array<Pose, kBodiesMax> moved;
        move_bodies(machine, box.centre, moved);
        const PlacedPair placed = placed_pair(task, moved);
        const PathMotion motion = motion_along(machine, task.path, moved, placed.a, placed.b, box);
        const double r_mm = task.margin_mm + task.pose_error_mm + motion.total_mm;
        const Pose pose = relative_pose(placed.a.placed, placed.b.placed);
        EXPECT_EQ(open_pairs(of.tasks.tasks[leaf.task], pose, r_mm, leaf.directions), 0U) << k;
        Directions turned;
        for (const Vec3f& e : leaf.directions) {
            turned.push_back({-e.x, -e.y, -e.z});
        }
        open_without_turn += open_pairs(of.tasks.tasks[leaf.task], pose, r_mm, turned);
    }
    EXPECT_GT(open_without_turn, 0U);
}

INSTANTIATE_TEST_SUITE_P(Programs, ProvenBoxesOf, testing::ValuesIn(test::kExamples),
                         [](const auto& example) { return test::name_of(example.param); });

// In a box as wide as a stop some position is nearer than the middle by more than its margin: a
// proof of the middle alone would be accepted, and false.
TEST(ProvenBoxes, TheMiddleAloneIsNotEnough) {
    CertifiedBoxes of(test::kExamples[1]);
    const Machine& machine = of.loaded.machine;
    const Tube tube(machine, of.path);
    const BlockProver prover(machine, of.path, tube, of.engine->engine(), of.engine->trees());
    std::uint64_t false_boxes = 0;
    for (std::size_t task = 0; task < of.tasks.tasks.size(); ++task) {
        for (std::uint64_t i = 0; i < of.path.segment_count(); ++i) {
            const UnitBox whole = tube.box({i * kPartsOfSegment, (i + 1) * kPartsOfSegment});
            const JointBox box = joint_box(machine, whole);
            const CertifyTask& at = of.tasks.tasks[task];
            const auto is_far = [&](const AxisPositions& position) {
                const Query query = prover.query_at(at, position, at.task.margin_mm);
                QueryResult result;
                of.engine->run({&query, 1}, {&result, 1});
                return result.proof == Proof::far;
            };
            AxisPositions corner = box.centre;
            bool has_near_corner = false;
            for (unsigned k = 0; k < 32; ++k) {
                for (std::size_t axis = 0; axis < machine.axes.size(); ++axis) {
                    const double sign = (k >> axis & 1U) != 0 ? 1 : -1;
                    corner[axis] = box.centre[axis] + sign * box.half[axis];
                }
                has_near_corner = has_near_corner || !is_far(corner);
            }
            false_boxes += is_far(box.centre) && has_near_corner ? 1 : 0;
        }
    }
    EXPECT_GT(false_boxes, 0U);
}

}  // namespace
}  // namespace axg
