// SPDX-License-Identifier: Apache-2.0
// A scene folder is read whole or refused with FILE:LINE; matrices of few digits are made rigid and
// every answer then allows for what that moved.
#include "hil_replay/lab/bench/scene_folder.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "firmware_if/cli/exit_codes.hpp"
#include "tests/support/engine_fixture.hpp"
#include "tests/support/random_queries.hpp"
#include "tests/support/replay_fixture.hpp"
#include "tests/support/scene.hpp"
#include "tests/support/solids.hpp"

namespace axg {
namespace {

const std::string kHead =
    "pose,body,m00,m01,m02,m03,m10,m11,m12,m13,m20,m21,m22,m23,m30,m31,m32,m33\n";
const std::string kUnit = "1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1";

/// Row by row, with so many digits behind the point.
std::string matrix_text(const Pose& p, int digits) {
    std::string text;
    for (int i = 0; i < 3; ++i) {
        text += fmt::format("{:.{}f},{:.{}f},{:.{}f},{:.{}f},", p.r[i][0], digits, p.r[i][1],
                            digits, p.r[i][2], digits, p.t[i], digits);
    }
    return text + "0,0,0,1";
}

class SceneFolderTest : public testing::Test {
  protected:
    void SetUp() override {
        test::Scene scene;
        scene.bodies = {{"rod", test::box({0, 0, 0}, {1, 1, 50})},
                        {"box", test::box({0, 0, 0}, {10, 10, 10})}};
        scene.pairs = {{"rod-box", 0, 1}};
        scene.pose_count = 1;
        scene.placed = {Pose{}, test::shifted(30, 0, 0)};
        test::write_scene(scene, shop.file("scene"));
        files = {{"bodies", test::content_of(shop.file("scene/bodies.csv"))},
                 {"pairs", test::content_of(shop.file("scene/pairs.csv"))},
                 {"poses", test::content_of(shop.file("scene/poses.csv"))}};
    }
    std::string read() {
        out = SceneFolder();
        return read_scene_folder(shop.file("scene"), out);
    }
    std::string with(const std::string& table, const std::string& text) {
        (void)shop.write("scene/" + table + ".csv", text);
        std::string message = read();
        for (const auto& [name, whole] : files) {
            if (name == table) {
                (void)shop.write("scene/" + table + ".csv", whole);
            }
        }
        return message;
    }
    std::string with_poses(const std::string& rod_matrix) {
        return with("poses", kHead + "p,rod," + rod_matrix + "\np,box," + kUnit + "\n");
    }
    static void expect_at(const std::string& message, const std::string& where,
                          const std::string& what) {
        EXPECT_NE(message.find(where + ": "), std::string::npos) << message;
        EXPECT_NE(message.find(what), std::string::npos) << message;
    }
    test::Workshop shop;
    SceneFolder out;
    std::string rod = "rod.stl";
    std::vector<std::pair<std::string, std::string>> files;
};

TEST_F(SceneFolderTest, AWholeFolderIsReadExactly) {
    ASSERT_EQ(read(), "");
    ASSERT_EQ(out.bodies.size(), 2U);
    EXPECT_EQ(out.bodies[0].triangles.size(), 12U);
    ASSERT_EQ(out.pairs.size(), 1U);
    EXPECT_EQ(out.pairs[0].a, 0U);
    EXPECT_EQ(out.pairs[0].b, 1U);
    ASSERT_EQ(out.poses.size(), 1U);
    EXPECT_EQ(out.at(0, 1).t[0], 30);
    EXPECT_EQ(out.pose_error_mm, 0);
}

TEST_F(SceneFolderTest, EveryTableThatIsMissingIsNamed) {
    for (const char* const name : {"bodies.csv", "pairs.csv", "poses.csv"}) {
        const std::string path = shop.file(std::string("scene/") + name);
        std::filesystem::rename(path, path + ".away");
        expect_at(read(), name, "cannot be read");
        std::filesystem::rename(path + ".away", path);
    }
    EXPECT_EQ(read(), "");
}

TEST_F(SceneFolderTest, FaultsOfBodiesNameTheirLine) {
    const std::string line = "rod," + rod + ",";
    expect_at(with("bodies", "name,stl,triangles\n" + line + "13\n"), "bodies.csv:2",
              "triangles: wrong number (found 13, expected 12");
    expect_at(with("bodies", "name,stl,triangles\n" + line + "some\n"), "bodies.csv:2",
              "found some");
    expect_at(with("bodies", "name,stl,triangles\n" + line + "12\n" + line + "12\n"),
              "bodies.csv:3", "duplicate body");
    expect_at(with("bodies", "name,stl,triangles\nrod,none.stl,12\n"), "bodies.csv:2", "none.stl");
    expect_at(with("bodies", "name,stl,triangles\nrod,../x.stl,12\n"), "bodies.csv:2", "../x.stl");
    expect_at(with("bodies", "name,stl,triangles\nrod,/etc/hostname,1\n"), "bodies.csv:2",
              "/etc/hostname");
    expect_at(with("bodies", "name,stl,triangles\nrod,pairs.csv,1\n"), "bodies.csv:2",
              "invalid STL file");
    expect_at(with("bodies", "name,stl\nrod," + rod + "\n"), "bodies.csv:1",
              "no column 'triangles'");
}

TEST_F(SceneFolderTest, FaultsOfPairsNameTheirLine) {
    expect_at(with("pairs", "pair,a,b\np,rod,sphere\n"), "pairs.csv:2", "unknown body 'sphere'");
    expect_at(with("pairs", "pair,a,b\np,,box\n"), "pairs.csv:2", "unknown body ''");
}

TEST_F(SceneFolderTest, FaultsOfPosesNameTheirLine) {
    const std::string box = "p,box," + kUnit + "\n", good = "p,rod," + kUnit + "\n";
    expect_at(with("poses", kHead + good + "p,cone," + kUnit + "\n"), "poses.csv:3",
              "unknown body 'cone'");
    expect_at(with("poses", kHead + good + good), "poses.csv:3", "pose 'p' has body 'rod' twice");
    expect_at(with("poses", kHead + good), "poses.csv", "pose 'p' has no body 'box'");
    expect_at(with("poses", kHead + good + box + "q,box," + kUnit + "\n"), "poses.csv",
              "pose 'q' has no body 'rod'");
    expect_at(with_poses("1,0,0,0,0,1,0,0,0,0,1,nan,0,0,0,1"), "poses.csv:2",
              "m23: invalid value (found 'nan'");
    expect_at(with_poses("1,0,0,,0,1,0,0,0,0,1,0,0,0,0,1"), "poses.csv:2",
              "m03: invalid value (found ''");
    expect_at(with_poses("1,0,0,0,0,1,0,0,0,0,1,0,0,0,1,1"), "poses.csv:2", "last row");
    expect_at(with_poses("1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,2"), "poses.csv:2", "last row");
    expect_at(with_poses("1,0,0,100001,0,1,0,0,0,0,1,0,0,0,0,1"), "poses.csv:2", "translation");
    EXPECT_EQ(with_poses("1,0,0,100000,0,1,0,0,0,0,1,0,0,0,0,1"), "");
}

TEST_F(SceneFolderTest, OnlyRotationsAreTaken) {
    expect_at(with_poses("-1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1"), "poses.csv:2", "not a rotation");
    expect_at(with_poses("0,1,0,0,1,0,0,0,0,0,1,0,0,0,0,1"), "poses.csv:2", "determinant -1");
    expect_at(with_poses("2,0,0,0,0,2,0,0,0,0,2,0,0,0,0,1"), "poses.csv:2", "not a rotation");
    expect_at(with_poses("0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,1"), "poses.csv:2", "not a rotation");
    expect_at(with_poses("1,1e-5,0,0,0,1,0,0,0,0,1,0,0,0,0,1"), "poses.csv:2", "not a rotation");
    EXPECT_EQ(with_poses("1,0.9e-6,0,0,0,1,0,0,0,0,1,0,0,0,0,1"), "");
    EXPECT_GT(out.pose_error_mm, 0);
}

TEST_F(SceneFolderTest, FewDigitsAreMadeRigidAndTheErrorCoversWhatThatMoved) {
    test::Draw draw(9);
    double worst = 0;  // share of the error allowed for
    for (int i = 0; i < 50; ++i) {
        Pose written = test::random_rotation(draw);
        for (auto& row : written.r) {
            for (double& entry : row) {
                entry = std::round(entry * 1e7) / 1e7;
            }
        }
        ASSERT_EQ(with_poses(matrix_text(written, 7)), "");
        ASSERT_GT(out.pose_error_mm, 0);
        ASSERT_LT(out.pose_error_mm, 0.001);
        double defect = 0, moved = 0;
        const Pose& taken = out.at(0, 0);
        for (int a = 0; a < 3; ++a) {
            for (int b = 0; b < 3; ++b) {
                double d = a == b ? -1.0 : 0.0;
                for (int k = 0; k < 3; ++k) {
                    d += taken.r[k][a] * taken.r[k][b];
                }
                defect = std::max(defect, std::abs(d));
            }
        }
        EXPECT_LT(defect, 1e-15);
        for (const Triangle& t : out.bodies[0].triangles) {
            const Vec3d p = apply(taken, widen(t.a)), q = apply(written, widen(t.a));
            moved = std::max(moved, std::sqrt(dot(p - q, p - q)));
        }
        EXPECT_LE(moved, out.pose_error_mm);
        worst = std::max(worst, moved / out.pose_error_mm);
    }
    EXPECT_GT(worst, 0.05) << "and not by orders of magnitude more"
                           << ": the tables of others would be judged near for nothing";
}

TEST_F(SceneFolderTest, QuerySaysSoWithExit3) {
    if (!std::filesystem::exists(AXG_PROGRAM)) {
        GTEST_SKIP() << AXG_PROGRAM << " is not built";
    }
    ASSERT_EQ(shop.run("query scene --output answers.csv --within 40"), kExitClean) << shop.err;
    const auto answers = test::read_answers(shop.file("answers.csv"));
    ASSERT_EQ(answers.size(), 1U);
    EXPECT_EQ(answers[0].hit, 0);
    EXPECT_LE(answers[0].clearance_mm, 29);
    EXPECT_GT(answers[0].clearance_mm, 29 - 1e-6);
    ASSERT_EQ(shop.run("query scene --output answers.csv --within 10"), kExitClean);
    EXPECT_EQ(test::read_answers(shop.file("answers.csv"))[0].clearance_mm, -1) << "beyond: empty";
    ASSERT_EQ(shop.run("query scene --output answers.csv --ask hit"), kExitClean);
    EXPECT_EQ(test::read_answers(shop.file("answers.csv"))[0].count, -1) << "not asked for: empty";
    (void)shop.write("scene/pairs.csv", "pair,a,b\np,rod,sphere\n");
    EXPECT_EQ(shop.run("query scene --output answers.csv"), kExitInput);
    EXPECT_NE(shop.err.find("scene/pairs.csv:2: "), std::string::npos) << shop.err;
    EXPECT_EQ(shop.run("query scene"), kExitUsage);
    EXPECT_EQ(shop.run("query scene --output a.csv --ask distance"), kExitUsage);
}

// Surfaces far apart, and one body inside the other all the same; an open one has no inside.
TEST_F(SceneFolderTest, ABodyInsideAnotherIsAHit) {
    if (!std::filesystem::exists(AXG_PROGRAM)) {
        GTEST_SKIP() << AXG_PROGRAM << " is not built";
    }
    const auto hit_of = [&](const test::Triangles& outer, double x_mm) {
        test::Scene scene;
        scene.bodies = {{"outer", outer}, {"inner", test::box({0, 0, 0}, {1, 1, 1})}};
        scene.pairs = {{"pair", 0, 1}};
        scene.pose_count = 1;
        scene.placed = {Pose{}, test::shifted(x_mm, 5, 5)};
        test::write_scene(scene, shop.file("nested"));
        EXPECT_EQ(shop.run("query nested --output answers.csv --json"), kExitClean) << shop.err;
        const auto answers = test::read_answers(shop.file("answers.csv"));
        EXPECT_EQ(answers.size(), 1U);
        const bool is_counted = shop.out.find("\"contained\": 1") != std::string::npos;
        EXPECT_EQ(is_counted, answers[0].hit == 1) << shop.out;
        return answers[0].hit;
    };
    test::Triangles outer = test::box({0, 0, 0}, {10, 10, 10});
    EXPECT_EQ(hit_of(outer, 5), 1);
    EXPECT_EQ(hit_of(outer, 15), 0);
    outer.pop_back();
    EXPECT_EQ(hit_of(outer, 5), 0);
}

// A table may come from anywhere, and a terminal obeys what it is sent.
TEST_F(SceneFolderTest, ControlCharactersAreShownAsEscapes) {
    for (const std::string& message :
         {with("pairs", "pair,a,b\nx,rod,\x1B[31mred\n"),
          with("bodies", "name,stl,triangles\nrod,\x1B[2J.stl,12\n"),
          with("poses", kHead + "0,\x1B]0;title\x07," + kUnit + "\n"),
          with("poses", kHead + "0,rod,\x1B" + kUnit.substr(1) + "\n")}) {
        EXPECT_NE(message, "");
        EXPECT_NE(message.find("\\x1b"), std::string::npos) << message;
        EXPECT_EQ(message.find('\x1B'), std::string::npos) << message;
    }
}

TEST_F(SceneFolderTest, APairNameIsGivenOnce) {
    EXPECT_NE(
        with("pairs", "pair,a,b\np,rod,box\np,box,rod\n").find("pairs.csv:3: duplicate pair 'p'"),
        std::string::npos);
    EXPECT_EQ(with("pairs", "pair,a,b\np,rod,box\nq,box,rod\n"), "");
}

}  // namespace
}  // namespace axg
