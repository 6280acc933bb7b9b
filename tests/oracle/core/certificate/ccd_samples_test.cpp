// SPDX-License-Identifier: Apache-2.0
// ctest-labels: data
// The sample queries of Tight Inclusion (Wang and others 2021: edges and faces in motion, exact
// answers) as travels of one linear axis. Where both primitives only shift, the difference of the
// shifts is the axis. Corners are rounded to float and the direction to double: the answer is found
// anew for the rounded numbers, and the list's own answer for its own. The others deform on the
// way: both ends are judged. Format: README of the folder ccd.
#include <gtest/gtest.h>

#ifdef AXG_EXACT
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/exact_distance.hpp"
#include "tests/support/judged_scene.hpp"
#include "tests/support/one_axis_pair.hpp"

namespace axg::test {
namespace {

namespace fs = std::filesystem;

const fs::path kCcdFolder = fs::path(AXG_SHARED_DATA) / "ccd";
constexpr double kMmPerUnit = 64;         // a primitive about as large as a tool; exact
constexpr double kRoundedAlike = 1e-6;    // units: shifts of one body that was placed by doubles
constexpr double kMovedByFloatMm = 1e-4;  // more than rounding a scene of 400 mm to float can do

using RationalPoint = std::array<mpq_class, 3>;

struct CcdQuery {
    std::array<RationalPoint, 8> at;  // four corners at the start, then at the end
    std::size_t moving = 0;           // corners of the first primitive: a vertex, or an edge
    bool touches = false;             // the list's answer

    [[nodiscard]] mpq_class shift(std::size_t corner, std::size_t k) const {
        return at[corner + 4][k] - at[corner][k];
    }
    [[nodiscard]] std::size_t first_of(std::size_t corner) const {
        return corner < moving ? 0 : moving;
    }
    /// How much the shifts of one primitive's corners differ at most.
    [[nodiscard]] mpq_class deformation() const {
        mpq_class most = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t k = 0; k < 3; ++k) {
                const mpq_class by = abs(shift(i, k) - shift(first_of(i), k));
                most = std::max(most, by);
            }
        }
        return most;
    }
};

std::vector<CcdQuery> read_ccd_file(const fs::path& file, bool is_edge_edge) {
    std::vector<CcdQuery> out;
    std::ifstream in(file);
    std::string line;
    for (std::size_t row = 0; std::getline(in, line); ++row) {
        std::istringstream cells(line);
        std::array<std::string, 7> cell;
        for (std::string& text : cell) {
            std::getline(cells, text, ',');
        }
        if (row % 8 == 0) {
            out.push_back({.at = {}, .moving = is_edge_edge ? 2U : 1U, .touches = cell[6] == "1"});
        }
        EXPECT_EQ(out.back().touches, cell[6] == "1") << file << ", row " << row;
        for (std::size_t k = 0; k < 3; ++k) {
            mpq_class& x = out.back().at[row % 8][k];
            x = mpq_class(mpz_class(cell[2 * k]), mpz_class(cell[2 * k + 1]));
            x.canonicalize();
        }
    }
    return out;
}

bool is_in_doubles(const CcdQuery& query) {
    return std::all_of(query.at.begin(), query.at.end(), [](const RationalPoint& p) {
        return std::all_of(p.begin(), p.end(),
                           [](const mpq_class& x) { return mpq_class(x.get_d()) == x; });
    });
}

ExactPoint moved_by(const ExactPoint& p, const ExactPoint& by) {
    return {p[0] + by[0], p[1] + by[1], p[2] + by[2]};
}

/// Least square of the distance while a vertex or an edge moves along `by` past the rest. What the
/// edge sweeps is two triangles; what the vertex sweeps has no area.
ExactSquare swept_distance(std::span<const ExactPoint> corners, std::size_t moving,
                           const ExactPoint& by) {
    const ExactTriangle rest{corners[moving], corners[moving + 1], corners[3]};
    const ExactPoint &p = corners[0], &q = corners[moving - 1];
    const ExactSquare near = squared_distance({p, q, moved_by(q, by)}, rest);
    const ExactSquare far = squared_distance({p, moved_by(q, by), moved_by(p, by)}, rest);
    return far.less_than(near) ? far : near;
}

/// The query with its own numbers, in units of the list.
ExactSquare own_distance(const CcdQuery& query) {
    std::array<ExactPoint, 4> corners;
    ExactPoint by;
    for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t i = 0; i < 4; ++i) {
            corners[i][k] = Dyadic(query.at[i][k].get_d());
        }
        const auto shift = [&](std::size_t i) {
            return Dyadic(query.at[i + 4][k].get_d()) - Dyadic(query.at[i][k].get_d());
        };
        by[k] = shift(0) - shift(query.moving);
    }
    return swept_distance(corners, query.moving, by);
}

Vec3f float_corner(const RationalPoint& p) {
    const auto mm = [](const mpq_class& x) { return static_cast<float>(kMmPerUnit * x.get_d()); };
    return {mm(p[0]), mm(p[1]), mm(p[2])};
}

/// Both primitives at the start or the end, mm; an edge and a vertex are triangles without area.
std::vector<Mesh> meshes_of(const CcdQuery& query, bool at_the_end = false) {
    std::array<Vec3f, 4> p;
    for (std::size_t i = 0; i < 4; ++i) {
        p[i] = float_corner(query.at[i + (at_the_end ? 4 : 0)]);
    }
    const std::size_t n = query.moving;
    return {{"moves", {{p[0], p[n - 1], p[n - 1]}}}, {"stands", {{p[n], p[n + 1], p[3]}}}};
}

/// The same as travel of an axis from 0.
struct CcdTravel {
    Vec3d direction{0, 0, 1};
    double length_mm = 0;

    explicit CcdTravel(const CcdQuery& query) {
        const auto along = [&query](std::size_t k) {
            const mpq_class by = query.shift(0, k) - query.shift(query.moving, k);
            return kMmPerUnit * by.get_d();
        };
        const Vec3d by{along(0), along(1), along(2)};
        length_mm = std::sqrt(dot(by, by));
        if (length_mm > 0) {
            direction = {by.x / length_mm, by.y / length_mm, by.z / length_mm};
        }
    }
    /// Of the floats and doubles that the machine is made of.
    [[nodiscard]] ExactSquare distance(const std::vector<Mesh>& meshes, std::size_t moving) const {
        const ExactTriangle a = exact(meshes[0].triangles[0]), b = exact(meshes[1].triangles[0]);
        const Dyadic length(length_mm);
        const ExactPoint by{Dyadic(direction.x) * length, Dyadic(direction.y) * length,
                            Dyadic(direction.z) * length};
        const std::array<ExactPoint, 4> corners =
            moving == 1 ? std::array{a[0], b[0], b[1], b[2]} : std::array{a[0], a[1], b[0], b[1]};
        return swept_distance(corners, moving, by);
    }
};

struct CcdTally {
    unsigned queries = 0, shifts = 0, rounded = 0, deformed = 0;
    unsigned touching = 0, apart = 0;  // shifts, exactly, of the rounded numbers
    unsigned by_rounding = 0;          // of those: the list's own numbers have the other answer
    unsigned not_proven = 0, not_proven_in_a_cycle = 0;
    double widest_mm = 0, widest_in_a_cycle_mm = 0;  // of these, the largest distance
    unsigned within_error = 0;  // apart by less than the placement error: never proven
    unsigned ends_touching = 0, ends_apart = 0, ends_not_proven = 0;
    double widest_end_mm = 0;
};

void judge_shift(const CcdQuery& query, CcdTally& tally) {
    const std::vector<Mesh> meshes = meshes_of(query);
    const CcdTravel travel(query);
    const ExactSquare truth = travel.distance(meshes, query.moving);
    const double distance_mm = truth.mm();
    OneAxisPair pair(meshes[0], meshes[1], AxisKind::linear, travel.direction);
    const bool is_far = pair.is_apart(0, travel.length_mm);
    const bool is_far_in_a_cycle = pair.is_apart_in_a_cycle(0, travel.length_mm);
    const bool own_touches = own_distance(query).is_zero();
    EXPECT_TRUE(query.deformation() != 0 || own_touches == query.touches)
        << "the exact judge and the list disagree";
    EXPECT_TRUE(!query.touches || distance_mm < kMovedByFloatMm) << distance_mm;
    tally.by_rounding += own_touches != truth.is_zero() ? 1 : 0;
    if (truth.is_zero()) {
        ++tally.touching;
        EXPECT_FALSE(is_far) << "false far";
        EXPECT_FALSE(is_far_in_a_cycle) << "false far in a cycle";
        return;
    }
    ++tally.apart;
    tally.within_error += distance_mm <= kPlacementErrorMm ? 1 : 0;
    // Both sides: no margin that is not below the distance is ever proven.
    const double too_much_mm = std::nextafter(distance_mm, HUGE_VAL) * (1 + 0x1p-50);
    EXPECT_FALSE(truth.more_than(too_much_mm));
    if (too_much_mm < kMarginMmMax) {
        EXPECT_FALSE(pair.is_apart(0, travel.length_mm, too_much_mm, {8, 1024}));
        EXPECT_FALSE(pair.is_apart_in_a_cycle(0, travel.length_mm, too_much_mm));
    }
    if (!is_far) {
        ++tally.not_proven;
        tally.widest_mm = std::max(tally.widest_mm, distance_mm);
    }
    if (!is_far_in_a_cycle) {
        ++tally.not_proven_in_a_cycle;
        tally.widest_in_a_cycle_mm = std::max(tally.widest_in_a_cycle_mm, distance_mm);
    }
}

void judge_ends(const CcdQuery& query, CcdTally& tally) {
    for (const bool at_the_end : {false, true}) {
        JudgedScene scene(meshes_of(query, at_the_end));
        const JudgedPair found = scene.judge(0, 1);
        ++(found.meets ? tally.ends_touching : tally.ends_apart);
        if (!found.meets && !found.is_far) {
            ++tally.ends_not_proven;
            tally.widest_end_mm = std::max(tally.widest_end_mm, found.distance_mm);
        }
    }
}

void judge_file(const fs::path& file, bool is_edge_edge, CcdTally& all) {
    CcdTally tally;
    for (const CcdQuery& query : read_ccd_file(file, is_edge_edge)) {
        SCOPED_TRACE(file.string() + ", query " + std::to_string(tally.queries));
        ++tally.queries;
        EXPECT_TRUE(is_in_doubles(query)) << "its own answer would be rounded";
        const mpq_class deformation = query.deformation();
        if (deformation <= mpq_class(kRoundedAlike)) {
            ++(deformation == 0 ? tally.shifts : tally.rounded);
            judge_shift(query, tally);
        } else {
            ++tally.deformed;
            judge_ends(query, tally);
        }
        if (testing::Test::HasFailure()) {
            return;
        }
    }
    std::printf(
        "%-24s %s: %4u queries, %3u shifts, %3u rounded, %3u deformed; %3u touch, %3u do "
        "not, %u by rounding; not proven %u, in a cycle %u\n",
        file.parent_path().parent_path().filename().c_str(), is_edge_edge ? "ee" : "vf",
        tally.queries, tally.shifts, tally.rounded, tally.deformed, tally.touching, tally.apart,
        tally.by_rounding, tally.not_proven, tally.not_proven_in_a_cycle);
    for (unsigned CcdTally::*const count :
         {&CcdTally::queries, &CcdTally::shifts, &CcdTally::rounded, &CcdTally::deformed,
          &CcdTally::touching, &CcdTally::apart, &CcdTally::by_rounding, &CcdTally::not_proven,
          &CcdTally::not_proven_in_a_cycle, &CcdTally::within_error, &CcdTally::ends_touching,
          &CcdTally::ends_apart, &CcdTally::ends_not_proven}) {
        all.*count += tally.*count;
    }
    for (double CcdTally::*const most :
         {&CcdTally::widest_mm, &CcdTally::widest_in_a_cycle_mm, &CcdTally::widest_end_mm}) {
        all.*most = std::max(all.*most, tally.*most);
    }
}

TEST(CcdSamples, NoTravelThatTouchesIsProvenApart) {
    if (!fs::exists(kCcdFolder)) {
        GTEST_SKIP() << "no " << kCcdFolder << ": set the CMake variable AXG_SHARED_DATA";
    }
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(kCcdFolder)) {
        if (entry.path().extension() == ".csv") {
            files.push_back(entry.path());
        }
    }
    std::sort(files.begin(), files.end());
    CcdTally all;
    for (const fs::path& file : files) {
        judge_file(file, file.parent_path().filename() == "edge-edge", all);
    }
    std::printf(
        "all: %u queries: %u shifts, %u shifts but for rounding, %u deformed\n"
        "shifts: %u touch and none is proven apart; %u are apart, %u of them by less than the "
        "error of a pose (%u of both by rounding)\n"
        "not proven: %u with time, up to %.3g mm; %u in a cycle, up to %.3g mm\n"
        "ends of the deformed: %u touch, %u are apart; not proven %u, up to %.3g mm\n",
        all.queries, all.shifts, all.rounded, all.deformed, all.touching, all.apart,
        all.within_error, all.by_rounding, all.not_proven, all.widest_mm, all.not_proven_in_a_cycle,
        all.widest_in_a_cycle_mm, all.ends_touching, all.ends_apart, all.ends_not_proven,
        all.widest_end_mm);
    EXPECT_GT(all.queries, 0U);
    EXPECT_GT(all.touching, 100U);
    EXPECT_GT(all.apart, 1000U);
    EXPECT_LE(all.widest_mm, 1e-6) << "of what a prover with time leaves open";
    EXPECT_LE(all.widest_end_mm, 1e-6);
}

}  // namespace
}  // namespace axg::test
#else
TEST(CcdSamples, NeedsExactArithmetic) {
    GTEST_SKIP() << "built without GMP and its C++ bindings (Debian: libgmp-dev)";
}
#endif
