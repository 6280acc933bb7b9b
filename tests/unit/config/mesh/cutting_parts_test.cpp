// SPDX-License-Identifier: Apache-2.0
// The cutting section of a tool goes where it likes in stock, and nowhere else; the machine is
// stopped before the shank comes within the margin. The judge of that measures for itself, from
// points of the true shank and holder to the blank, where the latest and weakest stop of the last
// certificate has brought the axes.
#include "config/mesh/cutting_parts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <string>

#include "config/machine/parse_machine.hpp"
#include "core/base/sincos.hpp"
#include "core/guard/monitor.hpp"
#include "core/mesh/mesh_check.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "hil_replay/page/pair_clearances.hpp"
#include "hil_replay/page/run_page.hpp"
#include "tests/support/machine_text.hpp"

namespace axg::test {
namespace {

// With the nose at z = -205 the tip of the end mill is at the top of the blank.
constexpr double kTouchZ = -205, kFlutesMm = 30, kMarginMm = 1;

std::string example() {
    std::ifstream file(AXG_SOURCE_DIR "/config/machines/vice-mill.yaml");
    return {std::istreambuf_iterator<char>(file), {}};
}

/// A machine of shapes alone, ready to be queried.
class Mill {
  public:
    explicit Mill(const std::string& text) {
        EXPECT_EQ(faults_of(text), "");
        EXPECT_TRUE(parse_machine(text, "m", loaded_.machine).empty());
        EXPECT_TRUE(load_meshes(loaded_.machine, "/", loaded_.meshes).empty());
        part_cutters(loaded_.machine, loaded_.meshes);
        engine_.emplace(std::move(*make_engine(loaded_)));
        containment_test_.emplace(std::move(*make_containment_test(loaded_, *engine_)));
        certificate_.emplace(std::move(*make_stop_certificate(loaded_)));
    }

    Mill(const Mill&) = delete;
    Mill& operator=(const Mill&) = delete;

    [[nodiscard]] const Machine& machine() const { return loaded_.machine; }
    [[nodiscard]] const LoadedMachine& loaded() const { return loaded_; }

    /// Of the nearest pair there, as a page shows them.
    TriangleIds nearest(const AxisSnapshot& snapshot) {
        return PairClearances(loaded_, engine_->engine(), kPageWithinMm).at(snapshot).triangles;
    }

    [[nodiscard]] AxisSnapshot at(double x_mm, double y_mm, double z_mm) const {
        AxisSnapshot out;
        out.axis_count = 3;
        out.tool = 1;
        out.mode = kModeMoving;
        out.position = {x_mm, y_mm, z_mm};
        return out;
    }

    /// Whether a certificate for this sample, the next of a motion, is proven.
    bool permits(AxisSnapshot snapshot, bool is_first = false) {
        snapshot.sample = ++sample_;
        snapshot.latched_us = static_cast<std::int64_t>(sample_) * loaded_.machine.can.sample_us;
        certificate_->note(snapshot, is_first);
        certificate_->prove(engine_->engine(), *containment_test_);
        certificate_->keep();
        return judge(certificate_->cycle(), true, true).has_permit;
    }

    /// Contact mode: a word for each pair of the tool, in the order table, vice, blank.
    std::string contact(const AxisSnapshot& snapshot) {
        const auto pair_queries = std::make_unique<PairQueries>();
        make_contact_queries(loaded_.machine, snapshot, *pair_queries);
        std::vector<QueryResult> results(pair_queries->count + 2);
        std::vector<ContainmentResult> inside(pair_queries->count);
        engine_->run({pair_queries->queries.data(), results.size()}, results);
        containment_test_->run({pair_queries->queries.data(), inside.size()},
                               std::span(results).first(pair_queries->count), inside);
        std::string out;
        for (std::size_t i = 0; i < 3; ++i) {
            out += out.empty() ? "" : " ";
            out += results[i].proof != Proof::far               ? "near"
                   : inside[i].containment != Containment::none ? "inside"
                                                                : "far";
        }
        return out;
    }

  private:
    LoadedMachine loaded_;
    std::optional<CpuEngine> engine_;
    std::optional<ContainmentTest> containment_test_;
    std::optional<StopCertificate> certificate_;
    std::uint64_t sample_ = 0;
};

/// From the true shank and holder, sampled, to the blank, with the axes at these positions.
double shank_to_blank_mm(Vec3d at) {
    struct Round {
        double radius_mm, low_mm, high_mm;
    };
    double least = 1e9;
    for (const Round& part : {Round{6, -80, -50}, Round{15, -50, -25}, Round{31.5, -25, 0}}) {
        for (int i = 0; i < 360; ++i) {
            const SinCos turn = sin_cos(i * kPi / 180);
            for (int k = 0; k <= 50; ++k) {
                for (const double share : {1.0, 0.6, 0.2}) {  // the end face, too
                    const double x = at.x + share * part.radius_mm * turn.cos;
                    const double y = at.y + share * part.radius_mm * turn.sin;
                    const double z = at.z + part.low_mm + (part.high_mm - part.low_mm) * k / 50.0;
                    const double dx = std::max(std::fabs(x) - 40, 0.0);
                    const double dy = std::max(std::fabs(y) - 30, 0.0);
                    const double dz = std::max({z - -315, -360 - z, 0.0});
                    least = std::min(least, std::sqrt(dx * dx + dy * dy + dz * dz));
                }
            }
        }
    }
    return least;
}

/// How far an axis goes that keeps its speed for as long as a permit is good for, and brakes as
/// weakly as it may.
double latest_stop_mm(const Machine& machine, std::uint32_t axis, double speed_mm_s) {
    constexpr double kStepS = 1e-6;
    double way = speed_mm_s * free_seconds(machine, machine.can.permit_samples.most),
           speed = speed_mm_s, braking = 0;
    while (speed > 0) {
        braking = std::min(braking + machine.axes[axis].jerk_max * kStepS,
                           machine.axes[axis].stopping_min);
        way += speed * kStepS;
        speed -= braking * kStepS;
    }
    return way;
}

struct Ride {
    bool was_stopped = false;
    double way_mm = 0;  // from the start until the last permit
    Vec3d rest;         // where the latest stop of that one ends
};

/// From `from` along `axis` by `way_mm`, at a steady feed that the snapshots know from the start.
Ride ride(Mill& mill, Vec3d from, std::uint32_t axis, double way_mm, double speed_mm_s) {
    const double period_s = mill.machine().can.sample_us * 1e-6;
    const double sign = way_mm < 0 ? -1 : 1;
    Ride out;
    const auto place = [&](double way) {
        std::array<double, 3> at{from.x, from.y, from.z};
        at[axis] += sign * way;
        return Vec3d{at[0], at[1], at[2]};
    };
    for (int i = 0; i * speed_mm_s * period_s <= std::fabs(way_mm); ++i) {
        const double way = i * speed_mm_s * period_s;
        const Vec3d at = place(way);
        const bool is_permitted = mill.permits(mill.at(at.x, at.y, at.z), i == 0);
        if (i > 20 && !is_permitted) {  // the first snapshots do not know the speed
            out.was_stopped = true;
            out.rest = place(out.way_mm + latest_stop_mm(mill.machine(), axis, speed_mm_s));
            return out;
        }
        out.way_mm = way;
    }
    return out;
}

TEST(CuttingSection, GoesAsDeepIntoTheStockAsTheFlutesAreLong) {
    Mill mill(example());
    for (const double speed : {5.0, 30.0}) {
        const double deep = kFlutesMm - kMarginMm - 3;
        EXPECT_FALSE(ride(mill, {-20, -10, kTouchZ + 2}, 2, -(2 + deep), speed).was_stopped);
        EXPECT_FALSE(ride(mill, {-20, -10, kTouchZ - deep}, 0, 40, speed).was_stopped) << "along";
        EXPECT_FALSE(ride(mill, {20, -10, kTouchZ - deep}, 1, 20, speed).was_stopped);
        EXPECT_FALSE(ride(mill, {0, -60, kTouchZ - deep}, 1, 60, speed).was_stopped)
            << "in from the side";
    }
}

TEST(CuttingSection, StopsBeforeTheShankIsWithinTheMargin) {
    Mill mill(example());
    for (const double speed : {3.0, 15.0, 50.0, 150.0}) {
        const Ride down = ride(mill, {-20, -10, kTouchZ + 20}, 2, -70, speed);
        EXPECT_TRUE(down.was_stopped) << speed;
        EXPECT_GT(down.way_mm, 20 + 10) << "it was cutting by then";
        EXPECT_GE(shank_to_blank_mm(down.rest), kMarginMm) << speed;
        const Ride beside = ride(mill, {0, -80, kTouchZ - 40}, 1, 80, speed);
        EXPECT_TRUE(beside.was_stopped) << speed;
        EXPECT_GE(shank_to_blank_mm(beside.rest), kMarginMm) << speed;
        if (speed < 20) {
            EXPECT_LE(shank_to_blank_mm(down.rest), kMarginMm + 2) << "no sooner than it has to be";
            EXPECT_LE(shank_to_blank_mm(beside.rest), kMarginMm + 2);
        }
    }
}

TEST(CuttingSection, WithoutAWordTheWholeToolKeepsAway) {
    for (const auto& [from, to] :
         {std::pair{"cutting: true, cylinder", "cylinder"}, std::pair{"stock: true, ", ""}}) {
        Mill mill(with(example(), from, to));
        const Ride down = ride(mill, {-20, -10, kTouchZ + 20}, 2, -30, 15);
        EXPECT_TRUE(down.was_stopped) << from;
        EXPECT_GE(down.rest.z - kTouchZ, kMarginMm) << from;
    }
}

// Along the blank in the depth of the jaws, which begin at 40 mm.
TEST(CuttingSection, KeepsAwayFromEverythingElse) {
    Mill mill(example());
    const Ride along = ride(mill, {0, 0, kTouchZ - 22}, 0, 60, 15);
    EXPECT_TRUE(along.was_stopped);
    EXPECT_GE(40 - along.rest.x - 6, kMarginMm);
    EXPECT_LE(40 - along.rest.x - 6, kMarginMm + 2);
}

/// The example with a wide blank from z = -360 to `top_mm`: the tip is at -110, the shank begins at
/// -80.
std::string in_a_blank_up_to(double top_mm) {
    return with(example(), "{box_mm: [80, 60, 45]}",
                "{box_mm: [200, 200, " + std::to_string(top_mm + 360) + "]}");
}

TEST(CuttingSection, InsideTheStockIsNoFindingAndTheShankInsideIsOne) {
    Mill to_the_shank(in_a_blank_up_to(-81.5));
    EXPECT_EQ(to_the_shank.contact(to_the_shank.at(0, 0, 0)), "far far far");
    Mill too_high(in_a_blank_up_to(-80.5));
    EXPECT_EQ(too_high.contact(too_high.at(0, 0, 0)), "far far near");
    Mill swallowed(in_a_blank_up_to(5));  // 5 mm above the upper face: all surfaces are apart
    EXPECT_EQ(swallowed.contact(swallowed.at(0, 0, 0)), "far far inside");
    for (int i = 0; i < 30; ++i) {
        EXPECT_FALSE(swallowed.permits(swallowed.at(0, 0, 0), i == 0));
    }
}

// All tools may be in the spindle then: the drill reaches 10 mm further, and cuts as well.
// Reports and pages number the triangles of the tool, not those of what is left of it: with the
// flutes in the blank the nearest one is part of the shank, which begins 80 mm below the nose.
TEST(CuttingSection, ATriangleOfTheShankIsNamedAsTheWholeToolHasIt) {
    Mill mill(example());
    const TriangleIds nearest = mill.nearest(mill.at(0, 0, kTouchZ - 20));
    const Mesh& tool = mill.loaded().meshes.tools[0];
    ASSERT_LT(nearest.a, tool.triangles.size());
    const Triangle& found = tool.triangles[nearest.a];
    EXPECT_EQ(std::min({found.a.z, found.b.z, found.c.z}), -80) << nearest.a;
    const BodyTriangles named(mill.loaded());
    Query query;
    query.mesh_a = pair_mesh_index(mill.machine(), 0);
    const std::vector<Triangle>& rest = mill.loaded().meshes.of_pairs[0].triangles;
    for (std::uint32_t i = 0; i < rest.size(); ++i) {
        const TriangleIds ids = named.of(query, {i, 7});
        ASSERT_LT(ids.a, tool.triangles.size());
        EXPECT_EQ(tool.triangles[ids.a], rest[i]);
        EXPECT_EQ(ids.b, 7U) << "the blank's own";
    }
}

TEST(CuttingSection, WhileTheToolIsChangedEachHasItsOwn) {
    Mill mill(example());
    AxisSnapshot snapshot = mill.at(0, 0, kTouchZ - 20);
    for (int i = 0; i < 40; ++i) {
        snapshot.mode = i >= 30 ? kModeToolChange : kModeMoving;
        const bool is_permitted = mill.permits(snapshot, i == 0);
        EXPECT_TRUE(is_permitted || i < 20) << i;
    }
}

}  // namespace
}  // namespace axg::test
