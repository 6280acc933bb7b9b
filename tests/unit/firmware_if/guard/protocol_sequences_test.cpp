// SPDX-License-Identifier: Apache-2.0
// What docs/reference/protocol.md says of the order of the guard's frames, and of the code that
// each stop has: the deployed guard runs, and what leaves is compared with the page, byte by byte.
#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>

#include "tests/support/live_world.hpp"
#include "tests/support/page_text.hpp"
#include "tests/support/timed_world.hpp"

namespace axg {
namespace {

using test::LiveWorld;
using test::page_bytes;
using test::page_of;
using test::TimedWorld;
using Texts = std::vector<std::string>;

constexpr std::uint32_t kFirstDrive = 0x303, kSecondDrive = 0x304;
constexpr std::int64_t kHeartbeatUs = 10'000;

Texts page_sequence(const std::string& name) {
    const auto blocks = test::blocks_of(page_of("reference/protocol.md"), "sequence " + name);
    EXPECT_EQ(blocks.size(), 1U) << name;
    Texts bytes;
    for (const test::FrameLine& line : test::frame_lines(blocks.empty() ? "" : blocks[0])) {
        bytes.push_back(line.bytes);
    }
    return bytes;
}

/// The page leaves out what has a pace of its own: hints, and the status for an operator.
std::vector<CanFrame> without_displays(const std::vector<CanFrame>& frames) {
    std::vector<CanFrame> out;
    std::copy_if(frames.begin(), frames.end(), std::back_inserter(out), [](const CanFrame& frame) {
        return frame.id != CanLayout{}.hints_id && frame.id != CanLayout{}.operator_out_id;
    });
    return out;
}

/// As the page lists them: a frame that is the same as the one before is its repetition.
Texts sequence_of(const std::vector<CanFrame>& frames) {
    Texts bytes;
    for (const CanFrame& frame : without_displays(frames)) {
        const std::string text = page_bytes(frame);
        if (bytes.empty() || bytes.back() != text) {
            bytes.push_back(text);
        }
    }
    return bytes;
}

std::vector<CanFrame> since(const std::vector<CanFrame>& frames, std::int64_t from_us) {
    std::vector<CanFrame> out;
    std::copy_if(frames.begin(), frames.end(), std::back_inserter(out),
                 [from_us](const CanFrame& frame) { return frame.time_us >= from_us; });
    return out;
}

// As the page has them in its section on hashes.
constexpr ConfigurationHashes kHashes{{0xD6E7F809, 0x1A2B3C4D, 0x5E6F7081, 0x92A3B4C5}};

/// What a machine file gets where nobody states it.
void set_defaults(CanLayout& can) {
    can.hashes_in_id = 0x582;
    can.hashes_out_id = 0x602;
    can.quick_stop_ids = {kFirstDrive, kSecondDrive};
}

/// A guard with two quick stops, and a wire that gives each frame back after 0.1 ms.
void start(TimedWorld& world) {
    set_defaults(world.machine.can);
    world.options.guard.hashes = kHashes;
    world.options.echoes = false;
    world.options.arm_from_us = TimedWorld::kBeginUs + 63'000;
    world.start();
}

/// Runs until it is stopped by an engine that no longer knows the known answers.
void run_to_stop(TimedWorld& world) {
    start(world);
    world.run_samples(100);
    ASSERT_EQ(world.phase(), GuardPhase::armed) << to_text(world.cause());
    world.answers.is_well = false;
    world.run_samples(1);
    ASSERT_EQ(world.phase(), GuardPhase::stopped);
}

TEST(ProtocolSequences, FromTheStartToThePermits) {
    TimedWorld world;
    start(world);
    const CanLayout& can = world.machine.can;
    while (world.with_id(can.permit_id + 1).size() < 2 && world.newest_us() < 1'500'000) {
        world.run_samples(1);
        world.run_before(world.newest_us() + 990);
    }
    EXPECT_EQ(sequence_of(world.sent), page_sequence("start"));
    const auto permits = world.with_id(can.permit_id), inverses = world.with_id(can.permit_id + 1);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(inverses[i].time_us - permits[i].time_us, world.echo_us)
            << "as soon as the permit was seen";
    }
    const auto heartbeats = world.with_id(can.heartbeat_out_id);
    for (std::size_t i = 1; i < heartbeats.size(); ++i) {
        const std::int64_t pause_us = heartbeats[i].time_us - heartbeats[i - 1].time_us;
        if (heartbeats[i].data[0] == heartbeats[i - 1].data[0]) {
            EXPECT_NEAR(static_cast<double>(pause_us), kHeartbeatUs, 100) << "hashes are in flight";
        } else {
            EXPECT_LE(pause_us, kHeartbeatUs) << "at once";
        }
    }
}

TEST(ProtocolSequences, AStopAndItsRepetitionUntilTheBoardConfirms) {
    TimedWorld world;
    run_to_stop(world);
    const CanLayout& can = world.machine.can;
    const std::int64_t stop_us = world.with_id(can.stop_id).front().time_us;
    world.run_samples(200);
    const std::vector<CanFrame> sent = without_displays(since(world.sent, stop_us));
    const Texts shown = page_sequence("stop");
    ASSERT_GE(sent.size(), shown.size());
    Texts begin;
    for (std::size_t i = 0; i < shown.size(); ++i) {
        begin.push_back(page_bytes(sent[i]));
    }
    EXPECT_EQ(begin, shown);
    EXPECT_LE(sent[3].time_us - stop_us, world.echo_us) << "the word stop after the stop's echo";
    EXPECT_LE(sent[5].time_us - stop_us, 3 * world.echo_us) << "the emergency after its inverse";
    EXPECT_LE(sent[6].time_us - stop_us, 4 * world.echo_us) << "the heartbeat after that";
    EXPECT_EQ(world.with_id(can.emergency_id).size(), 1U) << "once";
    const auto stops = world.with_id(can.stop_id);
    EXPECT_NEAR(static_cast<double>(stops.size()), 200, 2) << "each period";
    for (std::size_t i = 1; i < stops.size(); ++i) {
        const std::int64_t pause_us = stops[i].time_us - stops[i - 1].time_us;
        EXPECT_LE(pause_us, can.sample_us + can.sample_us / 50);
    }
    for (std::size_t i = 0; i < sent.size(); ++i) {
        if (sent[i].id == can.stop_id && i + 2 < sent.size()) {
            EXPECT_EQ(sent[i + 1].id, kFirstDrive);
            EXPECT_EQ(sent[i + 2].id, kSecondDrive);
        }
    }
}

TEST(ProtocolSequences, TheStopEndsWhenTheBoardStands) {
    TimedWorld world;
    run_to_stop(world);
    world.run_samples(20);
    world.stands_still = true;
    world.run_samples(150);
    const std::int64_t confirmed_us = world.guard->now_us() + 1;
    world.run_samples(100);
    const auto sent = without_displays(since(world.sent, confirmed_us));
    EXPECT_EQ(sequence_of(sent), page_sequence("confirmed"));
    EXPECT_NEAR(static_cast<double>(sent.size()), 10, 1);
}

// The page's table of what confirms: in no format anything that a moving machine sends.
TEST(ProtocolSequences, NothingConfirmsAStopOfAMovingMachine) {
    for (const CanFormat format :
         {CanFormat::classical, CanFormat::fd, CanFormat::signals, CanFormat::cia402}) {
        TimedWorld world(format);
        run_to_stop(world);
        world.run_samples(50);
        const std::size_t stops = world.with_id(world.machine.can.stop_id).size();
        EXPECT_EQ(world.with_id(kFirstDrive).size(), stops);
        EXPECT_NEAR(static_cast<double>(stops), 50, 2);
    }
}

class ProtocolWorld {
  public:
    explicit ProtocolWorld(LatchCell stored = {kLatchClear, ~kLatchClear}) : latch(stored) {
        set_defaults(world.machine.can);
        world.options.hashes = kHashes;
        world.wire.sent.clear();
        world.start();
    }
    /// Once the hashes are compared.
    void run_to_armed() {
        world.run_periods(20);
        world.run_to_armed();
    }
    LatchCell latch;
    LiveWorld world{CanFormat::classical, latch};
};

TEST(ProtocolSequences, AResetSaysThatTheCauseIsGone) {
    ProtocolWorld made;
    LiveWorld& world = made.world;
    made.run_to_armed();
    world.run_periods(20);
    world.guard->report(GuardFault::gap, world.wire.now_us);
    world.stands_still = true;
    world.run_periods(world.kStandPeriods);
    const std::int64_t from_us = world.wire.now_us;
    world.guard->reset(from_us);
    world.run_periods(40);
    EXPECT_EQ(world.guard->guard().phase, GuardPhase::ready);
    EXPECT_EQ(sequence_of(since(world.wire.sent, from_us)), page_sequence("reset"));
}

TEST(ProtocolSequences, AStoredStopIsSentFromTheStart) {
    ProtocolWorld made({0, 0});
    made.world.run_periods(30);
    const Texts shown = page_sequence("latched");
    Texts begin;
    for (const CanFrame& frame : without_displays(made.world.wire.sent)) {
        begin.push_back(page_bytes(frame));
    }
    ASSERT_GE(begin.size(), shown.size());
    begin.resize(shown.size());
    EXPECT_EQ(begin, shown);
    EXPECT_EQ(made.world.count_sent(made.world.machine.can.emergency_id), 0U);
}

// The block of the section on hashes: what is asked, in this order, one every 10 ms.
TEST(ProtocolSequences, HashesAreAskedInTheOrderOfThePage) {
    Texts asked;
    ConfigurationHashes hashes;
    const std::regex words("hash asked: part = (\\d) \\w+, hash = (0x\\w+)");
    for (const std::string& block : test::blocks_of(page_of("reference/protocol.md"), "frames")) {
        for (const test::FrameLine& line : test::frame_lines(block)) {
            std::smatch match;
            if (std::regex_match(line.words, match, words)) {
                asked.push_back(line.bytes);
                hashes.of.at(std::stoul(match[1])) =
                    static_cast<std::uint32_t>(std::stoul(match[2], nullptr, 0));
            }
        }
    }
    LatchCell latch{kLatchClear, ~kLatchClear};
    LiveWorld world(CanFormat::classical, latch);
    world.machine.can.hashes_in_id = 0x582;
    world.machine.can.hashes_out_id = 0x602;
    world.options.hashes = hashes;
    world.wire.sent.clear();
    world.start();
    world.run_periods(60);
    std::vector<CanFrame> sent;
    std::copy_if(world.wire.sent.begin(), world.wire.sent.end(), std::back_inserter(sent),
                 [](const CanFrame& frame) { return frame.id == 0x602; });
    EXPECT_EQ(sequence_of(sent), asked);
    for (std::size_t i = 1; i < sent.size(); ++i) {
        EXPECT_NEAR(static_cast<double>(sent[i].time_us - sent[i - 1].time_us),
                    Handshake::kRepeatUs, 500);
    }
    EXPECT_EQ(world.guard->guard().phase, GuardPhase::ready);
}

/// A row of the table of codes: code, causes, and reasons of a verdict.
struct CodeRow {
    std::uint32_t code;
    Texts causes, reasons;
};

Texts names_in(const std::string& cell) {
    const std::regex name("`(\\w+)`");
    Texts names;
    for (std::sregex_iterator at(cell.begin(), cell.end(), name), end; at != end; ++at) {
        names.push_back((*at)[1]);
    }
    return names;
}

std::vector<CodeRow> code_table() {
    const std::string page = page_of("reference/protocol.md");
    const std::size_t begin = page.find("\n| Code | Cause of the stop |");
    EXPECT_NE(begin, std::string::npos);
    std::istringstream text(page.substr(begin, page.find("\n\n", begin) - begin));
    std::vector<CodeRow> rows;
    const std::regex row("\\| (0x\\w+) [^|]*\\|([^|]*)\\|([^|]*)\\|");
    for (std::string line; std::getline(text, line);) {
        std::smatch match;
        if (std::regex_match(line, match, row)) {
            rows.push_back({static_cast<std::uint32_t>(std::stoul(match[1], nullptr, 0)),
                            names_in(match[2]), names_in(match[3])});
        }
    }
    return rows;
}

/// By its text in the log.
template <class Enum>
std::map<std::string, Enum> by_text() {
    std::map<std::string, Enum> all;
    for (std::uint32_t i = 0; to_text(static_cast<Enum>(i)) != std::string("unknown"); ++i) {
        all[to_text(static_cast<Enum>(i))] = static_cast<Enum>(i);
    }
    return all;
}

/// The one emergency of an armed guard that `stops` stops.
CanFrame emergency_after(const std::function<void(LiveWorld&)>& stops) {
    ProtocolWorld made;
    LiveWorld& world = made.world;
    made.run_to_armed();
    world.run_periods(20);
    EXPECT_EQ(world.guard->guard().phase, GuardPhase::armed);
    stops(world);
    world.run_periods(20);
    EXPECT_EQ(world.guard->guard().phase, GuardPhase::stopped);
    std::vector<CanFrame> found;
    for (const CanFrame& frame : world.wire.sent) {
        if (frame.id == world.machine.can.emergency_id) {
            found.push_back(frame);
        }
    }
    EXPECT_EQ(found.size(), 1U);
    return found.empty() ? CanFrame{} : found[0];
}

void expect_code(const CanFrame& frame, std::uint32_t code, const std::string& why) {
    EXPECT_EQ(static_cast<std::uint32_t>(frame.data[0] | frame.data[1] << 8U), code) << why;
    EXPECT_NE(page_of("reference/protocol.md").find("\n" + page_bytes(frame) + "  emergency: "),
              std::string::npos)
        << why << ": not shown: " << page_bytes(frame);
}

TEST(ProtocolSequences, EachStopHasTheCodeOfThePage) {
    auto causes = by_text<GuardFault>();
    auto reasons = by_text<StopReason>();
    for (const CodeRow& row : code_table()) {
        for (const std::string& name : row.causes) {
            ASSERT_TRUE(causes.contains(name)) << name;
            const GuardFault cause = causes[name];
            expect_code(emergency_after([&](LiveWorld& world) {
                            world.guard->report(cause, world.wire.now_us);
                        }),
                        row.code, name);
            causes.erase(name);
        }
        for (const std::string& name : row.reasons) {
            ASSERT_TRUE(reasons.contains(name)) << name;
            CycleResult result{.is_stop = true, .reason = reasons[name]};
            result.pair = row.code == 0xFF01 || row.code == 0xFF02 ? 2 : kNoIndex;
            expect_code(emergency_after([&](LiveWorld& world) {
                            world.verdict = [result](std::uint64_t) { return result; };
                        }),
                        row.code, name);
            reasons.erase(name);
        }
    }
    // What is left stops nothing, or, latched, sends no emergency.
    Texts left;
    for (const auto& [name, cause] : causes) {
        left.push_back(name);
    }
    EXPECT_EQ(left, (Texts{"input_noise", "latched", "none", "recorder", "verdict"}));
    left.clear();
    for (const auto& [name, reason] : reasons) {
        left.push_back(name);
    }
    EXPECT_EQ(left, (Texts{"input", "none", "own_stop"}))
        << "input is the cause, not the verdict's reason";
}

}  // namespace
}  // namespace axg
