// SPDX-License-Identifier: Apache-2.0
// The number grammar of machine files, on both sides of each rule.
#include "config/text/number_text.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace axg {
namespace {

TEST(DecimalNumber, TakesTheFormsOfJson) {
    EXPECT_EQ(decimal_number("0"), 0.0);
    EXPECT_EQ(decimal_number("12"), 12.0);
    EXPECT_EQ(decimal_number("-0.5"), -0.5);
    EXPECT_EQ(decimal_number("1.5e-3"), 1.5e-3);
    EXPECT_EQ(decimal_number("1E+3"), 1000.0);
    EXPECT_EQ(decimal_number("0.1"), 0.1);
    EXPECT_EQ(decimal_number("1.7976931348623157e308"), 1.7976931348623157e308);
    EXPECT_EQ(decimal_number("2.2250738585072014e-308"), 2.2250738585072014e-308);
}

TEST(DecimalNumber, RefusesEveryOtherForm) {
    for (const char* text :
         {"",      "-",     "+1",       ".5",       "1.",     "01",     "-01",      "00",
          "1e",    "1e+",   "e5",       "1.e5",     "0x10",   "0b1",    "0o17",     "1_000",
          "1,5",   "1 000", " 1",       "1 ",       "1mm",    "nan",    ".nan",     "inf",
          "-inf",  ".inf",  "infinity", "1e309",    "-1e309", "1e-400", "4.9e-324", "1.0f",
          "0x1p3", "--1",   "1-2",      "\xD9\xA1", "1\n",    "~",      "true"}) {
        EXPECT_FALSE(decimal_number(text).has_value()) << '"' << text << '"';
    }
    EXPECT_FALSE(decimal_number(std::string("1\0", 2)).has_value());
}

TEST(DecimalNumber, NegativeZeroIsZero) {
    ASSERT_TRUE(decimal_number("-0").has_value());
    EXPECT_FALSE(std::signbit(*decimal_number("-0")));
    EXPECT_FALSE(std::signbit(*decimal_number("-0.0e5")));
}

TEST(DecimalNumber, SixtyFourCharactersAreReadAndOneMoreIsNot) {
    EXPECT_EQ(decimal_number("1." + std::string(62, '0')), 1.0);
    EXPECT_FALSE(decimal_number("1." + std::string(63, '0')).has_value());
}

TEST(WholeNumber, TakesDigitsUpTo32Bits) {
    EXPECT_EQ(whole_number("0"), 0U);
    EXPECT_EQ(whole_number("4294967295"), 4294967295U);
    for (const char* text : {"", "-1", "+1", "4294967296", "010", "1.0", "1e3", "0x10", " 1"}) {
        EXPECT_FALSE(whole_number(text).has_value()) << '"' << text << '"';
    }
}

TEST(HexNumber, TakesHexAndWholeNumbers) {
    EXPECT_EQ(hex_number("0x080"), 0x80U);
    EXPECT_EQ(hex_number("0x7fF"), 0x7FFU);
    EXPECT_EQ(hex_number("385"), 385U);
    EXPECT_EQ(hex_number("0xFFFFFFFF"), 0xFFFFFFFFU);
    for (const char* text :
         {"0x", "0X10", "0x-1", "0x 1", "0x1g", "0x100000000", "080", "x10", "-0x1", "0x1.0"}) {
        EXPECT_FALSE(hex_number(text).has_value()) << '"' << text << '"';
    }
}

}  // namespace
}  // namespace axg
