// SPDX-License-Identifier: Apache-2.0
// The promise of stoppable mode, kept or broken: a thin bar on three axes goes for a wall of 0.1 mm
// on a table that turns at up to 100 rpm, the guard decides from samples that are off, late and
// lost, the board brakes as late and as weakly as it may, and whether the two ever touch is judged
// by formulas of this file, in steps of 1 um at most. AXG_COUNT: cycles.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <vector>

#include "core/base/sincos.hpp"
#include "core/certificate/stop_certificate.hpp"
#include "core/guard/monitor.hpp"
#include "core/machine/cycle_plan.hpp"
#include "hil_replay/lab/ablations/ablations.hpp"
#include "tests/support/containment_fixture.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/triangle_cases.hpp"

namespace axg::test {
namespace {

using Random = std::mt19937_64;

std::uint64_t cycle_count() {
    const char* const text = std::getenv("AXG_COUNT");
    return text == nullptr ? 100'000U : std::strtoull(text, nullptr, 10);
}
constexpr std::uint64_t kTelling = 100'000;  // cycles that show what an ablation does

enum : std::uint32_t { kX, kZ, kC, kAxes };
constexpr double kCyclePeriodS = 1e-3;
constexpr double kWallRadiusMm = 120, kBarMm = 0.3;

// The wall: 80 to 120 mm from the table's axis, 0.1 mm thick, 30 mm high. The bar: 0.3 x 0.3 mm,
// 30 mm long, hanging above the circle of 100 mm, its foot 30 mm over the table at Z 0.
const Vec3d kWallLow{80, -0.05, 0}, kWallHigh{kWallRadiusMm, 0.05, 30};
const Vec3d kBarLow{100 - 0.5 * kBarMm, -0.5 * kBarMm, 30},
    kBarHigh{100 + 0.5 * kBarMm, 0.5 * kBarMm, 60};

Mesh box_mesh(const char* name, Vec3d low, Vec3d high) {
    const auto narrow = [](Vec3d v) {
        return Vec3f{static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
    };
    return {name, box(narrow(low), narrow(high))};
}

Machine random_mill(Random& random, bool is_jerk_limited) {
    Machine m;
    m.axes.resize(kAxes);
    for (std::uint32_t i = 0; i < kAxes; ++i) {
        Axis& axis = m.axes[i];
        const bool is_linear = i != kC;
        axis.kind = is_linear ? AxisKind::linear : AxisKind::rotary;
        axis.unlimited = !is_linear;
        axis.min = is_linear ? -500 : 0;
        axis.max = is_linear ? 500 : 0;
        const double size = is_linear ? 1 : 0.01;
        axis.speed_max = is_linear ? between(random, 100, 1000) : 100 * 2 * kPi / 60;
        axis.acceleration_max = size * between(random, 1000, 10'000);
        axis.jerk_max = size * between(random, 20'000, 200'000);
        axis.stopping_min = axis.acceleration_max * between(random, 0.5, 1);
        axis.position_error = is_linear ? 0.001 : 1e-5;
    }
    m.bodies.resize(3);
    m.bodies[0].joint = {kX, {1, 0, 0}, {}};
    m.bodies[1].parent = 0;
    m.bodies[1].joint = {kC, {0, 0, 1}, {}};
    m.bodies[2].joint = {kZ, {0, 0, 1}, {}};
    m.pairs = {{2, 1, 0}};
    m.guard.free_jerk_limited = is_jerk_limited;
    m.guard.board_reaction_s = between(random, 0, 3e-3);
    return m;
}

/// One axis during a short step: constant jerk, or at rest from some instant on.
struct Moving {
    double q = 0, v = 0, a = 0, jerk = 0;
    double rests_after = HUGE_VAL;

    [[nodiscard]] double at(double t) const {
        const double u = std::min(t, rests_after);
        return q + u * (v + u * (0.5 * a + u * jerk / 6));
    }
    void advance(double t) {
        const bool rests = t >= rests_after;
        const double u = std::min(t, rests_after);
        const double end = at(t);
        v = rests ? 0 : v + u * (a + 0.5 * jerk * u);
        a = rests ? 0 : a + jerk * u;
        q = end;
        jerk = 0;
        rests_after = HUGE_VAL;
    }
};
using Axes = std::array<Moving, kAxes>;

/// How far the two boxes are apart along the best of their normals, and of the vertical: never more
/// than their distance; not positive only where they touch (two boxes that share an axis).
double gap_mm(double x, double z, double c) {
    // In the wall's frame: the bar's centre turned back about the table's axis.
    const double co = std::cos(c), si = std::sin(c);
    const double bx = 100 - x, by = 0;
    const double px = co * bx + si * by, py = -si * bx + co * by;
    const double half = 0.5 * kBarMm;
    const double around = half * (std::fabs(co) + std::fabs(si));  // the bar seen along wall axes
    const double wx = 0.5 * (kWallHigh.x - kWallLow.x), wy = 0.05;
    const double cx = 0.5 * (kWallHigh.x + kWallLow.x);
    const double dx = std::fabs(px - cx) - wx - around;
    const double dy = std::fabs(py) - wy - around;
    // The wall seen along the bar's axes.
    const double wall_x = wx * std::fabs(co) + wy * std::fabs(si);
    const double wall_y = wx * std::fabs(si) + wy * std::fabs(co);
    const double ex = std::fabs(cx * co - bx) - wall_x - half;
    const double ey = std::fabs(cx * si - by) - wall_y - half;
    const double dz = std::max(kBarLow.z + z - kWallHigh.z, kWallLow.z - (kBarHigh.z + z));
    return std::max({dx, dy, ex, ey, dz});
}

/// Whether the bodies touch at any time of a step: far apart means that none can for a while.
bool touches(const Axes& axes, double step_s) {
    const auto fastest = [step_s](const Moving& m) {
        return std::fabs(m.v) + step_s * (std::fabs(m.a) + step_s * std::fabs(m.jerk));
    };
    const double speed = fastest(axes[kX]) + fastest(axes[kZ]) +
                         fastest(axes[kC]) * (kWallRadiusMm + std::fabs(axes[kX].q) + 200) + 1e-9;
    double t = 0;
    while (true) {
        const double gap = gap_mm(axes[kX].at(t), axes[kZ].at(t), axes[kC].at(t));
        if (gap <= 0) {
            return true;
        }
        if (t >= step_s) {
            return false;
        }
        t = std::min(step_s, t + std::max(gap, 1e-3) / speed);
    }
}

enum class Mode { stoppable, no_jerk_ramp, contact };

struct Tally {
    std::uint64_t cycles = 0, approaches = 0, touched = 0, unseen = 0, stopped = 0, permits = 0;
    double nearest_mm = HUGE_VAL;
};

/// One approach: board, axes, wire and guard.
class Approach {
  public:
    Approach(Random& random, const Machine& machine, ContainmentScene& scene, Mode mode)
        : random_(random), machine_(machine), of_guard_(machine), scene_(scene), mode_(mode) {
        if (mode == Mode::no_jerk_ramp) {
            lab::forget_jerk_ramp(of_guard_);
        }
        const std::vector<const Mesh*> surfaces{&scene.meshes()[0], &scene.meshes()[1],
                                                &scene.meshes()[2]};
        certificate_.emplace(*StopCertificate::create(
            of_guard_, surfaces, {.plan = cycle_plan(of_guard_, stop_tasks(of_guard_))}));
        from_above_ = (random() & 1U) != 0;
        axes_[kZ].q = from_above_ ? between(random, 20, 120) : -between(random, 1, 25);
        axes_[kX].q = from_above_ ? between(random, -15, 15) : -between(random, 60, 200);
        axes_[kC].q = between(random, 0, 2 * kPi);
        // One in three stands with its wall under the bar: there the stop ends close to it.
        if (random() % 3 == 0) {
            axes_[kC].q = between(random, -1e-3, 1e-3);
        } else {
            spin_ = ((random() & 1U) != 0 ? 1 : -1) * between(random, 0.05, 0.97) *
                    machine.axes[kC].speed_max;
        }
        aim_ = from_above_ ? -between(random, 2, 25) : between(random, -15, 15);
        axes_[kC].v = spin_;
        loss_ = (random() & 1U) != 0 ? 0 : between(random, 0, 0.05);
        late_s_ = free_seconds(machine_, machine_.can.permit_samples.least) *
                  ((random() & 1U) != 0 ? 1 : between(random, 0.7, 1));
    }

    void run(Tally& tally) {
        ++tally.approaches;
        bool touched = false, seen = false;
        for (std::uint64_t k = 1; k < 700 && !is_resting(); ++k) {
            ++tally.cycles;
            const bool is_lost = k > 20 && between(random_, 0, 1) < loss_;
            if (!is_lost) {
                sample(k, tally, seen);
            }
            const bool touches_now = move(k);
            const double gap = gap_mm(axes_[kX].q, axes_[kZ].q, axes_[kC].q);
            tally.nearest_mm = std::min(tally.nearest_mm, gap);
            if (touched && !touches_now) {
                break;  // the first touch is over: a sample has seen it, or none ever will
            }
            touched = touched || touches_now;
        }
        tally.touched += touched ? 1 : 0;
        tally.unseen += touched && !seen ? 1 : 0;
        tally.stopped += stop_s_ != HUGE_VAL ? 1 : 0;
    }

  private:
    [[nodiscard]] bool is_resting() const {
        return is_braking_ && axes_[kX].v == 0 && axes_[kZ].v == 0 && axes_[kC].v == 0;
    }

    AxisSnapshot snapshot(std::uint64_t k) {
        AxisSnapshot p;
        p.sample = k;
        p.axis_count = kAxes;
        p.mode = kModeMoving;
        for (std::uint32_t i = 0; i < kAxes; ++i) {
            const double error = between(random_, -1, 1) * machine_.axes[i].position_error;
            p.position[i] = axes_[i].q + error;
        }
        p.position[kC] -= 2 * kPi * std::floor(p.position[kC] / (2 * kPi));
        return p;
    }

    void sample(std::uint64_t k, Tally& tally, bool& seen) {
        CycleResult result;
        const AxisSnapshot now = snapshot(k);
        if (mode_ == Mode::contact) {
            make_contact_queries(machine_, now, contact_);
            std::array<QueryResult, 3> results;
            std::array<ContainmentResult, 1> containment_results;
            scene_.engine().run({contact_.queries.data(), 3}, results);
            scene_.containment_test().run({contact_.queries.data(), 1}, {results.data(), 1},
                                          containment_results);
            result = judge(contact_, results, containment_results, k > 2);
            seen = seen || result.reason == StopReason::contact;
        } else {
            certificate_->note(now, k <= 2);
            certificate_->prove(scene_.engine().engine(), scene_.containment_test());
            certificate_->keep();
            result = judge(certificate_->cycle(), k > 2, permitted_s_ > 0);
        }
        if (stop_s_ != HUGE_VAL) {
            return;  // the guard latches
        }
        if (result.has_permit) {
            ++tally.permits;
            permitted_s_ = static_cast<double>(k) * kCyclePeriodS;
        }
        if (result.is_stop) {  // the board may brake at once, or when the permit has run out
            const double latest = permitted_s_ + late_s_ - static_cast<double>(k) * kCyclePeriodS;
            stop_s_ = static_cast<double>(k) * kCyclePeriodS +
                      ((random_() & 1U) != 0 ? 1 : between(random_, 0, 1)) * std::max(0.0, latest);
        }
    }

    /// One period in short steps; whether the bodies touched in it.
    bool move(std::uint64_t k) {
        constexpr int kSteps = 10;
        constexpr double kStepS = kCyclePeriodS / kSteps;
        bool touched = false;
        for (int i = 0; i < kSteps; ++i) {
            const double now = static_cast<double>(k) * kCyclePeriodS + i * kStepS;
            // The first permit may take some samples; until then the linear axes stand far away.
            const bool has_run_out = permitted_s_ > 0 && now >= permitted_s_ + late_s_ - 1e-9;
            if (!is_braking_ && (has_run_out || now >= stop_s_ - 1e-9)) {
                is_braking_ = true;
                harder_ = (random_() & 1U) != 0 ? 1 : between(random_, 1, 2);
            }
            for (std::uint32_t a = 0; a < kAxes; ++a) {
                is_braking_ ? brake(a, kStepS) : drive(a, kStepS);
            }
            touched = touched || touches(axes_, kStepS);
            for (std::uint32_t a = 0; a < kAxes; ++a) {
                axes_[a].advance(kStepS);
                EXPECT_LE(std::fabs(axes_[a].v), machine_.axes[a].speed_max)
                    << "not what is promised";
            }
        }
        return touched;
    }

    void drive(std::uint32_t index, double step) {
        Moving& m = axes_[index];
        const Axis& axis = machine_.axes[index];
        const bool goes = index == (from_above_ ? kZ : kX) && permitted_s_ > 0;
        const bool is_there = from_above_ ? m.q < aim_ : m.q > aim_;
        if (index == kC) {
            wish_[index] = spin_;
        } else if (!goes || is_there) {
            wish_[index] = 0;
        } else if (wish_[index] == 0 || random_() % 200 == 0) {  // another one every 20 ms or so
            const double hurry = between(random_, 0.05, 1);
            wish_[index] = (from_above_ ? -1 : 1) * hurry * axis.speed_max;
        }
        const double room = 0.97 * axis.speed_max;
        const double wanted = std::clamp(wish_[index], -room, room);
        const double soon = m.v + m.a * std::fabs(m.a) / (2 * axis.jerk_max);
        double aim = std::clamp((wanted - (machine_.guard.free_jerk_limited ? soon : m.v)) / 2e-3,
                                -axis.acceleration_max, axis.acceleration_max);
        if (!machine_.guard.free_jerk_limited) {
            // It may jump, but a stop takes it away by the jerk alone, and until that is done the
            // speed rises on: no further than the axis may go.
            const double sign = aim > 0 ? 1 : -1, gain = axis.jerk_max * step;
            const double left = std::max(0.0, axis.speed_max - sign * m.v);
            const double most = std::sqrt(gain * gain + 2 * axis.jerk_max * left) - gain;
            m.a = sign * std::min(std::fabs(aim), most);
            m.jerk = 0;
            return;
        }
        const double gain = axis.jerk_max * step;
        aim = std::clamp(aim, m.a - gain, m.a + gain);
        m.jerk = (aim - m.a) / step;
    }

    /// Towards the guaranteed deceleration, or a harder one, without turning round.
    void brake(std::uint32_t index, double step) {
        Moving& m = axes_[index];
        const Axis& axis = machine_.axes[index];
        if (m.v == 0) {
            m.a = m.jerk = 0;
            return;
        }
        const double sign = m.v > 0 ? 1 : -1;
        const double wanted = -sign * harder_ * axis.stopping_min;
        const double most = harder_ * axis.jerk_max * step;
        const bool is_harder_already = sign * m.a < sign * wanted;
        const double end = is_harder_already ? wanted : std::clamp(wanted, m.a - most, m.a + most);
        m.a = is_harder_already ? wanted : m.a;
        m.jerk = (end - m.a) / step;
        // Speed v + a t + j t^2 / 2 is zero at:
        const double v = sign * m.v, a = sign * m.a, j = sign * m.jerk;
        const double root = a * a - 2 * j * v;
        if (v + step * (a + 0.5 * j * step) <= 0 && root >= 0) {
            m.rests_after = 2 * v / (-a + std::sqrt(root));
        }
    }

    Random& random_;
    const Machine& machine_;
    Machine of_guard_;
    ContainmentScene& scene_;
    Mode mode_;
    std::optional<StopCertificate> certificate_;
    PairQueries contact_;
    Axes axes_;
    std::array<double, kAxes> wish_{};
    bool from_above_ = true, is_braking_ = false;
    double aim_ = 0, spin_ = 0, loss_ = 0, late_s_ = 0, permitted_s_ = 0, stop_s_ = HUGE_VAL,
           harder_ = 1;
};

ContainmentScene make_scene() {
    return ContainmentScene({{"", {}},
                             box_mesh("wall", kWallLow, kWallHigh),
                             box_mesh("bar", kBarLow, kBarHigh),
                             known_answer_mesh()});
}

Tally run_approaches(std::uint64_t seed, Mode mode, bool is_jerk_limited) {
    Random random(printed_seed(seed));
    ContainmentScene scene = make_scene();
    Tally tally;
    while (tally.cycles < cycle_count()) {
        Random own(random());  // the same set for every mode
        const Machine machine = random_mill(own, is_jerk_limited);
        Approach approach(own, machine, scene, mode);
        const std::uint64_t touched = tally.touched;
        approach.run(tally);
        if (mode == Mode::stoppable && tally.touched != touched) {
            ADD_FAILURE() << "approach " << tally.approaches << " touched";
            break;
        }
    }
    std::printf(
        "%llu cycles, %llu approaches, %llu permits, %llu stopped, %llu touched, %llu of "
        "them never judged in contact; nearest %.4f mm\n",
        static_cast<unsigned long long>(tally.cycles),
        static_cast<unsigned long long>(tally.approaches),
        static_cast<unsigned long long>(tally.permits),
        static_cast<unsigned long long>(tally.stopped),
        static_cast<unsigned long long>(tally.touched),
        static_cast<unsigned long long>(tally.unseen), tally.nearest_mm);
    return tally;
}

TEST(StoppableApproach, NeverTouchesWhereAccelerationMayJump) {
    const Tally tally = run_approaches(20261170, Mode::stoppable, false);
    EXPECT_EQ(tally.touched, 0U);
    if (cycle_count() >= kTelling) {
        EXPECT_GT(tally.stopped, tally.approaches / 3) << "the approaches must be dangerous";
        EXPECT_GT(tally.permits, tally.cycles / 10);
    }
}

TEST(StoppableApproach, NeverTouchesWhereJerkIsLimited) {
    const Tally tally = run_approaches(20261171, Mode::stoppable, true);
    EXPECT_EQ(tally.touched, 0U);
    if (cycle_count() >= kTelling) {
        EXPECT_GT(tally.stopped, tally.approaches / 3);
        EXPECT_GT(tally.permits, tally.cycles / 10);
    }
}

// The same set, judged at the sampled poses: many touch, and some of those show at no sample at
// all.
TEST(StoppableApproach, ContactModeMissesOnTheSameSet) {
    const Tally tally = run_approaches(20261171, Mode::contact, true);
    if (cycle_count() >= kTelling) {
        EXPECT_GT(tally.touched, tally.approaches / 5);
        EXPECT_GT(tally.unseen, 0U);
    }
}

// Without the ramp from acceleration to braking the reach is too short, and it shows.
TEST(StoppableApproach, ForgettingTheJerkRampTouches) {
    const Tally tally = run_approaches(20261170, Mode::no_jerk_ramp, false);
    if (cycle_count() >= kTelling) {
        EXPECT_GT(tally.touched, 0U);
    }
}

// The judge of this file against numbers by hand.
TEST(StoppableApproach, TheJudgeIsRight) {
    EXPECT_NEAR(gap_mm(0, 5, 0), 5, 1e-12);                    // 5 mm above the wall
    EXPECT_LE(gap_mm(0, 0, 0), 0);                             // standing on it
    EXPECT_NEAR(gap_mm(-30, -5, 0), 130 - 120 - 0.15, 1e-12);  // beyond its end
    EXPECT_NEAR(gap_mm(0, -5, kPi / 2), 100 - 0.05 - 0.15, 1e-9);
    Axes axes;
    axes[kZ].q = -5;
    axes[kC].q = -0.01;  // 1 mm before the bar, and 1 mm behind it a millisecond later
    axes[kC].v = 20;
    EXPECT_TRUE(touches(axes, 1e-3));
    EXPECT_GT(gap_mm(0, -5, -0.01), 0.5);
    EXPECT_GT(gap_mm(0, -5, 0.01), 0.5);
    axes[kZ].q = 1;
    EXPECT_FALSE(touches(axes, 1e-3));
}

}  // namespace
}  // namespace axg::test
