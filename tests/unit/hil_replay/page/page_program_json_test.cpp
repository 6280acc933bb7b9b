// SPDX-License-Identifier: Apache-2.0
// ctest-labels: long
// The program within the data of a page: each block once and as text, the line of every row and
// stop also where the program is too long for its steps, and nothing where no line is known.
#include "hil_replay/page/page_program_json.hpp"
#include "tests/support/json_value.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include <string>

namespace axg::test {
namespace {

/// A run of one axis, a sample each `sample_us`, that has its permit half of the time.
struct SampledRun {
    explicit SampledRun(std::size_t samples, std::int64_t sample_us = 1000,
                        std::size_t rows_max = 64)
        : loaded(one_axis()), rows(loaded.machine, rows_max) {
        for (std::size_t i = 0; i < samples; ++i) {
            AxisSnapshot snapshot;
            snapshot.axis_count = 1;
            snapshot.latched_us = snapshot.arrived_us = static_cast<std::int64_t>(i) * sample_us;
            rows.add(snapshot, {.has_permit = i % 2000 < 1000}, {});
        }
        rows.finish();
    }
    static LoadedMachine one_axis() {
        LoadedMachine out;
        out.machine.axes = {{.name = "X", .speed_max = 100}};
        return out;
    }
    [[nodiscard]] RunPage page(const ProgramLines* program, const std::string& stops = "[]") const {
        return {loaded, rows, nullptr, 500, "run", "words", stops, program};
    }

    LoadedMachine loaded;
    PageSamples rows;
};

/// A new line each `step_us`, from line 1 on, after one step without a line.
ProgramLines many_lines(std::uint32_t count, std::int64_t step_us, const std::string& block) {
    ProgramLines lines;
    lines.program = "part.ngc";
    for (std::uint32_t i = 0; i < count; ++i) {
        lines.steps.push_back({i * step_us, i, block + std::to_string(i)});
    }
    return lines;
}

/// The line that a reader of the page finds at an instant; 0: none.
std::uint32_t line_at(const Json& program, double time_s) {
    const Json& times = program["steps"]["time_s"];
    const auto next =
        std::upper_bound(times.begin(), times.end(), time_s + 5e-7,
                         [](double time, const Json& step) { return time < step.get<double>(); });
    return next == times.begin()
               ? 0
               : program["steps"]["line"][static_cast<std::size_t>(next - times.begin() - 1)]
                     .get<std::uint32_t>();
}

TEST(PageProgram, ALoopHasItsBlocksOnceAndAllItsSteps) {
    const SampledRun run(10);
    ProgramLines lines;
    lines.program = "loop.ngc";
    lines.read_as = "read as: starts in mm";
    for (const std::uint32_t line : {0U, 7U, 12U, 7U, 12U, 7U}) {
        add_program_step(lines, 1500 * static_cast<std::int64_t>(lines.steps.size()), line);
        lines.steps.back().block = line == 0 ? "" : "G1 X" + std::to_string(line);
    }
    const std::string text = page_data(run.page(&lines));
    EXPECT_EQ(text.find("G1 X7"), text.rfind("G1 X7")) << "a block is written twice";
    const auto program = Json::parse(text)["program"];
    EXPECT_EQ(program["file"], "loop.ngc");
    EXPECT_EQ(program["read_as"], "read as: starts in mm");
    EXPECT_EQ(program["count"], 6);
    EXPECT_EQ(program["steps"]["time_s"], Json::array({0.0, 0.0015, 0.003, 0.0045, 0.006, 0.0075}));
    EXPECT_EQ(program["steps"]["line"], Json::array({0, 7, 12, 7, 12, 7}));
    EXPECT_EQ(program["blocks"], Json::object({{"7", "G1 X7"}, {"12", "G1 X12"}}));
}

TEST(PageProgram, AHostileBlockIsText) {
    const SampledRun run(10);
    ProgramLines lines;
    lines.program = "\xe2\x80\xae</script>.ngc";
    lines.steps = {{0, 1, "(\xe2\x80\xae </script><b>\")"}, {5, 2, "\xff\x01"}};
    lines.steps.push_back({9, 3, std::string(100'000, '<')});
    const std::string text = page_data(run.page(&lines));
    EXPECT_EQ(text.find('<'), std::string::npos) << "it may close the script";
    EXPECT_EQ(text.find('\xae'), std::string::npos) << "it turns the direction of writing";
    EXPECT_LT(text.size(), 10'000U) << "a block that no table of simulate has";
    const auto program = Json::parse(text)["program"];
    EXPECT_EQ(program["file"], "\\u202e</script>.ngc");
    EXPECT_EQ(program["blocks"]["1"], "(\\u202e </script><b>\")");
    EXPECT_EQ(program["blocks"]["2"], "\\xff\\x01");
}

TEST(PageProgram, ARunWithoutLinesHasNone) {
    const SampledRun run(10);
    const ProgramLines none;
    EXPECT_FALSE(Json::parse(page_data(run.page(nullptr))).contains("program"));
    EXPECT_FALSE(Json::parse(page_data(run.page(&none))).contains("program"));
}

// Both sides of the bound: whole below it; above it every row and the stop keep their line.
TEST(PageProgram, ALongProgramKeepsTheLineOfEveryRowAndStop) {
    constexpr std::uint32_t kSteps = 60'000;
    const SampledRun run(kSteps / 2, 2'000);
    ASSERT_GT(run.rows.stride(), 1U);
    const std::string block = "G1 X1.2345 Y2.3456 Z3.4567 A4.5678 C5.6789 F1234.567 N";
    const ProgramLines small = many_lines(20'000, 1000, block);
    const auto whole = Json::parse(page_data(run.page(&small)))["program"];
    EXPECT_EQ(whole["count"], 20'000);
    EXPECT_EQ(whole["steps"]["line"].size(), 20'000U);
    EXPECT_EQ(whole["blocks"].size(), 19'999U) << "line 0 is none";

    const ProgramLines lines = many_lines(kSteps, 1000, block);
    const RunPage page = run.page(&lines, R"([{"time_us": 23456789, "reason": "pair"}])");
    const std::string text = program_data(page);
    EXPECT_LT(text.size(), kProgramBytesMax);
    const auto program = Json::parse(text);
    EXPECT_EQ(program["count"], kSteps);
    EXPECT_LE(program["steps"]["line"].size(), run.rows.rows() + 1);
    EXPECT_EQ(program["steps"]["line"].size(), program["blocks"].size() + 1) << "line 0 is none";
    for (std::size_t row = 0; row < run.rows.rows(); ++row) {
        const double time_s = run.rows.row(row)[0];
        EXPECT_EQ(line_at(program, time_s), std::lround(time_s * 1e3)) << "row " << row;
    }
    EXPECT_EQ(line_at(program, 23.456789), 23'456U) << "the stop's line";
    EXPECT_EQ(program["blocks"]["23456"], block + "23456");
}

// The worst that a table may hold: blocks of characters that take most room, more than a page has.
TEST(PageProgram, APageOfTheWorstProgramKeepsItsBound) {
    const SampledRun run(200'000, 1000, kPageRowsMax);
    ASSERT_GT(run.rows.rows(), kPageRowsMax) << "rows about the losses of the permit";
    const ProgramLines lines = many_lines(40'000, 5000, std::string(200, '<'));
    EXPECT_LT(page_data(run.page(&lines)).size(), 20'000'000U);
    const ProgramLines few = many_lines(5'000, 1000, std::string(200, '<'));
    ASSERT_LT(program_data(run.page(&few)).size(), kProgramBytesMax) << "as it is, in a script not";
    EXPECT_LT(page_data(run.page(&few)).size(), kProgramBytesMax + 100'000);
}

TEST(PageAxes, AreDrawnWhereTheCommandKnowsWhichAreGuesses) {
    SampledRun run(4);
    run.loaded.machine.bodies.resize(2);
    run.loaded.meshes.bodies.resize(2);
    RunPage page = run.page(nullptr);
    EXPECT_EQ(Json::parse(page_data(page))["shows_axes"], false);
    page.guessed_axes = {false, true};
    const auto data = Json::parse(page_data(page));
    EXPECT_EQ(data["shows_axes"], true);
    EXPECT_EQ(data["machine"]["bodies"][0]["is_guess"], false);
    EXPECT_EQ(data["machine"]["bodies"][1]["is_guess"], true);
}

}  // namespace
}  // namespace axg::test
