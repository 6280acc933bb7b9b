// SPDX-License-Identifier: Apache-2.0
// A board on a bus that loses, delays, reorders, repeats and damages frames, holds them for whole
// laps, and plays them back after a power cycle: it may move only before t_k + n T of a permit that
// the guard sent for a sample of this session. By chance the answer of another session is right
// once in 65,536: with other seeds, one run in some hundreds may show it. The test knows every
// permit that was ever sent, and nothing of the rules by which the board refuses one.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <vector>

#include "tests/support/board_fixture.hpp"
#include "tests/support/count.hpp"
#include "tests/support/dice.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

using test::board_pair;
using test::BoardPermit;
using test::Dice;

struct Waiting {
    std::uint64_t at_us;
    axg_board_can_frame frame;
};

/// A run of the board between power-ups and armings.
struct Session {
    std::uint32_t nonce = 0;
    std::map<std::uint32_t, std::uint64_t> latched_us;  // by sample number
    std::set<std::uint64_t> ends_us;                    // of all permits sent for those samples
};

class Schedule {
  public:
    explicit Schedule(Dice& dice) : dice_(dice) {
        fixture_.options.cap_kind =
            dice.chance(0.5) ? AXG_BOARD_CAP_ENFORCED : AXG_BOARD_CAP_IGNORED;
        fixture_.options.permit_samples_max = static_cast<std::uint8_t>(whole(3, 15));
        power_up();
    }

    void run(int periods) {
        for (int i = 0; i < periods; ++i) {
            ++number_;
            now_us_ += 1000;
            if (!dice_.chance(0.01)) {
                latch();
            }
            send();
            if (dice_.chance(0.003)) {
                play_back();
            }
            if (dice_.chance(0.002)) {
                power_up();
            }
            if (dice_.chance(0.003)) {
                hold_us_ = now_us_ + (dice_.chance(0.3) ? 240'000 : whole(1000, 30'000));
            }
            deliver(now_us_ + 999);
            act(now_us_ + 999);
        }
    }

    int allowed = 0, used = 0, armed = 0;

  private:
    std::uint64_t whole(double low, double high) {
        return static_cast<std::uint64_t>(dice_.in(low, high + 1));
    }

    void power_up() {
        number_ = dice_.chance(0.5) ? 0 : 230;
        now_us_ += 50'000;
        session_ = {};
        (void)axg_board_power_up(&board(), &fixture_.options,
                                 static_cast<std::uint32_t>(whole(0, 0xFFFFFE)), now_us_);
        is_moving_ = false;
    }
    void arm(std::uint64_t at_us) {
        const auto nonce = static_cast<std::uint32_t>(whole(0, 0xFFFFFE));
        if (axg_board_arm(&board(), nonce, at_us) == AXG_BOARD_ARMING_DONE) {
            session_ = {};
            session_.nonce = nonce;
            ++armed;
        }
    }
    void latch() {
        const std::uint64_t at_us = now_us_ - whole(0, 20);
        if (fixture_.latch_at(number_, at_us)) {
            session_.latched_us[number_] = at_us;
        }
    }
    /// The guard answers a sample of this session; some of its permits are for older ones.
    void send() {
        const std::uint32_t back = dice_.chance(0.1) ? static_cast<std::uint32_t>(whole(0, 20)) : 0;
        BoardPermit permit{.number = number_ - std::min(number_, back),
                           .live = static_cast<std::uint8_t>(++live_),
                           .samples = static_cast<std::uint8_t>(whole(1, 15)),
                           .nonce = session_.nonce};
        if (dice_.chance(0.3)) {
            permit.cap = static_cast<std::uint8_t>(whole(0, 250));
            permit.mask = static_cast<std::uint8_t>(whole(0, 255));
        }
        const auto latched = session_.latched_us.find(permit.number);
        if (latched != session_.latched_us.end() &&
            permit.samples <= fixture_.options.permit_samples_max) {
            session_.ends_us.insert(latched->second + std::uint64_t{1000} * permit.samples);
        }
        std::uint64_t at_us = now_us_ + whole(100, 900);
        at_us += dice_.chance(0.05) ? whole(0, 20'000) : 0;
        for (axg_board_can_frame frame : board_pair(permit)) {
            recorded_.push_back(frame);
            at_us += whole(1, 60);
            if (dice_.chance(0.05)) {
                continue;
            }
            if (dice_.chance(0.01)) {
                frame.data[whole(0, 7)] ^= static_cast<std::uint8_t>(1U << whole(0, 7));
            }
            waiting_.push_back({at_us, frame});
            if (dice_.chance(0.01)) {
                waiting_.push_back({at_us + whole(0, 3000), frame});
            }
        }
    }
    /// What was on the bus at some time, once more.
    void play_back() {
        const std::size_t from = recorded_.size() - std::min<std::size_t>(recorded_.size(), 800);
        std::uint64_t at_us = now_us_ + whole(0, 1000);
        for (std::size_t i = from + whole(0, 200); i < recorded_.size(); ++i) {
            waiting_.push_back({at_us += whole(20, 400), recorded_[i]});
        }
    }
    void deliver(std::uint64_t until_us) {
        std::stable_sort(waiting_.begin(), waiting_.end(),
                         [](const Waiting& a, const Waiting& b) { return a.at_us < b.at_us; });
        if (until_us < hold_us_) {
            return;
        }
        std::size_t count = 0;
        for (; count < waiting_.size() && waiting_[count].at_us <= until_us; ++count) {
            const Waiting& one = waiting_[count];
            const std::uint64_t at_us = std::max(one.at_us, hold_us_);
            used += axg_board_frame(&board(), &one.frame, at_us) == AXG_BOARD_HEARD_PERMIT;
            expect_allowed(at_us);
        }
        waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(count));
    }
    void act(std::uint64_t at_us) {
        expect_allowed(at_us);
        const bool may = fixture_.may_move(at_us);
        if (is_moving_ != may && dice_.chance(0.5)) {
            is_moving_ = may;
            axg_board_moves(&board(), is_moving_, at_us);
        } else if (is_moving_ && dice_.chance(0.2)) {
            is_moving_ = false;
            axg_board_moves(&board(), false, at_us);
        }
        if (board().phase == AXG_BOARD_STOPPED && !is_moving_) {
            arm(at_us);
        }
        if (dice_.chance(0.3)) {
            axg_board_caps wanted{};
            std::fill(std::begin(wanted.of), std::end(wanted.of),
                      static_cast<std::uint8_t>(whole(0, 250)));
            (void)axg_board_keeps(&board(), &wanted, at_us);
        }
        if (dice_.chance(0.01)) {
            axg_board_change(&board(), false, at_us);
            session_.latched_us.clear();  // nothing of before is a reason to move
            session_.ends_us.clear();
        }
    }
    void expect_allowed(std::uint64_t at_us) {
        const axg_board_motion motion = axg_board_may_move(&board(), at_us);
        if (!motion.may_move) {
            return;
        }
        ++allowed;
        ASSERT_LT(at_us, motion.end_us);
        ASSERT_TRUE(session_.ends_us.contains(motion.end_us))
            << "at " << at_us << " until " << motion.end_us << ": no permit of this session";
    }
    axg_board& board() { return fixture_.board; }

    Dice& dice_;
    test::BoardFixture fixture_;
    Session session_;
    std::vector<Waiting> waiting_;
    std::vector<axg_board_can_frame> recorded_;
    std::uint64_t now_us_ = 0, hold_us_ = 0;
    std::uint32_t number_ = 0, live_ = 0;
    bool is_moving_ = false;
};

TEST(BoardSchedule, MotionEndsWithAPermitOfThisSession) {
    Dice dice(test::printed_seed(1));
    const std::uint64_t count = test::count_from_environment(200);
    int allowed = 0, used = 0, armed = 0;
    for (std::uint64_t i = 0; i < count && !HasFatalFailure(); ++i) {
        Schedule schedule(dice);
        schedule.run(1500);
        allowed += schedule.allowed;
        used += schedule.used;
        armed += schedule.armed;
    }
    std::printf("%d permits used, %d instants of motion, armed %d times\n", used, allowed, armed);
    EXPECT_GT(used, 100 * static_cast<int>(count));
    EXPECT_GT(allowed, 100 * static_cast<int>(count));
}

}  // namespace
}  // namespace axg
