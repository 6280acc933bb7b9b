// SPDX-License-Identifier: Apache-2.0
// Every shipped program on its machine, from G-code to the end of its replay: from positions alone,
// with a look-ahead path, and with a look-ahead path along which the board stops. The table below
// says where each run ends, and docs/measurements/stoppable.md says the same. Runs axguard itself.
// ctest-labels: long
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>

#include "firmware_if/cli/exit_codes.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/machine_text.hpp"
#include "tests/support/replay_fixture.hpp"
#include "tests/support/screen.hpp"

namespace axg::test {
namespace {

constexpr std::int64_t kSampleUs = 1000;

/// What the board sends and promises.
enum class Wire { positions, look_ahead, path_keeping };

/// Where a replay ends; `pair` empty: at the end of the program, without a stop.
struct End {
    const char* pair = "";
    double time_s = 0;  // of the snapshot that withdraws the permit
};

struct Shipped {
    const char *machine, *program;
    End positions, look_ahead, path_keeping;
};

// The near programs end at a stop from positions alone because there the axes
// could get to the margin for all that positions say. Only the demo is meant to collide.
const Shipped kShipped[] = {
    {"paper-trunnion", "paper-trunnion-clean", {}, {}, {}},
    {"paper-trunnion",
     "paper-trunnion-demo",
     {"cutter-c", 40.875405},
     {"cutter-c", 41.307105},
     {"cutter-c", 41.316105}},
    {"paper-trunnion", "paper-trunnion-near", {"cutter-c", 16.907405}, {}, {}},
    {"spindle-tilting", "spindle-tilting", {}, {}, {}},
    {"table-spindle-tilting", "table-spindle-tilting", {}, {}, {}},
    {"table-spindle-tilting", "table-spindle-tilting-near", {"cutter-plate", 15.552405}, {}, {}},
};

/// The shipped machine with what another board sends and promises.
std::string machine_text(const std::string& name, Wire wire) {
    std::string text = content_of(source_file("config/machines/" + name + ".yaml"));
    if (wire == Wire::path_keeping) {
        const std::string guard = "\nguard:\n";
        const std::size_t at = text.find(guard);
        EXPECT_NE(at, std::string::npos);
        text.insert(at + guard.size(), "  promise: path_keeping\n");
    }
    return wire == Wire::positions ? text
                                   : with_can(text, "  format: fd\n  ahead: {samples: 300}\n");
}

class ShippedProgram : public testing::TestWithParam<Shipped> {
  protected:
    void SetUp() override {
        if (!std::filesystem::exists(AXG_PROGRAM)) {
            GTEST_SKIP() << AXG_PROGRAM << " is not built";
        }
    }

    void expect_end(Wire wire, const End& end) {
        const Shipped& shipped = GetParam();
        const std::string machine =
            shop.write("machine.yaml", machine_text(shipped.machine, wire)) + " --mesh-root " +
            source_file("config/machines");
        const std::string program =
            source_file(std::string("hil_replay/programs/") + shipped.program + ".ngc");
        ASSERT_EQ(shop.run("simulate " + machine + " " + program + " -o trace.log"), kExitClean)
            << shop.err;
        const bool stops = *end.pair != '\0';
        // The deadline is not the point here: a shared machine may be late.
        ASSERT_EQ(shop.run("replay " + machine +
                           " trace.log --engine cpu --deadline-us 10000000 --json=end.json"),
                  stops ? kExitCollision : kExitClean)
            << shop.out << shop.err;
        EXPECT_LE(lines_of(shop.out).size(), kScreenLines) << shop.out;
        const auto all = Json::parse(content_of(shop.file("end.json")));
        ASSERT_EQ(all["stops"].size(), stops ? 1U : 0U) << "one entry a stop";
        EXPECT_EQ(all["stop_count"], stops ? 1 : 0);
        if (stops) {
            const auto& stop = all["stops"][0];
            EXPECT_EQ(stop["reason"], "predicted");
            EXPECT_EQ(stop["pair"], end.pair);
            EXPECT_NEAR(stop["time_us"].get<double>(), end.time_s * 1e6, kSampleUs);
        }
    }

    Workshop shop;
};

TEST_P(ShippedProgram, EndsWhereTheTableSaysFromPositionsAlone) {
    expect_end(Wire::positions, GetParam().positions);
}

TEST_P(ShippedProgram, EndsWhereTheTableSaysWithALookAheadPath) {
    expect_end(Wire::look_ahead, GetParam().look_ahead);
}

TEST_P(ShippedProgram, EndsWhereTheTableSaysOfABoardThatStopsAlongItsPath) {
    expect_end(Wire::path_keeping, GetParam().path_keeping);
}

TEST_P(ShippedProgram, FitsOnOneScreenWhenDriven) {
    const auto program = std::string("hil_replay/programs/") + GetParam().program + ".ngc";
    const int code = shop.run(
        "drive " + source_file(std::string("config/machines/") + GetParam().machine + ".yaml") +
        " " + source_file(program));
    ASSERT_TRUE(code == kExitClean || code == kExitCollision) << shop.err;
    EXPECT_LE(lines_of(shop.out).size(), kScreenLines) << shop.out;
    EXPECT_NE(shop.out.find(code == kExitClean ? "\nthe program ran to its end\n" : "\nSTOP: "),
              std::string::npos)
        << shop.out;
}

INSTANTIATE_TEST_SUITE_P(Each, ShippedProgram, testing::ValuesIn(kShipped),
                         [](const testing::TestParamInfo<Shipped>& row) {
                             std::string name = row.param.program;
                             std::replace(name.begin(), name.end(), '-', '_');
                             return name;
                         });

TEST(ShippedPrograms, AreAllInTheTable) {
    std::set<std::string> shipped, listed;
    for (const auto& file :
         std::filesystem::directory_iterator(source_file("hil_replay/programs"))) {
        if (file.path().extension() == ".ngc") {
            shipped.insert(file.path().stem().string());
        }
    }
    for (const Shipped& row : kShipped) {
        listed.insert(row.program);
    }
    EXPECT_EQ(shipped, listed);
}

/// A cell of the record: where a replay ends.
std::string cell(const End& end) {
    return *end.pair == '\0' ? " end |" : fmt::format(" {}, {:.3f} s |", end.pair, end.time_s);
}

// What the record says of a shipped program is what the replays above have found.
TEST(ShippedPrograms, AreRecordedWithTheseEnds) {
    const std::string record = content_of(source_file("docs/measurements/stoppable.md"));
    int harmless = 0, unstopped = 0, unstopped_with_path = 0;
    for (const Shipped& row : kShipped) {
        const std::string line = fmt::format("\n| {} |", row.program) + cell(row.positions) +
                                 cell(row.look_ahead) + cell(row.path_keeping) + '\n';
        EXPECT_NE(record.find(line), std::string::npos) << "not in the record:" << line;
        const bool is_harmless = row.program != std::string("paper-trunnion-demo");
        harmless += is_harmless ? 1 : 0;
        unstopped += is_harmless && *row.positions.pair == '\0' ? 1 : 0;
        unstopped_with_path +=
            is_harmless && *row.look_ahead.pair == '\0' && *row.path_keeping.pair == '\0' ? 1 : 0;
    }
    const std::string says = fmt::format(
        "in replays from positions alone {} of the {} harmless programs are not stopped, with a "
        "look-ahead path {}",
        unstopped, harmless, unstopped_with_path);
    EXPECT_NE(record.find(says), std::string::npos) << "the record has to say: " << says;
}

}  // namespace
}  // namespace axg::test
