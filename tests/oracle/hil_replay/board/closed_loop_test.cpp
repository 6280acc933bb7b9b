// SPDX-License-Identifier: Apache-2.0
// Random approaches to contact in closed loop, three types of machine: the simulated board drives
// for a pose in which the machine touches itself, as hard as the limits allow, while frames are
// lost and guards are killed; the guard has to stop it. CGAL judges the true axes until they rest.
// With one part of the guard left out the same approaches must end in contact, or this test tells
// nothing. AXG_COUNT: approaches of the whole guard; AXG_SEED: which.
#include <gtest/gtest.h>

#ifdef AXG_CGAL
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "core/base/sincos.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "hil_replay/board/approach_driver.hpp"
#include "hil_replay/drive/drive_run.hpp"
#include "hil_replay/lab/ablations/ablations.hpp"
#include "tests/oracle/contact_scene.hpp"
#include "tests/support/count.hpp"
#include "tests/support/look_ahead_machine.hpp"
#include "tests/support/seed.hpp"

namespace axg::test {
namespace {

constexpr std::uint64_t kUsual = 48;
constexpr double kMarginMm = 0.5;
constexpr double kWatchedMm = 8;  // how far the judge looks in motion
constexpr std::int64_t kWatchUs = 250, kLongestUs = 1'500'000;

/// Linear axes to 60 m/min and 1 to 10 m/s2, rotary ones to 100 rpm; jerk 20 to 200 m/s3.
void draw_limits(Random& random, Machine& machine) {
    for (Axis& axis : machine.axes) {
        const bool is_rotary = axis.kind == AxisKind::rotary;
        const double unit = is_rotary ? 0.005 : 1;  // as at a radius of 200 mm
        axis.speed_max = is_rotary ? between(random, 1, 10.47) : between(random, 50, 1000);
        axis.acceleration_max = between(random, 1000, 10000) * unit;
        axis.jerk_max = between(random, 20'000, 200'000) * unit;
        axis.stopping_min = axis.acceleration_max * between(random, 0.5, 1);
    }
    machine.guard.board_reaction_s = between(random, 0.2e-3, 3e-3);
    machine.guard.free_jerk_limited = random() % 2 == 0;
    const auto samples = static_cast<std::uint8_t>(3 + random() % 3);
    machine.can.permit_samples = {samples, samples};
    machine.can.stale_after_us = 1000U * machine.can.permit_samples.most;
}

enum class Guard { whole, contact_only, no_jerk, no_dead_man };
enum class Board {
    each_axis,
    each_axis_with_look_ahead,
    along_path,
    each_axis_with_cap,   // the same for all axes
    each_axis_with_caps,  // or one of its own for each
};

bool keeps_cap(Board board) {
    return board == Board::each_axis_with_cap || board == Board::each_axis_with_caps;
}

struct Tally {
    std::uint64_t approaches = 0, moved = 0, stopped = 0, contacts = 0, too_near = 0;
    std::uint64_t left_limits = 0;               // stops for a broken limit
    std::uint64_t left_cap = 0;                  // and for a cap that was not kept
    std::uint64_t slowed = 0, cap_breaches = 0;  // approaches with a lower cap; ticks beyond it
    double least_mm = HUGE_VAL;                  // clearance seen, up to kWatchedMm
};

/// Judges the true axes wherever they may be too near: in between no point can have moved that far.
class Watcher {
  public:
    explicit Watcher(ContactScene& scene) : scene_(scene) {}

    void look(std::span<const AxisMotion> axes) {
        double moved_mm = 0;
        for (std::size_t i = 0; i < axes.size(); ++i) {
            const bool is_rotary = scene_.machine().axes[i].kind == AxisKind::rotary;
            moved_mm +=
                std::abs(axes[i].position - at_[i]) * (is_rotary ? scene_.judge.reach_mm() : 1);
        }
        if (has_looked_ && moved_mm < last_.clear_mm - kMarginMm) {
            return;
        }
        for (std::size_t i = 0; i < axes.size(); ++i) {
            at_[i] = axes[i].position;
        }
        has_looked_ = true;
        last_ = scene_.judge.judge(scene_.of(at_), kWatchedMm);
        touches_ = touches_ || last_.touches;
        too_near_ = too_near_ || last_.too_near;
        least_mm_ = std::min(least_mm_, last_.clear_mm);
    }
    [[nodiscard]] bool touches() const { return touches_; }
    [[nodiscard]] bool too_near() const { return too_near_; }
    [[nodiscard]] double least_mm() const { return least_mm_; }

  private:
    ContactScene& scene_;
    Judgement last_;
    Positions at_{};
    bool has_looked_ = false, touches_ = false, too_near_ = false;
    double least_mm_ = HUGE_VAL;
};

struct Drawn {
    Approach approach;
    Positions start;
    DriveOptions options;
    std::unique_ptr<double> share = std::make_unique<double>(1);  // of a board that keeps caps
    std::unique_ptr<AxisShares> axis_shares;
    std::int64_t moves_us = 0;  // when the first command comes out of the board's buffer
};

/// Limits, a way to a contact and a board; the limits go into the scene's machine.
Drawn draw_approach(Random& random, ContactScene& scene, Guard guard, Board board) {
    Machine& machine = scene.machine();
    draw_limits(random, machine);
    if (keeps_cap(board)) {
        machine.guard.cap =
            board == Board::each_axis_with_cap ? CapPromise::all_axes : CapPromise::per_axis;
        machine.can.permit_samples = {3, static_cast<std::uint8_t>(8 + random() % 5)};
        machine.can.stale_after_us = 1000U * machine.can.permit_samples.most;
    } else if (board != Board::each_axis) {
        give_look_ahead(random, {.linear_mm = 0.05, .rotary_rad = 2e-4}, machine);
    }
    if (board == Board::along_path) {
        machine.guard.promise = StopPromise::path_keeping;
    }
    Drawn out;
    const Positions& target = scene.touching[random() % scene.touching.size()];
    const Positions& clear = scene.clear[random() % scene.clear.size()];
    out.start = begin_near(scene, target, clear, between(random, 2, 40));
    out.approach.target = target;
    for (double& share : out.approach.speed_share) {
        share = random() % 2 == 0 ? 1 : between(random, 0.1, 1);
    }
    out.options.board = promised_board(machine, random());
    if (board == Board::each_axis_with_cap) {
        out.options.board.speed_share = out.share.get();
    } else if (board == Board::each_axis_with_caps) {
        out.axis_shares = std::make_unique<AxisShares>();
        out.options.board.axis_shares = out.axis_shares.get();
    }
    if (guard == Guard::no_dead_man) {
        lab::forget_dead_man(out.options.board);
    }
    // The first commands come out of the buffer as long after the first permit as it is long; and
    // where the path has to be known for a permit, that takes as long again.
    const std::int64_t buffer_us = 1000 * std::int64_t{machine.can.look_ahead_samples};
    out.moves_us = (board == Board::along_path ? 2 : 1) * buffer_us;
    out.options.time_us_max = kLongestUs + out.moves_us;
    return out;
}

DriveResult drive_watched(ContactScene& scene, Guard guard, const Drawn& drawn, Watcher& watcher) {
    LoadedMachine of_guard = scene.loaded;
    if (guard == Guard::no_jerk) {
        lab::forget_jerk_ramp(of_guard.machine);
    }
    std::optional<StopCertificate> certificate =
        guard == Guard::contact_only ? std::nullopt : make_stop_certificate(of_guard);
    const bool has_cap = certificate && scene.machine().guard.cap != CapPromise::none;
    std::optional<SpeedAdvisory> advisory =
        has_cap ? SpeedAdvisory::create(of_guard.machine) : std::nullopt;
    GuardChain chain(scene.machine(), scene.engine->engine(), *scene.containment_test,
                     {certificate ? &*certificate : nullptr, advisory ? &*advisory : nullptr});
    DriveObservers observers;
    observers.watch_us = kWatchUs;
    observers.watch = [&](std::int64_t, std::span<const AxisMotion> axes) { watcher.look(axes); };
    observers.each = [&](const MotionBoard&, const DriveGuard&) { return !watcher.touches(); };
    return drive(
        scene.machine(), chain, scene.of(drawn.start),
        make_approach(scene.machine(), drawn.approach, drawn.share.get(), drawn.axis_shares.get()),
        drawn.options, observers);
}

void approach_once(Random& random, ContactScene& scene, Guard guard, Board board, Tally& tally,
                   CapFault cap_fault = CapFault::none) {
    const Machine as_loaded = scene.machine();
    Drawn drawn = draw_approach(random, scene, guard, board);
    BusFaults& faults = drawn.options.faults;
    faults.lost = random() % 3 == 0 ? between(random, 0, 0.05) : 0;
    if (keeps_cap(board)) {
        faults.permit_lost = random() % 2 == 0 ? between(random, 0, 0.2) : 0;
        faults.late = random() % 3 == 0 ? between(random, 0, 0.1) : 0;
        drawn.options.board.cap_fault = cap_fault;
    }
    // Killed before it can say stop: then the board's own timer is all there is.
    const bool is_killed = guard == Guard::no_dead_man || random() % 4 == 0;
    const auto killed_us = static_cast<std::int64_t>(between(random, 15e3, 120e3));
    faults.killed_from_us = is_killed ? kBoardStartUs + drawn.moves_us + killed_us : kNever;
    Watcher watcher(scene);
    const DriveResult result = drive_watched(scene, guard, drawn, watcher);
    ++tally.approaches;
    tally.moved += result.moving_since_us != INT64_MIN ? 1 : 0;
    tally.stopped += result.state == BoardState::stopped ? 1 : 0;
    tally.contacts += watcher.touches() ? 1 : 0;
    tally.left_limits += result.guard_stop.reason == StopReason::left_limits ? 1 : 0;
    tally.left_cap += result.guard_stop.reason == StopReason::left_cap ? 1 : 0;
    tally.slowed += result.speed_cap < kCapRapid ? 1 : 0;
    tally.cap_breaches += result.cap_breaches;
    tally.too_near += watcher.too_near() ? 1 : 0;
    tally.least_mm = std::min(tally.least_mm, watcher.least_mm());
    scene.machine() = as_loaded;
}

Tally run(std::vector<std::unique_ptr<ContactScene>>& scenes, Random& random, Guard guard,
          Board board, std::uint64_t count, CapFault cap_fault = CapFault::none) {
    Tally tally;
    for (std::uint64_t n = 0; n < count; ++n) {
        approach_once(random, *scenes[n % scenes.size()], guard, board, tally, cap_fault);
    }
    return tally;
}

void print(const char* name, const Tally& t) {
    std::printf(
        "%-14s %6llu approaches, %6llu moved, %6llu stopped, %5llu contacts, %5llu nearer "
        "than the margin, least %.4f mm\n",
        name, static_cast<unsigned long long>(t.approaches),
        static_cast<unsigned long long>(t.moved), static_cast<unsigned long long>(t.stopped),
        static_cast<unsigned long long>(t.contacts), static_cast<unsigned long long>(t.too_near),
        t.least_mm);
}

/// The whole guard, and the same without one of its parts.
void run_all(Board board, std::uint64_t seed) {
    Random random(printed_seed(seed));
    const std::uint64_t count = count_from_environment(kUsual);
    std::vector<std::unique_ptr<ContactScene>> scenes;
    for (const std::string& name : kMachines) {
        scenes.push_back(make_contact_scene(random, name, kMarginMm));
        ASSERT_TRUE(scenes.back() && scenes.back()->containment_test);
        ASSERT_FALSE(scenes.back()->touching.empty() || scenes.back()->clear.empty()) << name;
    }
    const Tally whole = run(scenes, random, Guard::whole, board, count);
    print("whole guard", whole);
    EXPECT_EQ(whole.contacts, 0U);
    EXPECT_EQ(whole.too_near, 0U);
    EXPECT_EQ(whole.left_limits, 0U) << "every board kept its limits";
    const std::uint64_t few = std::min<std::uint64_t>(count, 1500) / 3;
    const Tally contact = run(scenes, random, Guard::contact_only, board, few);
    print("contact only", contact);
    const Tally no_jerk = run(scenes, random, Guard::no_jerk, board, few);
    print("no jerk", no_jerk);
    const Tally no_dead_man = run(scenes, random, Guard::no_dead_man, board, few);
    print("no dead man", no_dead_man);
    if (count >= kUsual) {
        constexpr const char* kWeak = "too weak to tell anything";
        EXPECT_GT(3 * whole.moved, count) << kWeak;
        EXPECT_GT(contact.contacts, 0U) << kWeak;
        EXPECT_GT(no_jerk.too_near, 0U) << kWeak;
        EXPECT_GT(no_dead_man.contacts, 0U) << kWeak;
    }
}

TEST(ClosedLoop, EveryApproachEndsClearAndWithoutAPartOfTheGuardNot) {
    run_all(Board::each_axis, 20261121);
}

TEST(ClosedLoop, EveryStopAlongThePathEndsClearAndWithoutAPartOfTheGuardNot) {
    run_all(Board::along_path, 20261124);
}

TEST(ClosedLoop, EveryStopFromALookAheadPathEndsClearAndWithoutAPartOfTheGuardNot) {
    run_all(Board::each_axis_with_look_ahead, 20261126);
}

// With caps, permits lost at up to 20 % and late: what a board acknowledges and keeps is believed,
// and one that does not keep it is seen.
void run_capped(Board board, std::uint64_t seed) {
    Random random(printed_seed(seed));
    const std::uint64_t count = count_from_environment(kUsual / 2);
    std::vector<std::unique_ptr<ContactScene>> scenes;
    for (const std::string& name : kMachines) {
        scenes.push_back(make_contact_scene(random, name, kMarginMm));
        ASSERT_TRUE(scenes.back() && scenes.back()->containment_test);
    }
    const auto run_with = [&](const char* name, Guard guard, std::uint64_t approaches,
                              CapFault fault) {
        const Tally tally = run(scenes, random, guard, board, approaches, fault);
        print(name, tally);
        std::printf("    %llu slowed, %llu seen to break their cap\n",
                    static_cast<unsigned long long>(tally.slowed),
                    static_cast<unsigned long long>(tally.left_cap));
        return tally;
    };
    const Tally whole = run_with("whole guard", Guard::whole, count, CapFault::none);
    EXPECT_EQ(whole.contacts, 0U);
    EXPECT_EQ(whole.too_near, 0U);
    EXPECT_EQ(whole.left_limits, 0U);
    EXPECT_EQ(whole.left_cap, 0U) << "every board kept its cap";
    EXPECT_EQ(whole.cap_breaches, 0U);
    const std::uint64_t few = std::max<std::uint64_t>(count / 8, 12);
    std::uint64_t seen = 0;
    for (const auto& [name, fault] :
         {std::pair{"late", CapFault::late}, std::pair{"half", CapFault::half},
          std::pair{"ignores", CapFault::ignores}}) {
        seen += run_with(name, Guard::whole, few, fault).left_cap;
    }
    const Tally contact = run_with("contact only", Guard::contact_only, few, CapFault::none);
    const Tally no_dead_man = run_with("no dead man", Guard::no_dead_man, few, CapFault::none);
    if (count >= kUsual / 2) {
        EXPECT_GT(whole.slowed, 0U);
        EXPECT_GT(seen, 0U);
        EXPECT_GT(contact.contacts + no_dead_man.contacts, 0U);
    }
}

TEST(ClosedLoop, EveryApproachUnderACapEndsClearAndABoardThatLiesIsSeen) {
    run_capped(Board::each_axis_with_cap, 20261127);
}

TEST(ClosedLoop, EveryApproachUnderCapsOfSingleAxesEndsClearAndABoardThatLiesIsSeen) {
    run_capped(Board::each_axis_with_caps, 20261128);
}

enum class Fault { silence, late, killed, stuck };
constexpr std::array<const char*, 4> kFaultNames{"silence", "late by one cycle, then dead",
                                                 "killed process", "stuck engine"};

BusFaults faults_of(Fault fault, std::int64_t at_us) {
    BusFaults out;
    out.silent_from_us = fault == Fault::silence ? at_us : kNever;
    out.late_from_us = fault == Fault::late ? at_us : kNever;
    out.killed_from_us = fault == Fault::killed ? at_us
                         : fault == Fault::late ? at_us + 20'000
                                                : kNever;
    out.stuck_from_us = fault == Fault::stuck ? at_us : kNever;
    return out;
}

struct FaultTally {
    std::uint64_t approaches = 0, stopped = 0, in_time = 0, contacts = 0, too_near = 0;
    std::int64_t latest_us = INT64_MIN;  // from the bound to the beginning of the brakes
};

/// One approach; it counts where the fault comes in motion.
void fail_once(Random& random, ContactScene& scene, Fault fault, Board board, FaultTally& tally) {
    const Machine as_loaded = scene.machine();
    Drawn drawn = draw_approach(random, scene, Guard::whole, board);
    const std::int64_t fault_us =
        kBoardStartUs + drawn.moves_us + static_cast<std::int64_t>(between(random, 15e3, 120e3));
    drawn.options.faults = faults_of(fault, fault_us);
    Watcher watcher(scene);
    const DriveResult result = drive_watched(scene, Guard::whole, drawn, watcher);
    const CanLayout& can = scene.machine().can;
    const BoardStopRecord& stop = result.board_stop;
    const std::int64_t late_us =
        stop.brake_us - (stop.certified_us + std::int64_t{can.permit_samples.most} * can.sample_us +
                         drawn.options.board.reaction_us_max);
    const bool is_meant = result.moving_since_us != INT64_MIN &&
                          result.moving_since_us < fault_us && result.ended_us > fault_us &&
                          (result.state != BoardState::stopped || stop.brake_us > fault_us);
    if (is_meant) {
        const bool is_stopped = result.state == BoardState::stopped;
        ++tally.approaches;
        tally.stopped += is_stopped ? 1 : 0;
        tally.in_time += is_stopped && late_us <= 0 ? 1 : 0;
        tally.contacts += watcher.touches() ? 1 : 0;
        tally.too_near += watcher.too_near() ? 1 : 0;
        tally.latest_us = std::max(tally.latest_us, late_us);
    }
    scene.machine() = as_loaded;
}

// AXG_COUNT approaches of each fault, three types of machine, three kinds of board in turn.
TEST(ClosedLoop, WhateverEndsTheGuardTheBoardBrakesInTimeAndStopsClear) {
    constexpr std::uint64_t kUsualOfEach = 6, kTriesMax = 20;
    Random random(printed_seed(20261140));
    const std::uint64_t count = count_from_environment(kUsualOfEach);
    std::vector<std::unique_ptr<ContactScene>> scenes;
    for (const std::string& name : kMachines) {
        scenes.push_back(make_contact_scene(random, name, kMarginMm));
        ASSERT_TRUE(scenes.back() && scenes.back()->containment_test);
    }
    std::printf("%-30s %10s %8s %8s %10s %8s %8s\n", "fault", "approaches", "stopped", "in time",
                "latest, us", "contacts", "< margin");
    for (std::size_t i = 0; i < kFaultNames.size(); ++i) {
        FaultTally tally;
        std::uint64_t tries = 0;
        for (; tally.approaches < count && tries < kTriesMax * count; ++tries) {
            fail_once(random, *scenes[tries % scenes.size()], static_cast<Fault>(i),
                      static_cast<Board>(tries / scenes.size() % 3), tally);
        }
        std::printf("%-30s %10llu %8llu %8llu %10lld %8llu %8llu\n", kFaultNames[i],
                    static_cast<unsigned long long>(tally.approaches),
                    static_cast<unsigned long long>(tally.stopped),
                    static_cast<unsigned long long>(tally.in_time),
                    static_cast<long long>(tally.latest_us),
                    static_cast<unsigned long long>(tally.contacts),
                    static_cast<unsigned long long>(tally.too_near));
        EXPECT_EQ(tally.approaches, count) << "too few approaches are still on their way";
        EXPECT_EQ(tally.stopped, count);
        EXPECT_EQ(tally.in_time, count);
        EXPECT_EQ(tally.contacts, 0U);
        EXPECT_EQ(tally.too_near, 0U);
    }
}

// The judge itself: what is known of the paper's machine at two poses, and of a bound it leans on.
TEST(CgalJudge, KnowsAContactFromAGap) {
    Random random(printed_seed(20261122));
    const auto scene = make_contact_scene(random, kMachines[0], kMarginMm);
    ASSERT_TRUE(scene && !scene->touching.empty() && !scene->clear.empty());
    for (const Positions& pose : scene->touching) {
        const Judgement judged = scene->judge.judge(scene->of(pose), kFarMm);
        EXPECT_TRUE(judged.touches && judged.too_near && judged.clear_mm == 0);
    }
    // From a pose with a known gap, nothing is too near before the axes have moved that far.
    for (int i = 0; i < 60; ++i) {
        const Positions& touching = scene->touching[random() % scene->touching.size()];
        const Positions& clear = scene->clear[random() % scene->clear.size()];
        const Positions from = begin_near(*scene, touching, clear, between(random, 2, 10));
        const double gap_mm = scene->judge.judge(scene->of(from), kFarMm).clear_mm;
        Positions to = from;
        double moved_mm = 0;
        for (int k = 1; k <= 100 && moved_mm < 3 * gap_mm; ++k) {
            moved_mm = 0;
            for (std::size_t j = 0; j < scene->machine().axes.size(); ++j) {
                const bool is_rotary = scene->machine().axes[j].kind == AxisKind::rotary;
                to[j] = from[j] + (touching[j] - from[j]) * k / 1000;
                moved_mm += std::abs(to[j] - from[j]) * (is_rotary ? scene->judge.reach_mm() : 1);
            }
            if (scene->judge.judge(scene->of(to), kFarMm).too_near) {
                EXPECT_GE(moved_mm, gap_mm - kMarginMm);
                break;
            }
        }
    }
}

}  // namespace
}  // namespace axg::test
#else
TEST(ClosedLoop, NeedsCgal) {
    GTEST_SKIP() << "built without CGAL (Debian: libcgal-dev), by clang or with sanitizers";
}
#endif
