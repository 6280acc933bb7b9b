// SPDX-License-Identifier: Apache-2.0
// What the tests read JSON with fails loudly: a key, an element or a type that is not there throws,
// and what compares equal is equal.
#include "tests/support/json_value.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <exception>
#include <string>

namespace axg::test {
namespace {

const char* const kText = R"({"a": [1, -2, 3.5], "b": {"c": null, "d": "text"}, "e": true})";

TEST(JsonValue, AMissingKeyOrElementThrows) {
    const Json value = Json::parse(kText);
    EXPECT_THROW((void)value["x"], std::exception);
    EXPECT_THROW((void)value.at("x"), std::exception);
    EXPECT_THROW((void)value["b"]["x"].is_null(), std::exception);
    EXPECT_THROW((void)value["a"][3], std::exception);
    EXPECT_THROW((void)value["a"][-1], std::exception);
    EXPECT_THROW((void)Json::array({}).back(), std::exception);
    EXPECT_TRUE(value["b"]["c"].is_null());
    EXPECT_EQ(value["a"].back(), 3.5);
    Json changed = value;
    EXPECT_THROW(changed.erase("x"), std::exception);
    changed.erase("a");
    changed.set("x", "new");
    changed.set("e", 2);
    EXPECT_EQ(changed.dump(), R"({"b":{"c":null,"d":"text"},"e":2,"x":"new"})");
}

TEST(JsonValue, AnotherTypeThrows) {
    const Json value = Json::parse(kText);
    const Json& list = value["a"];
    EXPECT_THROW((void)list["x"], std::exception);
    EXPECT_THROW((void)value[0], std::exception);
    EXPECT_THROW((void)list.contains("a"), std::exception);
    EXPECT_THROW((void)list.items(), std::exception);
    EXPECT_THROW((void)value.begin(), std::exception);
    EXPECT_THROW((void)value["e"].size(), std::exception);
    EXPECT_THROW((void)value["b"]["c"].empty(), std::exception);
    EXPECT_THROW((void)value["b"]["d"].empty(), std::exception);
    EXPECT_THROW(Json().set("a", 1), std::exception);
    EXPECT_THROW((void)value["e"].get<int>(), std::exception);
    EXPECT_THROW((void)value["e"].get<std::string>(), std::exception);
    EXPECT_THROW((void)list[0].get<bool>(), std::exception);
    EXPECT_THROW((void)list[0].get<std::string>(), std::exception);
    EXPECT_THROW((void)value["b"]["d"].get<double>(), std::exception);
    EXPECT_THROW((void)value["b"]["c"].get<double>(), std::exception);
    EXPECT_THROW((void)(value["e"] < 2), std::exception);
    EXPECT_THROW((void)(value["b"]["c"] >= 0), std::exception);
    EXPECT_THROW((void)(value["b"]["d"] < "z"), std::exception);
}

TEST(JsonValue, ANumberIsGivenAsATypeThatHoldsIt) {
    const Json list = Json::parse("[1, -2, 3.5, 255, 256, 18446744073709551615]");
    EXPECT_EQ(list[1].get<int>(), -2);
    EXPECT_THROW((void)list[1].get<unsigned>(), std::exception);
    EXPECT_THROW((void)list[2].get<int>(), std::exception);
    EXPECT_EQ(list[2].get<double>(), 3.5);
    EXPECT_EQ(list[0].get<double>(), 1);
    EXPECT_EQ(list[3].get<std::uint8_t>(), 255);
    EXPECT_THROW((void)list[4].get<std::uint8_t>(), std::exception);
    EXPECT_EQ(list[5].get<std::uint64_t>(), UINT64_MAX);
    EXPECT_THROW((void)list[5].get<std::int64_t>(), std::exception);
}

TEST(JsonValue, EqualIsWhatHasTheSameValue) {
    const Json value = Json::parse(kText);
    EXPECT_EQ(value, Json::parse(value.dump()));
    EXPECT_EQ(value["a"], Json::array({1.0, -2, 3.5}));
    EXPECT_NE(value["a"], Json::array({1, -2}));
    EXPECT_NE(value["a"], Json::array({-2, 1, 3.5}));
    EXPECT_EQ(value["b"], Json::object({{"d", "text"}, {"c", nullptr}}));
    EXPECT_NE(value["b"], Json::object({{"d", "text"}, {"x", nullptr}}));
    EXPECT_EQ(value["e"], true);
    EXPECT_NE(value["e"], 1);
    EXPECT_NE(value["a"][0], "1");
    EXPECT_NE(value["a"][1], UINT64_MAX - 1);
    EXPECT_NE(value["b"]["c"], 0);
    EXPECT_NE(value["b"]["c"], "");
    EXPECT_LT(value["a"][1], 0U);
    EXPECT_GT(value["a"][2], value["a"][0]);
    EXPECT_LE(value["a"][0], 1);
}

TEST(JsonValue, PrintsItsText) {
    EXPECT_EQ(testing::PrintToString(Json::parse("[1, {\"a\": 2.0}]")), R"([1,{"a":2.0}])");
    EXPECT_EQ(Json::array({1}).dump(1), "[\n 1\n]");
}

TEST(JsonValue, WhatIsNoJsonIsNotRead) {
    EXPECT_TRUE(Json::accept("[]"));
    EXPECT_EQ(Json::parse("{}"), Json::object());
    for (const char* const text : {"", "[", "{\"a\"}", "[1,]", "nul", "[] []", "\"\xff\""}) {
        EXPECT_FALSE(Json::accept(text)) << text;
        EXPECT_THROW((void)Json::parse(text), std::exception) << text;
    }
    EXPECT_THROW((void)Json::parse_file("/no/such/file.json"), std::exception);
}

}  // namespace
}  // namespace axg::test
