// SPDX-License-Identifier: Apache-2.0
// Both sides of every limit on the size of a machine and of its file.
#include <gtest/gtest.h>

#include "config/text/fault_list.hpp"
#include "config/text/yaml_tree.hpp"
#include "tests/support/machine_text.hpp"

namespace axg::test {
namespace {

struct Size {
    int bodies, checked_pairs;
    int axes = 1, tools = 0;
};

/// Bodies b0, b1, ... on the axes in turn; the first pairs are checked, the rest excluded.
std::string machine_of(const Size& size) {
    std::string text = "version: 1\nname: big\naxes:\n";
    for (int i = 0; i < size.axes; ++i) {
        text += "  U" + std::to_string(i) +
                ": {kind: linear, travel_mm: [-1, 1], speed_mm_min: 1, acceleration_mm_s2: 1, "
                "jerk_mm_s3: 1, stopping_mm_s2: 1}\n";
    }
    text += "can: {ids: {axes: [";
    for (int i = 0; i < (size.axes + 2) / 2; ++i) {
        text += (i > 0 ? ", " : "") + std::to_string(0x300 + i);
    }
    text += "]}}\nbodies:\n";
    for (int i = 0; i < size.bodies; ++i) {
        const bool is_tool = size.tools > 0 && i == 0;
        text += "  - {name: b" + std::to_string(i) + ", axis: U" + std::to_string(i % size.axes) +
                ", direction: [1, 0, 0], " +
                (is_tool ? "tool: true}\n" : "mesh: {file: a.stl, unit: mm}}\n");
    }
    text += size.tools > 0 ? "tools:\n" : "";
    for (int i = 0; i < size.tools; ++i) {
        text += "  - {number: " + std::to_string(i + 1) +
                ", length_mm: 1, mesh: {file: t.stl, unit: mm}}\n";
    }
    std::string pairs = "pairs:\n";
    std::string exclusions;
    int count = 0;
    for (int a = 0; a < size.bodies; ++a) {
        for (int b = a + 1; b < size.bodies; ++b) {
            const std::string both =
                "  - {a: b" + std::to_string(a) + ", b: b" + std::to_string(b) + ", ";
            if (count++ < size.checked_pairs) {
                pairs += both + "margin_mm: 1}\n";
            } else {
                exclusions += both + "reason: not here}\n";
            }
        }
    }
    return text + pairs + (exclusions.empty() ? "" : "exclusions:\n" + exclusions);
}

Machine loaded(const std::string& text) {
    Machine machine;
    EXPECT_TRUE(parse_machine(text, "m", machine).empty());
    return machine;
}

TEST(MachineLimits, SixteenBodiesAndSixtyFourPairsLoad) {
    const Machine machine = loaded(machine_of({.bodies = 16, .checked_pairs = 64}));
    EXPECT_EQ(machine.bodies.size(), 16U);
    EXPECT_EQ(machine.pairs.size(), 64U);
    EXPECT_EQ(machine.exclusions.size(), 56U);
}

TEST(MachineLimits, TheMostBodiesAndPairsLoadAndOneMoreOfEitherIsRefused) {
    const int bodies = static_cast<int>(kBodiesMax);
    const int pairs = static_cast<int>(kPairsMax);
    const Machine machine = loaded(machine_of({.bodies = bodies, .checked_pairs = pairs}));
    EXPECT_EQ(machine.bodies.size(), kBodiesMax);
    EXPECT_EQ(machine.pairs.size(), kPairsMax);
    EXPECT_NE(
        faults_of(machine_of({.bodies = bodies + 1, .checked_pairs = 1}))
            .find(
                "bodies: invalid value (found a list of 33, expected a list of 1 to 32 bodies).\n"),
        std::string::npos);
    EXPECT_NE(faults_of(machine_of({.bodies = bodies, .checked_pairs = pairs + 1}))
                  .find("pairs: invalid value (found 257 pairs, expected at most 256).\n"),
              std::string::npos);
}

TEST(MachineLimits, SixteenAxesLoadAndSeventeenAreRefused) {
    const Size sixteen{.bodies = 20, .checked_pairs = 10, .axes = 16};
    EXPECT_EQ(loaded(machine_of(sixteen)).can.axis_ids.size(), 9U);
    const Size seventeen{.bodies = 20, .checked_pairs = 10, .axes = 17};
    EXPECT_NE(faults_of(machine_of(seventeen))
                  .find("axes: invalid value (found 17 axes, expected a map of 1 to 16"),
              std::string::npos);
}

TEST(MachineLimits, SixtyFourToolsLoadAndOneMoreIsRefused) {
    const Size most{.bodies = 2, .checked_pairs = 1, .axes = 1, .tools = 64};
    EXPECT_EQ(loaded(machine_of(most)).tools.size(), kToolsMax);
    const Size more{.bodies = 2, .checked_pairs = 1, .axes = 1, .tools = 65};
    EXPECT_NE(faults_of(machine_of(more))
                  .find("tools: invalid value (found a list of 65, expected a list of 1 to 64"),
              std::string::npos);
}

TEST(MachineLimits, FdCarriesThirteenAxesAndNotFourteen) {
    const auto in_fd = [](int axes) {
        std::string text = machine_of({.bodies = 20, .checked_pairs = 10, .axes = axes});
        const std::size_t begin = text.find("can: {");
        return text.replace(begin, text.find('\n', begin) - begin, "can: {format: fd}");
    };
    EXPECT_EQ(faults_of(in_fd(13)), "");
    EXPECT_NE(faults_of(in_fd(14)).find(
                  "can: invalid value (found 14 axes in one FD frame, expected at most 13"),
              std::string::npos);
}

TEST(MachineLimits, OneMebibyteIsReadAndOneByteMoreIsNot) {
    std::string text = kSmallMachine;
    text += '#' + std::string(kYamlSizeBytesMax - text.size() - 1, ' ');
    ASSERT_EQ(text.size(), kYamlSizeBytesMax);
    EXPECT_EQ(faults_of(text), "");
    EXPECT_EQ(faults_of(text + ' '),
              "m:1: invalid file (found 1048577 bytes, expected at most 1048576 bytes).\n");
}

TEST(MachineLimits, SixteenLevelsAreYamlAndSeventeenAreNot) {
    const auto nested = [](int depth) {
        const auto count = static_cast<std::size_t>(depth);
        return std::string(count, '[') + std::string(count, ']');
    };
    FaultList faults{"m"};
    YamlNode root;
    EXPECT_TRUE(parse_yaml(nested(kYamlDepthMax), faults, root));
    EXPECT_TRUE(faults.empty());
    EXPECT_FALSE(parse_yaml(nested(kYamlDepthMax + 1), faults, root));
    EXPECT_EQ(faults.count(), 1U);
}

TEST(MachineLimits, AHundredThousandValuesAreYamlAndOneMoreIsNot) {
    const auto list_of = [](std::uint32_t count) {  // itself one of them
        std::string text;
        for (std::uint32_t i = 1; i < count; ++i) {
            text += "- 1\n";
        }
        return text;
    };
    FaultList faults{"m"};
    YamlNode root;
    EXPECT_TRUE(parse_yaml(list_of(kYamlNodesMax), faults, root));
    EXPECT_EQ(root.entries.size(), kYamlNodesMax - 1);
    EXPECT_FALSE(parse_yaml(list_of(kYamlNodesMax + 1), faults, root));
}

TEST(MachineLimits, AFileWithoutFinalLineEndLoads) {
    std::string text = kSmallMachine;
    text.pop_back();
    EXPECT_EQ(faults_of(text), "");
}

TEST(MachineLimits, LineEndsOfOtherSystemsAndAByteOrderMarkLoad) {
    std::string text = "\xEF\xBB\xBF";
    for (const char c : std::string{kSmallMachine}) {
        text += c == '\n' ? "\r\n" : std::string{c};
    }
    EXPECT_EQ(faults_of(text), "");
}

// Whatever a cut leaves of the file: a fault, or only optional keys are gone.
TEST(MachineLimits, AFileCutBeforeItsLastRequiredSectionIsRefusedWhereverItIsCut) {
    const std::string text = kSmallMachine;
    const std::size_t end = text.find("  - {a: cradle, b: plate");
    for (std::size_t size = 0; size < end; ++size) {
        EXPECT_NE(faults_of(text.substr(0, size)), "") << "cut at " << size;
    }
}

}  // namespace
}  // namespace axg::test
