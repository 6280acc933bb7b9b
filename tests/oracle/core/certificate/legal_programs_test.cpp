// SPDX-License-Identifier: Apache-2.0
// Programs that do no harm: five, on three types of machine. With a look-ahead path that is kept
// the guard stops none of them, a third of a millimetre from a margin as little as anywhere else.
// From positions alone it may: but only where the axes, for all it knows, can get nearly as close
// as the margin, or where more queries than it has would have proven that they cannot. AXG_COUNT:
// seconds of each program, which begins again as often as that takes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "core/machine/kinematics.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "hil_replay/drive/drive_run.hpp"
#include "hil_replay/motion/motion_sampler.hpp"
#include "hil_replay/motion/program_motion.hpp"
#include "tests/support/count.hpp"
#include "tests/support/example_programs.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/surface_distance.hpp"

namespace axg::test {
namespace {

using Positions = std::array<double, kAxesMax>;

constexpr std::uint64_t kUsual = 40;
constexpr double kWatchedMm = 60;
constexpr int kStarts = 4;
/// A prover with time: seventeen halvings are few where only one corner of a box is near.
struct Patience {
    JointBoxBudget budget;
    double unexplained_mm;
};
Patience patience() {
    return count_from_environment(kUsual) >= kUsual
               ? Patience{{.rounds = 18, .queries = 1U << 18}, 0.15}
               : Patience{{.rounds = 14, .queries = 1U << 14}, 0.3};
}

/// Distances of pairs, measured by the test.
class Distances {
  public:
    explicit Distances(const LoadedMachine& loaded) : machine_(loaded.machine) {
        for (const Mesh& mesh : loaded.meshes.bodies) {
            bodies_.push_back(tree_of(mesh));
        }
        for (const Mesh& mesh : loaded.meshes.tools) {
            tools_.push_back(tree_of(mesh));
        }
    }

    /// How much farther apart than its margin a pair is, up to kWatchedMm.
    [[nodiscard]] double beyond_mm(const PairProof& proof, const Positions& at) const {
        std::array<Pose, kBodiesMax> placed;
        place_bodies(machine_, at, placed);
        const Pair& pair = machine_.pairs[proof.pair];
        Pose pose_a, pose_b;
        const DistanceTree& a = surface(pair.a, proof.tool, placed, pose_a);
        const DistanceTree& b = surface(pair.b, proof.tool, placed, pose_b);
        return surface_distance(a, b, relative_pose(pose_a, pose_b), kWatchedMm) - pair.margin_mm;
    }

  private:
    using Tree = std::unique_ptr<DistanceTree>;

    static Tree tree_of(const Mesh& mesh) {
        return mesh.triangles.empty() ? nullptr : std::make_unique<DistanceTree>(mesh.triangles);
    }

    const DistanceTree& surface(std::uint32_t body, std::uint32_t tool,
                                const std::array<Pose, kBodiesMax>& placed, Pose& pose) const {
        const bool is_tool = machine_.bodies[body].is_tool;
        pose = is_tool ? compose(placed[body], machine_.tools[tool].at) : placed[body];
        return is_tool ? *tools_[tool] : *bodies_[body];
    }

    const Machine& machine_;
    std::vector<Tree> bodies_, tools_;
};

/// The least that was found of beyond_mm in the box: from corners and middles drawn at random, one
/// axis after the other to where the pair comes closest.
double least_beyond_mm(std::mt19937_64& random, const Distances& distances, const PairProof& proof,
                       const JointBox& box, std::size_t axes) {
    double least_mm = HUGE_VAL;
    for (int start = 0; start < kStarts && least_mm > 0; ++start) {
        Positions at = box.centre;
        for (std::size_t i = 0; i < axes; ++i) {
            at[i] += (static_cast<int>(random() % 3) - 1) * box.half[i];
        }
        double here_mm = distances.beyond_mm(proof, at);
        for (bool improves = true; improves && here_mm > 0;) {
            improves = false;
            for (std::size_t i = 0; i < axes; ++i) {
                for (const double k : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
                    Positions next = at;
                    next[i] = box.centre[i] + k * box.half[i];
                    const double beyond_mm = distances.beyond_mm(proof, next);
                    if (beyond_mm < here_mm) {
                        improves = true;
                        here_mm = beyond_mm;
                        at = next;
                    }
                }
            }
        }
        least_mm = std::min(least_mm, here_mm);
    }
    return least_mm;
}

struct Tally {
    std::uint64_t samples = 0, not_proven = 0, episodes = 0;
    std::uint64_t too_few = 0;          // at the beginning of episodes: proven by more queries
    double most_beyond_mm = -HUGE_VAL;  // of the least where those prove no more, of each episode
};

/// What a sample left unproven.
struct OpenSample {
    std::vector<PairProof> proofs;
    std::vector<JointBoxTask> tasks;
    std::uint32_t line = 0;
};

/// From the samples of a motion, as a board would latch them, to what the certificate cannot prove,
/// and from there to what a prover with time does not prove either.
class StateAlone {
  public:
    StateAlone(LoadedMachine& loaded, const Engine& engine, const ContainmentTest& containment_test)
        : loaded_(loaded),
          engine_(engine),
          containment_test_(containment_test),
          certificate_(make_stop_certificate(loaded)),
          patient_(JointBoxProver::create(loaded.machine, stop_tasks(loaded.machine),
                                          patience().budget)),
          distances_(loaded) {}

    void add(const MotionSample& sample, std::mt19937_64& random, Tally& tally) {
        AxisSnapshot snapshot;
        snapshot.sample = tally.samples;
        snapshot.latched_us = static_cast<std::int64_t>(tally.samples) * 1000;
        snapshot.arrived_us = snapshot.latched_us;
        snapshot.axis_count = static_cast<std::uint32_t>(loaded_.machine.axes.size());
        snapshot.tool = sample.tool;
        snapshot.mode = sample.is_moving ? kModeMoving : kModeStandstill;
        snapshot.position = sample.position;
        certificate_->note(snapshot, tally.samples == 0);
        certificate_->prove(engine_, containment_test_);
        ++tally.samples;
        OpenSample open = open_of(certificate_->cycle());
        open.line = sample.line;
        if (!certificate_->cycle().is_settled) {
            return;
        }
        if (open.tasks.empty()) {
            end(random, tally);
        } else {
            ++tally.not_proven;
            episode_.push_back(std::move(open));
        }
        certificate_->keep();
    }

    /// The episode is over: where it begins for a prover with time, and how near the pair can be
    /// there.
    void end(std::mt19937_64& random, Tally& tally) {
        if (episode_.empty()) {
            return;
        }
        ++tally.episodes;
        const std::size_t first = first_open();
        tally.too_few += first;
        if (first < episode_.size()) {
            const OpenSample& open = episode_[first];
            const std::size_t pair = pair_left_open(open);
            const double beyond_mm =
                least_beyond_mm(random, distances_, open.proofs[pair], open.tasks[pair].box,
                                loaded_.machine.axes.size());
            tally.most_beyond_mm = std::max(tally.most_beyond_mm, beyond_mm);
            print(open, pair, first, beyond_mm);
        }
        episode_.clear();
    }

    [[nodiscard]] bool is_ready() const { return certificate_.has_value() && patient_.has_value(); }

  private:
    [[nodiscard]] OpenSample open_of(const StopCycle& cycle) const {
        OpenSample open;
        for (std::size_t i = 0; i < cycle.proofs.size(); ++i) {
            if (cycle.proofs[i].surfaces.proof != JointBoxProof::proven) {
                open.proofs.push_back(cycle.proofs[i]);
                open.tasks.push_back(certificate_->tasks()[i]);
            }
        }
        return open;
    }

    /// Of its tasks; as many as there are: more queries prove all of them.
    std::size_t pair_left_open(const OpenSample& open) {
        std::vector<JointBoxResult> results(open.tasks.size());
        patient_->prove(engine_, open.tasks, results);
        const auto left = std::find_if(
            results.begin(), results.end(),
            [](const JointBoxResult& result) { return result.proof != JointBoxProof::proven; });
        return static_cast<std::size_t>(left - results.begin());
    }
    bool is_open(std::size_t sample) {
        return pair_left_open(episode_[sample]) < episode_[sample].tasks.size();
    }

    /// Of the episode: the first sample that more queries do not prove, found in steps and then
    /// by halving the last one; as many as there are: none.
    std::size_t first_open() {
        std::size_t proven = 0;  // so many are
        for (std::size_t at = 0; at < episode_.size(); at += kStep) {
            if (is_open(at)) {
                std::size_t open = at;
                while (proven < open) {
                    const std::size_t middle = (proven + open) / 2;
                    if (is_open(middle)) {
                        open = middle;
                    } else {
                        proven = middle + 1;
                    }
                }
                return open;
            }
            proven = at + 1;
        }
        return episode_.size();
    }

    void print(const OpenSample& open, std::size_t pair, std::size_t later,
               double beyond_mm) const {
        const Machine& machine = loaded_.machine;
        const Pair& p = machine.pairs[open.proofs[pair].pair];
        std::printf(
            "  line %u, %s-%s, %zu samples later within reach of %.3f mm beyond its margin;",
            open.line, machine.bodies[p.a].name.c_str(), machine.bodies[p.b].name.c_str(), later,
            beyond_mm);
        const JointBox& box = open.tasks[pair].box;
        for (std::size_t i = 0; i < machine.axes.size(); ++i) {
            std::printf(" %s %.3f+-%.3f", machine.axes[i].name.c_str(), box.centre[i], box.half[i]);
        }
        std::printf("\n");
    }

    static constexpr std::size_t kStep = 16;

    LoadedMachine& loaded_;
    Engine engine_;
    const ContainmentTest& containment_test_;
    std::optional<StopCertificate> certificate_;
    std::optional<JointBoxProver> patient_;
    Distances distances_;
    std::vector<OpenSample> episode_;
};

class LegalProgram : public testing::TestWithParam<Example> {};

TEST_P(LegalProgram, FromStateAloneStopsOnlyWhereTheMarginCanBeReached) {
    std::mt19937_64 random(printed_seed(20261123));
    LoadedMachine loaded;
    ASSERT_TRUE(load_example(GetParam().machine, loaded));
    std::optional<CpuEngine> engine = make_engine(loaded);
    const std::optional<ContainmentTest> containment_test = make_containment_test(loaded, *engine);
    StateAlone state(loaded, engine->engine(), *containment_test);
    ASSERT_TRUE(state.is_ready());
    const std::uint64_t samples_wanted = 1000 * count_from_environment(kUsual);
    const MotionLimits limits = make_motion_limits(loaded.machine);
    const MotionOptions motion;
    Tally tally;
    for (std::uint64_t times = samples_wanted / 10'000 + 1; tally.samples < samples_wanted;) {
        const Program program = read_example(GetParam().program, loaded.machine, times);
        MotionSampler sampler(program, limits, motion);
        MotionSample sample;
        while (tally.samples < samples_wanted && sampler.next(sample)) {
            if (sample.index % 10 == 0) {
                state.add(sample, random, tally);
            }
        }
        ASSERT_GE(tally.samples, samples_wanted) << "a program shorter than ten seconds";
    }
    state.end(random, tally);
    std::printf(
        "%s: %llu samples, %llu not proven in %llu episodes, of them %llu by more questions; "
        "at most %.3f mm beyond\n",
        GetParam().program, static_cast<unsigned long long>(tally.samples),
        static_cast<unsigned long long>(tally.not_proven),
        static_cast<unsigned long long>(tally.episodes),
        static_cast<unsigned long long>(tally.too_few), tally.most_beyond_mm);
    EXPECT_LE(tally.most_beyond_mm, patience().unexplained_mm);
}

/// The board sends a look-ahead path, and every stop keeps the path.
void keep_path(Machine& machine) {
    for (Axis& axis : machine.axes) {
        axis.following_error = axis.kind == AxisKind::rotary ? 2e-5 : 0.01;
    }
    machine.can.format = CanFormat::fd;
    machine.can.look_ahead_samples = 400;
    machine.guard.promise = StopPromise::path_keeping;
}

/// A program in closed loop, again and again until the time is over.
DriveResult drive_for(LoadedMachine& loaded, const char* name, std::uint64_t seconds,
                      const DriveObservers& observers = {}) {
    Machine& machine = loaded.machine;
    std::optional<CpuEngine> engine = make_engine(loaded);
    const std::optional<ContainmentTest> containment_test = make_containment_test(loaded, *engine);
    std::optional<StopCertificate> certificate = make_stop_certificate(loaded);
    GuardChain chain(machine, engine->engine(), *containment_test, {&*certificate});
    const Program program = read_example(name, machine, seconds / 10 + 1);
    const MotionLimits limits = make_motion_limits(machine);
    const MotionOptions motion;
    DriveOptions options;
    options.board = promised_board(machine, 1);
    options.board.tick_us = kMotionStepUs;
    options.time_us_max = static_cast<std::int64_t>(seconds) * 1'000'000;
    const AxisPositions start = default_start(machine);
    return drive(machine, chain, {start.data(), machine.axes.size()},
                 make_program_motion(program, limits, motion), options, observers);
}

TEST_P(LegalProgram, WithALookAheadPathNothingIsStopped) {
    LoadedMachine loaded;
    ASSERT_TRUE(load_example(GetParam().machine, loaded));
    keep_path(loaded.machine);
    const DriveResult result =
        drive_for(loaded, GetParam().program, count_from_environment(kUsual));
    std::printf("%s: %llu samples, %llu permits, guard: %s, board: %s\n", GetParam().program,
                static_cast<unsigned long long>(result.samples),
                static_cast<unsigned long long>(result.permits), to_text(result.guard_stop.reason),
                to_text(result.state));
    EXPECT_EQ(result.guard_stop.reason, StopReason::none);
    EXPECT_EQ(result.board_stop.why, BoardStop::none);
    EXPECT_GT(result.permits + 500, result.samples);
    EXPECT_GT(result.samples, 1000 * (count_from_environment(kUsual) - 1));
}

INSTANTIATE_TEST_SUITE_P(Examples, LegalProgram, testing::ValuesIn(kExamples),
                         [](const auto& example) { return name_of(example.param); });

}  // namespace
}  // namespace axg::test
