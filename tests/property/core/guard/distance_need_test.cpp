// SPDX-License-Identifier: Apache-2.0
// Random approaches whose proof fails: what a report says of them is what the prover says. The
// need lowered to what is available is proven, by its margin; each remedy is proven once more, and
// the next step of it is not; nothing proves a pair whose worst case is within its margin.
#include "core/guard/distance_need.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <optional>
#include <random>

#include "tests/support/containment_fixture.hpp"
#include "tests/support/count.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/table_and_head.hpp"

namespace axg::test {
namespace {

constexpr double kStep = 0.01;  // of a share that is searched

class DistanceNeedProperty : public testing::Test {
  protected:
    DistanceNeedProperty() : scene(table_and_head_scene()) {
        m.tools.resize(1);
        m.pairs = {m.pairs[1]};  // head and table
    }
    double in(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    }
    /// At (x, z) at these speeds, with that margin.
    UnprovenPair come() {
        m.pairs[0].margin_mm = in(0.5, 8);
        m.axes[2].stopping_min = in(800, 4000);
        const double x = in(-60, 60), z = in(-119, -105);
        const double x_mm_s = in(-160, 160), z_mm_s = in(-160, 40);
        certificate.emplace(certificate_over(scene, m));
        for (std::uint32_t k = 0; k < kSamplesKept; ++k) {
            const double before_s = 1e-3 * (kSamplesKept - 1 - k);
            AxisSnapshot snapshot;
            snapshot.sample = k + 1;
            snapshot.axis_count = 5;
            snapshot.tool = 1;
            snapshot.mode = kModeMoving;
            snapshot.position[0] = x - before_s * x_mm_s;
            snapshot.position[2] = z - before_s * z_mm_s;
            certificate->note(snapshot, k == 0);
        }
        certificate->prove(scene.engine().engine(), scene.containment_test());
        return unproven_pair(m, *certificate, 0);
    }

    std::mt19937_64 random{printed_seed(29'112'601)};
    Machine m = table_and_head_machine();
    ContainmentScene scene;
    std::optional<StopCertificate> certificate;
};

TEST_F(DistanceNeedProperty, WhatAReportSaysIsWhatTheProverSays) {
    const Engine engine = scene.engine().engine();
    std::uint32_t unproven = 0, lowered = 0, by_speed = 0, by_margin = 0, hopeless = 0;
    const std::uint64_t tries = count_from_environment(200);
    for (std::uint64_t k = 0; k < tries; ++k) {
        const UnprovenPair pair = come();
        if (!pair.is_known) {
            continue;
        }
        ++unproven;
        const double margin_mm = pair.task.margin_mm;
        const DistanceNeed need = distance_need(m, pair);
        const double has_mm = available_mm(m, engine, pair, 100);
        ASSERT_LT(has_mm, need.sum_mm()) << "enough was there";
        for (const double part : {need.until_braking_mm, need.braking_mm, need.position_error_mm,
                                  need.speed_uncertainty_mm}) {
            ASSERT_GE(part, 0);
        }
        const double enough_mm = margin_mm - (need.sum_mm() - has_mm) - 1e-3;
        if (enough_mm > 0) {
            ++lowered;
            ASSERT_TRUE(is_proven_with(m, engine, pair, {.margin_share = enough_mm / margin_mm}))
                << "needed " << need.sum_mm() << ", available " << has_mm;
        }
        const double worst_mm = least_clearance_mm(m, engine, pair, 100);
        const NeedRemedies remedies = find_remedies(m, engine, pair, {});
        if (worst_mm <= margin_mm) {
            ++hopeless;
            ASSERT_FALSE(remedies.is_alone || remedies.queries) << "the worst case is too near";
        }
        if (remedies.speed_share) {
            ++by_speed;
            const double share = *remedies.speed_share;
            ASSERT_TRUE(is_proven_with(m, engine, pair, {.speed_share = share}));
            ASSERT_FALSE(is_proven_with(m, engine, pair, {.speed_share = share + kStep}));
        }
        if (remedies.margin_mm) {
            ++by_margin;
            const double share = *remedies.margin_mm / margin_mm;
            ASSERT_LE(*remedies.margin_mm, worst_mm);
            ASSERT_TRUE(is_proven_with(m, engine, pair, {.margin_share = share}));
            ASSERT_FALSE(is_proven_with(m, engine, pair, {.margin_share = share + kStep}));
        }
    }
    std::printf("%llu approaches, %u unproven: %u lowered, %u by speed, %u by margin, %u within\n",
                static_cast<unsigned long long>(tries), unproven, lowered, by_speed, by_margin,
                hopeless);
    EXPECT_GT(unproven, tries / 4);
    EXPECT_GT(std::min({lowered, by_speed, by_margin, hopeless}), tries / 40);
}

}  // namespace
}  // namespace axg::test
