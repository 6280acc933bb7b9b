// SPDX-License-Identifier: Apache-2.0
// The example programs, certified as a whole: equal bytes for any number of threads, each pair over
// all of its segments, and every sample in contact in a named hole.
#include "hil_replay/certify/prove_program.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "core/machine/kinematics.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "hil_replay/certify/block_prover.hpp"
#include "hil_replay/certify/certificate_file.hpp"
#include "hil_replay/certify/model_file.hpp"
#include "tests/support/example_programs.hpp"

namespace axg {
namespace {

/// A machine with a program, and the proof of it.
struct Certified {
    Certified(const std::string& machine, const std::string& name, std::uint32_t threads = 1,
              StopPromise promise = StopPromise::independent) {
        EXPECT_TRUE(test::load_example(machine, loaded));
        loaded.machine.guard.promise = promise;
        program = test::read_example(name, loaded.machine);
        PlannedPath planned = plan_chord_path(loaded.machine, program, {}, {}, {});
        path = std::move(planned.path);
        tasks = certify_tasks(loaded);
        std::optional<CpuEngine> engine = make_engine(loaded);
        const auto containment = make_containment_test(loaded, *engine);
        proof = prove_program(loaded, tasks, path, *engine, *containment, {.threads = threads});
    }
    [[nodiscard]] std::string bytes() const {
        return certificate_file(loaded.machine, path, proof, {{"program", sha256_of("")}}, "1");
    }

    LoadedMachine loaded;
    Program program;
    ChordPath path;
    CertifyTasks tasks;
    ProgramProof proof;
};

/// Every stretch in its place: the pieces of the task, one after the other, nothing left out.
void expect_cover(const ChordPath& path, std::uint32_t tool,
                  const std::vector<ProvenStretch>& stretches) {
    std::size_t next = 0;
    for (const SegmentRange& piece : pieces_of(path, tool)) {
        std::uint64_t at = piece.first * kPartsOfSegment;
        while (at < piece.end * kPartsOfSegment) {
            ASSERT_LT(next, stretches.size());
            ASSERT_EQ(stretches[next].at.begin, at);
            ASSERT_GT(stretches[next].at.end, at);
            at = stretches[next++].at.end;
        }
        ASSERT_EQ(at, piece.end * kPartsOfSegment);
    }
    EXPECT_EQ(next, stretches.size());
}

class CertifiedExample : public testing::TestWithParam<test::Example> {};

TEST_P(CertifiedExample, CoversEveryPairAndReadsBack) {
    const Certified one(GetParam().machine, GetParam().program);
    const bool is_near = std::string(GetParam().program).ends_with("-near");
    EXPECT_EQ(one.proof.open.empty(), !is_near);
    for (std::size_t i = 0; i < one.tasks.tasks.size(); ++i) {
        expect_cover(one.path, one.tasks.tasks[i].tool, one.proof.tasks[i]);
    }
    const std::string bytes = one.bytes();
    const auto read = read_certificate(bytes);
    ASSERT_TRUE(read);
    EXPECT_EQ(read->path.nodes, one.path.nodes);
    EXPECT_EQ(read->path.lines, one.path.lines);
    EXPECT_EQ(read->path.speeds, one.path.speeds);
    EXPECT_EQ(read->is_partial, is_near);
    ASSERT_EQ(read->tasks.size(), one.proof.tasks.size());
    for (std::size_t i = 0; i < read->tasks.size(); ++i) {
        ASSERT_EQ(read->tasks[i].size(), one.proof.tasks[i].size());
        for (std::size_t k = 0; k < read->tasks[i].size(); ++k) {
            EXPECT_EQ(read->tasks[i][k].tree, one.proof.tasks[i][k].tree);
            EXPECT_EQ(read->tasks[i][k].is_hole, one.proof.tasks[i][k].is_hole);
        }
    }
}

TEST_P(CertifiedExample, HasEqualBytesForAnyNumberOfThreads) {
    const Certified one(GetParam().machine, GetParam().program, 1);
    const Certified two(GetParam().machine, GetParam().program, 2);
    EXPECT_EQ(one.bytes(), two.bytes());
    EXPECT_EQ(model_file(one.loaded, one.tasks), model_file(two.loaded, two.tasks));
}

INSTANTIATE_TEST_SUITE_P(Programs, CertifiedExample, testing::ValuesIn(test::kExamples),
                         [](const auto& example) { return test::name_of(example.param); });

// A stop along the path leads nowhere else: programs that are near need no room for one.
TEST(ProveProgram, NearProgramsAreCertifiedWhereStopsKeepThePath) {
    for (const test::Example& example : test::kExamples) {
        const Certified one(example.machine, example.program, 1, StopPromise::path_keeping);
        EXPECT_TRUE(one.proof.open.empty()) << example.program;
        EXPECT_TRUE(one.path.speeds.empty());
        for (std::size_t i = 0; i < one.tasks.tasks.size(); ++i) {
            expect_cover(one.path, one.tasks.tasks[i].tool, one.proof.tasks[i]);
        }
    }
}

/// Segments of a task that are holes.
std::vector<bool> holes_of(const ChordPath& path, const std::vector<ProvenStretch>& stretches) {
    std::vector<bool> out(path.segment_count());
    for (const ProvenStretch& stretch : stretches) {
        for (std::uint64_t i = stretch.at.first_segment(); i < stretch.at.end_segment(); ++i) {
            out[i] = out[i] || stretch.is_hole;
        }
    }
    return out;
}

bool is_inside(const Machine& machine, const UnitBox& box, const AxisPositions& position) {
    const JointBox joints = joint_box(machine, box);
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        if (!(std::abs(position[i] - joints.centre[i]) <= joints.half[i])) {
            return false;
        }
    }
    return true;
}

// The motion is sampled once more, each sample is found on the path in turn, and each pair queried
// there: one in contact lies in a hole, and every hole is named.
TEST(ProveProgram, EverySampleInContactIsInANamedHole) {
    const Certified demo("paper-trunnion", "paper-trunnion-demo");
    const Machine& machine = demo.loaded.machine;
    const ChordPath& path = demo.path;
    std::optional<CpuEngine> engine = make_engine(demo.loaded);
    const Tube tube(machine, path);
    const BlockProver prover(machine, path, tube, engine->engine(), engine->trees());
    std::vector<std::vector<bool>> holes;
    for (const std::vector<ProvenStretch>& task : demo.proof.tasks) {
        holes.push_back(holes_of(path, task));
    }
    const MotionLimits limits = make_motion_limits(machine);
    const MotionOptions options;
    MotionSampler sampler(demo.program, limits, options);
    MotionSample sample;
    std::uint64_t segment = 0, contacts = 0, clear_in_holes = 0;
    const auto box_of = [&](std::uint64_t i) { return tube.box({i * 256, (i + 1) * 256}); };
    while (sampler.next(sample)) {
        while (!is_inside(machine, box_of(segment), sample.position)) {
            ++segment;
            ASSERT_LT(segment, path.segment_count()) << sample.index;
        }
        for (std::size_t task = 0; sample.index % 10 == 0 && task < holes.size(); ++task) {
            const CertifyTask& of = demo.tasks.tasks[task];
            const Query query = prover.query_at(of, sample.position, of.task.margin_mm);
            QueryResult result;
            engine->run({&query, 1}, {&result, 1});
            const bool is_far = result.proof == Proof::far;
            contacts += is_far ? 0 : 1;
            clear_in_holes += is_far && holes[task][segment] ? 1 : 0;
            EXPECT_TRUE(is_far || holes[task][segment]) << sample.index;
        }
    }
    EXPECT_GT(contacts, 100U);
    EXPECT_GT(clear_in_holes, 0U);  // stops
    std::vector<std::vector<bool>> named(holes.size(), std::vector<bool>(path.segment_count()));
    for (const OpenStretch& open : demo.proof.open) {
        std::fill(named[open.task].begin() + static_cast<std::ptrdiff_t>(open.first),
                  named[open.task].begin() + static_cast<std::ptrdiff_t>(open.end), true);
        EXPECT_GE(path.lines[open.first], 697U);
        EXPECT_LE(path.lines[open.first], 733U);
    }
    EXPECT_EQ(named, holes);
}

// Around a change every tool is part of the proof, so a long one is found before it is there.
TEST(ProveProgram, PiecesOfATool) {
    ChordPath path;
    path.axis_count = 1;
    path.lines.assign(30, 1);
    path.runs = {{.tool = 0, .segments = 10, .first = 0, .last = 2},
                 {.tool = 1, .segments = 10, .first = 3, .last = 4},
                 {.tool = 0, .segments = 10, .first = 1, .last = 0}};
    const auto text = [&](std::uint32_t tool) {
        std::string out;
        for (const SegmentRange& piece : pieces_of(path, tool)) {
            out += std::to_string(piece.first) + "-" + std::to_string(piece.end) + " ";
        }
        return out;
    };
    EXPECT_EQ(text(kNoIndex), "0-30 ");
    EXPECT_EQ(text(0), "0-13 16-30 ");
    EXPECT_EQ(text(1), "8-21 ");
    EXPECT_EQ(text(2), "8-13 16-21 ");
}

// A body wholly inside another is near to no surface: only the test of containment finds it.
TEST(ProveProgram, APartInsideAnotherIsOpen) {
    LoadedMachine loaded;
    ASSERT_TRUE(test::load_example("paper-trunnion", loaded));
    const std::uint32_t pair = 0;
    const auto cube = [](float from, float to) {
        std::vector<Triangle> out;
        const auto corner = [&](unsigned i) {
            return Vec3f{(i & 1U) != 0 ? to : from, (i & 2U) != 0 ? to : from,
                         (i & 4U) != 0 ? to : from};
        };
        const unsigned faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                      {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
        for (const auto& f : faces) {
            out.push_back({corner(f[0]), corner(f[1]), corner(f[2])});
            out.push_back({corner(f[0]), corner(f[2]), corner(f[3])});
        }
        return out;
    };
    loaded.machine.pairs = {loaded.machine.pairs[pair]};
    loaded.machine.travel.proofs.clear();
    const Pair& only = loaded.machine.pairs[0];
    const std::uint32_t other = loaded.machine.bodies[only.a].is_tool ? only.b : only.a;
    loaded.meshes.bodies[other].triangles = cube(-5000, 5000);
    loaded.meshes.bodies[other].shape = {};
    loaded.meshes.bodies[other].parts = {};
    const Program program = test::read_example("paper-trunnion-clean", loaded.machine);
    const PlannedPath planned = plan_chord_path(loaded.machine, program, {}, {}, {});
    const CertifyTasks tasks = certify_tasks(loaded);
    std::optional<CpuEngine> engine = make_engine(loaded);
    const auto containment = make_containment_test(loaded, *engine);
    const ProgramProof proof =
        prove_program(loaded, tasks, planned.path, *engine, *containment, {.threads = 1});
    ASSERT_EQ(proof.open.size(), 1U);
    EXPECT_EQ(proof.open[0].reason, OpenReason::inside);
    EXPECT_EQ(proof.open[0].end, planned.path.segment_count());
    ASSERT_EQ(proof.tasks[0].size(), 1U);
    EXPECT_TRUE(proof.tasks[0][0].is_hole);
}

}  // namespace
}  // namespace axg
