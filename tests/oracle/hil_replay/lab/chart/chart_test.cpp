// SPDX-License-Identifier: Apache-2.0
// axguard-lab chart: the failures it shows are those that are known, each printed case fails again
// when it is read back, two runs of one seed count alike, and figures appear where matplotlib is
// there.
// ctest-labels: rare hil_replay.lab.bench hil_replay.lab.methods
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/replay_fixture.hpp"
#include "tests/support/seed.hpp"
#ifdef AXG_EXACT
#include "hil_replay/lab/cases/pair_cases.hpp"
#include "hil_replay/lab/chart/exact_clearance.hpp"
#include "hil_replay/lab/chart/figures.hpp"
#include "hil_replay/lab/chart/method_scores.hpp"
#include "hil_replay/lab/judge/exact_judge.hpp"
#include "hil_replay/plan/draw_figures.hpp"
#endif

namespace axg {
namespace {

#ifdef AXG_EXACT

using chart::MethodScore;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr std::size_t kPairsAKind = 40;  // fewer pairs, not fewer kinds
#else
constexpr std::size_t kPairsAKind = 100;
#endif

/// A table as `axguard-lab chart` writes it: quotes around cells that hold a comma.
std::vector<std::vector<std::string>> rows_of(const std::string& text) {
    std::vector<std::vector<std::string>> rows;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        std::vector<std::string> cells(1);
        bool is_quoted = false;
        for (const char c : line) {
            if (c == '"') {
                is_quoted = !is_quoted;
            } else if (c == ',' && !is_quoted) {
                cells.emplace_back();
            } else {
                cells.back() += c;
            }
        }
        rows.push_back(cells);
    }
    return rows;
}

std::string head_of(const std::string& text) {
    return text.substr(0, text.find('\n'));
}

class ChartScores : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        const char* const count = std::getenv("AXG_COUNT");
        const std::uint64_t seed = test::printed_seed(1);
        book_ = chart::make_case_book(
            seed, count == nullptr ? kPairsAKind : std::strtoull(count, nullptr, 10));
        for (const lab::Method& method : lab::methods()) {
            scores_[std::string(method.name)] = chart::score_of(method, book_);
        }
    }
    /// Summed over the categories whose name begins so.
    static chart::Score in_categories(const MethodScore& m, const std::string& beginning) {
        chart::Score sum;
        for (std::size_t i = 0; i < m.by_category.size(); ++i) {
            if (std::string(lab::pair_category_name(i)).starts_with(beginning)) {
                sum.far_false_hits += m.by_category[i].far_false_hits;
                sum.missed += m.by_category[i].missed;
            }
        }
        return sum;
    }
    static chart::CaseBook book_;
    static std::map<std::string, MethodScore> scores_;
};
chart::CaseBook ChartScores::book_;
std::map<std::string, MethodScore> ChartScores::scores_;

TEST_F(ChartScores, CertifiedMethodsMissNothingAndInventNothing) {
    unsigned certified = 0;
    for (const auto& [name, score] : scores_) {
        if (!score.is_certified) {
            continue;
        }
        ++certified;
        for (const chart::Score& s : score.by_category) {
            EXPECT_EQ(s.missed, 0U) << name;
            EXPECT_EQ(s.false_hits, 0U) << name;
        }
    }
    EXPECT_GE(certified, 2U);
}

// Methods that trust the sign of a computed plane miss a triangle that float turned to a line,
// however deep it goes through the other. One such pair in thirty, so many are drawn.
TEST_F(ChartScores, MethodsOfSignsMissDeep) {
    std::size_t line = 0;
    while (lab::pair_category_name(line) != std::string("pierced by a rounded line")) {
        ASSERT_LT(++line, lab::pair_category_count());
    }
    const std::uint64_t seed = test::printed_seed(1);
    lab::PairSet pairs;
    for (std::uint64_t i = 0; i < 1000; ++i) {
        pairs.add(lab::make_pair_case<float>(line, seed, i));
    }
    for (const char* const name : {"moller-f32", "guigue-devillers-f32", "held-f32",
                                   "certified-f32", "certified-f32+f64", "exact"}) {
        const lab::Method* const method = lab::find_method(name);
        ASSERT_NE(method, nullptr) << name;
        const lab::Judged judged = lab::judge(*method, pairs, false);
        double deepest_um = 0;
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            if (judged.verdicts[i] == lab::Verdict::separated) {
                deepest_um = std::max(deepest_um, chart::truth_of(pairs.given[i]).depth_um);
            }
        }
        if (method->certified) {
            EXPECT_EQ(deepest_um, 0) << name;
        } else {
            EXPECT_GT(deepest_um, 1000) << name;
            EXPECT_GT(scores_.at(name).machine.missed, 100U) << name;
        }
    }
}

// Separating axes without a bound miss what touches within rounding, and nothing deeper.
TEST_F(ChartScores, PlainAxesMissShallow) {
    for (const char* const name : {"sat17-f32", "sat11-f32"}) {
        EXPECT_GT(scores_.at(name).machine.missed, 0U) << name;
        EXPECT_LT(scores_.at(name).machine.deepest_missed_um, 1) << name;
    }
}

// Eleven axes cannot tell neighbours in one plane apart; seventeen can.
TEST_F(ChartScores, ElevenAxesCallCoplanarNeighboursHits) {
    EXPECT_GT(in_categories(scores_.at("sat11-f32"), "one plane").far_false_hits, 20U);
    EXPECT_LT(in_categories(scores_.at("sat17-f32"), "one plane").far_false_hits,
              in_categories(scores_.at("sat11-f32"), "one plane").far_false_hits / 4);
}

TEST_F(ChartScores, DepthsAndDistancesFitTheExactAnswers) {
    for (const chart::Cases* const cases : {&book_.f32, &book_.f64}) {
        std::uint64_t touching = 0;
        for (std::size_t i = 0; i < cases->truth.size(); ++i) {
            const chart::Truth& truth = cases->truth[i];
            touching += truth.intersects ? 1 : 0;
            EXPECT_TRUE(truth.depth_um >= 0 && truth.depth_um < 1e9) << i;
            EXPECT_TRUE(truth.distance_um == 0 || !truth.intersects) << i;
            EXPECT_TRUE(truth.depth_um == 0 || truth.intersects) << i;
        }
        EXPECT_GT(touching, cases->truth.size() / 5);
        EXPECT_LT(touching, cases->truth.size() / 2);
    }
}

TEST(CaseBook, ASeedMeansItsPairs) {
    const chart::CaseBook one = chart::make_case_book(1, 2), same = chart::make_case_book(1, 2),
                          other = chart::make_case_book(2, 2);
    const auto first_vertex = [](const chart::CaseBook& book) {
        return book.f32.pairs.given[0].a[0];
    };
    EXPECT_EQ(first_vertex(one), first_vertex(same));
    EXPECT_NE(first_vertex(one), first_vertex(other));
}

TEST(ExactClearance, IsTheDistanceOfTheNearestTriangles) {
    const std::vector<Triangle> floor = {{{0, 0, 0}, {10, 0, 0}, {0, 10, 0}},
                                         {{10, 0, 0}, {10, 10, 0}, {0, 10, 0}}};
    const std::vector<Triangle> tip = {{{0, 0, 0}, {1, 0, 5}, {0, 1, 5}},
                                       {{0, 0, 9}, {1, 0, 9}, {0, 1, 9}},
                                       {{2, 2, 2.5F}, {3, 2, 2.5F}, {2, 3, 2.5F}}};
    Pose pose;
    pose.t[0] = 4, pose.t[1] = 4, pose.t[2] = 0.125;
    EXPECT_EQ(chart::exact_clearance_mm(tip, pose, floor, 50), 0.125);
    EXPECT_EQ(chart::exact_clearance_mm(tip, pose, floor, 0.0625), 0.0625);  // no farther
    pose.t[2] = 0;
    EXPECT_EQ(chart::exact_clearance_mm(tip, pose, floor, 50), 0);
    pose.t[2] = -2;  // pierces, and its edges are farther off than another triangle is
    EXPECT_EQ(chart::exact_clearance_mm(tip, pose, floor, 50), 0);
    pose.t[0] = 13, pose.t[2] = 4;  // past the edge x = 10: 3, 4, 5
    EXPECT_EQ(chart::exact_clearance_mm(tip, pose, floor, 50), 5);
}

TEST(Conditions, QuoteWhatAValueMayHold) {
    EXPECT_EQ(conditions_table({{"scene", "a \"b\", c"}}),
              "name,value\nscene,\"a \"\"b\"\", c\"\n");
}

/// The program, in a folder of its own, once for all tests below.
class ChartCommand : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        workshop_ = new test::Workshop;
        exit_code_ = workshop_->run("chart -o first --quick --seed 5 --json=first.json");
    }
    static void TearDownTestSuite() { delete workshop_; }

    static std::string table(const std::string& folder, const std::string& name) {
        return test::content_of(workshop_->file(folder + "/" + name));
    }
    static bool has_matplotlib() {
        return std::system(
                   "python3 -c 'import matplotlib' >/dev/null 2>&1 || "
                   "/usr/bin/python3 -c 'import matplotlib' >/dev/null 2>&1") == 0;
    }

    static constexpr const char* kFigures[] = {
        "speed-accuracy", "missed-contacts", "not-told-apart",  "cycle-accuracy", "model-curve",
        "undecided-gap",  "rechecks",        "clearance-error", "flips"};
    static test::Workshop* workshop_;
    static int exit_code_;
};
test::Workshop* ChartCommand::workshop_ = nullptr;
int ChartCommand::exit_code_ = -1;

TEST_F(ChartCommand, WritesTablesWithTheirColumns) {
    ASSERT_EQ(exit_code_, 0) << workshop_->err;
    EXPECT_EQ(head_of(table("first", "speed-accuracy.csv")),
              "method,certified,fused,ns_a_pair,ns_touching,ns_apart,intersecting,apart,missed,"
              "deepest_missed_um,false_hits,false_hits_beyond_1_um,farthest_false_hit_um,"
              "undecided_hits,undecided_apart,widest_undecided_um");
    EXPECT_EQ(head_of(table("first", "undecided-gap.csv")),
              "method,aspect,least_gap_um,most_gap_um,pairs,undecided,undecided_percent");
    EXPECT_EQ(head_of(table("first", "rechecks.csv")),
              "least_rechecks,most_rechecks,anywhere,near contact,sliding,climb to the most");
    EXPECT_EQ(head_of(table("first", "clearance-error.csv")), "method,bodies,distance_mm,error_um");
    EXPECT_EQ(head_of(table("first", "flips.csv")),
              "method,certified,fused,frame,pairs,differing_in_72_orders,"
              "separated_though_touching");
    for (const char* const name : {"speed-accuracy", "undecided-gap", "flips", "failure-map",
                                   "failing-cases", "rechecks", "clearance-error"}) {
        const auto rows = rows_of(table("first", std::string(name) + ".csv"));
        EXPECT_GT(rows.size(), 3U) << name;
        for (const auto& row : rows) {
            EXPECT_EQ(row.size(), rows.front().size()) << name;
        }
    }
}

// What was measured here takes the place of its name; what a record states stays as it is.
TEST_F(ChartCommand, CyclesHaveTheirTimes) {
    auto rows = rows_of(table("first", "cycle-accuracy.csv"));
    const auto records =
        rows_of(test::content_of(AXG_SOURCE_DIR "/docs/figures/cycle-records.csv"));
    ASSERT_EQ(rows.size(), records.size());
    unsigned measured = 0;
    for (std::size_t i = 1; i < rows.size(); ++i) {
        ASSERT_EQ(rows[i].size(), 8U);
        EXPECT_GT(std::stod(rows[i][4]), 0) << rows[i][1];
        measured += std::isalpha(static_cast<unsigned char>(records[i][4][0])) != 0 ? 1 : 0;
        EXPECT_EQ(rows[i][7], records[i][7]);
    }
    EXPECT_EQ(measured, 3U);
}

// Of the records beside it: a level bends back if a finer one of its machine is faster.
TEST_F(ChartCommand, ModelsThatBendBackAreNamed) {
    const auto rows = rows_of(table("first", "model-curve.csv"));
    ASSERT_EQ(rows.size(), 11U);
    std::string bends;
    for (std::size_t i = 1; i < rows.size(); ++i) {
        const bool is_first = rows[i][0] != rows[i - 1][0];
        bool bends_back = false;
        for (std::size_t j = i - 1; !is_first && j > 0 && rows[j][0] == rows[i][0]; --j) {
            bends_back |= std::stod(rows[j][3]) < std::stod(rows[i][3]);
        }
        EXPECT_EQ(rows[i][6], bends_back ? "1" : "0") << rows[i][0] << " " << rows[i][1];
        bends += bends_back ? rows[i][0] + rows[i][1] + " " : "";
    }
    EXPECT_EQ(bends, "real0.05 real0.1 real0.2 ");
    const std::string picture = table("first", "model-curve.svg");
    EXPECT_TRUE(!has_matplotlib() || picture.find("0.05 mm, bends back") != std::string::npos);
    EXPECT_TRUE(!has_matplotlib() || picture.find("deadline, 500 µs") != std::string::npos);
}

TEST_F(ChartCommand, CertifiedMethodsNeverClaimTooMuch) {
    unsigned certified = 0;
    for (const auto& row : rows_of(table("first", "speed-accuracy.csv"))) {
        if (row[1] == "1") {
            ++certified;
            EXPECT_EQ(row[8], "0") << row[0];
        }
    }
    EXPECT_GE(certified, 2U);
    unsigned turned = 0;
    for (const auto& row : rows_of(table("first", "flips.csv"))) {
        turned += row[1] == "1" ? 1 : 0;
        EXPECT_TRUE(row[1] != "1" || row[6] == "0") << row[0] << ", " << row[3];
    }
    EXPECT_GE(turned, 8U);
    unsigned clearances = 0;
    for (const auto& row : rows_of(table("first", "clearance-error.csv"))) {
        if (row[0] == "axguard engine") {
            ++clearances;
            EXPECT_LE(std::stod(row[3]), 0) << row[2];
        }
    }
    EXPECT_GT(clearances, 10U);
}

// What a user would do with a line of the table: read the numbers, and see the method fail.
TEST_F(ChartCommand, PrintedCasesFailAgain) {
    auto rows = rows_of(table("first", "failing-cases.csv"));
    ASSERT_GT(rows.size(), 5U);
    rows.erase(rows.begin());
    for (const auto& row : rows) {
        ASSERT_EQ(row.size(), 24U);
        double v[18];
        for (std::size_t i = 0; i < 18; ++i) {
            v[i] = std::strtod(row[6 + i].c_str(), nullptr);
        }
        lab::Pair<double> pair;
        for (int i = 0; i < 3; ++i) {
            pair.a[i] = {v[3 * i], v[3 * i + 1], v[3 * i + 2]};
            pair.b[i] = {v[9 + 3 * i], v[10 + 3 * i], v[11 + 3 * i]};
        }
        const bool missed = row[1].ends_with("missed");
        EXPECT_EQ(lab::intersect(pair), missed) << row[0] << ", " << row[1];
        lab::PairSet pairs;
        pairs.add(pair);
        const lab::Method* const method = lab::find_method(row[0]);
        ASSERT_NE(method, nullptr) << row[0];
        EXPECT_EQ(lab::judge(*method, pairs, false).verdicts[0],
                  missed ? lab::Verdict::separated : lab::Verdict::intersecting)
            << row[0] << ", " << row[1];
    }
}

TEST_F(ChartCommand, SameSeedCountsAlike) {
    ASSERT_EQ(workshop_->run("chart -o second --quick --seed 5"), 0) << workshop_->err;
    for (const char* const name : {"failure-map.csv", "failing-cases.csv", "undecided-gap.csv",
                                   "rechecks.csv", "clearance-error.csv", "flips.csv"}) {
        EXPECT_EQ(table("first", name), table("second", name)) << name;
        EXPECT_FALSE(table("first", name).empty()) << name;
    }
    auto first = rows_of(table("first", "speed-accuracy.csv"));
    auto second = rows_of(table("second", "speed-accuracy.csv"));
    for (auto* const rows : {&first, &second}) {
        for (auto& row : *rows) {
            row.erase(row.begin() + 3, row.begin() + 6);  // the times
        }
    }
    EXPECT_EQ(first, second);
}

TEST_F(ChartCommand, DrawsWhereMatplotlibIs) {
    if (!has_matplotlib()) {
        GTEST_SKIP() << "no matplotlib (Debian: python3-matplotlib)";
    }
    for (const std::string name : kFigures) {
        EXPECT_NE(table("first", name + ".svg").find("</svg>"), std::string::npos) << name;
        EXPECT_EQ(table("first", name + ".png").substr(1, 3), "PNG") << name;
        EXPECT_FALSE(std::filesystem::exists(workshop_->file("first/" + name + ".svg.part")));
    }
}

// A module of that name that cannot be imported is in the place of matplotlib.
TEST_F(ChartCommand, WithoutMatplotlibSaysWhatToInstall) {
    (void)workshop_->write("matplotlib.py", "raise ImportError\n");
    const std::string line = "cd '" + workshop_->file("") + "' && PYTHONPATH=. '" +
                             AXG_LAB_PROGRAM + "' chart -o bare --quick >bare.out 2>bare.err";
    EXPECT_EQ(std::system(line.c_str()), 0);
    EXPECT_NE(test::content_of(workshop_->file("bare.err")).find("python3-matplotlib"),
              std::string::npos);
    EXPECT_FALSE(table("bare", "conditions.csv").empty());
    for (const std::string name : kFigures) {
        EXPECT_FALSE(std::filesystem::exists(workshop_->file("bare/" + name + ".svg"))) << name;
    }
}

// Debian's packages belong to its own python3: another in PATH does not hide them.
TEST_F(ChartCommand, DrawsWithThePythonOfTheSystem) {
    if (std::system("/usr/bin/python3 -c 'import matplotlib' >/dev/null 2>&1") != 0) {
        GTEST_SKIP() << "no matplotlib (Debian: python3-matplotlib)";
    }
    const std::string line = "cd '" + workshop_->file("") + "' && PATH=/nowhere '" +
                             AXG_LAB_PROGRAM + "' chart -o system --quick >system.out 2>system.err";
    EXPECT_EQ(std::system(line.c_str()), 0);
    EXPECT_FALSE(table("system", "flips.svg").empty());
}

TEST_F(ChartCommand, SaysWhatIsWrongWithItsFolders) {
    EXPECT_EQ(workshop_->run("chart -o bad --quick --data /nowhere"), 3);
    EXPECT_NE(workshop_->err.find("--data"), std::string::npos) << workshop_->err;
    EXPECT_EQ(workshop_->run("chart -o bad --quick --tritri /nowhere"), 3);
    EXPECT_NE(workshop_->err.find("meshes.bin"), std::string::npos) << workshop_->err;
    EXPECT_EQ(workshop_->run("chart -o first/flips.csv --quick"), 2);
    EXPECT_EQ(workshop_->run("chart"), 2);
}

#else

TEST(ChartCommand, WithoutExactJudgeSaysWhatToInstall) {
    test::Workshop workshop;
    EXPECT_EQ(workshop.run("chart -o out"), 3);
    EXPECT_NE(workshop.err.find("libgmp-dev"), std::string::npos) << workshop.err;
}

#endif

}  // namespace
}  // namespace axg
