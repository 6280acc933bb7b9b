// SPDX-License-Identifier: Apache-2.0
// The library for boards, which slows its axes as slowly as it likes, and a guard that loses,
// delays and reorders permits with any caps: whatever permit the board stands on, no axis was ever
// faster since its sample than what the guard's proof for that permit took for granted.
// AXG_COUNT: runs of 2,000 periods.
#include "core/guard/ack_ledger.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "tests/support/board_fixture.hpp"
#include "tests/support/count.hpp"
#include "tests/support/dice.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

using test::BoardFixture;
using test::Dice;

constexpr std::uint32_t kPeriods = 2000;
constexpr std::uint64_t kTickUs = 250, kPeriodUs = 1000;
constexpr std::size_t kGroups = AXG_BOARD_CAP_GROUPS;

/// What the guard takes for granted of the caps that a sample acknowledges.
enum class Belief {
    ledger,
    newest,   // the newest permit with the nibble
    ordered,  // the order is in force as soon as it is sent
};

struct Waiting {
    std::uint64_t at_us;
    std::array<axg_board_can_frame, 2> pair;
};

struct SampleBound {
    AxisCaps proven{};   // V
    AxisCaps highest{};  // of what the board kept since the latch
};

struct Tally {
    std::uint64_t standing = 0, broken = 0, unknown = 0, lowered = 0, stops = 0, behind_most = 0;
};

class Run {
  public:
    Run(Dice& dice, Belief belief, Tally& tally) : dice_(dice), belief_(belief), tally_(tally) {
        samples_ = static_cast<std::uint8_t>(dice_.in(3, 16));
        fall_ = dice_.magnitude(0.5, 30);  // 250 in 8 to 500 periods
        (void)axg_board_power_up(&board(), &fixture_.options, 1, 0);
        arm(BoardFixture::instant_of(0) - kPeriodUs);
    }

    void go() {
        for (number_ = 0; number_ < kPeriods; ++number_) {
            const std::uint64_t latched_us = BoardFixture::instant_of(number_);
            (void)fixture_.latch(number_);
            bounds_[number_].highest = keeps();
            bounds_.erase(bounds_.begin(), bounds_.lower_bound(number_ < 40 ? 0 : number_ - 40));
            answer(latched_us);
            for (std::uint64_t at_us = latched_us; at_us < latched_us + kPeriodUs;
                 at_us += kTickUs) {
                deliver(at_us);
                act(at_us);
                judge(at_us);
            }
        }
    }

  private:
    axg_board& board() { return fixture_.board; }
    [[nodiscard]] AxisCaps keeps() {
        AxisCaps caps{};
        for (std::size_t axis = 0; axis < caps.size(); ++axis) {
            caps[axis] = board().keeps.of[std::min(axis, kGroups - 1)];
        }
        return caps;
    }
    void arm(std::uint64_t at_us) {
        if (axg_board_arm(&board(), ++nonce_, at_us) == AXG_BOARD_ARMING_DONE) {
            ledger_.clear();
            sent_.clear();
        }
    }

    /// Mostly as it was; now and then down at once, or up by a step, or all axes free.
    void draw_order() {
        if (dice_.chance(0.01)) {
            cap_ = static_cast<std::uint8_t>(dice_.in(0, 251));
            mask_ = static_cast<std::uint8_t>(dice_.chance(0.5) ? 255 : dice_.in(0, 256));
        } else if (dice_.chance(0.1)) {
            cap_ = static_cast<std::uint8_t>(std::min(250, cap_ + std::max(1, cap_ / 32)));
        }
    }
    [[nodiscard]] AxisCaps believed(std::optional<std::uint8_t> nibble) {
        const AckedCaps acked = ledger_.note_ack(nibble);
        tally_.unknown += acked.status == AckStatus::unknown ? 1 : 0;
        tally_.behind_most = std::max(tally_.behind_most, ledger_.behind());
        if (belief_ == Belief::ledger || !nibble) {
            return acked.caps;
        }
        const auto newest =
            std::find_if(sent_.rbegin(), sent_.rend(),
                         [nibble](const auto& permit) { return (permit.first & 15U) == *nibble; });
        return belief_ == Belief::ordered || newest == sent_.rend() ? AxisCaps{} : newest->second;
    }
    void answer(std::uint64_t latched_us) {
        axg_board_says says{};
        says.mode = 1;
        const std::uint8_t flags = axg_board_flags(&board(), &says);
        std::optional<std::uint8_t> nibble;
        if ((flags & 4U) != 0) {
            nibble = static_cast<std::uint8_t>(flags >> 4U);
        }
        const AxisCaps acked = believed(nibble);
        draw_order();
        const AxisCaps caps = caps_of_permit(cap_, mask_);
        bounds_[number_].proven = higher_caps(acked, caps);
        tally_.lowered += acked[0] < kCapRapid ? 1 : 0;
        ledger_.note_sent(++live_, caps);
        sent_.emplace_back(live_, caps);
        if (!dice_.chance(0.2)) {
            const bool is_late = dice_.chance(0.1);
            const double delay_us = dice_.in(100, 900) + (is_late ? dice_.in(0, 9000) : 0);
            const test::BoardPermit permit{.number = number_,
                                           .live = live_,
                                           .cap = cap_,
                                           .mask = mask_,
                                           .samples = samples_,
                                           .nonce = nonce_};
            waiting_.push_back(
                {latched_us + static_cast<std::uint64_t>(delay_us), test::board_pair(permit)});
        }
    }
    void deliver(std::uint64_t until_us) {
        std::stable_sort(waiting_.begin(), waiting_.end(),
                         [](const Waiting& a, const Waiting& b) { return a.at_us < b.at_us; });
        while (!waiting_.empty() && waiting_.front().at_us <= until_us) {
            for (const axg_board_can_frame& frame : waiting_.front().pair) {
                (void)axg_board_frame(&board(), &frame, until_us);
            }
            waiting_.pop_front();
        }
    }
    /// Down as fast as the axes can; up as far as the library lets it.
    void act(std::uint64_t at_us) {
        const axg_board_motion motion = axg_board_may_move(&board(), at_us);
        if (board().phase == AXG_BOARD_STOPPED) {
            tally_.stops += board().moves ? 1 : 0;
            axg_board_moves(&board(), false, at_us);
            arm(at_us);
        } else if (motion.may_move && !board().moves) {
            axg_board_moves(&board(), true, at_us);
        }
        axg_board_caps wanted = motion.ordered;
        for (std::size_t i = 0; i < kGroups; ++i) {
            fallen_[i] = std::max<double>(
                motion.ordered.of[i],
                std::min<double>(fallen_[i], motion.keeps.of[i]) - fall_ * kTickUs / kPeriodUs);
            if (motion.ordered.of[i] < motion.keeps.of[i]) {
                wanted.of[i] = static_cast<std::uint8_t>(std::ceil(fallen_[i]));
            } else {
                fallen_[i] = kCapRapid;
            }
        }
        (void)axg_board_keeps(&board(), &wanted, at_us);
        const AxisCaps now = keeps();
        for (auto& [number, bound] : bounds_) {
            bound.highest = higher_caps(bound.highest, now);
        }
    }
    void judge(std::uint64_t at_us) {
        const axg_board_motion motion = axg_board_may_move(&board(), at_us);
        if (!motion.may_move) {
            return;
        }
        ++tally_.standing;
        const std::uint64_t latched_us = motion.end_us - kPeriodUs * samples_;
        const auto number =
            static_cast<std::uint32_t>((latched_us - BoardFixture::instant_of(0)) / kPeriodUs);
        const auto bound = bounds_.find(number);
        ASSERT_NE(bound, bounds_.end());
        const AxisCaps& proven = bound->second.proven;
        tally_.broken += higher_caps(bound->second.highest, proven) == proven ? 0 : 1;
    }

    Dice& dice_;
    Belief belief_;
    Tally& tally_;
    BoardFixture fixture_{AXG_BOARD_CAP_ENFORCED};
    AckLedger ledger_;
    std::map<std::uint32_t, SampleBound> bounds_;  // the last 40 samples, by number
    std::vector<std::pair<std::uint8_t, AxisCaps>> sent_;
    std::deque<Waiting> waiting_;
    std::array<double, kGroups> fallen_{};
    double fall_ = 1;
    std::uint32_t number_ = 0, nonce_ = 0xC0FFEE;
    std::uint8_t samples_ = 10, live_ = 0, cap_ = kCapRapid, mask_ = 255;
};

Tally run_all(Belief belief, std::uint64_t count, Dice& dice) {
    Tally tally;
    for (std::uint64_t i = 0; i < count; ++i) {
        Run(dice, belief, tally).go();
    }
    std::printf(
        "%llu ticks on a permit, %llu faster than proven; %llu stops, %llu samples with a "
        "bound, up to %llu permits behind\n",
        static_cast<unsigned long long>(tally.standing),
        static_cast<unsigned long long>(tally.broken), static_cast<unsigned long long>(tally.stops),
        static_cast<unsigned long long>(tally.lowered),
        static_cast<unsigned long long>(tally.behind_most));
    return tally;
}

TEST(AckLedgerProperty, NoAxisIsEverFasterThanProven) {
    Dice dice(test::printed_seed(27));
    const std::uint64_t count = test::count_from_environment(100);
    const Tally tally = run_all(Belief::ledger, count, dice);
    EXPECT_EQ(tally.broken, 0U);
    EXPECT_EQ(tally.unknown, 0U);
    EXPECT_GT(tally.standing, 1000 * count);
    EXPECT_GT(tally.lowered, 100 * count);
}

// Ablations.
TEST(AckLedgerProperty, TheNewestPermitWithTheNibbleIsNotTheOneThatIsKept) {
    Dice dice(test::printed_seed(28));
    EXPECT_GT(run_all(Belief::newest, 20, dice).broken, 0U);
}
TEST(AckLedgerProperty, AnOrderIsNotInForceBeforeItsAck) {
    Dice dice(test::printed_seed(29));
    EXPECT_GT(run_all(Belief::ordered, 20, dice).broken, 0U);
}

}  // namespace
}  // namespace axg
