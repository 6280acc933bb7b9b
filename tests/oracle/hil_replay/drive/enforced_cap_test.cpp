// SPDX-License-Identifier: Apache-2.0
// The parts of an enforced cap in closed loop, without a wire: certificate with bounded speeds,
// ledger of acks, control law; against the library for boards and a program that is slowed as a
// whole. Both near programs get past the place where they are stopped without it. They do not run
// to their end yet, and no guard that is deployed has this loop. The board names no permit while it
// slows down (AckLedger::note_recent_ack). AXG_COUNT: seconds of machine time at most; beyond the
// usual number nothing is expected. Figures: docs/measurements/cap.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <optional>
#include <vector>

#include "core/guard/ack_ledger.hpp"
#include "core/guard/cap_control.hpp"
#include "core/guard/speed_advisory.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "hil_replay/drive/path_judge.hpp"
#include "hil_replay/motion/program_motion.hpp"
#include "tests/support/board_fixture.hpp"
#include "tests/support/count.hpp"
#include "tests/support/dice.hpp"
#include "tests/support/example_programs.hpp"

namespace axg::test {
namespace {

constexpr std::uint64_t kUsual = 20;            // both are stopped before without a cap
constexpr std::uint8_t kLeast = 3, kWork = 10;  // n
constexpr int kTicks = 10;                      // of kMotionStepUs, in a period
constexpr std::uint64_t kSentUs = 400;          // from the latch to the permit at the board
constexpr std::uint64_t kOldUs =
    5000;                          // after the end of a permit of kWork: its sample is the 16th
constexpr double kSettleS = 0.04;  // a drive's lag, twenty times

/// How fast the board's axes may still be: what was commanded or seen in so many ticks.
class SpeedBound {
  public:
    explicit SpeedBound(std::size_t ticks) : seen_(ticks, 0) {}
    void add(double share) {
        seen_.push_back(share);
        seen_.pop_front();
    }
    [[nodiscard]] double most() const { return *std::max_element(seen_.begin(), seen_.end()); }

  private:
    std::deque<double> seen_;
};

struct CapRun {
    bool is_over = false, is_stopped = false;
    double seconds = 0;
    std::uint64_t samples = 0, unproven = 0, short_permits = 0, held = 0, too_fast = 0;
    std::uint8_t least_cap = kCapRapid;
    std::uint64_t slow_downs = 0;
    bool has_contact = false;
};

class CappedLoop {
  public:
    CappedLoop(LoadedMachine& loaded, const Program& program, CapPromise promise, double lost)
        : machine_(loaded.machine),
          engine_(make_engine(loaded)),
          containment_(make_containment_test(loaded, *engine_)),
          certificate_(make_stop_certificate(loaded)),
          advisory_(SpeedAdvisory::create(machine_, true)),
          control_(promise),
          lost_(lost),
          limits_(make_motion_limits(machine_)),
          motion_(make_program_motion(program, limits_, options_, &share_)),
          bound_(static_cast<std::size_t>((limits_.smooth_s + kSettleS) / kMotionStepS)),
          judge_(machine_, engine_->engine(), *containment_) {
        machine_.guard.cap_lead_s = limits_.smooth_s + kSettleS;  // as late as this board is
        for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
            axes_[i].position = program.start[i];
        }
        fixture_.arm();
    }

    CapRun run(double seconds_most) {
        while (!run_.is_over && !run_.is_stopped && run_.seconds < seconds_most) {
            cycle();
        }
        run_.has_contact = judge_.contact().has_value();
        return run_;
    }

  private:
    axg_board& board() { return fixture_.board; }
    [[nodiscard]] std::uint64_t now_us(int tick) const {
        return BoardFixture::instant_of(number_) + static_cast<std::uint64_t>(tick) * kMotionStepUs;
    }

    void cycle() {
        (void)fixture_.latch(number_);
        axg_board_says says{};
        says.mode = kModeMoving;
        AxisSnapshot snapshot;
        snapshot.sample = snapshot.arrived_us = number_ + 1;
        snapshot.latched_us = static_cast<std::int64_t>(now_us(0));
        snapshot.axis_count = static_cast<std::uint32_t>(machine_.axes.size());
        snapshot.mode = kModeMoving;
        snapshot.flags = axg_board_flags(&board(), &says);
        if (board().acked.end_us + kOldUs < now_us(0)) {  // while it slows down it names none
            snapshot.flags = 0;
        }
        snapshot.tool = tool_;
        for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
            snapshot.position[i] = axes_[i].position;
        }
        certificate_->note(snapshot, number_ == 0);
        answer(ledger_.note_recent_ack(acked_permit(snapshot)).caps);
        for (int tick = 0; tick < kTicks && !run_.is_over && !run_.is_stopped; ++tick) {
            move(tick);
        }
        judge_.look(snapshot.latched_us, {axes_.data(), machine_.axes.size()}, tool_);
        ++number_;
    }

    [[nodiscard]] bool is_proven(const AxisCaps& caps, std::uint8_t samples) {
        std::vector<double> speeds;
        for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
            speeds.push_back(capped_speed(machine_.axes[i], caps[i] / double{kCapRapid}));
        }
        certificate_->bound_speeds(speeds);
        machine_.can.permit_samples = {samples, samples};
        certificate_->prove(engine_->engine(), *containment_);
        const StopCycle cycle = certificate_->cycle();
        return cycle.status == SnapshotStatus::ok && cycle.is_settled &&
               std::all_of(cycle.proofs.begin(), cycle.proofs.end(), [](const PairProof& proof) {
                   return proof.surfaces.proof == JointBoxProof::proven &&
                          proof.containment_result.containment == Containment::none;
               });
    }

    void answer(const AxisCaps& acked) {
        const auto bounds_at = [&](std::uint8_t cap) {
            return higher_caps(acked, caps_of_permit(cap, 0xFF));
        };
        const std::uint8_t before = control_.order().cap;
        CapCycle cycle;
        cycle.sample_us = static_cast<std::int64_t>(now_us(0));
        cycle.is_raise_proven =
            before < kCapRapid && is_proven(bounds_at(control_.raised_cap()), kWork);
        cycle.is_proven = cycle.is_raise_proven || is_proven(bounds_at(before), kWork);
        const bool is_short = !cycle.is_proven && is_proven(bounds_at(before), kLeast);
        certificate_->keep();
        machine_.can.permit_samples = {kLeast, kLeast};
        advisory_->update(engine_->engine(), *certificate_, queries_of(certificate_->plan()));
        cycle.wanted = advisory_->cap();
        const bool is_known = certificate_->cycle().is_settled;
        const CapOrder order = is_known ? control_.update(cycle) : control_.order();
        run_.samples += is_moving_ ? 1 : 0;
        run_.slow_downs += is_moving_ && before == kCapRapid && order.cap < before ? 1 : 0;
        run_.short_permits += is_moving_ && is_short ? 1 : 0;
        run_.held += is_moving_ && order.cap == kCapHold ? 1 : 0;
        run_.least_cap = std::min(run_.least_cap, is_moving_ ? order.cap : kCapRapid);
        ledger_.note_sent(++live_, caps_of_permit(order.cap, 0xFF));
        if (!cycle.is_proven && !is_short) {
            run_.unproven += is_moving_ ? 1 : 0;
            return;  // its number is lost, as a permit on the bus would be
        }
        if (!dice_.chance(lost_)) {
            (void)fixture_.hear({.number = number_,
                                 .live = live_,
                                 .cap = order.cap,
                                 .mask = 0xFF,
                                 .samples = cycle.is_proven ? kWork : kLeast},
                                now_us(0) + kSentUs);
        }
    }

    void move(int tick) {
        const std::uint64_t at_us = now_us(0) + kSentUs + static_cast<std::uint64_t>(tick) * 50;
        const axg_board_motion motion = axg_board_may_move(&board(), at_us);
        if (!is_moving_ && motion.may_move) {
            axg_board_moves(&board(), true, at_us);
            is_moving_ = true;
        }
        if (is_moving_ && !motion.may_move) {
            run_.is_stopped = true;
            return;
        }
        keep(motion, at_us);
        if (!is_moving_) {
            return;
        }
        const MotionTick state = motion_({axes_.data(), machine_.axes.size()});
        tool_ = state.tool;
        double fastest = 0;
        for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
            axes_[i] = moved_on(axes_[i], kMotionStepS);
            fastest = std::max(fastest, std::abs(axes_[i].speed) / machine_.axes[i].speed_max);
        }
        run_.too_fast += fastest * kCapRapid > board().keeps.of[0] ? 1 : 0;
        bound_.add(std::max(fastest, share_));
        run_.seconds += kMotionStepS;
        run_.is_over = state.is_over;
    }

    /// Slower at once where that is ordered; faster when the library lets it. What it keeps is what
    /// may still be on its way to the axes.
    void keep(const axg_board_motion& motion, std::uint64_t at_us) {
        const double ordered = motion.ordered.of[0];
        const double may_be = std::max(ordered, std::ceil(bound_.most() * kCapRapid));
        axg_board_caps wanted{};
        std::fill(std::begin(wanted.of), std::end(wanted.of),
                  static_cast<std::uint8_t>(std::min(may_be, double{kCapRapid})));
        const axg_board_caps kept = axg_board_keeps(&board(), &wanted, at_us);
        const double cap = std::min<double>(kept.of[0], ordered);
        share_ = std::max(0.98 * cap / kCapRapid, 1e-4);  // hold: the least that there is
    }

    Machine& machine_;
    std::optional<CpuEngine> engine_;
    std::optional<ContainmentTest> containment_;
    std::optional<StopCertificate> certificate_;
    std::optional<SpeedAdvisory> advisory_;
    AckLedger ledger_;
    CapControl control_;
    Dice dice_{27};
    double lost_;
    MotionLimits limits_;
    MotionOptions options_;
    double share_ = 1e-4;
    CommandedMotion motion_;
    SpeedBound bound_;
    PathJudge judge_;
    BoardFixture fixture_{AXG_BOARD_CAP_ENFORCED};
    AxisMotions axes_{};
    std::uint16_t tool_ = 0;
    std::uint32_t number_ = 0;
    std::uint8_t live_ = 0;
    bool is_moving_ = false;
    CapRun run_;
};

class EnforcedCap : public testing::TestWithParam<Example> {
  protected:
    [[nodiscard]] static CapRun run(CapPromise promise, double lost) {
        LoadedMachine loaded;
        EXPECT_TRUE(load_example(GetParam().machine, loaded));
        const Program program = read_example(GetParam().program, loaded.machine);
        CappedLoop loop(loaded, program, promise, lost);
        const CapRun run = loop.run(static_cast<double>(count_from_environment(kUsual)));
        const double whole_s =
            motion_seconds(program, make_motion_limits(loaded.machine), MotionOptions{});
        std::printf(
            "%s, lost %.0f %%: %s after %.2f s, %.2f s without a cap; %llu samples, %llu not "
            "proven, %llu with n = %u, %llu at hold; least cap %u, %llu slow-downs\n",
            GetParam().program, 100 * lost,
            run.is_over      ? "over"
            : run.is_stopped ? "STOPPED"
                             : "under way",
            run.seconds, whole_s, static_cast<unsigned long long>(run.samples),
            static_cast<unsigned long long>(run.unproven),
            static_cast<unsigned long long>(run.short_permits), kLeast,
            static_cast<unsigned long long>(run.held), run.least_cap,
            static_cast<unsigned long long>(run.slow_downs));
        EXPECT_EQ(run.too_fast, 0U) << "the board of this test keeps less than it says";
        EXPECT_FALSE(run.has_contact);
        return run;
    }
};

TEST_P(EnforcedCap, PassesThePlaceWhereItWouldBeStopped) {
    for (const double lost : {0.0, 0.01}) {
        const CapRun capped = run(CapPromise::all_axes, lost);
        EXPECT_GT(capped.slow_downs, 0U);
        if (count_from_environment(kUsual) <= kUsual) {
            EXPECT_FALSE(capped.is_stopped);
            EXPECT_EQ(capped.unproven, 0U);
        }
    }
}

TEST_P(EnforcedCap, IsStoppedWithoutIt) {
    EXPECT_TRUE(run(CapPromise::none, 0).is_stopped);
}

INSTANTIATE_TEST_SUITE_P(Near, EnforcedCap, testing::Values(kExamples[1], kExamples[4]),
                         [](const auto& example) { return name_of(example.param); });

}  // namespace
}  // namespace axg::test
