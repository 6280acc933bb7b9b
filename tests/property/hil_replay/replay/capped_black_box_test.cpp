// SPDX-License-Identifier: Apache-2.0
// A run with an enforced cap, and its black box: boards acknowledge late, frames are lost and late,
// orders fall and rise. A dump that goes back to the start gives every cycle again, with the same
// verdict, box, n, order and permit bytes. One that begins later, while an order is in force, gives
// the same verdicts, and behind the first order to slow down the same boxes and n. Before that a
// raise may be asked for in another cycle: the record does not say in which it was.
// AXG_COUNT: runs of each kind of cap; AXG_SEED: the first.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/certificate/permit_ladder.hpp"
#include "firmware_if/guard/black_box.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "hil_replay/drive/drive_run.hpp"
#include "hil_replay/guard/timed_guard.hpp"
#include "hil_replay/replay/black_box_replay.hpp"
#include "tests/support/approach_machine.hpp"
#include "tests/support/count.hpp"
#include "tests/support/lazy_motion.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/wild_approach.hpp"
#include "tests/support/wild_wire.hpp"

namespace axg::test {
namespace {

/// What a cycle proved: the box of the longest permit that is, and its n.
struct Proven {
    std::uint8_t samples = 0;
    JointBox box;
};
bool is_same(const Proven& a, const Proven& b) {
    const auto same = [](const std::array<double, kAxesMax>& p,
                         const std::array<double, kAxesMax>& q) {
        return std::memcmp(p.data(), q.data(), 3 * sizeof(double)) == 0;
    };
    return a.samples == b.samples && same(a.box.centre, b.box.centre) &&
           same(a.box.half, b.box.half);
}
Proven proven_by(const GuardChain& chain) {
    const StopCertificate& certificate = *chain.stop_certificate();
    return {certificate.cycle().samples,
            certificate.tasks().empty() ? JointBox{} : certificate.tasks()[0].box};
}

/// All that a guard's chain needs, new.
struct Parts {
    Parts(const CompiledMachine& loaded, CpuEngine& engine, const ContainmentTest& containment_test)
        : certificate(make_stop_certificate(loaded)),
          advisory(SpeedAdvisory::create(loaded.machine)),
          chain(loaded.machine, engine.engine(), containment_test, {&*certificate, &*advisory}) {}

    std::optional<StopCertificate> certificate;
    std::optional<SpeedAdvisory> advisory;
    GuardChain chain;
};

/// Goes for the plate, as lazily as it may, and after a while away from it.
class ThereAndBack {
  public:
    ThereAndBack(const Machine& machine, const Approach& there, const Approach& back,
                 std::size_t lazy_ticks, int turn_tick)
        : there_(machine, there, machine.guard.cap, {.lazy_ticks = lazy_ticks}),
          back_(machine, back, machine.guard.cap, {.lazy_ticks = lazy_ticks}),
          turn_tick_(turn_tick) {}

    MotionTick operator()(std::span<AxisMotion> axes) {
        if (tick_++ < turn_tick_) {
            MotionTick tick = there_(axes);
            tick.is_over = false;
            return tick;
        }
        back_.share = there_.share;
        back_.shares.wanted = there_.shares.wanted;
        const MotionTick tick = back_(axes);
        for (std::size_t i = 0; i < axes.size(); ++i) {
            there_.shares.needed[i] = std::max(there_.shares.needed[i], back_.shares.needed[i]);
        }
        back_.shares.needed = {};
        return tick;
    }
    void give(BoardOptions& options) {
        if (options.cap == CapPromise::per_axis) {
            options.axis_shares = &there_.shares;
        } else {
            options.speed_share = &there_.share;
        }
    }

  private:
    LazyMotion there_, back_;
    int turn_tick_, tick_ = 0;
};

constexpr std::uint64_t kUsual = 12;
constexpr std::uint64_t kRunIn = 50;  // cycles: the permit ladder bars an n for 32

/// What is changed in the records before they are replayed.
enum class Forgotten : std::uint8_t {
    nothing,
    orders,  // what the permits ordered
    acks,    // what the samples acknowledged
};

/// What came of a replay, cycle by cycle.
struct Replayed {
    ReplayedBlackBox result;
    std::int64_t begins_us = 0;
    std::uint64_t cycles = 0, compared = 0, other_boxes = 0;
    // Behind an order to slow down nothing is left of what the guard knew before the dump.
    std::uint64_t compared_known = 0, other_known = 0;
    std::int64_t known_us = INT64_MAX;
};

/// One run: what the guard did, and its records.
class CappedRun {
  public:
    CappedRun(CapPromise promise, std::uint64_t seed)
        : loaded_(approach_machine()),
          engine_(make_engine(loaded_)),
          containment_test_(make_containment_test(loaded_, *engine_)) {
        Dice dice(seed);
        Machine& machine = loaded_.machine;
        draw_limits(dice, machine);
        draw_slow(dice, machine);
        machine.guard.cap = promise;
        machine.can.permit_samples = {static_cast<std::uint8_t>(dice.in(3, 9)), 13};
        machine.can.stale_after_us = 13'000;
        machine.cycle.queries = 48;
        play(dice, seed);
    }

    std::uint64_t cycles = 0, permits = 0, frames = 0, falls = 0, raises = 0, lagging = 0;
    std::int64_t last_permit_us = 0;  // instant of its sample

    /// @param share  of its records that the ring has room for; above 1: the dump goes back to the
    ///     start
    /// @param settles  cycles of a dump that begins later, whose boxes are not compared
    [[nodiscard]] Replayed replay(double share, std::uint64_t settles,
                                  Forgotten forgotten = Forgotten::nothing) {
        const std::vector<std::uint8_t> bytes = dump(share, forgotten);
        Parts parts(loaded_, *engine_, *containment_test_);
        BlackBoxReplay replay(loaded_.machine, parts.chain, options());
        Replayed out;
        BlackBoxRecord record;
        for (std::span<const std::uint8_t> rest = bytes; !rest.empty();
             rest = rest.subspan(record.size_bytes)) {
            if (decode_black_box_record(rest, record) != BlackBoxStatus::ok) {
                ADD_FAILURE() << "a record cannot be read";
                break;
            }
            replay.on_record(record);
            const auto* const made = std::get_if<LiveResult>(&record.entry.content);
            if (made != nullptr && made->kind == LiveQuery::Kind::snapshot) {
                compare(*made, parts.chain, settles, out);
            }
        }
        out.result = replay.result();
        out.begins_us = out.result.first_us;
        return out;
    }

  private:
    static LiveOptions options() {
        LiveOptions out;
        out.supposes_arming = true;
        out.ignores_period = true;
        return out;
    }
    [[nodiscard]] std::vector<std::uint8_t> dump(double share, Forgotten forgotten) const {
        BlackBox ring(static_cast<std::size_t>(share * static_cast<double>(bytes_)));
        for (BlackBoxEntry entry : entries_) {
            auto* const made = std::get_if<LiveResult>(&entry.content);
            auto* const query = std::get_if<LiveQuery>(&entry.content);
            if (forgotten == Forgotten::orders && made != nullptr) {
                made->result.cap_order = {};
            } else if (forgotten == Forgotten::acks && query != nullptr) {
                query->caps = {};
            }
            ring.add(entry);
        }
        std::vector<std::uint8_t> out;
        for (const std::span<const std::uint8_t> part : ring.records()) {
            out.insert(out.end(), part.begin(), part.end());
        }
        return out;
    }
    void compare(const LiveResult& made, const GuardChain& chain, std::uint64_t settles,
                 Replayed& out) const {
        if (out.cycles == kRunIn) {
            const auto fall = fell_.upper_bound(made.latched_us);
            out.known_us = fall != fell_.end() ? *fall : INT64_MAX;
        }
        // Of a sample whose frames were before the dump there is nothing.
        if (chain.snapshot().latched_us != made.latched_us || out.cycles++ < settles) {
            return;
        }
        const Proven &live = proven_.at(made.latched_us), again = proven_by(chain);
        const bool is_other = !is_same(live, again), is_known = made.latched_us > out.known_us;
        ++out.compared;
        out.other_boxes += is_other ? 1 : 0;
        out.compared_known += is_known ? 1 : 0;
        out.other_known += is_known && is_other ? 1 : 0;
    }

    static WildFaults draw_few_faults(Dice& dice) {
        WildFaults faults;
        faults.lost = dice.chance(0.5) ? dice.magnitude(0.002, 0.02) : 0;
        faults.permit_lost = dice.chance(0.5) ? dice.in(0, 0.1) : 0;
        faults.late = dice.chance(0.5) ? dice.in(0, 0.3) : 0;
        faults.late_us_max = 2500;
        return faults;
    }
    void play(Dice& dice, std::uint64_t seed) {
        const Machine& machine = loaded_.machine;
        Approach there, back;
        const Positions touching = place(dice, true);
        const Positions start = place_near(dice, touching, 2.5 * standing_mm(machine) + 10);
        std::copy(touching.begin(), touching.end(), there.target.begin());
        std::copy(start.begin(), start.end(), back.target.begin());
        there.speed_share.fill(dice.in(0.1, 0.4));
        back.speed_share.fill(1);
        const auto lazy_ticks = static_cast<std::size_t>(dice.in(0, 40));
        ThereAndBack motion(machine, there, back, lazy_ticks, static_cast<int>(dice.in(150, 500)));
        BoardOptions board_options = promised_board(machine, seed);
        board_options.tool = 1;
        board_options.cap_smooth_s = static_cast<double>(lazy_ticks) * kTickS;
        motion.give(board_options);
        MotionBoard board(machine, {start.data(), 3}, std::ref(motion), board_options);
        run(board, draw_few_faults(dice), seed);
    }
    void run(MotionBoard& board, const WildFaults& faults, std::uint64_t seed) {
        const Machine& machine = loaded_.machine;
        Parts parts(loaded_, *engine_, *containment_test_);
        auto records = std::make_unique<BlackBoxQueue>();
        std::vector<CanFrame> first, *sent = &first;
        TimedGuardOptions of_guard;
        of_guard.guard = options();
        of_guard.guard.black_box = records.get();
        of_guard.echoes = of_guard.answers_hashes = false;
        of_guard.sent = [&](const CanFrame& frame) { sent->push_back(frame); };
        of_guard.response_us = [](std::int64_t) { return 300; };
        of_guard.evaluated = [&](std::int64_t) {
            proven_[parts.chain.snapshot().latched_us] = proven_by(parts.chain);
        };
        of_guard.each = [&](const TimedCycle& cycle) { note(cycle); };
        TimedGuard guard({.machine = machine, .chain = parts.chain}, of_guard,
                         board.next_latch_us());
        const auto hear = [&](const CanArrival& arrival, std::vector<CanFrame>& out) {
            sent = &out;
            guard.arrive(arrival);
        };
        const LoopGuard node{
            .on_frame = [&](const CanFrame& frame,
                            std::vector<CanFrame>& out) { hear({.frame = frame}, out); },
            .on_time =
                [&](std::int64_t now_us, std::vector<CanFrame>& out) {
                    out.insert(out.end(), first.begin(), first.end());
                    first.clear();
                    sent = &out;
                    guard.run_before(now_us + 1);
                },
            .on_echo =
                [&](const CanFrame& frame, std::vector<CanFrame>& out) {
                    hear({.frame = frame, .is_own = true}, out);
                },
            .next_due_us = [&] { return guard.next_due_us(); }};
        BusOptions bus;
        bus.permit_id = machine.can.permit_id;
        bus.heartbeat_id = machine.can.heartbeat_out_id;
        bus.period_us = machine.can.sample_us;
        bus.seed = seed + 1;
        WildLoop loop(board, bus, node, faults);
        loop.stop_id = machine.can.stop_id;
        const std::int64_t end_us = kBoardStartUs + 1'000'000;
        while (!board.is_at_rest() && board.next_latch_us() < end_us && loop.cycle()) {
            drain(*records);
        }
        drain(*records);
    }
    void note(const TimedCycle& cycle) {
        const CapOrder& order = cycle.result.result.cap_order;
        const AxisCaps before = caps_of_permit(order_.cap, order_.mask);
        const AxisCaps after = caps_of_permit(order.cap, order.mask);
        order_ = order;
        ++cycles;
        if (cycle.sent_permit) {
            ++permits;
            last_permit_us = cycle.result.latched_us;
            const bool is_raise = higher_caps(before, after) != before;
            const bool is_fall = higher_caps(before, after) != after;
            falls += is_fall ? 1 : 0;
            raises += is_raise ? 1 : 0;
            if (is_fall && !is_raise) {
                fell_.insert(cycle.result.latched_us);
            }
        }
    }
    void drain(BlackBoxQueue& records) {
        std::array<std::uint8_t, kBlackBoxRecordBytesMax> encoded;
        BlackBoxEntry entry;
        while (records.pop(entry)) {
            const auto* const query = std::get_if<LiveQuery>(&entry.content);
            if (query != nullptr && query->kind == LiveQuery::Kind::snapshot) {
                const AxisCaps ordered = caps_of_permit(order_.cap, order_.mask);
                lagging += higher_caps(ordered, query->caps.acked) != ordered ? 1 : 0;
            }
            frames += std::holds_alternative<SentFrame>(entry.content) ? 1 : 0;
            bytes_ += encode_black_box_record(entry, 0, encoded);
            entries_.push_back(entry);
        }
    }

    CompiledMachine loaded_;
    std::optional<CpuEngine> engine_;
    std::optional<ContainmentTest> containment_test_;
    std::vector<BlackBoxEntry> entries_;
    std::size_t bytes_ = 0;
    std::map<std::int64_t, Proven> proven_;  // by the sample's latch
    std::set<std::int64_t> fell_;            // samples at which the order fell, of no axis it rose
    CapOrder order_;
};

class CappedBlackBox : public testing::TestWithParam<CapPromise> {
  protected:
    /// Calls it with each run in which the axes moved for a while under permits.
    template <class Each>
    static void for_each_run(Each&& each) {
        const std::uint64_t seed = printed_seed(20261128);
        std::uint64_t runs = 0, permits = 0, falls = 0, raises = 0, lagging = 0;
        for (std::uint64_t i = 0; i < count_from_environment(kUsual) && !HasFailure(); ++i) {
            SCOPED_TRACE("seed " + std::to_string(seed + i));
            CappedRun run(GetParam(), seed + i);
            if (run.permits < 100) {
                continue;
            }
            ++runs;
            permits += run.permits;
            falls += run.falls;
            raises += run.raises;
            lagging += run.lagging;
            each(run);
        }
        std::printf(
            "runs %llu, permits %llu, orders that fall %llu, that rise %llu, samples "
            "whose ack lags %llu\n",
            static_cast<unsigned long long>(runs), static_cast<unsigned long long>(permits),
            static_cast<unsigned long long>(falls), static_cast<unsigned long long>(raises),
            static_cast<unsigned long long>(lagging));
        if (count_from_environment(kUsual) >= kUsual) {
            EXPECT_GT(runs, 2U) << "too few to tell anything";
            EXPECT_GT(falls, runs);
            EXPECT_GT(raises, 0U);
            EXPECT_GT(lagging, 10 * runs);
        }
    }
};

TEST_P(CappedBlackBox, FromTheStartEveryCycleAndFrameIsMadeAgain) {
    std::uint64_t other_frames = 0;
    for_each_run([&](CappedRun& run) {
        const Replayed whole = run.replay(1.5, 0);
        ASSERT_TRUE(whole.result.sent);
        EXPECT_EQ(whole.result.sent->different, 0U);
        EXPECT_EQ(whole.result.sent->same, run.frames);
        EXPECT_EQ(whole.result.snapshots.different + whole.result.snapshots.run_in, 0U);
        EXPECT_EQ(whole.result.verdicts.different + whole.result.verdicts.run_in, 0U);
        EXPECT_EQ(whole.result.verdicts.same, run.cycles);
        EXPECT_EQ(whole.compared, run.cycles);
        EXPECT_EQ(whole.other_boxes, 0U);
        EXPECT_TRUE(!whole.result.recorded || is_reproduced(whole.result));
        const Replayed without = run.replay(1.5, 0, Forgotten::acks);
        other_frames += without.result.sent ? without.result.sent->different : 0;
    });
    if (count_from_environment(kUsual) >= kUsual) {
        EXPECT_GT(other_frames, 0U) << "without the recorded acks it must differ";
    }
}

// CapControl waits 100 ms before it asks for a raise, and the permit ladder bars an n for 32
// cycles.
constexpr std::uint64_t kSettles = 150;

TEST_P(CappedBlackBox, FromLaterOnTheVerdictsAreTheSameAndThenTheBoxes) {
    std::uint64_t dumps = 0, compared = 0, known = 0, other_boxes = 0, other_without = 0;
    for_each_run([&](CappedRun& run) {
        for (const double share : {0.85, 0.6, 0.35}) {
            const Replayed later = run.replay(share, kSettles);
            // One that begins in a stop of the board's own does not know of that.
            if (later.begins_us > run.last_permit_us - 50'000) {
                continue;
            }
            SCOPED_TRACE("share " + std::to_string(share));
            ++dumps;
            compared += later.compared;
            EXPECT_FALSE(later.result.sent) << "it does not begin later";
            EXPECT_EQ(later.result.snapshots.different, 0U);
            EXPECT_EQ(later.result.verdicts.different, 0U);
            EXPECT_GT(later.result.verdicts.same, 0U);
            EXPECT_LT(later.result.verdicts.run_in, 30U);
            EXPECT_TRUE(!later.result.recorded || is_reproduced(later.result));
            other_boxes += later.other_boxes;
            EXPECT_EQ(later.other_known, 0U);
            known += later.compared_known;
            const Replayed without = run.replay(share, kSettles, Forgotten::orders);
            other_without += without.other_boxes;
        }
    });
    std::printf(
        "dumps %llu, cycles compared %llu, behind a fall %llu, with other boxes %llu; orders not "
        "taken over: "
        "%llu\n",
        static_cast<unsigned long long>(dumps), static_cast<unsigned long long>(compared),
        static_cast<unsigned long long>(known), static_cast<unsigned long long>(other_boxes),
        static_cast<unsigned long long>(other_without));
    EXPECT_LE(100 * other_boxes, compared);
    if (count_from_environment(kUsual) >= kUsual) {
        EXPECT_GT(known, 500U) << "too few to tell anything";
        EXPECT_GT(other_without, 0U) << "where orders are not taken over it must differ";
    }
}

INSTANTIATE_TEST_SUITE_P(OfCaps, CappedBlackBox,
                         testing::Values(CapPromise::all_axes, CapPromise::per_axis));

}  // namespace
}  // namespace axg::test
