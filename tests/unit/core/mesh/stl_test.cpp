// SPDX-License-Identifier: Apache-2.0
// Every way in which an STL file may be malformed is refused with its kind and place; both sides of
// each bound.
#include "core/mesh/stl.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "tests/support/solids.hpp"

namespace {

using namespace axg;
using axg::test::box;

std::span<const std::byte> bytes_of(const std::string& text) {
    return std::as_bytes(std::span(text));
}

StlResult read_text(const std::string& text) {
    return read_stl(bytes_of(text), 1.0);
}

std::vector<std::byte> binary_box() {
    return write_stl(box({0, 0, 0}, {10, 20, 30}));
}

void set_count(std::vector<std::byte>& bytes, std::uint32_t count) {
    std::memcpy(bytes.data() + 80, &count, 4);
}

void set_coordinate(std::vector<std::byte>& bytes, std::size_t facet, std::size_t k, float value) {
    std::memcpy(bytes.data() + 84 + 50 * facet + 12 + 4 * k, &value, 4);
}

std::string facet_text(const std::string& x) {
    return "facet normal 0 0 1\n outer loop\n  vertex " + x +
           " 0 0\n  vertex 1 0 0\n  vertex 0 1 0\n endloop\nendfacet\n";
}

std::string solid_text(const std::string& x) {
    return "solid part\n" + facet_text(x) + "endsolid part\n";
}

void expect_fault(const StlResult& result, StlFaultKind kind) {
    ASSERT_FALSE(result.faults.empty());
    EXPECT_EQ(result.faults[0].kind, kind);
    EXPECT_TRUE(result.triangles.empty());
}

// Editors put a byte-order mark first; programs of old ended lines with CR alone.
TEST(Stl, TextWithAByteOrderMarkOrOtherLineEndsIsReadAlike) {
    const StlResult wanted = read_text(solid_text("2"));
    ASSERT_EQ(wanted.triangles.size(), 1U);
    const auto with_ends = [](const std::string& end) {
        std::string text;
        for (const char c : solid_text("2")) {
            text += c == '\n' ? end : std::string(1, c);
        }
        return text;
    };
    EXPECT_EQ(read_text("\xEF\xBB\xBF" + solid_text("2")).triangles, wanted.triangles);
    EXPECT_EQ(read_text(with_ends("\r")).triangles, wanted.triangles);
    EXPECT_EQ(read_text(with_ends("\r\n")).triangles, wanted.triangles);
    const std::string bad = "solid part\nfacet normal 0 0 1\nouter loop\nvertex 1 2 z\n";
    for (const char* const end : {"\n", "\r", "\r\n"}) {
        std::string text;
        for (const char c : bad) {
            text += c == '\n' ? std::string(end) : std::string(1, c);
        }
        const StlResult result = read_text(text);
        ASSERT_FALSE(result.faults.empty());
        EXPECT_EQ(result.faults[0].line, 4U) << "counted alike";
    }
}

TEST(Stl, WrittenTrianglesAreReadBackUnchanged) {
    const auto triangles = box({-1.5F, 0.1F, 3e-30F}, {7, 9, 11});
    const StlResult result = read_stl(write_stl(triangles), 1.0);
    EXPECT_TRUE(result.faults.empty());
    EXPECT_TRUE(result.is_binary);
    EXPECT_EQ(result.triangles, triangles);
}

TEST(Stl, TruncatedAndTrailingBinaryIsRefused) {
    const auto whole = binary_box();
    for (std::size_t size = 85; size < whole.size(); ++size) {
        const StlResult result = read_stl(std::span(whole).first(size), 1.0);
        ASSERT_FALSE(result.faults.empty()) << size;
        EXPECT_EQ(result.faults[0].kind, StlFaultKind::wrong_size) << size;
        EXPECT_EQ(result.faults[0].got, size);
        EXPECT_EQ(result.faults[0].wanted, whole.size());
    }
    for (std::size_t size : {0U, 1U, 83U}) {
        expect_fault(read_stl(std::span(whole).first(size), 1.0), StlFaultKind::too_short);
    }
    auto longer = whole;
    longer.push_back(std::byte{0});
    expect_fault(read_stl(longer, 1.0), StlFaultKind::wrong_size);
}

TEST(Stl, LyingCountsAreRefusedWithoutTakingMemoryForThem) {
    for (const std::uint32_t count : {0U, 11U, 13U, 1U << 31U, 0xffffffffU}) {
        auto bytes = binary_box();
        set_count(bytes, count);
        const StlResult result = read_stl(bytes, 1.0);
        expect_fault(result, StlFaultKind::wrong_size);
        EXPECT_EQ(result.faults[0].wanted, 84 + 50 * static_cast<std::uint64_t>(count));
    }
    // 50 * 85899346 is 4 beyond 2^32: 32-bit arithmetic would accept a file of 88 bytes.
    std::vector<std::byte> wrapped(88);
    set_count(wrapped, 85899346U);
    expect_fault(read_stl(wrapped, 1.0), StlFaultKind::wrong_size);
}

TEST(Stl, AFileWithoutFacetsIsRefused) {
    std::vector<std::byte> bytes(84);
    const StlResult result = read_stl(bytes, 1.0);
    expect_fault(result, StlFaultKind::no_facets);
    expect_fault(read_text("solid nothing\nendsolid nothing\n"), StlFaultKind::no_facets);
}

TEST(Stl, TheSizeAloneTellsBinaryFromText) {
    auto bytes = binary_box();
    const std::string header = "solid says the header";
    std::memcpy(bytes.data(), header.data(), header.size());
    const StlResult binary = read_stl(bytes, 1.0);
    EXPECT_TRUE(binary.is_binary);
    EXPECT_EQ(binary.triangles.size(), 12U);
    bytes.pop_back();  // and cut short it is a bad binary file, not a strange text
    expect_fault(read_stl(bytes, 1.0), StlFaultKind::wrong_size);
}

TEST(Stl, ValuesThatAreNoCoordinatesAreRefusedAtTheirByte) {
    const float inf = std::numeric_limits<float>::infinity();
    for (const float value : {std::nanf(""), inf, -inf}) {
        auto bytes = binary_box();
        set_coordinate(bytes, 7, 5, value);
        const StlResult result = read_stl(bytes, 1.0);
        expect_fault(result, StlFaultKind::not_finite);
        EXPECT_EQ(result.faults[0].byte, 84U + 350U + 12U + 20U);
        EXPECT_EQ(result.faults[0].facet, 7U);
    }
    auto bytes = binary_box();
    set_coordinate(bytes, 0, 0, std::numeric_limits<float>::max());
    expect_fault(read_stl(bytes, 1.0), StlFaultKind::out_of_range);
}

TEST(Stl, TheCoordinateLimitIsMeasuredInMillimetres) {
    const auto limit = static_cast<float>(kCoordinateMmMax);
    auto bytes = binary_box();
    set_coordinate(bytes, 0, 0, limit);
    EXPECT_TRUE(read_stl(bytes, 1.0).faults.empty());
    expect_fault(read_stl(bytes, 1.001), StlFaultKind::out_of_range);
    set_coordinate(bytes, 0, 0, std::nextafterf(limit, 2 * limit));
    expect_fault(read_stl(bytes, 1.0), StlFaultKind::out_of_range);
    set_coordinate(bytes, 0, 0, 101.0F);
    expect_fault(read_stl(bytes, 1000.0), StlFaultKind::out_of_range);
}

TEST(Stl, SubnormalsBecomeZeroAndTheSmallestNormalStays) {
    auto bytes = binary_box();
    set_coordinate(bytes, 0, 0, std::numeric_limits<float>::denorm_min());
    set_coordinate(bytes, 0, 1, -std::nextafterf(std::numeric_limits<float>::min(), 0.0F));
    set_coordinate(bytes, 0, 2, std::numeric_limits<float>::min());
    const StlResult result = read_stl(bytes, 1.0);
    ASSERT_TRUE(result.faults.empty());
    EXPECT_EQ(result.triangles[0].a, (Vec3f{0, 0, std::numeric_limits<float>::min()}));
    EXPECT_EQ(read_text(solid_text("1e-400")).triangles.at(0).a.x, 0.0F);
}

TEST(Stl, UnitsAreScaledInDoubleAndRoundedOnce) {
    auto bytes = binary_box();
    set_coordinate(bytes, 0, 0, 0.1F);
    const StlResult result = read_stl(bytes, 25.4);
    EXPECT_EQ(result.triangles.at(0).a.x, static_cast<float>(static_cast<double>(0.1F) * 25.4));
    EXPECT_EQ(read_stl(bytes_of(solid_text("0.1")), 25.4).triangles.at(0).a.x,
              static_cast<float>(0.1 * 25.4));
}

TEST(Stl, TextIsReadWhateverItsCaseSpacingAndNames) {
    const std::string text = "  SOLID a name: facet, \xc3\xa4, endsolid\r\n" +
                             facet_text("+1.5E+0") + "endsolid\nsolid second\n" +
                             facet_text("-.5") + "endsolid second";
    const StlResult result = read_text(text);
    ASSERT_TRUE(result.faults.empty());
    EXPECT_FALSE(result.is_binary);
    ASSERT_EQ(result.triangles.size(), 2U);
    EXPECT_EQ(result.triangles[0].a.x, 1.5F);
    EXPECT_EQ(result.triangles[1].a.x, -0.5F);
}

TEST(Stl, EveryTruncationOfATextIsRefused) {
    const std::string whole = solid_text("1") + "solid b\n" + facet_text("2") + "endsolid b";
    const std::size_t first = solid_text("1").size();
    const std::size_t last = whole.size() - std::string("b").size() - 1;
    for (std::size_t size = 0; size < last; ++size) {
        const bool ends_with_a_solid =
            size >= first - std::string(" part\n").size() && size <= first;
        EXPECT_EQ(read_text(whole.substr(0, size)).faults.empty(), ends_with_a_solid) << size;
    }
}

TEST(Stl, NumbersFollowOneGrammarWhateverTheLocale) {
    for (const char* good : {"1", "-1", "+1", "1.", ".5", "1e3", "1E-3", "-0.0"}) {
        EXPECT_TRUE(read_text(solid_text(good)).faults.empty()) << good;
    }
    for (const char* bad : {"1,5", "0x1", "1e", "--1", "+-1", "++1", "1.2.3", "e5", "one", "1f"}) {
        const StlResult result = read_text(solid_text(bad));
        expect_fault(result, StlFaultKind::bad_number);
        EXPECT_EQ(result.faults[0].line, 4U) << bad;
    }
    for (const char* bad : {"nan", "-NAN", "inf", "-Infinity", "1e999"}) {
        expect_fault(read_text(solid_text(bad)), StlFaultKind::not_finite);
    }
    EXPECT_TRUE(read_text(solid_text("1." + std::string(62, '0'))).faults.empty());
    expect_fault(read_text(solid_text("1." + std::string(63, '0'))), StlFaultKind::bad_number);
}

TEST(Stl, AWrongWordIsRefusedAtItsLine) {
    const StlResult result = read_text("solid\nfacet normal 0 0 1\nouter lop\n");
    expect_fault(result, StlFaultKind::unexpected_word);
    EXPECT_EQ(result.faults[0].line, 3U);
    EXPECT_STREQ(result.faults[0].wanted_word, "loop");
    expect_fault(read_text("solid\n\x01 facet"), StlFaultKind::unprintable_byte);
    expect_fault(read_text(solid_text("1") + "something behind"), StlFaultKind::unexpected_word);
    expect_fault(read_text("solid\nfacet normal 0 0 1\nouter"), StlFaultKind::unexpected_end);
}

TEST(Stl, AllFaultsAreCountedAndTheFirstOnesListed) {
    auto bytes = write_stl(std::vector<Triangle>(40, Triangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    for (std::size_t facet = 0; facet < 40; ++facet) {
        set_coordinate(bytes, facet, 3, std::nanf(""));
    }
    const StlResult result = read_stl(bytes, 1.0);
    EXPECT_EQ(result.fault_count, 40U);
    EXPECT_EQ(result.faults.size(), kStlFaultsMax);
}

TEST(Stl, TheLargestFileIsBoundedBeforeItIsLookedAt) {
    // A span that claims more than may be read: the answer may not depend on what lies there.
    const std::byte one{};
    const std::span<const std::byte> claimed(&one, kStlBytesMax + 1);
    expect_fault(read_stl(claimed, 1.0), StlFaultKind::too_large);
}

}  // namespace
