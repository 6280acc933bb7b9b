// SPDX-License-Identifier: Apache-2.0
// Ways out of random places near a contact, three types of machine, against CGAL on the true
// positions: no way out touches anything or comes nearer than it says, all end clearer than they
// began; and most of the ways that plainly lead out are found. AXG_COUNT: places; AXG_SEED: which.
#include <gtest/gtest.h>

#include "core/guard/escape.hpp"

#ifdef AXG_CGAL
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

#include "core/reach/jog.hpp"
#include "tests/oracle/contact_scene.hpp"
#include "tests/support/count.hpp"
#include "tests/support/seed.hpp"

namespace axg::test {
namespace {

constexpr std::uint64_t kUsualPlaces = 60;
constexpr int kSteps = 10;  // of a way, that the judge looks at

/// What a way comes to, judged at kSteps places of it.
struct Way {
    double least_mm = HUGE_VAL, end_mm = 0;
};

Way judge_way(ContactScene& scene, const Positions& from, const EscapeJog& jog,
              const Positions& off) {
    const bool is_rotary = scene.machine().axes[jog.axis].kind == AxisKind::rotary;
    const double step = (jog.is_negative ? -1 : 1) * (is_rotary ? kEscapeStepRad : kEscapeStepMm);
    Way way;
    for (int k = 0; k <= kSteps; ++k) {
        Positions at = from;
        at[jog.axis] += step * k / kSteps;
        way.end_mm = judged_mm(scene, at);
        for (std::size_t i = 0; i < at.size(); ++i) {
            at[i] += off[i];
        }
        way.least_mm = std::min(way.least_mm, judged_mm(scene, at));
    }
    return way;
}

struct EscapeTally {
    std::uint64_t places = 0, ways = 0, plain = 0, found = 0, without = 0;
};

void try_place(Random& random, ContactScene& scene, EscapeTally& tally) {
    const Positions at = place_near(random, scene, between(random, 0.03, 3));
    const double clear_mm = judged_mm(scene, at);
    // Some places are nearer than the margin, as after a stop that came too late for it.
    const double margin_mm = between(random, 0.2, 3);
    const double within_mm = std::min(clear_mm, margin_mm);
    set_margins(scene.machine(), margin_mm);
    Positions off{};
    double most_off_mm = 0;
    for (std::size_t i = 0; i < scene.machine().axes.size(); ++i) {
        Axis& axis = scene.machine().axes[i];
        axis.position_error = axis.kind == AxisKind::rotary ? 2e-6 : 5e-4;
        off[i] = (random() % 2 == 0 ? 1 : -1) * axis.position_error;
        most_off_mm +=
            axis.position_error * (axis.kind == AxisKind::rotary ? scene.judge.reach_mm() : 1);
    }
    std::optional<StopCertificate> certificate = make_stop_certificate(scene.loaded);
    std::optional<EscapeFinder> finder = EscapeFinder::create(scene.machine());
    AxisSnapshot snapshot;
    snapshot.axis_count = static_cast<std::uint32_t>(scene.machine().axes.size());
    snapshot.position = at;
    certificate->note(snapshot, true);
    certificate->prove(scene.engine->engine(), *scene.containment_test);
    const Escapes escapes =
        finder->find(scene.engine->engine(), *scene.containment_test, *certificate);
    ++tally.places;
    tally.without += escapes.count == 0 ? 1 : 0;
    EXPECT_LE(escapes.clearance_mm, clear_mm + 1e-6);
    for (const EscapeJog& jog : escapes.list()) {
        const Way way = judge_way(scene, at, jog, off);
        ++tally.ways;
        EXPECT_GT(way.end_mm, std::min(clear_mm, kJudgedMm - 1)) << "no way out";
        EXPECT_GE(way.end_mm, std::min(jog.clearance_mm, kJudgedMm) - 1e-6);
        EXPECT_GT(way.least_mm, 0) << "touches";
        EXPECT_GE(way.least_mm, within_mm - kJogGiveMm - 4 * most_off_mm - 1e-3);
    }
    // What is found, of the ways that lead out without a doubt.
    for (std::uint32_t axis = 0; axis < snapshot.axis_count && escapes.is_clear; ++axis) {
        for (const bool is_negative : {false, true}) {
            const Way way = judge_way(scene, at, {axis, is_negative, 0}, {});
            const Axis& a = scene.machine().axes[axis];
            const bool ends = !a.unlimited && (at[axis] > a.max - 2 || at[axis] < a.min + 2);
            if (!ends && way.end_mm > clear_mm + 0.2 && way.least_mm > clear_mm - 1e-6) {
                ++tally.plain;
                tally.found +=
                    std::any_of(escapes.list().begin(), escapes.list().end(),
                                [&](const EscapeJog& jog) {
                                    return jog.axis == axis && jog.is_negative == is_negative;
                                })
                        ? 1
                        : 0;
            }
        }
    }
}

TEST(Escape, EveryWayOutIsOneAndMostAreFound) {
    Random random(printed_seed(20261127));
    const std::uint64_t count = count_from_environment(kUsualPlaces);
    for (const std::string& name : kMachines) {
        const auto scene = make_contact_scene(random, name, kJudgedMm);
        ASSERT_TRUE(scene && scene->containment_test && !scene->touching.empty() &&
                    !scene->clear.empty());
        EscapeTally tally;
        for (std::uint64_t n = 0; n < count / kMachines.size(); ++n) {
            try_place(random, *scene, tally);
        }
        std::printf(
            "%-22s %llu places, %llu ways out; of %llu plain ones %llu found; %llu places "
            "without any\n",
            name.c_str(), static_cast<unsigned long long>(tally.places),
            static_cast<unsigned long long>(tally.ways),
            static_cast<unsigned long long>(tally.plain),
            static_cast<unsigned long long>(tally.found),
            static_cast<unsigned long long>(tally.without));
        if (count >= kUsualPlaces) {
            EXPECT_GT(tally.ways, tally.places) << "too weak to tell anything";
            EXPECT_GT(10 * tally.found, 8 * tally.plain);
        }
    }
}

}  // namespace
}  // namespace axg::test
#else
TEST(Escape, NeedsCgal) {
    GTEST_SKIP() << "built without CGAL (Debian: libcgal-dev), by clang or with sanitizers";
}
#endif
