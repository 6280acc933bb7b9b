// SPDX-License-Identifier: Apache-2.0
// Jogs in closed loop from random places near a contact, three types of machine: along ways out,
// the other way, and in any direction at all. The board obeys its permit, brakes as late and as
// weakly as it may, frames are lost and guards are killed. CGAL judges the true axes until they
// rest: no jog touches, and none comes nearer than what its certificates keep. AXG_COUNT: jogs;
// AXG_SEED: which.
#include <gtest/gtest.h>

#ifdef AXG_CGAL
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

#include "core/guard/escape.hpp"
#include "firmware_if/explain/format_escapes.hpp"
#include "hil_replay/board/jog_driver.hpp"
#include "hil_replay/drive/drive_run.hpp"
#include "tests/oracle/contact_scene.hpp"
#include "tests/support/count.hpp"
#include "tests/support/seed.hpp"

namespace axg::test {
namespace {

constexpr std::uint64_t kUsualJogs = 180;

enum class Board { each_axis, each_axis_with_look_ahead, along_path };

void draw_rules(Random& random, Machine& machine, Board board) {
    machine.guard.board_reaction_s = between(random, 0.2e-3, 3e-3);
    machine.guard.free_jerk_limited = random() % 2 == 0;
    const auto samples = static_cast<std::uint8_t>(3 + random() % 3);
    machine.can.permit_samples = {samples, samples};
    machine.can.stale_after_us = 1000U * machine.can.permit_samples.most;
    JogRules& jog = machine.guard.jog;
    jog.is_promised = true;
    jog.speed_mm_s = between(random, 2, 20);
    jog.acceleration_mm_s2 = between(random, 20, 500);
    jog.speed_rad_s = 0.005 * jog.speed_mm_s;  // as at a radius of 200 mm
    jog.acceleration_rad_s2 = 0.005 * jog.acceleration_mm_s2;
    for (Axis& axis : machine.axes) {
        const bool is_rotary = axis.kind == AxisKind::rotary;
        axis.position_error = is_rotary ? 2e-6 : 5e-4;
        // The board is as far off its commands as it may be, and in a stop the other way.
        axis.following_error = board == Board::each_axis || random() % 2 == 0
                                   ? 0
                                   : between(random, 0, is_rotary ? 1e-5 : 2e-3);
    }
    if (board != Board::each_axis) {
        machine.can.format = CanFormat::fd;
        machine.can.look_ahead_samples = static_cast<std::uint32_t>(between(random, 8, 100));
    }
    machine.guard.promise =
        board == Board::along_path ? StopPromise::path_keeping : StopPromise::independent;
}

struct JogTally {
    std::uint64_t jogs = 0, moved = 0, stopped = 0, ways = 0, ways_ended = 0, would_touch = 0;
    double least_over_floor_mm = HUGE_VAL;
};

/// What the jog would do without a guard.
bool would_touch(ContactScene& scene, Positions at, const JogMove& move, double distance) {
    constexpr int kLooks = 8;
    for (int k = 0; k < kLooks; ++k) {
        at[move.axis] += (move.is_negative ? -1 : 1) * distance / kLooks;
        if (judged_mm(scene, at) == 0) {
            return true;
        }
    }
    return false;
}

struct Place {
    Positions at;
    double clear_mm, margin_mm, off_mm;
};

Place draw_place(Random& random, ContactScene& scene) {
    Place place;
    place.at = place_near(random, scene, between(random, 0.05, 1.2));
    place.clear_mm = judged_mm(scene, place.at);
    place.margin_mm = between(random, 0.2, 3);
    place.off_mm = 0;
    for (const Axis& axis : scene.machine().axes) {
        const double lever = axis.kind == AxisKind::rotary ? scene.judge.reach_mm() : 1;
        place.off_mm += (axis.position_error + 2 * axis.following_error) * lever;
    }
    return place;
}

/// Of a ladder without a floor in force.
double widest_rung_mm(double margin_mm) {
    const auto rungs = jog_ladder(margin_mm, kNoJogFloor);
    double widest = rungs.back();
    for (std::size_t i = 1; i < rungs.size(); ++i) {
        widest = std::max(widest, rungs[i - 1] - rungs[i]);
    }
    return widest;
}

/// Drives, and judges the true axes on the way and where they rest. The least clearance, mm.
double drive_jog(Random& random, ContactScene& scene, const Place& place, const JogMove& move,
                 double distance, JogTally& tally, bool& has_ended) {
    Machine& machine = scene.machine();
    set_margins(machine, place.margin_mm);
    std::optional<StopCertificate> certificate = make_stop_certificate(scene.loaded);
    GuardChain chain(machine, scene.engine->engine(), *scene.containment_test, {&*certificate});
    DriveOptions options;
    options.board = promised_board(machine, random());
    options.board.jog = move;
    options.faults.lost = random() % 3 == 0 ? between(random, 0, 0.05) : 0;
    const bool is_killed = random() % 4 == 0;
    options.faults.killed_from_us =
        is_killed ? kBoardStartUs + static_cast<std::int64_t>(between(random, 20e3, 400e3))
                  : kNever;
    double least_mm = place.clear_mm;
    DriveObservers observers;
    observers.watch_us = 8000;
    observers.watch = [&](std::int64_t, std::span<const AxisMotion> axes) {
        Positions now{};
        for (std::size_t i = 0; i < axes.size(); ++i) {
            now[i] = axes[i].position;
        }
        least_mm = std::min(least_mm, judged_mm(scene, now));
        set_margins(machine, place.margin_mm);
    };
    const DriveResult result =
        drive(machine, chain, scene.of(place.at),
              make_jog(machine, {.move = move, .distance = distance}), options, observers);
    tally.moved += result.moving_since_us != INT64_MIN ? 1 : 0;
    tally.stopped += result.state == BoardState::stopped ? 1 : 0;
    has_ended = result.state == BoardState::finished;
    return least_mm;
}

void jog_once(Random& random, ContactScene& scene, Board board, JogTally& tally) {
    const Machine as_loaded = scene.machine();
    draw_rules(random, scene.machine(), board);
    const Place place = draw_place(random, scene);
    set_margins(scene.machine(), place.margin_mm);
    AxisSnapshot snapshot;
    snapshot.axis_count = static_cast<std::uint32_t>(as_loaded.axes.size());
    snapshot.position = place.at;
    const Escapes ways =
        find_escapes(scene.loaded, scene.engine->engine(), *scene.containment_test, snapshot);
    // Half of them lead out, a quarter go the other way, the rest anywhere.
    const std::uint64_t kind = ways.count == 0 ? 3 : random() % 4;
    const bool is_way = kind < 2;
    JogMove move{static_cast<std::uint32_t>(random() % as_loaded.axes.size()), random() % 2 == 0};
    if (kind < 3) {
        const EscapeJog& way = ways.jogs[random() % ways.count];
        move = {way.axis, way.is_negative == is_way};
    }
    const bool is_rotary = as_loaded.axes[move.axis].kind == AxisKind::rotary;
    const double step = is_rotary ? kEscapeStepRad : kEscapeStepMm;
    const double distance = is_way ? step : between(random, 0.5, 3) * step;
    const bool is_doomed = would_touch(scene, place.at, move, distance);
    bool has_ended = false;
    const double least_mm = drive_jog(random, scene, place, move, distance, tally, has_ended);
    ++tally.jogs;
    tally.would_touch += is_doomed ? 1 : 0;
    tally.ways += is_way ? 1 : 0;
    tally.ways_ended += is_way && has_ended ? 1 : 0;
    EXPECT_GT(least_mm, 0) << "touches";
    EXPECT_FALSE(is_doomed && has_ended);
    // jog_floor_mm at the place where the board was when the jog began: off by what it may be, and
    // a rung below at most.
    const double floor_mm =
        std::min(place.margin_mm, place.clear_mm - kJogGiveMm - 5 * place.off_mm - 1e-3) -
        widest_rung_mm(place.margin_mm);
    EXPECT_GE(least_mm, floor_mm - 1e-6);
    tally.least_over_floor_mm = std::min(tally.least_over_floor_mm, least_mm - floor_mm);
    scene.machine() = as_loaded;
}

void run_all(Board board, std::uint64_t seed) {
    Random random(printed_seed(seed));
    const std::uint64_t count = count_from_environment(kUsualJogs);
    JogTally tally;
    for (const std::string& name : kMachines) {
        const auto scene = make_contact_scene(random, name, kJudgedMm);
        ASSERT_TRUE(scene && scene->containment_test && !scene->touching.empty() &&
                    !scene->clear.empty());
        for (std::uint64_t n = 0; n < count / (3 * kMachines.size()); ++n) {
            jog_once(random, *scene, board, tally);
        }
    }
    std::printf(
        "%llu jogs, %llu moved, %llu stopped; %llu of %llu ways out driven to their end; "
        "%llu would touch without a guard; nearest to what is kept: %.4f mm\n",
        static_cast<unsigned long long>(tally.jogs), static_cast<unsigned long long>(tally.moved),
        static_cast<unsigned long long>(tally.stopped),
        static_cast<unsigned long long>(tally.ways_ended),
        static_cast<unsigned long long>(tally.ways),
        static_cast<unsigned long long>(tally.would_touch), tally.least_over_floor_mm);
    if (count >= kUsualJogs) {
        constexpr const char* kWeak = "too weak to tell anything";
        EXPECT_GT(3 * tally.moved, tally.jogs) << kWeak;
        EXPECT_GT(tally.would_touch, 0U) << kWeak;
        EXPECT_GT(3 * tally.ways_ended, tally.ways) << "guards are killed in one of four";
    }
}

TEST(Jog, NoneTouchesOrComesNearerThanItsCertificatesKeep) {
    run_all(Board::each_axis, 20261128);
}

TEST(Jog, NoneDoesWithALookAheadPath) {
    run_all(Board::each_axis_with_look_ahead, 20261129);
}

TEST(Jog, NoneDoesWhereStopsKeepThePath) {
    run_all(Board::along_path, 20261130);
}

}  // namespace
}  // namespace axg::test
#else
TEST(Jog, NeedsCgal) {
    GTEST_SKIP() << "built without CGAL (Debian: libcgal-dev), by clang or with sanitizers";
}
#endif
