// SPDX-License-Identifier: Apache-2.0
// The candump grammar: a corpus of lines on which other readers disagree, with our answer to each;
// every refusal names file and line; what the writer writes is the core that all readers share.
#include "hil_replay/trace/candump_log.hpp"
#include "hil_replay/trace/line_source.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace axg {
namespace {

struct Answer {
    std::vector<CanFrame> frames;
    std::string error;
    std::uint64_t skipped = 0;
};

std::vector<CanFrame> frames_of(TraceReader& reader) {
    std::vector<CanFrame> frames;
    CanFrame frame;
    while (reader.next(frame)) {
        frames.push_back(frame);
    }
    return frames;
}

Answer read_log(const std::string& text, const TraceOptions& options = {}) {
    Answer answer;
    const auto reader = read_candump("t.log", text, options);
    answer.frames = frames_of(*reader);
    answer.error = reader->error();
    answer.skipped = reader->skipped();
    return answer;
}

std::string line(const std::string& body) {
    return "(1.000001) can0 " + body + "\n";
}

/// What we say of a frame, in one word a property.
std::string describe(const Answer& answer) {
    if (!answer.error.empty()) {
        return "refused";
    }
    if (answer.frames.size() != 1) {
        return std::to_string(answer.frames.size()) + " frames";
    }
    const CanFrame& f = answer.frames[0];
    std::ostringstream out;
    out << std::hex << f.id << (f.extended ? "x" : "") << (f.error ? " error" : "")
        << (f.remote ? " remote" : "") << (f.fd ? " fd" : "") << (f.bit_rate_switch ? " brs" : "")
        << (f.error_state ? " esi" : "") << " " << std::dec << unsigned{f.length_bytes};
    if (f.raw_dlc != 0) {
        out << " dlc" << unsigned{f.raw_dlc};
    }
    return out.str();
}

TEST(CandumpReader, AnswersTheCorpusOnWhichReadersDisagree) {
    const std::pair<std::string, const char*> corpus[] = {
        {line("123#R7"), "123 remote 7"},
        {line("123#R8_9"), "123 remote 8 dlc9"},
        {line("20000080#0000000000000000"), "80 error 8"},
        {line("20000080#"), "80 error 0"},  // of python-can
        {line("20000004#0004000000000000"), "4 error 8"},
        {line("123##E112233"), "123 fd esi 3"},
        {line("123#1122334455667788_E"), "123 8 dlc14"},
        {line("123#11.22"), "123 2"},
        {line("123#A"), "refused"},
        {"(1.5) can0 123#11\n", "refused"},
        {"(1.000012123) can0 123#11\n", "123 1"},
        {line("123#11 word"), "refused"},
        {"DROPCOUNT: dropped 3 CAN frames on 'can0' socket (total drops 3)\n", "refused"},
        {"# comment\n", "0 frames"},
        {line("123#R"), "123 remote 0"},
        {line("123##4"), "123 fd 0"},
        {line("123##7112233445566778899AABBCC"), "123 fd brs esi 12"},
        {line("123#11 T"), "123 1"},
        {line("00000123#11"), "123x 1"},
        {line("7FF#"), "7ff 0"},
        {line("800#"), "refused"},
        {line("123##0112233445566778899"), "refused"},
    };
    for (const auto& [text, wanted] : corpus) {
        EXPECT_EQ(describe(read_log(text)), wanted) << text;
    }
}

TEST(CandumpReader, RefusesOnBothSidesOfEachBound) {
    const std::pair<std::string, const char*> cases[] = {
        {line("1FFFFFFF#"), "1fffffffx 0"},
        {line("40000000#"), "refused"},
        {line("80000123#11"), "refused"},
        {line("200000FF#00"), "refused"},  // an error frame has 8 bytes
        {line("12#11"), "refused"},
        {line("1234#11"), "refused"},
        {line("12G#11"), "refused"},
        {line("123#1122334455667788"), "123 8"},
        {line("123#112233445566778899"), "refused"},
        {line("123#1122334455667788_8"), "refused"},
        {line("123#1122334455667788_9"), "123 8 dlc9"},
        {line("123#11223344556677_9"), "refused"},
        {line("123#R9"), "refused"},
        {line("123#r8"), "123 remote 8"},
        {line("123#11."), "refused"},
        {line("123#.11"), "123 1"},
        {line("123#1.1"), "refused"},
        {line("123#11 22"), "refused"},
        {line("123##"), "refused"},
        {line("123##0" + std::string(128, 'A')), "123 fd 64"},
        {line("123##0" + std::string(130, 'A')), "refused"},
        {line("12345#00:00:00000000#11"), "refused"},  // CAN XL
        {line("123#11 R"), "123 1"},
        {line("123#11 TT"), "refused"},
        {line("123#11 T T"), "refused"},
        {line("123#11  "), "123 1"},
        {"(1.000001) can0 123#11\r\n", "123 1"},
        {"(1.000001) can0 123#11", "123 1"},  // no end of line at the end of the file
        {"(1.00001) can0 123#11\n", "refused"},
        {"(1.0000011) can0 123#11\n", "refused"},
        {"(1.00000112) can0 123#11\n", "refused"},
        {"(1.0000011234) can0 123#11\n", "refused"},
        {"(.000001) can0 123#11\n", "refused"},
        {"(1) can0 123#11\n", "refused"},
        {"(1.000001 can0 123#11\n", "refused"},
        {"(-1.000001) can0 123#11\n", "refused"},
        {"(1234567890123.000001) can0 123#11\n", "refused"},
        {"(1.000001)can0 123#11\n", "refused"},
        {"(1.000001) 123#11\n", "refused"},
        {"(1.000001) abcdefghijklmno 123#11\n", "123 1"},
        {"(1.000001) abcdefghijklmnop 123#11\n", "refused"},
        {"(1.000001)     can0 123#11\n", "123 1"},  // padded where several interfaces are logged
        {"(1.000001) can0\n", "refused"},
        {"(1.000001)\n", "refused"},
        {"hello\n", "refused"},
        {"\n\n", "0 frames"},
        {"", "0 frames"},
    };
    for (const auto& [text, wanted] : cases) {
        EXPECT_EQ(describe(read_log(text)), wanted) << text;
    }
}

TEST(CandumpReader, ReadsWhatTheConsoleShows) {
    const std::pair<std::string, const char*> cases[] = {
        {" (1.000001)  can0  123   [2]  11 22\n", "123 2"},
        {" (1.000001)  can0  RX - -  123   [2]  11 22\n", "123 2"},
        {" (1.000001)  can0  TX B E  123  [12]  00 01 02 03 04 05 06 07 08 09 0A 0B\n",
         "123 fd brs esi 12"},
        {" (1.000001)  can0  123  [02]  11 22\n", "123 fd 2"},
        {" (1.000001)  can0  123  {9}  11 22 33 44 55 66 77 88\n", "123 8 dlc9"},
        {" (1.000001)  can0  12345678   [0]\n", "12345678x 0"},
        {" (1.000001)  can0  123   [3]  remote request\n", "123 remote 3"},
        {" (1.000001)  can0  123  [03]  remote request\n", "refused"},  // none is flexible
        {" (1.000001)  can0  20000080   [8]  00 00 00 00 00 00 00 00   ERRORFRAME\n", "80 error 8"},
        {" (1.000001)  can0  123   [2]  11 22   '.\"'\n", "123 2"},
        {" (1.000001)  can0  123   [2]  11\n", "refused"},
        {" (1.000001)  can0  123   [2]  11 22 33\n", "refused"},
        {" (1.000001)  can0  123   [9]  11 22\n", "refused"},
        {" (1.000001)  can0  123  [09]  11 22\n", "refused"},
        {" (1.000001)  can0  RX - 123   [2]  11 22\n", "refused"},
        {" (2019-01-09 22:42:07.670704)  can0  123   [2]  11 22\n", "refused"},
    };
    for (const auto& [text, wanted] : cases) {
        EXPECT_EQ(describe(read_log(text)), wanted) << text;
    }
}

TEST(CandumpReader, KeepsTimeDirectionAndBytes) {
    const Answer answer = read_log(
        "(1547073727.670704) can0 0A1#00fFa9 T\n"
        "(1547073727.670704999) can0 0A1#01 R\n");
    ASSERT_EQ(answer.frames.size(), 2U) << answer.error;
    EXPECT_EQ(answer.frames[0].time_us, 1'547'073'727'670'704);
    EXPECT_EQ(answer.frames[1].time_us, 1'547'073'727'670'704);  // nanoseconds rounded down
    EXPECT_TRUE(answer.frames[0].sent_by_host);
    EXPECT_FALSE(answer.frames[1].sent_by_host);
    EXPECT_EQ(answer.frames[0].data[1], 0xFF);
    EXPECT_EQ(answer.frames[0].data[2], 0xA9);
}

TEST(CandumpReader, EveryRefusalNamesFileLineGotAndWanted) {
    const Answer answer = read_log(line("123#11") + "\n" + line("123#1"));
    EXPECT_EQ(answer.frames.size(), 1U);
    EXPECT_EQ(
        answer.error,
        "t.log:3: data: invalid value (found \"1\", expected two hexadecimal digits a byte).");
}

TEST(CandumpReader, ForeignTextCannotReachTheTerminal) {
    const Answer answer = read_log("(1.000001) can0 \x1B[31m#11\n");
    EXPECT_NE(answer.error.find("\\x1B[31m"), std::string::npos) << answer.error;
    EXPECT_EQ(answer.error.find('\x1B'), std::string::npos);
}

TEST(CandumpReader, TimeMayNotRunBackwardsBeyondTheTolerance) {
    const std::string text = "(1.000100) can0 123#\n(1.000050) can0 123#\n";
    EXPECT_NE(read_log(text).error.find(
                  "t.log:2: time: invalid value (found \"1.000050 s after 1.000100 s\""),
              std::string::npos)
        << read_log(text).error;
    EXPECT_EQ(read_log(text, {.backwards_us_max = 50}).frames.size(), 2U);
    EXPECT_EQ(read_log(text, {.backwards_us_max = 49}).frames.size(), 1U);
}

TEST(CandumpReader, TwoInterfacesNeedAChoice) {
    const std::string text = "(1.000100) can0 123#\n(1.000200) can1 124#\n(1.000300) can0 125#\n";
    EXPECT_NE(read_log(text).error.find("t.log:2: interface: invalid value (found \"can1\""),
              std::string::npos);
    const Answer chosen = read_log(text, {.device = "can1"});
    ASSERT_EQ(chosen.frames.size(), 1U) << chosen.error;
    EXPECT_EQ(chosen.frames[0].id, 0x124U);
}

TEST(CandumpReader, LenientSkipsCountsAndKeepsTheFirstReason) {
    const std::string text = line("123#11") + "DROPCOUNT: dropped 3 CAN frames on 'can0' socket\n" +
                             line("123#1") + line("123#22");
    const auto reader = read_candump("t.log", text, {.lenient = true});
    EXPECT_EQ(frames_of(*reader).size(), 2U);
    EXPECT_EQ(reader->error(), "");
    EXPECT_EQ(reader->skipped(), 2U);
    EXPECT_NE(reader->first_skipped().find("t.log:2: dropped frames"), std::string::npos);
}

TEST(CandumpReader, AnEndlessLineIsRefusedNotStored) {
    EXPECT_NE(
        read_log(std::string(70'000, '(')).error.find("t.log:1: line: invalid value (found \"(((("),
        std::string::npos);
}

// One line that a full disk or a crash left behind must not end what follows.
TEST(CandumpReader, ATooLongLineIsOneFaultAndReadingGoesOn) {
    for (const std::size_t size : {kLineBytesMax, kLineBytesMax + 1, 10 * kLineBytesMax}) {
        for (const char* const end : {"\n", ""}) {
            const std::string text =
                line("123#11") + std::string(size, 'x') + end + (*end != 0 ? line("123#22") : "");
            const auto reader = read_candump("t.log", text, {.lenient = true});
            CanFrame frame;
            int frames = 0;
            while (reader->next(frame)) {
                ++frames;
            }
            EXPECT_EQ(reader->error(), "") << size;
            EXPECT_EQ(frames, *end != 0 ? 2 : 1) << size;
            EXPECT_EQ(reader->skipped(), 1U) << size;
            const bool is_too_long = size > kLineBytesMax;
            EXPECT_EQ(reader->first_skipped().find("t.log:2: line: ") == 0, is_too_long)
                << reader->first_skipped();
        }
    }
}

TEST(CandumpReader, BlankLinesAndAByteOrderMarkArePassedOver) {
    const auto got = read_log("\xEF\xBB\xBF" + line("123#11") + "   \n\t\r\n\n" + line("123#22"));
    EXPECT_EQ(got.error, "");
    EXPECT_EQ(got.frames.size(), 2U);
}

// candump -e prints what an error frame means below it, a line each.
TEST(CandumpReader, DetailsOfAnErrorFrameArePassedOver) {
    const std::string error_frame =
        " (1700000001.000200)  can1  20000088   [8]  00 00 08 00 00 00 00 00   ERRORFRAME\n"
        "\tprotocol-violation{{tx-stuff-error}{}}\n\tbus-error\n";
    const std::string frame = " (1700000001.000300)  can1  2A0   [1]  05\n";
    const auto got = read_log(error_frame + frame);
    EXPECT_EQ(got.error, "");
    ASSERT_EQ(got.frames.size(), 2U);
    EXPECT_TRUE(got.frames[0].error);
    // Behind anything else such a line is a fault; the option that the message names reads on.
    const std::string strange = frame + "\tbus-error\n" + frame;
    const auto refused = read_log(strange);
    EXPECT_EQ(refused.frames.size(), 1U);
    EXPECT_NE(refused.error.find("Pass over such lines with --lenient."), std::string::npos)
        << refused.error;
    EXPECT_EQ(read_log(strange, {.lenient = true}).frames.size(), 2U);
}

// Sorted, differences would look like a log. What helps is another record, or for a log of two
// queues the sorting that is named there.
TEST(CandumpReader, ATimeThatDecreasesNamesWhatHelps) {
    const auto differences =
        read_log("(000.000000) can1 100#01\n(000.150000) can1 100#02\n(000.149000) can1 100#03\n");
    EXPECT_NE(differences.error.find("found \"0.149000 s after 0.150000 s\", expected a time that "
                                     "does not decrease). Candump -td writes differences, which "
                                     "are no times: record with candump -L or -ta."),
              std::string::npos)
        << differences.error;
    EXPECT_EQ(differences.error.find("ort the trace"), std::string::npos);
    // The same bus by -L, -ta and -tz.
    for (const char* const good :
         {"(1700000001.000000) can1 100#01\n(1700000001.150000) can1 100#02\n"
          "(1700000001.299000) can1 100#03\n",
          " (1700000001.000000)  can1  100   [1]  01\n (1700000001.150000)  can1  100   [1]  02\n"
          " (1700000001.299000)  can1  100   [1]  03\n",
          " (000.000000)  can1  100   [1]  01\n (000.150000)  can1  100   [1]  02\n"
          " (000.299000)  can1  100   [1]  03\n"}) {
        EXPECT_EQ(read_log(good).error, "");
        EXPECT_EQ(read_log(good).frames.size(), 3U);
    }
    const std::string early = line("100#01"), late = "(1547073999.000000) can0 100#02\n";
    EXPECT_NE(read_log(late + early).error.find("Sort the trace."), std::string::npos);
    EXPECT_EQ(read_log(early + late).error, "") << "sorted";
}

class CandumpFile : public testing::Test {
  protected:
    void SetUp() override {
        char name[] = "/tmp/axg-candump-XXXXXX";
        ASSERT_NE(mkdtemp(name), nullptr);
        folder_ = name;
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::filesystem::path folder_;
};

TEST_F(CandumpFile, LinesAcrossBufferBoundsAreWhole) {
    const auto path = folder_ / "long.log";
    constexpr int kFrames = 60'000;  // 2 MB: several buffers
    {
        std::ofstream out(path);
        for (int i = 0; i < kFrames; ++i) {
            char text[64];
            std::snprintf(text, sizeof text, "(%010d.%06d) can0 123#%0*X\n", i / 1000,
                          i % 1000 * 1000, 2 + 2 * (i % 8), i % 251);
            out << text;
        }
    }
    std::string error;
    const auto reader = open_trace(path, {}, error);
    ASSERT_NE(reader, nullptr) << error;
    CanFrame frame;
    int count = 0;
    for (; reader->next(frame); ++count) {
        ASSERT_EQ(frame.time_us, std::int64_t{count} * 1000);
        ASSERT_EQ(frame.length_bytes, 1 + count % 8);
        ASSERT_EQ(frame.data[frame.length_bytes - 1U], count % 251);
    }
    EXPECT_EQ(reader->error(), "");
    EXPECT_EQ(count, kFrames);
    EXPECT_EQ(reader->line(), static_cast<std::uint64_t>(kFrames));
}

TEST_F(CandumpFile, TheNameAppearsOnlyWhenTheLogIsComplete) {
    const auto path = folder_ / "out.log";
    {
        CandumpWriter abandoned(path);
        CanFrame frame;
        EXPECT_TRUE(abandoned.write(frame));
        EXPECT_FALSE(std::filesystem::exists(path));
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder_));
    CandumpWriter writer(path);
    CanFrame frame;
    frame.time_us = 5;
    frame.id = 0x181;
    frame.length_bytes = 2;
    frame.data[1] = 0xAB;
    EXPECT_TRUE(writer.write(frame));
    ASSERT_TRUE(writer.finish()) << writer.error();
    std::ifstream in(path);
    std::string text;
    std::getline(in, text);
    EXPECT_EQ(text, "(0000000000.000005) can0 181#00AB");
    EXPECT_FALSE(writer.write(frame));
    EXPECT_FALSE(writer.error().empty());
}

TEST_F(CandumpFile, AFullDiskIsSaidAndLeavesNothingBehind) {
    CandumpWriter nowhere((folder_ / "missing" / "out.log").string());
    EXPECT_FALSE(nowhere.write(CanFrame{}));
    EXPECT_FALSE(nowhere.finish());
    EXPECT_NE(nowhere.error().find("missing/out.log"), std::string::npos);
}

// The same from a file, where a line crosses the buffer.
TEST_F(CandumpFile, ATooLongLineIsPassedOverWithFixedMemory) {
    const std::string path = folder_ / "long.log";
    std::ofstream(path) << line("123#11") << std::string(3U << 20U, 'x') << '\n' << line("123#22");
    std::string error;
    const auto reader = open_trace(path, {.lenient = true}, error);
    ASSERT_NE(reader, nullptr) << error;
    EXPECT_EQ(frames_of(*reader).size(), 2U);
    EXPECT_EQ(reader->error(), "");
    EXPECT_EQ(reader->skipped(), 1U);
    EXPECT_EQ(reader->line(), 3U);
}

TEST_F(CandumpFile, WhatIsNoTraceIsRefusedByName) {
    const auto say = [&](const char* name, const std::string& content) {
        std::ofstream(folder_ / name) << content;
        std::string error;
        EXPECT_EQ(open_trace(folder_ / name, {}, error), nullptr);
        return error;
    };
    EXPECT_NE(
        say("a", "hello\n").find("a:1: invalid file (found \"hello\", expected a candump log"),
        std::string::npos);
    EXPECT_NE(say("b", "\n \n").find("b: the trace is empty"), std::string::npos);
    // candump without an option: no converter can add times.
    const std::string untimed = say("c", "  can1  2A0   [2]  07 08\n");
    EXPECT_NE(untimed.find("c:1: invalid file (found \"  can1  2A0   [2]  07 08\", expected a time "
                           "before each frame). Record with candump -L or -ta."),
              std::string::npos)
        << untimed;
    EXPECT_NE(
        say("d", "MDF     4.10    amdf\n").find(". Convert MF4 with can_logconvert of PyPI's "),
        std::string::npos);
    std::string error;
    EXPECT_EQ(open_trace(folder_, {}, error), nullptr);
    EXPECT_NE(error.find("found a folder, expected a trace file"), std::string::npos) << error;
    EXPECT_EQ(open_trace(folder_ / "none", {}, error), nullptr);
    EXPECT_NE(error.find("cannot be opened"), std::string::npos);
}

TEST(AppendCandump, WritesTheCoreThatAllReadersShare) {
    const auto written = [](auto change, bool directions = false) {
        CanFrame frame;
        frame.time_us = 1'547'073'727'670'704;
        frame.id = 0x1AB;
        frame.length_bytes = 2;
        frame.data[0] = 0xFE;
        change(frame);
        std::string text;
        append_candump(text, frame, "can0", directions);
        return text;
    };
    const std::string time = "(1547073727.670704) can0 ";
    EXPECT_EQ(written([](CanFrame&) {}), time + "1AB#FE00\n");
    EXPECT_EQ(written([](CanFrame& f) { f.extended = true; }), time + "000001AB#FE00\n");
    EXPECT_EQ(written([](CanFrame& f) { f.remote = true; }), time + "1AB#R2\n");
    EXPECT_EQ(written([](CanFrame& f) { f.fd = f.bit_rate_switch = true; }), time + "1AB##1FE00\n");
    EXPECT_EQ(written([](CanFrame& f) { f.raw_dlc = 9; }), time + "1AB#FE00\n");
    EXPECT_EQ(written([](CanFrame& f) {
                  f.error = true;
                  f.length_bytes = 8;
              }),
              time + "200001AB#FE00000000000000\n");
    EXPECT_EQ(written([](CanFrame& f) { f.sent_by_host = true; }, true), time + "1AB#FE00 T\n");
    EXPECT_EQ(written([](CanFrame&) {}, true), time + "1AB#FE00 R\n");
}

}  // namespace
}  // namespace axg
