// SPDX-License-Identifier: Apache-2.0
// axguard-lab bench --paper without a GPU: the CPU's columns, what they agree on, and what is said
// when something is missing.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "firmware_if/cli/exit_codes.hpp"
#include "hil_replay/lab/bench/paper_benchmark.hpp"
#include "hil_replay/lab/bench/paper_tables.hpp"
#include "hil_replay/lab/commands/axguard_lab.hpp"
#include "tests/support/json_value.hpp"

namespace axg {
namespace {

namespace fs = std::filesystem;

TEST(BenchCommand, WantsToKnowWhatToMeasure) {
    EXPECT_EQ(run_axguard_lab({"bench"}), kExitUsage);
    EXPECT_EQ(run_axguard_lab({"bench", "--paper", "--poses", "0"}), kExitUsage);
    EXPECT_EQ(run_axguard_lab({"bench", "--paper", "--data", "no-such-folder"}), kExitInput);
}

TEST(BenchCommand, PosesTheBoxesOfAMachineThatProvesNothing) {
    const fs::path file =
        fs::temp_directory_path() / ("axg-bench-pose-" + std::to_string(::getpid()) + ".json");
    ASSERT_EQ(
        run_axguard_lab({"bench", "--pose", AXG_SOURCE_DIR "/config/machines/paper-trunnion.yaml",
                         "--passes", "1", "--json=" + file.string()}),
        kExitClean);
    const test::Json document = test::Json::parse_file(file);
    fs::remove(file);
    EXPECT_EQ(document["bench"], "pose");
    EXPECT_EQ(document["tasks"], 8);
    EXPECT_EQ(document["queries"], 2 * 8 + 8 + 8 * 2 + 8 * 64 + 5 * 2)
        << "whole boxes for both permits, the leaves below each, and a known-answer test a batch";
    EXPECT_GT(document["us"], 0.0);
    EXPECT_EQ(run_axguard_lab({"bench", "--paper", "--pose", "no.yaml"}), kExitUsage);
    EXPECT_EQ(run_axguard_lab({"bench", "--pose", "no.yaml"}), kExitInput);
}

TEST(BenchCommand, OfflineNeedsAMachineAndAGpu) {
    EXPECT_EQ(run_axguard_lab({"bench", "--offline", "--machine", "no.yaml"}), kExitInput);
    EXPECT_EQ(run_axguard_lab({"bench", "--offline", "--paper"}), kExitUsage);
    EXPECT_EQ(run_axguard_lab({"bench", "--offline", "--positions", "0"}), kExitUsage);
    const int code = run_axguard_lab({"bench", "--offline", "--positions", "20", "--passes", "1"});
    EXPECT_TRUE(code == kExitGpu || code == kExitClean) << code;
}

TEST(BenchCommand, PaperWritesTheCpuColumnsWithoutAGpu) {
    const fs::path file =
        fs::temp_directory_path() / ("axg-bench-" + std::to_string(::getpid()) + ".json");
    ASSERT_EQ(run_axguard_lab({"bench", "--paper", "--poses", "3", "--passes", "1", "--engine",
                               "cpu", "--json=" + file.string()}),
              kExitClean);
    const test::Json document = test::Json::parse_file(file);
    fs::remove(file);
    EXPECT_EQ(document["poses"], 3);
    EXPECT_EQ(document["no_gpu"], "not asked for");
    EXPECT_FALSE(document.contains("techniques"));
    // The paper's numbers of triangles: X 44, Y 136, Z 180, A 164, C 548, cutter 716.
    EXPECT_EQ(document["triangle_pairs"]["cutter-c"], 716 * 548);
    EXPECT_EQ(document["triangle_pairs"]["z-x"], 180 * 44);
    ASSERT_EQ(document["methods"].size(), 3U);
    for (const auto& method : document["methods"]) {
        EXPECT_EQ(method["pairs"].size(), 8U);
        EXPECT_GT(method["pose"]["min_us"], 0.0) << method["name"];
        EXPECT_LE(method["pose"]["min_us"], method["pose"]["avg_us"]) << method["name"];
    }
    const auto& certified = document["methods"][1];
    EXPECT_EQ(certified["tested_a_pose"], 799'232);
    EXPECT_EQ(certified["counts_unlike_cpu_engine"], 0);
    // All 56 figures of the seed paper, whether or not there is a GPU here.
    ASSERT_EQ(document["seed_paper"]["pairs"].size(), 8U);
    std::size_t figures = 0;
    for (const auto& [name, row] : document["seed_paper"]["pairs"].items()) {
        EXPECT_TRUE(document["methods"][0]["pairs"].contains(name)) << name;
        figures += row["cpu"].size() + row["gpu"].size() + (row.contains("speed_up") ? 1 : 0);
    }
    EXPECT_EQ(figures, 56U);
    EXPECT_EQ(document["seed_paper"]["pairs"]["cutter-c"]["cpu"]["max_us"], 108174);
    // Pruning by the operating range drops triangles and no contact.
    EXPECT_LT(document["operating_range"]["triangle_pairs"], 799'232);
    EXPECT_GT(document["operating_range"]["triangle_pairs"], 716 * 548);
    EXPECT_EQ(document["operating_range"]["hits_unlike_cpu_naive"], 0);
}

// The table against itself: its last column divides its averages, and its mean is the one stated.
TEST(PaperTables, SpeedUpsAreThoseOfTheAverages) {
    double mean = 0;
    for (const PaperRow& row : kPaperRows) {
        EXPECT_NEAR(row.cpu.average / row.gpu.average, row.speed_up, 0.02) << row.pair;
        for (const Spread& s : {row.cpu, row.gpu}) {
            EXPECT_LT(s.least, s.average) << row.pair;
            EXPECT_LT(s.average, s.most) << row.pair;
        }
        mean += row.speed_up / 8;
    }
    EXPECT_NEAR(mean, kPaperSpeedUp, 0.05);
    EXPECT_NEAR(paper_sum(&PaperRow::gpu).average, 6045.15, 0.01);
}

TEST(PaperBenchmark, GivesTheSamePosesForASeedAndOthersForAnother) {
    PaperBenchmark same[3];
    for (std::uint64_t i = 0; i < 3; ++i) {
        PaperBenchmarkOptions options{
            .data = AXG_SOURCE_DIR, .poses = 4, .passes = 1, .seed = i / 2, .use_gpu = false};
        ASSERT_EQ(run_paper_benchmark(options, same[i], stderr), kExitClean);
    }
    EXPECT_EQ(same[0].cpu[2].found, same[1].cpu[2].found);
    EXPECT_NE(same[0].cpu[2].found, same[2].cpu[2].found);
}

TEST(PaperBenchmark, CountsWhatDiffers) {
    PaperSeries a{"a", {}, std::vector<paper::Found>(4)}, b = a;
    a.found[1].touching = 3, b.found[1].touching = 2;
    b.found[3].touching = 1;
    EXPECT_EQ(differences(a, b).hits, 1U);
    EXPECT_EQ(differences(a, b).counts, 2U);
}

}  // namespace
}  // namespace axg
