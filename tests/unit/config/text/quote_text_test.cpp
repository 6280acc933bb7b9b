// SPDX-License-Identifier: Apache-2.0
// Foreign text is shown, never obeyed.
#include "config/text/quote_text.hpp"

#include <gtest/gtest.h>

#include "config/text/nearest_word.hpp"

namespace axg {
namespace {

TEST(QuoteText, PlainTextAndLettersOfAnyLanguageStay) {
    EXPECT_EQ(escaped("plate 3 \"b\""), "plate 3 \"b\"");
    EXPECT_EQ(escaped("Fr\xC3\xA4se \xE5\x88\x80"), "Fr\xC3\xA4se \xE5\x88\x80");
    EXPECT_EQ(quoted("a\"b\\c"), "\"a\\\"b\\\\c\"");
}

TEST(QuoteText, WhatSteersATerminalIsEscaped) {
    EXPECT_EQ(escaped("\x1b[2J"), "\\x1b[2J");
    EXPECT_EQ(escaped(std::string("a\0b\n\r\t\x7f", 7)), "a\\x00b\\n\\r\\t\\x7f");
    EXPECT_EQ(escaped("\xC2\x9B"
                      "31m"),
              "\\u009b31m");  // CSI as one C1 character
    EXPECT_EQ(escaped("\xE2\x80\xAE"
                      "txt"),
              "\\u202etxt");                                // right-to-left override
    EXPECT_EQ(escaped("\xF3\xA0\x81\x81"), "\\U000e0041");  // invisible tag letter
}

TEST(QuoteText, BrokenUtf8IsShownByteByByte) {
    EXPECT_EQ(escaped("\xFF"), "\\xff");
    EXPECT_EQ(escaped("\xC0\xAF"), "\\xc0\\xaf");           // overlong /
    EXPECT_EQ(escaped("\xED\xA0\x80"), "\\xed\\xa0\\x80");  // surrogate
    EXPECT_EQ(escaped("\xF4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");
    EXPECT_EQ(escaped("\xE2\x82"), "\\xe2\\x82");  // cut off
}

TEST(QuoteText, LongTextIsCut) {
    EXPECT_EQ(escaped(std::string(10, 'a'), 10), std::string(10, 'a'));
    EXPECT_EQ(escaped(std::string(11, 'a'), 10), std::string(10, 'a') + "...");
}

TEST(NearestWord, OneSlipIsForgivenAndAnotherWordIsNot) {
    constexpr std::string_view kWords[] = {"name", "travel_mm", "x"};
    EXPECT_EQ(nearest_word("nmae", kWords), "name");
    EXPECT_EQ(nearest_word("Name", kWords), "name");
    EXPECT_EQ(nearest_word("travelmm", kWords), "travel_mm");
    EXPECT_EQ(nearest_word("trevel_nn", kWords), "travel_mm");
    EXPECT_EQ(nearest_word("colour", kWords), "");
    EXPECT_EQ(nearest_word("y", kWords), "");
    EXPECT_EQ(nearest_word("", kWords), "");
    EXPECT_EQ(nearest_word(std::string(65, 'x'), kWords), "");
}

}  // namespace
}  // namespace axg
