// SPDX-License-Identifier: Apache-2.0
// Every row of the fault tables that frames, a wire, an engine and a process can have, at random
// moments, and a guard that may never let one pass: what leaves on the wire is judged against the
// row's bound. Healthy periods between must have their permits, so that silence is no way to pass.
// AXG_COUNT: faults; AXG_SEED: which. Prints the table of docs/measurements/live-faults.md.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <random>
#include <string>

#include "tests/support/count.hpp"
#include "tests/support/fault_scene.hpp"
#include "tests/support/input_faults.hpp"
#include "tests/support/live_world.hpp"
#include "tests/support/output_faults.hpp"
#include "tests/support/seed.hpp"

namespace axg::test {
namespace {

struct Tally {
    std::uint64_t injected = 0, applied = 0, seen = 0, missed = 0, late = 0, false_stops = 0;
    // After the first effect: the stop, the last permit; of faults that are borne, the longest time
    // without a permit.
    std::int64_t stop_us = INT64_MIN, permit_us = INT64_MIN, without_us = 0;
};

// Of permit 2, once after a stop.
constexpr std::uint8_t kStopWord = 0x5A, kStopWordInverted = 0xA5;

/// What left on the wire since the fault was set up.
struct Sent {
    std::int64_t first_stop_us = INT64_MAX, last_permit_us = INT64_MIN, without_us = 0;
    bool has_permit_after_stop = false;
};
Sent sent_since(const LiveWorld& world, std::size_t first, std::int64_t from_us) {
    const CanLayout& can = world.machine.can;
    Sent out;
    std::int64_t last_us = from_us;
    for (std::size_t i = first; i < world.wire.sent.size(); ++i) {
        const CanFrame& frame = world.wire.sent[i];
        const bool is_permit =
            (frame.id == can.permit_id && frame.data[0] != kStopWord) ||
            (frame.id == can.permit_id + 1 && frame.data[0] != kStopWordInverted);
        if (frame.id == can.stop_id && out.first_stop_us == INT64_MAX) {
            out.first_stop_us = frame.time_us;
        }
        if (is_permit) {
            out.has_permit_after_stop |= out.first_stop_us != INT64_MAX;
            out.last_permit_us = frame.time_us;
            out.without_us = std::max(out.without_us, frame.time_us - last_us);
            last_us = frame.time_us;
        }
    }
    out.without_us = std::max(out.without_us, world.wire.now_us - last_us);
    return out;
}

class Campaign {
  public:
    explicit Campaign(std::uint64_t seed) : random_(seed) {}

    /// One guard from its start to a fault, and on for some periods; then the fault is gone.
    void run(const LiveFaultRow& row, Tally& tally) {
        LatchCell latch{kLatchClear, ~kLatchClear};
        LiveWorld world(format_for(row), latch);
        FaultScene scene{.world = world, .random = random_};
        if (row.prepare != nullptr) {
            row.prepare(scene);
        }
        world.start();
        tally.false_stops += runs_healthy(world) ? 0U : 1U;
        scene.before = world.guard->receiver().counters();
        const std::size_t first = world.wire.sent.size();
        const std::int64_t set_us = world.wire.now_us;
        ++tally.injected;
        row.inject(scene);
        world.run_periods(row.periods);
        judge(scene, row, first, set_us, tally);
        cycles += world.samples();
    }

    std::uint64_t cycles = 0;

  private:
    std::uint32_t draw(std::uint32_t below) {
        return std::uniform_int_distribution<std::uint32_t>(0, below - 1)(random_);
    }
    CanFormat format_for(const LiveFaultRow& row) {
        using enum LiveFaultRow::For;
        const bool is_fd = row.format == fd || (row.format == every_format && draw(2) == 0);
        return is_fd ? CanFormat::fd : CanFormat::classical;
    }
    /// Armed, and a permit in every period; ends at a random instant of one.
    bool runs_healthy(LiveWorld& world) {
        world.run_to_armed();
        const std::int64_t armed_us = world.wire.now_us;
        world.run_periods(10 + draw(40));
        world.run_until(world.wire.now_us + draw(20) * LiveWorld::kStepUs);
        const auto periods =
            static_cast<std::size_t>((world.wire.now_us - armed_us) / world.machine.can.sample_us);
        return world.guard->guard().phase == GuardPhase::armed &&
               world.count_sent(world.machine.can.permit_id, armed_us) + 2 >= periods;
    }
    static void heal(LiveWorld& world) {
        world.alters = [](std::vector<CanFrame>&) {};
        world.says = [](AxisSnapshot&) {};
        world.verdict = [](std::uint64_t) {
            return CycleResult{.has_permit = true, .known_answer_signature = kKnownAnswerSignature};
        };
        world.engine_runs = true;
        world.has_second_board = false;
        world.wire.is_deaf = false;
        world.wire.echo_us = 150;
        world.wire.reply = SendStatus::ok;
    }
    static bool is_stopped(const LiveWorld& world) {
        return world.guard->guard().phase == GuardPhase::stopped && is_latched(world.latch);
    }

    void judge(FaultScene& scene, const LiveFaultRow& row, std::size_t first, std::int64_t set_us,
               Tally& tally) {
        LiveWorld& world = scene.world;
        const bool stops = is_stopped(world);
        const Sent then = sent_since(world, first, set_us);
        tally.applied += scene.applied > 0 ? 1U : 0U;
        tally.seen += row.is_seen != nullptr && row.is_seen(scene) ? 1U : 0U;
        if (row.reaction == Reaction::borne || (row.reaction == Reaction::either && !stops)) {
            const bool is_armed = world.guard->guard().phase == GuardPhase::armed;
            tally.false_stops += !is_armed || then.without_us > permit_valid_us(world) ? 1U : 0U;
            tally.without_us = std::max(tally.without_us, then.without_us);
            return;
        }
        heal(world);
        world.run_periods(5);
        const Sent all = sent_since(world, first, set_us);
        if (row.reaction == Reaction::unarmed) {
            tally.missed += all.last_permit_us != INT64_MIN ? 1U : 0U;
            return;
        }
        tally.missed += !stops || !is_stopped(world) || all.has_permit_after_stop ? 1U : 0U;
        const bool has_stop = then.first_stop_us != INT64_MAX;
        const bool is_stop_late = row.reaction != Reaction::mute &&
                                  (!has_stop || then.first_stop_us > scene.first_us + row.limit_us);
        const bool is_permit_late = all.last_permit_us > scene.first_us + row.limit_us;
        tally.late += is_stop_late || is_permit_late ? 1U : 0U;
        if (has_stop) {
            tally.stop_us = std::max(tally.stop_us, then.first_stop_us - scene.first_us);
        }
        if (all.last_permit_us != INT64_MIN) {
            tally.permit_us = std::max(tally.permit_us, all.last_permit_us - scene.first_us);
        }
    }
    static std::int64_t permit_valid_us(const LiveWorld& world) {
        return std::int64_t{world.machine.can.permit_samples.most} * world.machine.can.sample_us;
    }

    std::mt19937_64 random_;
};

/// Empty: nothing left after the first effect.
std::string time_text(std::int64_t time_us) {
    return time_us < 0 ? "" : std::to_string(time_us);
}

void print(const LiveFaultRow& row, const Tally& tally) {
    const bool is_borne = row.reaction == Reaction::borne;
    const auto count = [](std::uint64_t n) { return static_cast<unsigned long long>(n); };
    std::printf("| %s | %s | %llu | %llu | %s | %llu | %llu | %s | %s | %s |\n", row.id, row.what,
                count(tally.injected), count(tally.applied),
                row.is_seen == nullptr ? "" : std::to_string(tally.seen).c_str(),
                count(tally.missed), count(tally.late), time_text(tally.stop_us).c_str(),
                time_text(tally.permit_us).c_str(),
                is_borne ? std::to_string(tally.without_us).c_str() : "");
}

TEST(GuardNodeProperty, NoFaultIsFollowedByAPermit) {
    Campaign campaign(printed_seed(20261121));
    std::vector<LiveFaultRow> rows;
    const auto add = [&rows](const auto& more) {
        rows.insert(rows.end(), more.begin(), more.end());
    };
    add(kLostRows), add(kFrameRows), add(kShapeRows), add(kControllerRows), add(kAxisRows);
    add(kOutputRows), add(kProcessRows);
    std::vector<Tally> tallies(rows.size());
    const std::uint64_t count = count_from_environment(16 * 1000);
    for (std::uint64_t i = 0; i < count; ++i) {
        campaign.run(rows[i % rows.size()], tallies[i % rows.size()]);
    }
    std::printf(
        "| row | fault | injected | applied | detected | missed | late | stop us |"
        " last permit us | without us |\n|---|---|---|---|---|---|---|---|---|---|\n");
    std::uint64_t false_stops = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const LiveFaultRow& row = rows[i];
        const Tally& tally = tallies[i];
        print(row, tally);
        false_stops += tally.false_stops;
        EXPECT_EQ(tally.applied, tally.injected) << row.id << ' ' << row.what;
        EXPECT_TRUE(row.is_seen == nullptr || tally.seen == tally.injected)
            << row.id << ' ' << row.what;
        EXPECT_EQ(tally.missed, 0U) << row.id << ' ' << row.what;
        EXPECT_EQ(tally.late, 0U) << row.id << ' ' << row.what;
        EXPECT_EQ(tally.false_stops, 0U) << row.id << ' ' << row.what;
    }
    std::printf("%zu rows, %llu faults, %llu cycles, %llu false stops\n", rows.size(),
                static_cast<unsigned long long>(count),
                static_cast<unsigned long long>(campaign.cycles),
                static_cast<unsigned long long>(false_stops));
}

// Two samples lost in a row are older than the usual three periods before the next one is complete,
// and stop; a permit of four periods bears them (docs/guide/live.md).
TEST(GuardNodeProperty, OneFrameLostInAThousandStopsNothingWithPermitsOfFourPeriods) {
    std::mt19937_64 random(printed_seed(20261122));
    const std::uint64_t periods = count_from_environment(200'000);
    for (const CanFormat format : {CanFormat::classical, CanFormat::fd}) {
        LatchCell latch{kLatchClear, ~kLatchClear};
        LiveWorld world(format, latch);
        world.machine.can.permit_samples = {4, 4};
        world.machine.can.stale_after_us = 4 * world.machine.can.sample_us;
        world.start();
        std::uint64_t lost = 0;
        world.passes = [&](const CanFrame&) {
            const bool is_lost = random() % 1000 == 0;
            lost += is_lost ? 1U : 0U;
            return !is_lost;
        };
        world.run_to_armed();
        const std::uint64_t before = world.guard->counters().permits;
        for (std::uint64_t done = 0; done < periods; done += 1000) {
            world.run_periods(1000);
            world.wire.sent.clear();  // nobody reads them
        }
        const std::uint64_t permits = world.guard->counters().permits - before;
        EXPECT_EQ(world.guard->guard().phase, GuardPhase::armed)
            << to_text(world.guard->guard().cause);
        EXPECT_GE(permits + 2 * lost + 2, periods);
        EXPECT_TRUE(periods < 20'000 || lost > 20) << "nothing was lost: this shows nothing";
        std::printf("%llu periods, %llu frames lost, %llu permits\n",
                    static_cast<unsigned long long>(periods), static_cast<unsigned long long>(lost),
                    static_cast<unsigned long long>(permits));
    }
}

}  // namespace
}  // namespace axg::test
