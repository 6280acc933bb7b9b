// SPDX-License-Identifier: Apache-2.0
// axguard-lab query --ask hit writes the same table over both engines, on a GPU in large batches;
// and bench --offline finds no result that differs.
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <string>

#include "firmware_if/cli/exit_codes.hpp"
#include "tests/support/random_queries.hpp"
#include "tests/support/replay_fixture.hpp"
#include "tests/support/scene.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

class QueryInBatches : public testing::Test {
  protected:
    void SetUp() override {
        if (!std::filesystem::exists(AXG_LAB_PROGRAM)) {
            GTEST_SKIP() << AXG_LAB_PROGRAM << " is not built";
        }
    }
    test::Workshop shop;
};

TEST_F(QueryInBatches, WritesTheTableOfTheCpu) {
    test::Draw draw{test::printed_seed(61)};
    test::Scene scene;
    scene.bodies = {test::lumpy_ball(draw, 6, 40, 0.2), test::lumpy_ball(draw, 3, 30, 0.2),
                    test::plate(8, 8, 64)};
    scene.bodies[1].name = "small";  // also that of its file
    scene.pairs = {{"balls", 0, 1}, {"plate", 1, 2}, {"other", 2, 0}};
    scene.pose_count = 3000;
    for (std::uint32_t i = 0; i < scene.pose_count * scene.bodies.size(); ++i) {
        Pose pose = test::random_rotation(draw);
        for (double& t : pose.t) {
            t = draw.between(-40, 40);
        }
        scene.placed.push_back(pose);
    }
    test::write_scene(scene, shop.file("scene"));
    ASSERT_EQ(shop.run("query scene --ask hit --engine cpu -o cpu.csv"), kExitClean) << shop.err;
    const int code = shop.run("query scene --ask hit --engine cuda -o gpu.csv");
    if (code == kExitGpu) {
        GTEST_SKIP() << shop.err;
    }
    ASSERT_EQ(code, kExitClean) << shop.err;
    const std::string wanted = test::content_of(shop.file("cpu.csv"));
    EXPECT_GT(wanted.size(), 9000U * 10U);
    EXPECT_EQ(test::content_of(shop.file("gpu.csv")), wanted);
    EXPECT_NE(wanted.find(",0,"), std::string::npos);
    EXPECT_NE(wanted.find(",1,"), std::string::npos);
}

TEST_F(QueryInBatches, TheBenchmarkFindsNoDifference) {
    const int code =
        shop.run("bench --offline --positions 2000 --passes 1 --machine " + test::kPaperMachine);
    if (code == kExitGpu) {
        GTEST_SKIP() << shop.err;
    }
    ASSERT_EQ(code, kExitClean) << shop.err << shop.out;
    EXPECT_NE(shop.out.find(" 65536 queries a batch, 4 under way"), std::string::npos) << shop.out;
    EXPECT_NE(shop.out.find("; 0 of "), std::string::npos) << shop.out;
}

}  // namespace
}  // namespace axg
