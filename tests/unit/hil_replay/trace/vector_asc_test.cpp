// SPDX-License-Identifier: Apache-2.0
// Vector ASC: every line form that is read, both bases, both kinds of stamps, dates in two
// languages, and the refusals.
#include "hil_replay/trace/vector_asc.hpp"

#include <gtest/gtest.h>

#include "hil_replay/trace/asc_date.hpp"

namespace axg {
namespace {

const std::string kHeader =
    "date Thu Jan 1 00:00:00 1970\nbase hex  timestamps absolute\nno internal events logged\n"
    "// version 9.0.0\nBegin Triggerblock Thu Jan 1 00:00:00 1970\n   0.0000 Start of "
    "measurement\n";

std::vector<CanFrame> read_asc(const std::string& text, std::string& error,
                               const TraceOptions& options = {}) {
    const auto reader = read_asc("t.asc", text, options);
    std::vector<CanFrame> frames;
    CanFrame frame;
    while (reader->next(frame)) {
        frames.push_back(frame);
    }
    error = reader->error();
    return frames;
}

CanFrame one(const std::string& line) {
    std::string error;
    const auto frames = read_asc(kHeader + line + "\nEnd TriggerBlock\n", error);
    EXPECT_EQ(error, "") << line;
    EXPECT_EQ(frames.size(), 1U) << line;
    return frames.empty() ? CanFrame{} : frames[0];
}

std::string refusal(const std::string& line) {
    std::string error;
    const auto frames = read_asc(kHeader + line + "\n", error);
    EXPECT_TRUE(frames.empty()) << line;
    return error;
}

TEST(AscReader, ReadsClassicalLines) {
    CanFrame frame = one("   2.501 1  1F3             Rx   d 3 01 ff A0");
    EXPECT_EQ(frame.time_us, 2'501'000);
    EXPECT_EQ(frame.id, 0x1F3U);
    EXPECT_EQ(frame.length_bytes, 3);
    EXPECT_EQ(frame.data[2], 0xA0);
    EXPECT_FALSE(frame.sent_by_host || frame.extended || frame.fd || frame.remote);
    frame = one("2.5010001 1 18EBFF00x Tx d 1 7F Length = 1 BitCount = 2 ID = 3x");
    EXPECT_TRUE(frame.extended && frame.sent_by_host);
    EXPECT_EQ(frame.id, 0x18EBFF00U);
    EXPECT_EQ(frame.time_us, 2'501'000);
    frame = one("2.5 1 123 Rx d f 00 01 02 03 04 05 06 07");
    EXPECT_EQ(frame.length_bytes, 8);
    EXPECT_EQ(frame.raw_dlc, 15);
    EXPECT_TRUE(one("2.5 1 123 Rx r").remote);
    EXPECT_EQ(one("2.5 1 123 Rx r 5 Length = 0").length_bytes, 5);
}

TEST(AscReader, ReadsFlexibleLines) {
    const CanFrame frame =
        one("30.5 CANFD 4 Rx 1C4D80A7x AName_2 1 0 9 12 0 1 2 3 4 5 6 7 8 9 a b 10 11 0 0 0");
    EXPECT_TRUE(frame.fd && frame.extended && frame.bit_rate_switch);
    EXPECT_FALSE(frame.error_state);
    EXPECT_EQ(frame.length_bytes, 12);
    EXPECT_EQ(frame.data[11], 0x0B);
    EXPECT_TRUE(one("30.5 CANFD 4 Rx 123 0 1 1 1 55").error_state);
    EXPECT_TRUE(one("30.5 CANFD 4 Rx 123 0 0 1 1 55 10 11 1000").fd);
    EXPECT_FALSE(one("30.5 CANFD 4 Rx 123 0 0 1 1 55 10 11 200000").fd);
}

TEST(AscReader, ErrorFramesReachTheReceiver) {
    for (const char* line :
         {"2.5 1 ErrorFrame", "2.5 1 ErrorFrame ECC: 10100010",
          "2.5 CANFD 1 Tx ErrorFrame Not Acknowledge error, dominant error flag fffe"}) {
        const CanFrame frame = one(line);
        EXPECT_TRUE(frame.error) << line;
        EXPECT_EQ(frame.id, 0x80U);
    }
}

TEST(AscReader, TakesTheBaseOfTheHeader) {
    std::string error;
    const auto frames = read_asc(
        "base dec  timestamps relative\n1.0 1 291 Rx d 2 255 10\n"
        "0.5 1 292x Rx d 0\n",
        error);
    ASSERT_EQ(frames.size(), 2U) << error;
    EXPECT_EQ(frames[0].id, 0x123U);
    EXPECT_EQ(frames[0].data[0], 255);
    EXPECT_EQ(frames[1].time_us, 1'500'000);  // relative: half a second after the one before
    EXPECT_TRUE(frames[1].extended);
}

TEST(AscReader, AddsTheDateOfTheHeader) {
    std::string error;
    const auto frames = read_asc(
        "date Sam Sep 30 15:06:13.191 2017\nbase hex  timestamps absolute\n1.5 1 1 Rx d 0\n",
        error);
    ASSERT_EQ(frames.size(), 1U) << error;
    EXPECT_EQ(frames[0].time_us, 1'506'783'974'691'000);
}

TEST(AscDate, ReadsBothLanguagesAndBothClocks) {
    const std::pair<const char*, std::int64_t> dates[] = {
        {"Thu Jan 1 00:00:00 1970", 0},
        {"Sam Sep 30 15:06:13.191 2017", 1'506'783'973'191'000},
        {"Die M\xC3\xA4r 5 12:00:00 2024", 1'709'640'000'000'000},
        {"Die M\xE4r 5 12:00:00 2024", 1'709'640'000'000'000},
        {"Die Mrz 5 12:00:00 pm 2024", 1'709'640'000'000'000},
        {"Tue Mar 5 12:00:00 am 2024", 1'709'596'800'000'000},
        {"Don Feb 29 1:02:03 pm 2024", 1'709'211'723'000'000},
        {"Fri Okt 4 00:00:00.5 2024", 1'728'000'000'500'000},
        {"Fri Dez 31 23:59:59 1999", 946'684'799'000'000},
    };
    for (const auto& [text, wanted] : dates) {
        std::int64_t time_us = -1;
        EXPECT_TRUE(parse_asc_date(text, time_us)) << text;
        EXPECT_EQ(time_us, wanted) << text;
    }
    for (const char* text :
         {"", "Thu", "Thu Foo 1 00:00:00 1970", "Thu Jan 0 00:00:00 1970",
          "Thu Jan 32 00:00:00 1970", "Thu Jan 1 24:00:00 1970", "Thu Jan 1 00:60:00 1970",
          "Thu Jan 1 13:00:00 pm 1970", "Thu Jan 1 0:00:00 am 1970", "Thu Jan 1 00:00 1970",
          "Thu Jan 1 00:00:00 1969", "Thu Jan 1 00:00:00 1970 CET", "Thu Jan 1 00:00:00. 1970"}) {
        std::int64_t time_us = 0;
        EXPECT_FALSE(parse_asc_date(text, time_us)) << text;
    }
}

TEST(AscReader, EveryRefusalNamesFileAndLine) {
    const std::pair<const char*, const char*> cases[] = {
        {"2.5 1 123 Rx d 2 01", "t.asc:7: data: invalid value (found \"\""},
        {"2.5 1 123 Rx d 2 01 0202", "t.asc:7: data: invalid value (found \"0202\""},
        {"2.5 1 123 Rx d 1 01 02", "t.asc:7: end of line: invalid value (found \"02\""},
        {"2.5 1 123 Rx d 16", "t.asc:7: length: invalid value (found \"16\""},
        {"2.5 1 123 Rx q 1 01", "t.asc:7: frame kind: invalid value (found \"q\""},
        {"2.5 1 123 Up d 1 01", "t.asc:7: direction: invalid value (found \"Up\""},
        {"2.5 1 800 Rx d 1 01", "t.asc:7: id: invalid value (found \"800\""},
        {"2.5 1 20000000x Rx d 1 01", "t.asc:7: id: invalid value (found \"20000000x\""},
        {"2.5 1 x Rx d 1 01", "t.asc:7: id: invalid value (found \"x\""},
        {"2.5 Marker 3",
         "t.asc:7: event: invalid value (found \"Marker 3\", expected a channel, CANFD or Start of "
         "measurement). Pass over such lines with --lenient."},
        {"2 1 123 Rx d 1 01", "t.asc:7: line: invalid value (found \"2 1 123 Rx"},
        {"hello", "t.asc:7: line: invalid value (found \"hello\""},
        {"2.5 CANFD 1 Rx 123 0 0 9 8 1 2 3 4 5 6 7 8", "t.asc:7: CANFD"},
        {"2.5 CANFD 1 Rx 123 0 0 9 12 1 2 3 4 5 6 7 8", "t.asc:7: data: invalid value (found \"\""},
        {"2.5 CANFD 1 Rx 123 0 2 1 1 0", "t.asc:7: CANFD"},
        {"date yesterday", "t.asc:7: date: invalid value (found \"yesterday\""},
        {"base oct  timestamps absolute", "t.asc:7: base: invalid value (found \"base oct"},
    };
    for (const auto& [line, wanted] : cases) {
        EXPECT_EQ(refusal(line).rfind(wanted, 0), 0U) << refusal(line);
    }
    std::string error;
    EXPECT_TRUE(read_asc("1.0 1 123 Rx d 0\n", error).empty());
    EXPECT_NE(error.find("t.asc:1: header"), std::string::npos);
}

// As CANoe begins a measurement, in English and German, on channels with and without FD.
TEST(AscReader, AMeasurementBeginsInTwoLanguages) {
    for (const char* const start : {"Start of measurement", "CANFD   Start of measurement",
                                    "Start der Messung", "CANFD Start der Messung"}) {
        std::string error;
        const auto frames = read_asc(
            "date Mon Mai 6 08:09:10 am 2024\nbase hex  timestamps "
            "absolute\n   0.000000 " +
                std::string(start) + "\n 0.5 1 1A0 Rx d 1 07\n",
            error);
        EXPECT_EQ(error, "") << start;
        EXPECT_EQ(frames.size(), 1U) << start;
    }
}

TEST(AscReader, InternalEventsHaveNoFrameAndAreCounted) {
    const std::string text = kHeader +
                             " 0.1 CAN 2 Status:chip status error active\n"
                             " 0.2 2  Statistic: D 12 R 0 XD 0 XR 0 E 0 O 0 B 1.50%\n"
                             " 0.3 SV: 1 0 1 ::Panel::Lamp 1.000000\n"
                             " 0.4 2 321 Rx d 2 0A 0B\n"
                             " 0.5 2  J1939TP EECx 3 2 0 - Rx d 9 * 00\n"
                             " 0.6 CANFD 2 Status:chip status error passive\n"
                             " 0.7 Log trigger event\n"
                             " 0.7 TFS: [0,0] begin of a group\n"
                             " 0.7 Li 2d Rx 8 1 2 3 4 5 6 7 8 checksum = 9\n"
                             " 0.7 L2 2d Rx 1 1\n"
                             " 0.7 ETH 1 STAT Link:up\n"
                             " 0.8 EnvLamp := 1\n"
                             " 0.9 2 OverloadFrame\n";
    const auto reader = read_asc("t.asc", text, TraceOptions{});
    CanFrame frame;
    ASSERT_TRUE(reader->next(frame)) << reader->error();
    EXPECT_EQ(frame.id, 0x321U);
    EXPECT_FALSE(reader->next(frame));
    EXPECT_EQ(reader->error(), "");
    EXPECT_EQ(reader->events(), 12U);
    EXPECT_EQ(reader->skipped(), 0U) << "nothing is lost";
    // A frame that looks like one of them is a frame.
    EXPECT_EQ(one("0.7 2 0A1 Rx d 1 01").id, 0x0A1U);
    EXPECT_NE(refusal("0.7 2 OverloadFrames").find("id: invalid value"), std::string::npos);
    // Another event is refused, and read over by the option that the message names.
    std::string error;
    const std::string other = kHeader + "0.1 Marker\n0.2 1 123 Rx d 0\n";
    EXPECT_TRUE(read_asc(other, error).empty());
    EXPECT_NE(error.find("--lenient"), std::string::npos) << error;
    EXPECT_EQ(read_asc(other, error, {.lenient = true}).size(), 1U);
}

TEST(AscReader, ARequestToSendIsNoFrame) {
    std::string error;
    EXPECT_TRUE(read_asc(kHeader + "2.5 1 123 TxRq d 1 01\n", error).empty());
    EXPECT_EQ(error, "");
}

TEST(AscReader, TwoChannelsNeedAChoice) {
    const std::string text = kHeader + "2.5 1 123 Rx d 0\n2.6 2 124 Rx d 0\n";
    std::string error;
    read_asc(text, error);
    EXPECT_NE(error.find("t.asc:8: interface: invalid value (found \"2\""), std::string::npos)
        << error;
    ASSERT_EQ(read_asc(text, error, {.device = "2"}).size(), 1U);
    EXPECT_EQ(error, "");
}

}  // namespace
}  // namespace axg
