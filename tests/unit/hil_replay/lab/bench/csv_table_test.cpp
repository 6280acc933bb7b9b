// SPDX-License-Identifier: Apache-2.0
// A table is read whole or refused with file and line.
#include "hil_replay/lab/bench/csv_table.hpp"

#include <gtest/gtest.h>

#include <array>

#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

constexpr std::array<std::string_view, 2> kColumns{"name", "size"};

class CsvTableTest : public testing::Test {
  protected:
    /// The message, or nothing when the table was read; kept in `table`.
    std::string read(const std::string& text) {
        table = CsvTable();
        const std::string path = shop.write("t.csv", text);
        return table.read(path, kColumns) ? std::string() : table.error();
    }
    static void expect_at(const std::string& message, const std::string& where,
                          const std::string& what) {
        EXPECT_NE(message.find("t.csv:" + where + ": "), std::string::npos) << message;
        EXPECT_NE(message.find(what), std::string::npos) << message;
    }
    test::Workshop shop;
    CsvTable table;
};

TEST_F(CsvTableTest, AByteOrderMarkIsPassedOver) {
    ASSERT_EQ(read("\xEF\xBB\xBFname,size\nball,3\n"), "");
    EXPECT_EQ(table.cell(0, 0), "ball");
}

TEST_F(CsvTableTest, FindsColumnsByNameInAnyOrderAmongOthers) {
    ASSERT_EQ(read("size,comment,name\n3,x,ball\n\n4,y,\"box\"\r\n"), "");
    ASSERT_EQ(table.row_count(), 2U);
    EXPECT_EQ(table.cell(0, 0), "ball");
    EXPECT_EQ(table.cell(0, 1), "3");
    EXPECT_EQ(table.cell(1, 0), "box");
    EXPECT_NE(table.where(1).find("t.csv:4"), std::string::npos) << "blank lines count";
}

TEST_F(CsvTableTest, BlanksAroundACellAndAMissingLastNewlineDoNotMatter) {
    ASSERT_EQ(read(" name ,\tsize\n a , 1"), "");
    EXPECT_EQ(table.cell(0, 0), "a");
    EXPECT_EQ(table.cell(0, 1), "1");
}

TEST_F(CsvTableTest, AnEmptyCellIsACell) {
    ASSERT_EQ(read("name,size\na,\n,b\n"), "");
    EXPECT_EQ(table.cell(0, 1), "");
    EXPECT_EQ(table.cell(1, 0), "");
}

TEST_F(CsvTableTest, RefusesWithFileAndLine) {
    expect_at(read("name,length\na,1\n"), "1", "no column 'size'");
    expect_at(read("name,size\na,1\nb\n"), "3", "1 cells (expected 2");
    expect_at(read("name,size\na,1\n\nb,2,3\n"), "4", "3 cells (expected 2");
    expect_at(read("name,size\n"), "1", "no rows");
    expect_at(read(""), "1", "no rows");
}

TEST_F(CsvTableTest, WhatCannotBeReadIsNamedAndEndsNothing) {
    EXPECT_FALSE(table.read(shop.file("none.csv"), kColumns));
    EXPECT_NE(table.error().find("none.csv: cannot be read"), std::string::npos) << table.error();
    std::filesystem::create_directory(shop.file("folder.csv"));
    CsvTable other;
    EXPECT_FALSE(other.read(shop.file("folder.csv"), kColumns));
    EXPECT_NE(other.error().find("folder.csv: cannot be read"), std::string::npos) << other.error();
}

TEST(ReadNumber, TakesAFiniteDecimalNumberAndNothingElse) {
    double value = 7;
    for (const char* const text : {"0", "-1.5", "1e3", "-0.0", "1e-300"}) {
        EXPECT_TRUE(read_number(text, value)) << text;
    }
    EXPECT_TRUE(read_number("2.25", value));
    EXPECT_EQ(value, 2.25);
    for (const char* const text : {"", " 1", "1 ", "+1", "1,5", "0x10", "nan", "inf", "-inf",
                                   "1e999", "1.5mm", "--1", "."}) {
        EXPECT_FALSE(read_number(text, value)) << text;
    }
}

}  // namespace
}  // namespace axg
