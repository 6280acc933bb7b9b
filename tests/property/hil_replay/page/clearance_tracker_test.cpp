// SPDX-License-Identifier: Apache-2.0
// The tracker against a query of every pair at every sample: a random walk of the paper's machine,
// in steps from 1 um to 10 mm, with jumps and tools.
#include "hil_replay/page/clearance_tracker.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "firmware_if/setup/choose_engine.hpp"
#include "firmware_if/setup/guard_parts.hpp"
#include "hil_replay/page/pair_clearances.hpp"
#include "hil_replay/page/run_page.hpp"
#include "tests/support/seed.hpp"

namespace axg::test {
namespace {

class Walk {
  public:
    Walk(const Machine& machine, std::uint64_t seed) : machine_(machine), random_(seed) {
        snapshot_.axis_count = static_cast<std::uint32_t>(machine.axes.size());
        jump();
    }

    const AxisSnapshot& next() {
        if (random_() % 64 == 0) {
            size_ = std::pow(10.0, std::uniform_real_distribution<double>(-3, 1)(random_));
        }
        if (random_() % 512 == 0) {
            jump();
        }
        for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
            const bool is_rotary = machine_.axes[i].kind == AxisKind::rotary;
            const double step = (is_rotary ? 0.01 : 1.0) * size_;
            move_to(i, snapshot_.position.at(i) +
                           std::uniform_real_distribution<double>(-step, step)(random_));
        }
        return snapshot_;
    }

  private:
    void jump() {
        for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
            const Axis& axis = machine_.axes[i];
            const double end = axis.unlimited ? 3.0 : axis.max,
                         begin = axis.unlimited ? -3.0 : axis.min;
            move_to(i, std::uniform_real_distribution<double>(begin, end)(random_));
        }
        snapshot_.tool = random_() % 2 == 0 ? 0 : machine_.first_tool;
    }
    void move_to(std::size_t i, double at) {
        const Axis& axis = machine_.axes[i];
        snapshot_.position.at(i) = axis.unlimited ? at : std::clamp(at, axis.min, axis.max);
    }

    const Machine& machine_;
    std::mt19937_64 random_;
    double size_ = 1;
    AxisSnapshot snapshot_;
};

class Tracked : public testing::Test {
  protected:
    void SetUp() override {
        ASSERT_TRUE(
            load(AXG_SOURCE_DIR "/config/machines/paper-trunnion.yaml", "", loaded_, stderr));
        engine_.emplace(std::move(*make_engine(loaded_)));
    }

    LoadedMachine loaded_;
    std::optional<CpuEngine> engine_;
};

TEST_F(Tracked, ABoundIsNeverAboveTheClearanceAndNeverFarBelow) {
    constexpr int kSamples = 20'000;
    ClearanceTracker tracker(loaded_, engine_->engine(), kPageWithinMm);
    PairClearances exact(loaded_, engine_->engine(), kPageWithinMm + 5);
    Walk walk(loaded_.machine, printed_seed(20261123));
    std::uint64_t near = 0;
    for (int i = 0; i < kSamples; ++i) {
        const AxisSnapshot& snapshot = walk.next();
        const std::span<const double> bounds = tracker.at(snapshot);
        const std::span<const double> clearances = exact.at(snapshot).mm;
        for (std::size_t pair = 0; pair < bounds.size(); ++pair) {
            const double clearance = clearances[pair];
            // Two certified clearances of one distance differ by their roundings.
            const double rounding = 1e-3;
            if (bounds[pair] == kNotNear) {
                ASSERT_GE(clearance, kPageWithinMm - rounding) << "sample " << i;
                continue;
            }
            ++near;
            ASSERT_LE(bounds[pair], clearance + rounding) << "sample " << i << ", pair " << pair;
            ASSERT_GE(bounds[pair],
                      std::min(kPageWithinMm, clearance) - tracking_error_mm(clearance) - rounding)
                << "sample " << i << ", pair " << pair;
        }
    }
    EXPECT_GT(near, kSamples / 4) << "hardly a pair was near: nothing was tested";
    EXPECT_LT(tracker.queries(), kSamples * loaded_.machine.pairs.size() / 2);
}

// What the bound is good for: without it a row's least clearance would be missed.
TEST_F(Tracked, WithoutTheMotionTheBoundWouldBeTooLarge) {
    ClearanceTracker tracker(loaded_, engine_->engine(), kPageWithinMm);
    PairClearances exact(loaded_, engine_->engine(), kPageWithinMm);
    Walk walk(loaded_.machine, printed_seed(20261123));
    std::vector<double> held(loaded_.machine.pairs.size());
    std::uint64_t too_large = 0;
    for (int i = 0; i < 2'000; ++i) {
        const AxisSnapshot& snapshot = walk.next();
        const std::span<const double> clearances = exact.at(snapshot).mm;
        for (std::size_t pair = 0; pair < held.size(); ++pair) {
            too_large += i % 16 != 0 && held[pair] > clearances[pair] + 1e-3 ? 1 : 0;
            held[pair] = i % 16 == 0 ? clearances[pair] : held[pair];
        }
    }
    EXPECT_GT(too_large, 100);
}

TEST_F(Tracked, TheNearestPairIsTheOneThatAllQueriesFind) {
    ClearanceTracker tracker(loaded_, engine_->engine(), kPageWithinMm);
    PairClearances exact(loaded_, engine_->engine(), kPageWithinMm);
    Walk walk(loaded_.machine, printed_seed(20261124));
    int near = 0;
    for (int i = 0; i < 2'000; ++i) {
        const AxisSnapshot& snapshot = walk.next();
        const std::span<const double> at = tracker.at(snapshot);
        const std::vector<double> bounds(at.begin(), at.end());
        const PageClearances found = tracker.nearest(snapshot, bounds), all = exact.at(snapshot);
        ASSERT_EQ(found.pair, all.pair) << "sample " << i;
        if (found.pair != kNoIndex) {
            ++near;
            ASSERT_EQ(found.mm[found.pair], all.mm[all.pair]);
        }
    }
    EXPECT_GT(near, 500);
}

}  // namespace
}  // namespace axg::test
