// SPDX-License-Identifier: Apache-2.0
// Boxes for which public reports of FCL, Drake and Coal name a wrong distance, an exception, a loop
// without end or a collision that was not seen. Each is built of our own triangles with the numbers
// of the report, judged in exact arithmetic, and its distance compared with that of exact fractions
// of those numbers, found by another program (separating axes; features of boxes).
#include <gtest/gtest.h>

#ifdef AXG_EXACT
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "core/machine/kinematics.hpp"
#include "tests/support/containment_fixture.hpp"
#include "tests/support/judged_scene.hpp"
#include "tests/support/one_axis_pair.hpp"
#include "tests/support/solids.hpp"

namespace axg::test {
namespace {

// Reports are in metres. In units of a twentieth of a mm nearly all of their sizes are floats.
constexpr double kUnitsPerMetre = 20'000, kUnitsPerMm = 20;
constexpr double kBoxBandMm = 1e-6;        // what the recheck in double may leave undecided
constexpr double kSizesAsFloatsMm = 1e-5;  // sizes that are no floats move a side by less

using Size = std::array<double, 3>;
using Rows = std::array<double, 12>;  // 3 x 4, as the reports print them

struct ReportedBox {
    Size size;
    Rows at;
};

Mesh box_of(const Size& size) {
    const auto half = [&size](std::size_t k) {
        return static_cast<float>(0.5 * kUnitsPerMetre * size[k]);
    };
    const Vec3f high{half(0), half(1), half(2)};
    return {"box", box({-high.x, -high.y, -high.z}, high)};
}

Pose pose_of(const Rows& rows) {
    Pose out;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            out.r[i][k] = rows[4 * i + k];
        }
        out.t[i] = kUnitsPerMetre * rows[4 * i + 3];
    }
    return out;
}

constexpr Rows shifted_to(double x, double y, double z) {
    return {1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z};
}

struct BoxReport {
    const char* what;
    ReportedBox a, b;
    double distance_mm;  // of exact fractions of the report's numbers; 0 where they overlap
};

const BoxReport kBoxReports[] = {
    {"FCL 388, 390: exception",
     {{0.03, 0.12, 0.1},
      {-3.0627937852578681533e-08, -0.99999999999999888978, -2.8893865161583314238e-08,
       0.63499979627350811029, 0.9999999999999980016, -3.0627939739957803544e-08,
       6.4729926918527511769e-08, -0.48500002215636439651, -6.4729927722963847085e-08,
       -2.8893863029448751323e-08, 0.99999999999999711342, 1.0778146458339641356}},
     {{0.025, 0.35, 1.845}, {0, -1, 0, 0.8, 1, 0, 0, -0.4575, 0, 0, 1, 1.0225}},
     1.7082191678258196e-05},
    {"FCL 395: exception, a triangle of no size",
     {{0.46, 0.48, 0.01}, shifted_to(-0.721, -0.772, 0.81000000000000005329)},
     {{0.049521, 0.146, 0.0725},
      {0.10758262492983036718, -0.6624881850015212903, -0.74130653817877356637,
       -0.42677133002999478872, 0.22682184885125472595, -0.709614040775253474,
       0.6670830248314786326, -0.76596851247746788882, -0.96797615037608542021,
       -0.23991106241273435495, 0.07392465377049164954, 0.80746731400091054098}},
     0},
    {"FCL 398 (Drake): exception, boxes that kiss",
     {{0.614, 3, 0.037}, shifted_to(-0.675, 0, 0.9115)},
     {{0.494, 0.552, 0.01}, shifted_to(-0.692, 0, 0.935)},
     7.7e-14},
    {"FCL 399 (Drake): exception",
     {{0.23768037557601928711, 0.15702305734157562256, 0.25},
      {-0.099432387353076273628, 0.99504432079443971837, 0, 0.29526406526565551758,
       -0.99504432079443971837, -0.099432387353076273628, 0, -0.013230856508016586304, 0, 0, 1, 0}},
     {{0.01, 0.78165709972381591797, 0.25},
      {0.99506598442099225554, 0.099215354901756730444, 0, 0.22759585694545214629,
       -0.099215354901756730444, 0.99506598442099225554, 0, 0.14974093549228112421, 0, 0, 1, 0}},
     0},
    {"FCL 415: exception, a corner in line with a side",
     {{0.49, 0.05, 0.21},
      {4.8966386501092529215e-12, -1, 0, -0.44, 1, 4.8966386501092529215e-12, 0,
       -0.61499999999858001587, 0, 0, 1, 0.355}},
     {{0.035, 0.12, 0.03},
      {0.83512153565236335595, -0.55006546945762568868, -9.4542360608233572896e-16,
       -0.40653441507331000704, 0.55006546945762568868, 0.83512153565236313391,
       1.1787444236552387666e-15, -0.69166166923735727945, 1.2902271444330665572e-16,
       -1.4878153530113264589e-15, 1, 0.43057093858718892276}},
     0},
    {"FCL 428: exception",
     {{0.2, 0.33, 0.1}, shifted_to(-0.071000000000000035305, -0.772, 0.79999999999999993339)},
     {{0.452, 0.27, 0.6}, shifted_to(0.121, -0.78769605692727695523, 0.53422044196125151316)},
     0},
    {"FCL 445: exception, boxes that kiss",
     {{0.3165, 0.2276, 0.1768},
      {0.44540578475530234748, 0.89532881496493399442, -8.8937407685638678971e-09,
       1.2652949075960071568, -0.89532881496493377238, 0.44540578475530190339,
       -2.8948680226084145336e-08, 1.4551012423210101243, -2.1957263975186326105e-08,
       2.0856732016652919226e-08, 0.99999999999999955591, 0.49480006232932938204}},
     {{0.4943, 0.3546, 0.0752},
      {0.44171122913485860728, 0.8971572827861190591, -1.622764514865468214e-09,
       1.1304016226141906376, -0.8971572827861190591, 0.44171122913485860728,
       -5.1621053952306079594e-09, 1.8410802645284281009, -3.9144271413829990148e-09,
       3.7360349218094348098e-09, 1, 0.44400006232932492933}},
     0},
    {"FCL 493: exception, a tilted stack",
     {{0.5, 0.5, 0.5},
      {0.96193976625564348026, 0.15401279915737359216, 0.22572537250328919556,
       2.0770063995786869349, -0.19134171618254486313, 0.96936494951283913579,
       0.15401279915737359216, 0.48468247475641951239, -0.19509032201612822033,
       -0.19134171618254486313, 0.96193976625564348026, 1.1543291419087275962}},
     {{0.5, 0.5, 0.5},
      {0.96193976625564348026, 0.15401279915737359216, 0.22572537250328919556, 2,
       -0.19134171618254486313, 0.96936494951283913579, 0.15401279915737359216, 0,
       -0.19509032201612822033, -0.19134171618254486313, 0.96193976625564348026, 1.25}},
     0},
    {"FCL 495: exception, a tilted stack",
     {{0.25, 0.25, 0.25},
      {0.94096063217417758029, 0.29296840037289501035, 0.16959541586174811667,
       0.073242100093223821977, -0.23569836841299879326, 0.92661523595848427348,
       -0.29296840037289506586, 0.2316538089896212349, -0.2429801799032638987,
       0.23569836841299884878, 0.94096063217417758029, 1.3089245921032497399}},
     {{0.25, 0.25, 0.25},
      {0.94096063217417758029, 0.29296840037289501035, 0.16959541586174811667, 0,
       -0.23569836841299879326, 0.92661523595848427348, -0.29296840037289506586, 0,
       -0.2429801799032638987, 0.23569836841299884878, 0.94096063217417758029, 1.25}},
     1.8e-13},
    {"Coal 604: a distance of another order",
     {{0.363, 0.277, 0.363},
      {0.9999195703, 0.01021849413, 0.007512347878, 1.503354966, -0.01021878248, 0.9999477869,
       -3.329855922e-17, -0.8531707835, -0.007511955635, -7.676704888e-05, 0.9999717819,
       0.7700092418}},
     {{0.363, 0.363, 0.277},
      {0.9998670967, -0.01297708324, 0.009868343982, 1.48838308, 0.01297771517, 0.9999157859,
       5.255670031e-17, -1.102020834, -0.009867512928, 0.0001280685574, 0.9999513067,
       0.4497073799}},
     0.003575454309254193},
};

/// What is apart by more than the recheck may leave undecided is proven, and its clearance found.
void expect_sharp(const JudgedPair& found) {
    const double distance_mm = found.distance_mm / kUnitsPerMm;
    EXPECT_TRUE(found.is_far || distance_mm <= kBoxBandMm) << distance_mm << " mm apart";
    EXPECT_NEAR(found.clearance_mm / kUnitsPerMm, distance_mm, kSizesAsFloatsMm);
}

TEST(ForeignBoxes, OfReportsHaveTheRightDistance) {
    for (const BoxReport& report : kBoxReports) {
        SCOPED_TRACE(report.what);
        JudgedScene scene({box_of(report.a.size), box_of(report.b.size)});
        const Pose pose = relative_pose(pose_of(report.a.at), pose_of(report.b.at));
        for (const bool is_turned_over : {false, true}) {
            const JudgedPair found =
                is_turned_over ? scene.judge(1, 0, inverse(pose)) : scene.judge(0, 1, pose);
            expect_sharp(found);
            EXPECT_NEAR(found.distance_mm / kUnitsPerMm, report.distance_mm, kSizesAsFloatsMm);
            std::printf("%-50s %s, exactly %.6g mm: %s, clearance %.6g mm\n", report.what,
                        is_turned_over ? "b, a" : "a, b", found.distance_mm / kUnitsPerMm,
                        found.is_far ? "proven apart" : "not proven",
                        found.clearance_mm / kUnitsPerMm);
        }
    }
}

// FCL 493 and its test, Drake 18704 (a wall of tilted boxes): a box and the next one of the stack,
// a few units of the last place nearer or farther than its size.
TEST(ForeignBoxes, OfATiltedStackAreNeverToldApartWhereTheyKiss) {
    const Rows tilts[] = {
        {0.94096063217417758029, 0.29296840037289501035, 0.16959541586174811667, 0,
         -0.23569836841299879326, 0.92661523595848427348, -0.29296840037289506586, 0,
         -0.2429801799032638987, 0.23569836841299884878, 0.94096063217417758029, 0},
        {0.99983216350830295127, 0.017302258779861117571, 0.0060230104948389619895,
         0.85626818476862631702, -0.017255387167394182352, 0.99982108658241231058,
         -0.0077489637286347464937, -0.77764714060125894601, -0.0061560074731557591632,
         0.007643733791746519686, 0.9999518372930324972, 0.070907056388150049853}};
    unsigned meet = 0, apart = 0;
    for (const Rows& tilt : tilts) {
        for (const double size : {0.01, 0.25, 0.3, 0.5, 2.0}) {
            JudgedScene scene({box_of({size, size, size}), box_of({size, size, size})});
            for (int gap = -8; gap <= 8; ++gap) {
                Pose a = pose_of(tilt), b = a;
                const double by = kUnitsPerMetre * size * (1 + gap * 0x1p-52);
                for (std::size_t i = 0; i < 3; ++i) {
                    b.t[i] += by * a.r[i][1];
                }
                const JudgedPair found = scene.judge(0, 1, relative_pose(a, b));
                expect_sharp(found);
                ++(found.meets ? meet : apart);
            }
        }
    }
    std::printf("a tilted stack: %u meet, %u are apart by some units of the last place\n", meet,
                apart);
    EXPECT_GT(meet, 10U);
    EXPECT_GT(apart, 10U);
}

// FCL 508: the distance of two cubes was right along x and up to twice their size along y and z,
// then that of other corners (3.162 for 3).
TEST(ForeignBoxes, AlongEveryAxisHaveTheDistanceOfTheirSides) {
    for (const double side : {1.0, 2.0}) {
        const auto half = static_cast<float>(side / 2);
        const Mesh cube{"cube", box({-half, -half, -half}, {half, half, half})};
        JudgedScene scene({cube, cube});
        for (std::size_t k = 0; k < 3; ++k) {
            for (int step = -24; step <= 24; ++step) {
                Pose pose;
                pose.t[k] = step / 4.0;
                const JudgedPair found = scene.judge(0, 1, pose);
                const double gap = std::fabs(pose.t[k]) - side;
                EXPECT_EQ(found.distance_mm, std::max(gap, 0.0)) << pose.t[k];
                EXPECT_NEAR(found.clearance_mm, std::max(gap, 0.0), 1e-6) << pose.t[k];
                EXPECT_EQ(found.is_far, gap > 0) << pose.t[k];
            }
        }
    }
}

// FCL 128: a box that leans over another one and beyond.
TEST(ForeignBoxes, ThatLeanOverAnotherAreSeen) {
    const Mesh upright{"box", box({0, 0, 0}, {1, 1, 1})};
    struct Leaning {
        float by;
        double distance;
    };
    for (const Leaning& leaning : {Leaning{0.75F, 0.25}, Leaning{0.999F, 0.001}, Leaning{1, 0},
                                   Leaning{1.1F, 0}, Leaning{2, 0}, Leaning{3, 0}, Leaning{4, 0}}) {
        Mesh skewed{"skewed", box({2, 0, 0}, {3, 1, 1})};
        for (Triangle& t : skewed.triangles) {
            for (Vec3f* const v : {&t.a, &t.b, &t.c}) {
                v->x -= v->z * leaning.by;
            }
        }
        JudgedScene scene({upright, skewed});
        const JudgedPair found = scene.judge(0, 1);
        EXPECT_EQ(found.is_far, leaning.distance > 0) << leaning.by;
        EXPECT_NEAR(found.distance_mm, leaning.distance, 1e-6) << leaning.by;
    }
}

// Coal 706: of two boxes of triangles that overlap, some of the triangles that meet were missing in
// the list. FCL 628: a box inside another one whose sides it shares.
TEST(ForeignBoxes, OfTrianglesListEveryPairThatMeets) {
    JudgedScene scene({{"two", box({-1, -1, -1}, {1, 1, 1})},
                       {"one", box({-0.5F, -0.5F, -0.5F}, {0.5F, 0.5F, 0.5F})},
                       {"unit", box({0, 0, 0}, {1, 1, 1})},
                       {"slice", box({0, 0.8F, 0}, {1, 1, 1})}});
    const JudgedPair one = scene.judge(1, 0, shifted(0, 0, 1)), slice = scene.judge(3, 2);
    EXPECT_TRUE(one.meets && slice.meets);
    EXPECT_EQ(one.touching, one.meeting) << "what is listed and does not meet";
    EXPECT_EQ(slice.touching, slice.meeting);
}

// FCL 78: a box inside a mesh: no surface is met.
TEST(ForeignBoxes, InsideAMeshAreContained) {
    ContainmentScene scene(
        std::vector<Mesh>{{"box", box({-0.5F, -0.5F, -0.5F}, {0.5F, 0.5F, 0.5F})},
                          {"mesh", box({-9, -9, -9}, {9, 9, 9})}});
    EXPECT_EQ(scene.judge(shifted(0, 0, -5)), Containment::a_in_b);
    EXPECT_EQ(scene.judge(shifted(0, 0, -10)), Containment::none);
}

// FCL 120 and 555: two boxes move towards each other, and conservative advancement saw nothing. Of
// their numbers we have the first side, 3 above the other box; the travel is ours.
TEST(ForeignBoxes, ThatMoveThroughEachOtherAreSeen) {
    OneAxisPair pair({"moves", box({-1, -1, 3}, {1, 1, 5})},
                     {"stands", box({-1, -1, -1}, {1, 1, 1})}, AxisKind::linear, {0, 0, -1});
    for (const double length : {2.0, 2.0625, 4.0, 6.0, 10.0, 1000.0}) {
        EXPECT_FALSE(pair.is_apart(0, length)) << length;
        EXPECT_FALSE(pair.is_apart_in_a_cycle(0, length)) << length;
    }
    EXPECT_TRUE(pair.is_apart(0, 2 - 0x1p-20)) << "a millionth before they touch";
    EXPECT_TRUE(pair.is_apart(6 + 0x1p-20, 1000));
    EXPECT_TRUE(pair.is_apart_in_a_cycle(0, 1.99));
}

// trimesh 300 and python-fcl 11: a box of 1 x 2 x 3 moves from x = -10 to 10 through a cone of
// radius 1 and height 3, now seen and now not. They touch at x = -1.5, for the cone's foot has a
// corner at x = -1.
TEST(ForeignBoxes, ThatMoveThroughAConeAreSeen) {
    constexpr int kSides = 64;
    Triangles cone;
    for (int i = 0; i < kSides; ++i) {
        const auto foot = [](int at) {
            const double a = 2 * 3.14159265358979323846 * (at % kSides) / kSides;
            return Vec3f{static_cast<float>(std::cos(a)), static_cast<float>(std::sin(a)), -1.5F};
        };
        cone.push_back({foot(i), foot(i + 1), {0, 0, 1.5F}});
        cone.push_back({foot(i + 1), foot(i), {0, 0, -1.5F}});
    }
    OneAxisPair pair({"box", box({-0.5F, -1, -1.5F}, {0.5F, 1, 1.5F})}, {"cone", cone},
                     AxisKind::linear, {1, 0, 0});
    for (const double end : {-1.5, -1.0, 0.0, 10.0}) {
        EXPECT_FALSE(pair.is_apart(-10, end)) << end;
        EXPECT_FALSE(pair.is_apart_in_a_cycle(-10, end)) << end;
    }
    EXPECT_TRUE(pair.is_apart(-10, -1.5 - 0x1p-20));
    EXPECT_TRUE(pair.is_apart_in_a_cycle(-10, -1.51));
}

}  // namespace
}  // namespace axg::test
#else
TEST(ForeignBoxes, NeedsExactArithmetic) {
    GTEST_SKIP() << "built without GMP and its C++ bindings (Debian: libgmp-dev)";
}
#endif
