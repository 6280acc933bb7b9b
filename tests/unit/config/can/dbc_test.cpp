// SPDX-License-Identifier: Apache-2.0
// DBC files as text: what is read of them, and every way in which one is refused, line included.
#include "config/can/dbc.hpp"

#include <gtest/gtest.h>

#include "config/can/dbc_signal.hpp"
#include "tests/support/dbc_text.hpp"

namespace axg {
namespace {

using test::kBoardDbc;
using test::with;

std::string faults_of(const std::string& text) {
    Dbc dbc;
    std::string all;
    for (const ConfigFault& fault : parse_dbc(text, "b.dbc", dbc)) {
        all += to_string(fault) + '\n';
    }
    EXPECT_TRUE(all.empty() || dbc.messages.empty()) << "a machine and faults at once";
    return all;
}

Dbc read(const std::string& text) {
    Dbc dbc;
    const auto faults = parse_dbc(text, "b.dbc", dbc);
    EXPECT_TRUE(faults.empty()) << to_string(faults.front());
    return dbc;
}

TEST(DbcFile, SaysWhatItsLinesSay) {
    const Dbc dbc = read(kBoardDbc);
    ASSERT_EQ(dbc.messages.size(), 4U);
    const DbcMessage& linear = dbc.messages[0];
    EXPECT_EQ(linear.name, "Linear");
    EXPECT_EQ(linear.id, 385U);
    EXPECT_EQ(linear.length_bytes, 8U);
    EXPECT_EQ(linear.line, 12);
    ASSERT_EQ(linear.signals.size(), 5U);
    const DbcSignal& x = linear.signals[0];
    EXPECT_EQ(x.name, "X");
    EXPECT_EQ(x.line, 13);
    EXPECT_EQ(x.start_bit, 0U);
    EXPECT_EQ(x.length_bits, 32U);
    EXPECT_EQ(x.order, ByteOrder::little);
    EXPECT_TRUE(x.is_signed);
    EXPECT_EQ(x.factor, 0.0001);
    EXPECT_EQ(x.minimum, -300);
    EXPECT_EQ(x.maximum, 300);
    EXPECT_EQ(x.unit, "mm");
    EXPECT_EQ(linear.signals[3].order, ByteOrder::big);
    EXPECT_EQ(dbc.messages[1].signals[0].type, SignalType::float32);
    EXPECT_EQ(dbc.messages[1].signals[1].type, SignalType::integer);
    const DbcMessage& pages = dbc.messages[2];
    EXPECT_EQ(pages.signals[0].turn, DbcSignal::Turn::selector);
    EXPECT_EQ(pages.signals[2].turn, DbcSignal::Turn::selected);
    EXPECT_EQ(pages.signals[2].selected_by, 1U);
    EXPECT_EQ(pages.signals[3].turn, DbcSignal::Turn::both);
    EXPECT_EQ(pages.signals[3].multiplexor, 0U);
    EXPECT_TRUE(dbc.messages[3].is_extended);
    EXPECT_EQ(dbc.messages[3].id, 129U);
}

TEST(DbcFile, LineEndsBlanksAndAByteOrderMarkMeanNothing) {
    std::string text = kBoardDbc;
    for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) {
        text.replace(at, 1, "\r\n");
    }
    EXPECT_EQ(read("\xEF\xBB\xBF" + text).messages.size(), 4U);
    EXPECT_EQ(read("BO_ 1 M : 8 N SG_ S:0|8@1+(1,0)[0|0]\"\"N\n").messages[0].signals.size(), 1U);
    EXPECT_EQ(read("").messages.size(), 0U);
    EXPECT_EQ(read("NS_:\nBS_:\nBU_:\nBO_ 1 M: 8 N").messages.size(), 1U);
    EXPECT_EQ(
        read("NS_ :\n\tCM_\nCM_ \"a section; and not a symbol\";\nBO_ 1 M: 8 N").messages.size(),
        1U);
}

TEST(DbcFile, FlexibleFramesAreTheLongOnesAndThoseSaidToBe) {
    const Dbc dbc = read(
        "BO_ 1 A: 8 N\nBO_ 2 B: 64 N\nBO_ 3 C: 8 N\n"
        "BA_DEF_ BO_ \"VFrameFormat\" ENUM \"StandardCAN\",\"ExtendedCAN\";\n"
        "BA_ \"VFrameFormat\" BO_ 3 14;\nBA_ \"Other\" BO_ 1 14;\nBA_ \"VFrameFormat\" BO_ 9 "
        "14;\n");
    EXPECT_FALSE(dbc.messages[0].is_flexible);
    EXPECT_TRUE(dbc.messages[1].is_flexible);
    EXPECT_TRUE(dbc.messages[2].is_flexible);
}

TEST(DbcFile, TheMessageOfNoMessageIsReadOver) {
    for (const std::string id : {"3221225472", "1073741824"}) {
        const Dbc dbc = read("BO_ " + id +
                             " VECTOR__INDEPENDENT_SIG_MSG: 0 Vector__XXX\n"
                             " SG_ Lost : 0|8@1+ (1,0) [0|0] \"\" Vector__XXX\n"
                             "SIG_VALTYPE_ " +
                             id + " Lost : 1;\n");
        EXPECT_TRUE(dbc.messages.empty()) << id;
    }
}

TEST(DbcFile, WhatRestatesASignalKeepsItFromUse) {
    const auto reason = [](const std::string& more) {
        return read(kBoardDbc + more).messages[2].signals[1].refused;
    };
    EXPECT_EQ(reason(""), "");
    EXPECT_EQ(reason("SIG_TYPE_REF_ 400 P0 : T;\n"), "SIG_TYPE_REF_ in line 39");
    EXPECT_EQ(reason("SG_MUL_VAL_ 385 X Page 0-0;\n"), "");
    const Dbc orphan = read("BO_ 1 M: 8 N\n SG_ S m0 : 0|8@1+ (1,0) [0|0] \"\" N\n");
    EXPECT_EQ(orphan.messages[0].signals[0].refused, "a multiplexed message without multiplexor");
    const Dbc two = read(
        "BO_ 1 M: 8 N\n SG_ S M : 0|8@1+ (1,0) [0|0] \"\" N\n"
        " SG_ T M : 8|8@1+ (1,0) [0|0] \"\" N\n SG_ P m0 : 16|8@1+ (1,0) [0|0] \"\" N\n");
    EXPECT_EQ(two.messages[0].signals[0].refused, "") << "each M is in every frame";
    EXPECT_EQ(two.messages[0].signals[2].refused,
              "a page without SG_MUL_VAL_, beside a second multiplexor");
}

/// One message: M at bit 0, m2M and m7M within it, and pages.
const std::string kPages =
    "BO_ 1 M: 8 N\n SG_ S M : 0|8@1+ (1,0) [0|0] \"\" N\n"
    " SG_ A m1 : 8|8@1+ (1,0) [0|0] \"\" N\n SG_ B m2M : 16|8@1+ (1,0) [0|0] \"\" N\n"
    " SG_ C m1 : 24|8@1+ (1,0) [0|0] \"\" N\n SG_ D : 32|8@1+ (1,0) [0|0] \"\" N\n"
    " SG_ E m7M : 40|8@1+ (1,0) [0|0] \"\" N\n SG_ F m0 : 48|8@1+ (1,0) [0|0] \"\" N\n";

/// Why a signal of kPages cannot be used with these lines added; empty: it can.
std::string refusal(std::size_t signal, const std::string& lines, CanSignal& out) {
    const Dbc dbc = read(kPages + lines);
    return to_can_signal(dbc.messages[0], dbc.messages[0].signals[signal], out);
}
std::string refusal(std::size_t signal, const std::string& lines) {
    CanSignal out;
    return refusal(signal, lines, out);
}

// A page whose multiplexor is not known would be read in frames of another page.
TEST(DbcFile, APageOfAnUnknownMultiplexorIsRefused) {
    const std::string without = "a page without SG_MUL_VAL_, beside a second multiplexor";
    EXPECT_EQ(refusal(1, ""), without) << "of S, B or E";
    EXPECT_EQ(refusal(0, ""), "") << "in every frame";
    EXPECT_EQ(refusal(4, ""), "") << "in every frame";
    EXPECT_EQ(refusal(1, "SG_MUL_VAL_ 1 A S 1-1;\n"), "");
    EXPECT_EQ(refusal(3, "SG_MUL_VAL_ 1 A S 1-1;\n"), without);
    EXPECT_EQ(refusal(1, "SG_MUL_VAL_ 1 A B 1-1;\n"), without) << "B's own is not known";
    EXPECT_EQ(refusal(1, "SG_MUL_VAL_ 1 A B 1-1;\nSG_MUL_VAL_ 1 B S 2-2;\n"), "");
    for (const auto& [lines, why] : {
             std::pair{"SG_MUL_VAL_ 1 A S 2-2;\n", "an SG_MUL_VAL_ without the number of its m"},
             std::pair{"SG_MUL_VAL_ 1 A S 3-1;\n", "an SG_MUL_VAL_ whose range decreases"},
             std::pair{"SG_MUL_VAL_ 1 A D 1-1;\n", "an SG_MUL_VAL_ whose multiplexor is none"},
             std::pair{"SG_MUL_VAL_ 1 A X 1-1;\n", "an SG_MUL_VAL_ whose multiplexor is none"},
             std::pair{"SG_MUL_VAL_ 1 A S 1-1;\nSG_MUL_VAL_ 1 A S 1-2;\n",
                       "two SG_MUL_VAL_ that differ"},
             std::pair{"SG_MUL_VAL_ 1 A S 1-1;\nSG_MUL_VAL_ 1 A B 1-1;\n",
                       "two SG_MUL_VAL_ that differ"},
         }) {
        EXPECT_EQ(refusal(1, lines), why) << lines;
    }
    EXPECT_EQ(refusal(1, "SG_MUL_VAL_ 1 A S 1-1;\nSG_MUL_VAL_ 1 A S 1-1;\n"), "");
    EXPECT_EQ(refusal(4, "SG_MUL_VAL_ 1 D S 0-0;\n"), "SG_MUL_VAL_, but no m in its SG_");
    EXPECT_EQ(refusal(0, "SG_MUL_VAL_ 1 S B 0-0;\n"), without) << "of B, which is not known";
}

TEST(DbcFile, SeveralValuesAndLevelsBecomeOneSelector) {
    CanSignal wire;
    ASSERT_EQ(refusal(1, "SG_MUL_VAL_ 1 A S 9-9, 1-2, 3-5,1-1;\n", wire), "");
    ASSERT_EQ(wire.selector.level_count, 1);
    EXPECT_EQ(wire.selector.levels[0], (SignalSelector::Level{0, 8, ByteOrder::little, 2}));
    EXPECT_EQ(wire.selector.ranges[0], (SignalSelector::Range{1, 5})) << "they touch";
    EXPECT_EQ(wire.selector.ranges[1], (SignalSelector::Range{9, 9}));
    const std::string lines =
        "SG_MUL_VAL_ 1 C E 1-1, 3-3;\nSG_MUL_VAL_ 1 E B 7-300;\nSG_MUL_VAL_ 1 B S 2-2;\n";
    ASSERT_EQ(refusal(3, lines, wire), "");
    ASSERT_EQ(wire.selector.level_count, 3);
    EXPECT_EQ(wire.selector.levels[0].start_bit, 0) << "S, the outermost";
    EXPECT_EQ(wire.selector.levels[2].start_bit, 40) << "E";
    EXPECT_EQ(wire.selector.ranges[0], (SignalSelector::Range{2, 2}));
    EXPECT_EQ(wire.selector.ranges[1], (SignalSelector::Range{7, 255})) << "of 8 bits";
    EXPECT_EQ(wire.selector.ranges[3], (SignalSelector::Range{3, 3}));
}

// cantools wrote M for each multiplexor once.
TEST(DbcFile, AnMWithALineIsAPage) {
    const Dbc dbc =
        read(with(kPages, "B m2M", "B M") + "SG_MUL_VAL_ 1 A B 1-1;\nSG_MUL_VAL_ 1 B S 4-5;\n");
    CanSignal wire;
    ASSERT_EQ(to_can_signal(dbc.messages[0], dbc.messages[0].signals[1], wire), "");
    EXPECT_EQ(wire.selector.level_count, 2);
    EXPECT_EQ(wire.selector.ranges[0], (SignalSelector::Range{4, 5}));
    ASSERT_EQ(to_can_signal(dbc.messages[0], dbc.messages[0].signals[2], wire), "");
    EXPECT_EQ(wire.selector.level_count, 1);
}

TEST(DbcFile, WhatASelectorCannotHoldIsRefused) {
    std::string eight = "SG_MUL_VAL_ 1 A S 1-1, 3-3, 5-5, 7-7, 9-9, 11-11, 13-13, 15-15";
    EXPECT_EQ(refusal(1, eight + ";\n"), "");
    EXPECT_EQ(refusal(1, eight + ", 17-17;\n"), "more than 8 ranges of multiplexor values");
    EXPECT_EQ(refusal(1, "SG_MUL_VAL_ 1 A S 1-1, 255-256;\n"), "");
    EXPECT_EQ(refusal(1, "SG_MUL_VAL_ 1 A S 1-1, 256-256;\n"),
              "a multiplexor value that its multiplexor cannot represent");
    const std::string circle = "more than 3 multiplexors, one in the other";
    EXPECT_EQ(refusal(2, "SG_MUL_VAL_ 1 B B 2-2;\n"), circle);
    EXPECT_EQ(refusal(1,
                      "SG_MUL_VAL_ 1 A B 1-1;\nSG_MUL_VAL_ 1 B E 2-2;\n"
                      "SG_MUL_VAL_ 1 E B 7-7;\n"),
              circle);
    const auto changed = [](const std::string& bits, const std::string& lines) {
        const Dbc dbc = read(with(kPages, "16|8@1+", bits) + "SG_MUL_VAL_ 1 B S 2-2;\n" + lines);
        CanSignal out;
        const std::string why = to_can_signal(dbc.messages[0], dbc.messages[0].signals[1], out);
        return why.empty() ? std::to_string(out.selector.ranges[1].most) : why;
    };
    const std::string of_b = "SG_MUL_VAL_ 1 A B 1-200;\n";
    EXPECT_EQ(changed("8|8@1+", of_b), "200");
    EXPECT_EQ(changed("7|8@1+", of_b), "multiplexors that share bits");
    EXPECT_EQ(changed("60|8@1+", of_b), "bits outside the message's 8 bytes");
    EXPECT_EQ(changed("16|8@1-", of_b), "127") << "the others are negative";
    EXPECT_EQ(changed("16|8@1-", "SG_MUL_VAL_ 1 A B 1-1, 127-128;\n"), "1");
    EXPECT_EQ(changed("16|8@1-", "SG_MUL_VAL_ 1 A B 1-1, 128-128;\n"),
              "a multiplexor value that its multiplexor cannot represent");
    EXPECT_EQ(changed("16|32@1-", of_b), "200");
    const std::string why = "a message whose multiplexor is a float, or longer than 32 bits";
    EXPECT_EQ(changed("16|33@1-", of_b), why);
    EXPECT_EQ(changed("16|32@1-", of_b + "SIG_VALTYPE_ 1 B : 1;\n"), why);
}

TEST(DbcFile, TheFirstThingThatCannotBeReadIsSaidWithItsLine) {
    struct Case {
        const char *from, *to, *said;
    };
    for (const Case& c : {
             Case{"385 Linear:", "0x181 Linear:",
                  "b.dbc:12: BO_: invalid value (found \"0x181\", expected an identifier in "
                  "decimal, such as 385).\n"},
             Case{"385 Linear:", "385 9Linear:",
                  "b.dbc:12: BO_: invalid value (found \"9Linear\", expected the message's name: "
                  "letters, digits and _).\n"},
             Case{"Linear: 8", "Linear 8",
                  "b.dbc:12: BO_: invalid value (found \"8\", expected \":\").\n"},
             Case{"Linear: 8", "Linear: -8",
                  "b.dbc:12: BO_: invalid value (found \"-8\", expected the message's length in "
                  "bytes).\n"},
             Case{"SG_ X :", "SG_ Position X :",
                  "b.dbc:13: BO_ Linear SG_ Position: invalid value (found \"X\", expected \":\", "
                  "or M, or m and a number).\n"},
             Case{"0|32@1- (0.0001", "0|32@2- (0.0001",
                  "b.dbc:13: BO_ Linear SG_ X: invalid value (found \"2\", expected the byte "
                  "order: 0 Motorola, 1 Intel).\n"},
             Case{"0|32@1- (0.0001", "0|32@1 (0.0001",
                  "b.dbc:13: BO_ Linear SG_ X: invalid value (found \"(\", expected + (unsigned) "
                  "or - (signed)).\n"},
             Case{"(0.0001,0)", "(0,0001,0)",
                  "b.dbc:13: BO_ Linear SG_ X: invalid value (found \",\", expected \")\").\n"},
             Case{"(0.0001,0)", "(1e999,0)",
                  "b.dbc:13: BO_ Linear SG_ X: invalid value (found \"1e999\", expected a number, "
                  "such as 0.0001).\n"},
             Case{"[-300|300]", "[-300..300]",
                  "b.dbc:13: BO_ Linear SG_ X: invalid value (found \"-300..300\", expected a "
                  "number, such as 0.0001).\n"},
             Case{"\"mm\" Guard", "mm Guard",
                  "b.dbc:13: BO_ Linear SG_ X: invalid value (found \"mm\", expected the unit in "
                  "quotation marks, \"\" for none).\n"},
             Case{"measures it\";", "measures it;",
                  "b.dbc:35: CM_: invalid value (found \"rest\\\" 1 \\\"\", expected"},
             Case{"A : 1;", "A : 1",
                  "b.dbc:36: SIG_VALTYPE_: invalid value (found \"SG_MUL_VAL_\", expected "
                  "\";\").\n"},
             Case{"Deep Page 2-2;", "Deep Page 2-2",
                  "b.dbc:39: SG_MUL_VAL_: invalid value (found the end of the file, expected "
                  "\";\").\n"},
             Case{"Deep Page 2-2;", "Deep Page 2;",
                  "b.dbc:38: SG_MUL_VAL_: invalid value (found \";\", expected a range of "
                  "multiplexor values, such as 1-3).\n"},
             Case{"A : 1;", "A : 4;",
                  "b.dbc:35: SIG_VALTYPE_: invalid value (found \"4\", expected 0 integer, 1 float "
                  "or 2 double).\n"},
             Case{"VERSION \"1.0\"", "VERSION 1.0",
                  "b.dbc:1: VERSION: invalid value (found \"1.0\", expected a text in quotation "
                  "marks).\n"},
             Case{"BS_:", "SG_ Y : 0|8@1+ (1,0) [0|0] \"\" N",
                  "b.dbc:8: SG_: invalid value (found \"SG_\", expected SG_ only inside a message, "
                  "after BO_).\n"},
             Case{"BU_: Board Guard", "NODES: Board",
                  "b.dbc:10: invalid file (found \"NODES\", expected a section, as BO_ or CM_).\n"},
         }) {
        const std::string faults = faults_of(with(kBoardDbc, c.from, c.to));
        if (std::string_view(c.from) == "measures it\";") {
            EXPECT_NE(faults, "") << "a text that swallows the next one ends nowhere";
            continue;
        }
        EXPECT_EQ(faults, c.said);
    }
    EXPECT_EQ(faults_of("CM_ \"open"),
              "b.dbc:1: CM_: invalid value (found a text without its closing quotation mark, "
              "expected \";\" at the end of the statement that begins in line 1).\n");
    EXPECT_EQ(faults_of("CM_ \"closed\""),
              "b.dbc:1: CM_: invalid value (found the end of the file, expected \";\" at the end "
              "of the statement that begins in line 1).\n");
}

TEST(DbcFile, ContradictionsAreSaidAllAtOnce) {
    EXPECT_EQ(faults_of("BO_ 1 M: 8 N\n SG_ S : 0|8@1+ (1,0) [0|0] \"\" N\n"
                        " SG_ S : 8|8@1+ (1,0) [0|0] \"\" N\n"
                        "BO_ 1 M: 8 N\n"
                        "BO_ 2048 O: 8 N\n"
                        "SIG_VALTYPE_ 1 S : 1;\nSIG_VALTYPE_ 1 T : 1;\nSIG_VALTYPE_ 1 S : 3;\n"),
              "b.dbc:3: BO_ M: invalid value (found \"S\", expected one signal of that name in a "
              "message).\nb.dbc:4: BO_ M: invalid value (found 1, expected one message for each "
              "identifier).\nb.dbc:4: BO_: invalid value (found \"M\", expected one message of "
              "that name).\nb.dbc:5: BO_: invalid value (found 2048, expected an identifier up to "
              "2047, or one of 29 bits with bit 31 set).\nb.dbc:6: SIG_VALTYPE_ 1: invalid value "
              "(found type 1 of 8 bits, expected 0 integer, 1 float of 32 bits or 2 double of "
              "64).\nb.dbc:7: SIG_VALTYPE_ 1: invalid value (found \"T\", expected a signal of "
              "that message).\nb.dbc:8: SIG_VALTYPE_ 1: invalid value (found type 3 of 8 bits, "
              "expected 0 integer, 1 float of 32 bits or 2 double of 64).\n");
}

TEST(DbcFile, SizesAreBounded) {
    std::string many;
    for (std::size_t i = 0; i <= kDbcMessagesMax; ++i) {
        many += "BO_ " + std::to_string(0x80000000U + i) + " M" + std::to_string(i) + ": 8 N\n";
    }
    EXPECT_NE(faults_of(many).find("expected at most 5000 messages"), std::string::npos);
    many.resize(many.rfind("BO_"));
    EXPECT_EQ(faults_of(many), "");
    EXPECT_EQ(faults_of(std::string(kDbcSizeBytesMax + 1, ' ')),
              "b.dbc:1: invalid file (found 4194305 bytes, expected at most 4194304 bytes).\n");
    EXPECT_EQ(faults_of(std::string(kDbcSizeBytesMax, ' ')), "");
    EXPECT_NE(faults_of("BO_ 1 " + std::string(129, 'M') + ": 8 N\n"), "");
    EXPECT_EQ(faults_of("BO_ 1 " + std::string(128, 'M') + ": 8 N\n"), "");
}

}  // namespace
}  // namespace axg
