// SPDX-License-Identifier: Apache-2.0
// Programs that do no harm: five, on three types of machine. With the path announced and kept the
// guard stops none of them, a third of a millimetre from a margin as little as anywhere else. From
// positions alone it may: but only where the axes, for all it knows, can get nearly as close as the
// margin. AXG_COUNT: seconds of each program, which begins again as often as that takes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <random>
#include <string>

#include "core/kinematics.hpp"
#include "hil_replay/drive_run.hpp"
#include "hil_replay/guard_engine.hpp"
#include "hil_replay/motion_sampler.hpp"
#include "hil_replay/program_motion.hpp"
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
constexpr double kUnexplainedMm = 0.6;

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
    std::uint64_t samples = 0, kept_back = 0, not_proven = 0, episodes = 0;
    double most_beyond_mm = -HUGE_VAL;  // of the least in each episode's box
};

/// From the samples of a motion, as a board would latch them, to what the plan cannot prove.
class StateAlone {
  public:
    StateAlone(LoadedMachine& loaded, const Engine& engine, const Solids& solids)
        : loaded_(loaded),
          engine_(engine),
          solids_(solids),
          plan_(make_stop_plan(loaded)),
          distances_(loaded) {}

    void add(const MotionSample& sample, std::mt19937_64& random, Tally& tally) {
        AxisPicture picture;
        picture.sample = tally.samples;
        picture.latched_us = static_cast<std::int64_t>(tally.samples) * 1000;
        picture.arrived_us = picture.latched_us;
        picture.axis_count = static_cast<std::uint32_t>(loaded_.machine.axes.size());
        picture.tool = sample.tool;
        picture.mode = sample.is_moving ? kModeMoving : kModeStandstill;
        picture.position = sample.position;
        plan_->note(picture, tally.samples == 0);
        plan_->prove(engine_, solids_);
        const StopCycle cycle = plan_->cycle();
        ++tally.samples;
        const PairProof* open = nullptr;
        for (const PairProof& proof : cycle.proofs) {
            if (proof.surfaces.proof != BoxProof::proven && open == nullptr) {
                open = &proof;
            }
        }
        if (!cycle.is_settled) {
            tally.kept_back += open != nullptr ? 1 : 0;
            return;
        }
        tally.not_proven += open != nullptr ? 1 : 0;
        if (open != nullptr && !in_episode_) {
            ++tally.episodes;
            const double beyond_mm =
                least_beyond_mm(random, distances_, *open, plan_->reach(), picture.axis_count);
            tally.most_beyond_mm = std::max(tally.most_beyond_mm, beyond_mm);
            print(*open, sample, beyond_mm);
        }
        in_episode_ = open != nullptr;
        plan_->keep();
    }

    [[nodiscard]] bool is_ready() const { return plan_.has_value(); }

  private:
    void print(const PairProof& open, const MotionSample& sample, double beyond_mm) const {
        const Machine& machine = loaded_.machine;
        const Pair& pair = machine.pairs[open.pair];
        std::printf("  line %u, %s-%s, within reach of %.3f mm beyond its margin;", sample.line,
                    machine.bodies[pair.a].name.c_str(), machine.bodies[pair.b].name.c_str(),
                    beyond_mm);
        const JointBox box = plan_->reach();
        for (std::size_t i = 0; i < machine.axes.size(); ++i) {
            std::printf(" %s %.3f+-%.3f", machine.axes[i].name.c_str(), box.centre[i], box.half[i]);
        }
        std::printf("\n");
    }

    LoadedMachine& loaded_;
    Engine engine_;
    const Solids& solids_;
    std::optional<StopPlan> plan_;
    Distances distances_;
    bool in_episode_ = false;
};

class LegalProgram : public testing::TestWithParam<Example> {};

TEST_P(LegalProgram, FromStateAloneStopsOnlyWhereTheMarginCanBeReached) {
    std::mt19937_64 random(printed_seed(20261123));
    LoadedMachine loaded;
    ASSERT_TRUE(load_example(GetParam().machine, loaded));
    std::optional<CpuEngine> engine = make_engine(loaded);
    const std::optional<Solids> solids = make_solids(loaded, *engine);
    StateAlone state(loaded, engine->engine(), *solids);
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
    std::printf("%s: %llu samples, %llu not proven in %llu episodes, at most %.3f mm beyond\n",
                GetParam().program, static_cast<unsigned long long>(tally.samples),
                static_cast<unsigned long long>(tally.not_proven),
                static_cast<unsigned long long>(tally.episodes), tally.most_beyond_mm);
    EXPECT_LE(tally.most_beyond_mm, kUnexplainedMm);
}

/// The board announces its commands, and every stop keeps the path.
void keep_path(Machine& machine) {
    for (Axis& axis : machine.axes) {
        axis.following_error = axis.kind == AxisKind::rotary ? 2e-5 : 0.01;
    }
    machine.can.format = CanFormat::fd;
    machine.can.ahead_samples = 400;
    machine.guard.promise = StopPromise::path_keeping;
}

/// A program in closed loop, again and again until the time is over.
DriveResult drive_for(LoadedMachine& loaded, const char* name, std::uint64_t seconds,
                      const DriveObservers& observers = {}) {
    Machine& machine = loaded.machine;
    std::optional<CpuEngine> engine = make_engine(loaded);
    const std::optional<Solids> solids = make_solids(loaded, *engine);
    std::optional<StopPlan> plan = make_stop_plan(loaded);
    GuardChain chain(machine, engine->engine(), *solids, &*plan);
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

TEST_P(LegalProgram, WithTheAnnouncedPathNothingIsStopped) {
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
