// SPDX-License-Identifier: Apache-2.0
// docs/reference/board.md is what a board's firmware is written from: each frame that it shows is
// encoded again from the values beside it, the library hears the permits that it shows, and the
// table of refusals has the library's names in the library's order.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "firmware_if/board/axguard_operator.h"
#include "firmware_if/protocol/axis_frames.hpp"
#include "firmware_if/protocol/hints_frame.hpp"
#include "tests/support/board_fixture.hpp"
#include "tests/support/page_text.hpp"

namespace axg {
namespace {

using test::blocks_of;
using test::BoardFixture;
using test::BoardPermit;
using test::frame_lines;
using test::FrameLine;
using test::page_of;

const std::string& page() {
    static const std::string text = page_of("reference/board.md");
    return text;
}

/// `key = value, key = value` beside a frame.
std::map<std::string, std::int64_t> values_of(const std::string& words) {
    std::map<std::string, std::int64_t> values;
    std::istringstream text(words);
    for (std::string part; std::getline(text, part, ',');) {
        const std::size_t equal = part.find(" = ");
        EXPECT_NE(equal, std::string::npos) << words;
        const std::size_t begin = part.find_first_not_of(' ');
        values[part.substr(begin, equal - begin)] = std::stoll(part.substr(equal + 3), nullptr, 0);
    }
    return values;
}

/// As the page writes it: an id, # or ##1, bytes with dots where the frame is classical.
std::string shown(const axg_board_can_frame& frame) {
    CanFrame made;
    made.id = frame.id;
    made.fd = made.bit_rate_switch = frame.is_fd;
    made.length_bytes = frame.length;
    std::copy_n(frame.data, frame.length, made.data.begin());
    return test::page_bytes(made);
}

template <class Integer>
Integer take(std::map<std::string, std::int64_t>& values, const std::string& key) {
    const auto found = values.find(key);
    EXPECT_NE(found, values.end()) << "no " << key;
    const std::int64_t value = found == values.end() ? 0 : found->second;
    values.erase(key);
    return static_cast<Integer>(value);
}

std::vector<FrameLine> only_block(const std::string& tag) {
    const auto blocks = blocks_of(page(), tag);
    EXPECT_EQ(blocks.size(), 1U) << tag;
    return blocks.empty() ? std::vector<FrameLine>{} : frame_lines(blocks[0]);
}

// A machine with five axes, X to C, the last one endless, and one sample of the number shown.
struct ShownBoard : BoardFixture {
    ShownBoard() { (void)axg_board_power_up(&board, &options, 0x123456, 0); }
};

TEST(BoardPage, ThePermitsAreTheGuardsAndTheLibraryTakesThem) {
    const auto lines = only_block("permits");
    ASSERT_EQ(lines.size(), 12U);
    std::set<int> words;
    for (std::size_t i = 0; i < lines.size(); i += 2) {
        auto values = values_of(lines[i].words);
        BoardPermit permit;
        permit.word = take<std::uint8_t>(values, "word");
        permit.live = take<std::uint8_t>(values, "live");
        permit.cap = take<std::uint8_t>(values, "cap");
        permit.mask = take<std::uint8_t>(values, "mask");
        permit.samples = take<std::uint8_t>(values, "n");
        permit.level = take<std::uint8_t>(values, "level");
        permit.nonce = take<std::uint32_t>(values, "nonce");
        permit.number = AXG_BOARD_SYNC_MAX * take<std::uint32_t>(values, "lap") +
                        take<std::uint32_t>(values, "echo") - 1;
        EXPECT_TRUE(values.empty()) << lines[i].words;
        const auto pair = test::board_pair(permit);
        EXPECT_EQ(lines[i].bytes, shown(pair[0]));
        EXPECT_EQ(lines[i + 1].bytes, shown(pair[1]));
        words.insert(permit.word);

        BoardFixture fixture;
        (void)axg_board_power_up(&fixture.board, &fixture.options, 0x123456, 0);
        ASSERT_EQ(axg_board_arm(&fixture.board, permit.nonce, 50'000), AXG_BOARD_ARMING_DONE);
        axg_board_change(&fixture.board, permit.word == AXG_BOARD_WORD_JOG, 60'000);
        ASSERT_TRUE(fixture.latch_at(permit.number, 100'000));
        BoardPermit before = permit;  // the first one only sets the live counter
        before.live = static_cast<std::uint8_t>(permit.live - 1);
        EXPECT_NE(fixture.hear(before, 100'100), AXG_BOARD_HEARD_PERMIT);
        EXPECT_EQ(fixture.hear(permit, 100'200), permit.word == AXG_BOARD_WORD_STOP
                                                     ? AXG_BOARD_HEARD_NOT_YET
                                                     : AXG_BOARD_HEARD_PERMIT);
    }
    EXPECT_EQ(words, (std::set<int>{0xA5, 0x3C, 0x5A}));
}

TEST(BoardPage, TheSessionFrameIsTheLibrarys) {
    const auto lines = only_block("session");
    ASSERT_EQ(lines.size(), 1U);
    auto values = values_of(lines[0].words);
    ShownBoard shown_board;
    axg_board& board = shown_board.board;
    ASSERT_EQ(axg_board_arm(&board, take<std::uint32_t>(values, "nonce"), 50'000),
              AXG_BOARD_ARMING_DONE);
    ASSERT_TRUE(shown_board.latch_at(AXG_BOARD_SYNC_MAX * take<std::uint32_t>(values, "lap") +
                                         take<std::uint32_t>(values, "SYNC") - 1,
                                     100'000));
    axg_board_can_frame frame{};
    for (std::int64_t i = 0; i <= values.at("counter"); ++i) {
        ASSERT_TRUE(axg_board_encode_session(&board, {.id = 0x583, .data_id = 0x583}, 0, &frame));
    }
    EXPECT_EQ(lines[0].bytes, shown(frame));
    EXPECT_NE(page().find("The board sends 0x583 every 100 ms"), std::string::npos);
    EXPECT_FALSE(axg_board_is_session_due(&board, 99'999));
    EXPECT_TRUE(axg_board_is_session_due(&board, 100'000));
}

TEST(BoardPage, TheHintsAreTheGuards) {
    const auto lines = only_block("hints");
    ASSERT_EQ(lines.size(), 1U);
    auto values = values_of(lines[0].words);
    const Hints hints{.sync_counter = take<std::uint8_t>(values, "SYNC"),
                      .pair = take<std::uint16_t>(values, "pair"),
                      .distance_10um = take<std::uint16_t>(values, "distance")};
    EXPECT_TRUE(values.empty());
    EXPECT_EQ(lines[0].bytes, test::page_bytes(encode_hints({}, hints, 0)));
    EXPECT_EQ(kHeartbeatPeriodUs, 10'000) << "they leave with the heartbeat";
}

// Sample 20 names permit 3, which orders no cap; its counters come from as many samples before.
void play_until(BoardFixture& fixture, std::uint32_t number, std::uint8_t counter) {
    fixture.options.cap_kind = AXG_BOARD_CAP_ENFORCED;
    fixture.arm();
    ASSERT_TRUE(fixture.latch_at(number - 1, 3'730'000));
    for (std::uint8_t live = 2; live <= 3; ++live) {
        (void)fixture.hear({.number = number - 1, .live = live}, 3'730'100);
    }
    ASSERT_TRUE(fixture.latch_at(number, 3'740'000));
    fixture.board.axes_counter = counter;
}

axg_board_says says_of(std::map<std::string, std::int64_t>& values) {
    axg_board_says says{};
    const auto flags = take<std::uint8_t>(values, "flags");
    says.mode = take<std::uint8_t>(values, "mode");
    says.tool = take<std::uint16_t>(values, "tool");
    says.is_homed = (flags & 1U) == 0;
    says.jogs_down = says.mode == 3 && (flags & 2U) != 0;
    says.jog_axis = flags >> 4U;
    return says;
}

std::array<std::int32_t, 5> positions_of(std::map<std::string, std::int64_t>& values) {
    std::array<std::int32_t, 5> positions{};
    for (std::size_t i = 0; i < 5; ++i) {
        positions[i] = take<std::int32_t>(values, std::string(1, "XYZAC"[i]));
    }
    return positions;
}

TEST(BoardPage, TheClassicalSamplesAreTheLibrarys) {
    const auto lines = only_block("samples classical");
    ASSERT_EQ(lines.size(), 6U);
    constexpr axg_board_axis_ids kIds[] = {{0x181, 0x181}, {0x281, 0x281}, {0x381, 0x381}};
    for (std::uint32_t sample = 0; sample < 2; ++sample) {
        std::map<std::string, std::int64_t> values;
        for (std::size_t i = 0; i < 3; ++i) {
            values.merge(values_of(lines[3 * sample + i].words));
        }
        BoardFixture fixture;
        play_until(fixture, 20 + sample, take<std::uint8_t>(values, "counter"));
        const std::int64_t flags = values.at("flags");
        const axg_board_says says = says_of(values);
        EXPECT_EQ(flags, axg_board_flags(&fixture.board, &says));
        const auto positions = positions_of(values);
        EXPECT_TRUE(values.empty());
        axg_board_can_frame frames[3];
        ASSERT_EQ(axg_board_encode_classical(&fixture.board, &says, positions.data(), kIds, frames),
                  3);
        for (std::size_t i = 0; i < 3; ++i) {
            EXPECT_EQ(lines[3 * sample + i].bytes, shown(frames[i]));
        }
    }
}

TEST(BoardPage, TheFlexibleSampleIsTheLibrarys) {
    const auto lines = only_block("samples fd");
    ASSERT_EQ(lines.size(), 1U);
    auto values = values_of(lines[0].words);
    EXPECT_EQ(take<std::uint32_t>(values, "clock"), 3'740'000U);
    BoardFixture fixture;
    play_until(fixture, 20, take<std::uint8_t>(values, "counter"));
    const axg_board_says says = says_of(values);
    const auto positions = positions_of(values);
    EXPECT_TRUE(values.empty());
    axg_board_can_frame frame{};
    ASSERT_EQ(axg_board_encode_fd(&fixture.board, &says, positions.data(), {0x181, 0x181}, &frame),
              1);
    EXPECT_EQ(lines[0].bytes, shown(frame));
}

TEST(BoardPage, TheOperatorsFramesAreTheLibrarysBothWays) {
    for (const FrameLine& line : only_block("operator")) {
        const std::size_t colon = line.words.find(": ");
        const bool is_message = line.words.substr(0, colon) == "message";
        auto values = values_of(line.words.substr(colon + 2));
        const auto action = static_cast<axg_operator_action>(take<int>(values, "action"));
        const auto counter = take<std::uint8_t>(values, "counter");
        const auto nonce = take<std::uint32_t>(values, "nonce");
        const std::uint32_t id = is_message ? 0x584 : 0x604;
        const axg_board_axis_ids ids{.id = id, .data_id = static_cast<std::uint16_t>(id)};
        axg_board_can_frame frame{};
        if (is_message) {
            const axg_operator_message message{
                .action = action,
                .step = static_cast<axg_operator_step>(take<int>(values, "step")),
                .stands = take<int>(values, "stands") != 0,
                .counter = counter,
                .nonce = nonce};
            axg_operator_encode(&message, ids, &frame);
            axg_operator_message read{};
            ASSERT_TRUE(axg_operator_decode(&frame, ids, &read));
            EXPECT_EQ(read.action, message.action);
            EXPECT_EQ(read.step, message.step);
            EXPECT_EQ(read.nonce, nonce);
            EXPECT_EQ(read.counter, counter);
            EXPECT_EQ(read.stands, message.stands);
        } else {
            const axg_operator_status status{
                .phase = take<std::uint8_t>(values, "phase"),
                .action = action,
                .refusal = static_cast<axg_operator_refusal>(take<int>(values, "refusal")),
                .counter = counter,
                .nonce = nonce};
            axg_operator_encode_status(&status, ids, &frame);
            axg_operator_status read{};
            ASSERT_TRUE(axg_operator_decode_status(&frame, ids, &read));
            EXPECT_EQ(read.phase, status.phase);
            EXPECT_EQ(read.action, status.action);
            EXPECT_EQ(read.refusal, status.refusal);
            EXPECT_EQ(read.nonce, nonce);
        }
        EXPECT_EQ(line.bytes, shown(frame)) << line.words;
        EXPECT_TRUE(values.empty()) << line.words;
    }
}

TEST(BoardPage, AnOperatorsFrameThatIsNotExactlyOneIsRefused) {
    constexpr axg_board_axis_ids kIds{.id = 0x584, .data_id = 0x584};
    const axg_operator_message message{.action = AXG_OPERATOR_ARM,
                                       .step = AXG_OPERATOR_CONFIRM,
                                       .stands = true,
                                       .counter = 15,
                                       .nonce = 0x345678};
    axg_board_can_frame good{};
    axg_operator_message read{};
    axg_operator_status status{};
    axg_operator_encode(&message, kIds, &good);
    ASSERT_TRUE(axg_operator_decode(&good, kIds, &read));
    EXPECT_FALSE(axg_operator_decode_status(&good, kIds, &status));  // phase 0x69
    for (unsigned bit = 0; bit < 64; ++bit) {
        axg_board_can_frame bad = good;
        bad.data[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
        EXPECT_FALSE(axg_operator_decode(&bad, kIds, &read)) << bit;
    }
    for (int kind = 0; kind < 3; ++kind) {
        axg_board_can_frame bad = good;
        bad.id += kind == 0 ? 1 : 0;
        bad.length = kind == 1 ? 7 : 8;
        bad.is_fd = kind == 2;
        EXPECT_FALSE(axg_operator_decode(&bad, kIds, &read)) << kind;
    }
    for (const auto& [action, step] : {std::pair{0, 0xF0}, {0x96, 0x00}, {0x97, 0x0F}}) {
        const axg_operator_message odd{.action = static_cast<axg_operator_action>(action),
                                       .step = static_cast<axg_operator_step>(step),
                                       .stands = false,
                                       .counter = 0,
                                       .nonce = 0};
        axg_operator_encode(&odd, kIds, &good);
        EXPECT_FALSE(axg_operator_decode(&good, kIds, &read)) << action;
    }
}

// An enumerator without a name here does not compile: so none is without a row.
const char* name_of(axg_board_refusal refusal) {
    switch (refusal) {
        case AXG_BOARD_REFUSED_SHAPE:
            return "shape";
        case AXG_BOARD_REFUSED_TWIN_MISSING:
            return "twin_missing";
        case AXG_BOARD_REFUSED_TWIN_ALONE:
            return "twin_alone";
        case AXG_BOARD_REFUSED_TWIN_LATE:
            return "twin_late";
        case AXG_BOARD_REFUSED_TWIN_DIFFERS:
            return "twin_differs";
        case AXG_BOARD_REFUSED_STOPPED:
            return "stopped";
        case AXG_BOARD_REFUSED_WORD:
            return "word";
        case AXG_BOARD_REFUSED_ECHO:
            return "echo";
        case AXG_BOARD_REFUSED_ANSWER:
            return "answer";
        case AXG_BOARD_REFUSED_LIVE:
            return "live";
        case AXG_BOARD_REFUSED_VALUE:
            return "value";
        case AXG_BOARD_REFUSED_SAMPLES:
            return "samples";
        case AXG_BOARD_REFUSED_OLD_ECHO:
            return "old_echo";
        case AXG_BOARD_REFUSED_LATE:
            return "late";
        case AXG_BOARD_REFUSED_JOG:
            return "jog";
        case AXG_BOARD_REFUSED_CAP:
            return "cap";
        case AXG_BOARD_REFUSED_NOTHING:
        case AXG_BOARD_REFUSALS:
            break;
    }
    return "";
}

TEST(BoardPage, TheTableOfRefusalsHasTheNamesOfTheLibraryInItsOrder) {
    std::istringstream table(page().substr(page().find("| Refusal |")));
    std::string line;
    std::getline(table, line);
    std::getline(table, line);  // |---|
    for (int i = AXG_BOARD_REFUSED_SHAPE; i < AXG_BOARD_REFUSALS; ++i) {
        std::getline(table, line);
        const std::string name = name_of(static_cast<axg_board_refusal>(i));
        EXPECT_EQ(line.substr(0, name.size() + 6), "| `" + name + "` |");
    }
    std::getline(table, line);
    EXPECT_EQ(line, "");
}

}  // namespace
}  // namespace axg
