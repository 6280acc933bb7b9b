// SPDX-License-Identifier: Apache-2.0
// Boards that say right hashes, wrong ones, nothing, damaged frames, at random and with frames
// lost: no permit leaves before all four were heard as they should be since the last start, and
// none after one that was different. A board that says all of them is permitted in the end.
#include <gtest/gtest.h>

#include <random>

#include "tests/support/count.hpp"
#include "tests/support/live_world.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

class Board {
  public:
    Board(test::LiveWorld& world, std::mt19937_64& random) : world_(world), random_(random) {
        wrong_share_ = random() % 3 == 0 ? 0.02 : 0;
        silent_part_ = random() % 4 == 0 ? random() % kHashParts : kHashParts;
        lost_share_ = random() % 2 == 0 ? 0.3 : 0;
        damaged_share_ = random() % 2 == 0 ? 0.3 : 0;
        world.says_hash = [this](HashFrame& hash) { return answer(hash); };
    }
    [[nodiscard]] bool has_said_all() const { return right_ == (1U << kHashParts) - 1U; }
    [[nodiscard]] bool was_wrong() const { return was_wrong_; }
    [[nodiscard]] bool is_silent() const { return silent_part_ < kHashParts; }

    /// Now and then by itself, as a board whose tables were changed, or a frame that is none.
    void send_unasked() {
        if (draw() < damaged_share_ * 0.2) {
            CanFrame frame = encode_hash(world_.machine.can.hashes_in_id,
                                         {.part = part(), .hash = 77}, world_.wire.now_us);
            frame.data[1 + random_() % 3] ^= static_cast<std::uint8_t>(1 + random_() % 255);
            world_.wire.arrive(frame);
        }
    }

  private:
    double draw() { return static_cast<double>(random_() >> 11U) * 0x1p-53; }
    std::uint8_t part() { return static_cast<std::uint8_t>(random_() % kHashParts); }
    bool answer(HashFrame& hash) {
        if (hash.part == silent_part_ || draw() < lost_share_) {
            return false;
        }
        hash.hash = world_.options.hashes.of[hash.part];
        if (draw() < wrong_share_) {
            hash.hash ^= 1U << random_() % 32;
            was_wrong_ = true;
        } else {
            right_ |= 1U << hash.part;
        }
        return true;
    }

    test::LiveWorld& world_;
    std::mt19937_64& random_;
    double wrong_share_, lost_share_, damaged_share_;
    std::uint64_t silent_part_;
    std::uint32_t right_ = 0;
    bool was_wrong_ = false;
};

TEST(HandshakeProperty, NoPermitBeforeAllHashesAreTheSameAndNoneAfterADifference) {
    std::mt19937_64 random(test::printed_seed(20261125));
    const std::uint64_t count = test::count_from_environment(300);
    std::uint64_t armed = 0, wrong = 0, silent = 0;
    for (std::uint64_t i = 0; i < count && !testing::Test::HasFailure(); ++i) {
        LatchCell latch{kLatchClear, ~kLatchClear};
        test::LiveWorld world(random() % 2 == 0 ? CanFormat::classical : CanFormat::fd, latch);
        world.machine.can.hashes_in_id = 0x582;
        world.machine.can.hashes_out_id = 0x602;
        for (std::uint32_t& hash : world.options.hashes.of) {
            hash = static_cast<std::uint32_t>(random());
        }
        Board board(world, random);
        world.start();
        for (int period = 0; period < 300; ++period) {
            board.send_unasked();
            world.run_periods(1);
            world.guard->arm(world.wire.now_us);
            const std::size_t permits = world.count_permits();
            ASSERT_TRUE(permits == 0 || board.has_said_all()) << "case " << i;
            if (board.was_wrong()) {
                world.run_periods(2);  // what was on its way
                const std::int64_t from_us = world.wire.now_us;
                world.run_periods(20);
                ASSERT_EQ(world.guard->guard().phase, GuardPhase::stopped) << "case " << i;
                ASSERT_EQ(world.count_permits(from_us), 0U);
                break;
            }
        }
        wrong += board.was_wrong() ? 1U : 0U;
        silent += board.is_silent() ? 1U : 0U;
        const bool is_armed = world.guard->guard().phase == GuardPhase::armed;
        armed += is_armed ? 1U : 0U;
        ASSERT_TRUE(is_armed || board.was_wrong() || board.is_silent())
            << "case " << i << ": a board that said everything right was never permitted";
    }
    std::printf("%llu boards: %llu permitted, %llu wrong, %llu silent\n",
                static_cast<unsigned long long>(count), static_cast<unsigned long long>(armed),
                static_cast<unsigned long long>(wrong), static_cast<unsigned long long>(silent));
    if (count >= 100) {  // or too few were drawn to tell anything
        EXPECT_GT(armed, count / 4);
        EXPECT_GT(wrong, 0U);
        EXPECT_GT(silent, count / 10);
    }
}

}  // namespace
}  // namespace axg
