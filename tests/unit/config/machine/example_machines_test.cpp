// SPDX-License-Identifier: Apache-2.0
// The example machines: their meshes have the paper's triangle counts; each file loads whole; at
// the zero pose no checked pair touches, and bodies said to be apart are.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "config/compiled/compiled_machine.hpp"
#include "config/mesh/load_meshes.hpp"
#include "config/mesh/size_doubts.hpp"
#include "core/machine/kinematics.hpp"
#include "core/mesh/self_intersect.hpp"
#include "tests/support/seed.hpp"

namespace {

using namespace axg;

const std::string kFolder = std::string(AXG_SOURCE_DIR) + "/config/machines";

struct Loaded {
    Machine machine;
    std::vector<std::vector<Triangle>> surface;  // [bodies], the first tool in the tool's body
};

void load(const std::string& name, Loaded& out) {
    auto faults = load_machine(kFolder + "/" + name + ".yaml", out.machine);
    ASSERT_TRUE(faults.empty()) << to_string(faults[0]);
    MachineMeshes meshes;
    faults = load_meshes(out.machine, kFolder, meshes);
    ASSERT_TRUE(faults.empty()) << to_string(faults[0]);
    faults = doubt_sizes(out.machine, meshes);
    ASSERT_TRUE(faults.empty()) << to_string(faults[0]);
    for (const std::string& note : meshes.notes) {
        EXPECT_NE(note.find("turns with the spindle"), std::string::npos) << note;
    }
    for (std::size_t i = 0; i < out.machine.bodies.size(); ++i) {
        out.surface.push_back(meshes.bodies[i].triangles);
        for (std::size_t k = 0; k < out.machine.tools.size(); ++k) {
            if (out.machine.bodies[i].is_tool &&
                out.machine.tools[k].number == out.machine.first_tool) {
                out.surface[i] =
                    meshes.tools[k].triangles;  // all our tools stand at the gauge face
            }
        }
    }
}

std::vector<Triangle> placed(const std::vector<Triangle>& surface, const Pose& pose) {
    std::vector<Triangle> out = surface;
    for (Triangle& t : out) {
        for (Vec3f* p : {&t.a, &t.b, &t.c}) {
            const Vec3d q = apply(pose, widen(*p));
            *p = {static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z)};
        }
    }
    return out;
}

bool touch(const std::vector<Triangle>& a, const std::vector<Triangle>& b) {
    return std::any_of(a.begin(), a.end(), [&](const Triangle& s) {
        return std::any_of(b.begin(), b.end(), [&](const Triangle& t) {
            return facet_contact(s, t, 1e-4) != FacetContact::none;
        });
    });
}

/// Pairs, by name, that touch at these positions among those that `is_queried` accepts.
template <class Queried>
std::string first_touch(const Loaded& loaded, const std::vector<double>& position,
                        const Queried& is_queried) {
    const std::vector<Body>& bodies = loaded.machine.bodies;
    std::vector<Pose> pose(bodies.size());
    place_bodies(loaded.machine, position, pose);
    for (std::size_t a = 0; a < bodies.size(); ++a) {
        for (std::size_t b = a + 1; b < bodies.size(); ++b) {
            if (is_queried(a, b) &&
                touch(placed(loaded.surface[a], pose[a]), placed(loaded.surface[b], pose[b]))) {
                return bodies[a].name + " and " + bodies[b].name;
            }
        }
    }
    return "";
}

TEST(ExampleMachines, PaperTrunnionHasThePapersTriangleCountsAndPairs) {
    Loaded m;
    ASSERT_NO_FATAL_FAILURE(load("paper-trunnion", m));
    std::map<std::string, std::size_t> counts;
    for (std::size_t i = 0; i < m.surface.size(); ++i) {
        counts[m.machine.bodies[i].name] = m.surface[i].size();
    }
    const std::map<std::string, std::size_t> wanted{{"x", 44},  {"y", 136}, {"z", 180},
                                                    {"a", 164}, {"c", 548}, {"cutter", 716}};
    EXPECT_EQ(counts, wanted);
    std::vector<std::string> pairs;
    for (const Pair& pair : m.machine.pairs) {
        EXPECT_EQ(pair.margin_mm, 0.0);
        pairs.push_back(m.machine.bodies[pair.a].name + "-" + m.machine.bodies[pair.b].name);
    }
    const std::vector<std::string> papers{"cutter-x", "cutter-y", "cutter-a", "cutter-c",
                                          "z-x",      "z-y",      "z-a",      "z-c"};
    EXPECT_EQ(pairs, papers);
    EXPECT_EQ(m.machine.exclusions.size(), 7U);
}

class EachMachine : public testing::TestWithParam<const char*> {};

TEST_P(EachMachine, NoCheckedPairTouchesAtTheZeroPose) {
    Loaded m;
    ASSERT_NO_FATAL_FAILURE(load(GetParam(), m));
    const auto is_checked = [&](std::size_t a, std::size_t b) {
        return std::any_of(m.machine.pairs.begin(), m.machine.pairs.end(), [&](const Pair& p) {
            return (p.a == a && p.b == b) || (p.a == b && p.b == a);
        });
    };
    const std::vector<double> zero(m.machine.axes.size(), 0.0);
    EXPECT_EQ(first_touch(m, zero, is_checked), "");
}

INSTANTIATE_TEST_SUITE_P(All, EachMachine,
                         testing::Values("paper-trunnion", "spindle-tilting",
                                         "table-spindle-tilting"));

struct Apart {
    const char* machine;
    std::vector<std::pair<std::string, std::string>> pairs;  // parent side first, as in the file
};

class Distances : public testing::TestWithParam<Apart> {};

/// Exclusions that claim a distance, not a contact by construction: at random poses, half of them
/// at the travel's ends.
TEST_P(Distances, BodiesExcludedForTheirDistanceStayApart) {
    Loaded m;
    ASSERT_NO_FATAL_FAILURE(load(GetParam().machine, m));
    const auto& pairs = GetParam().pairs;
    const auto is_queried = [&](std::size_t a, std::size_t b) {
        const std::string& first = m.machine.bodies[a].name;
        const std::string& second = m.machine.bodies[b].name;
        return std::any_of(pairs.begin(), pairs.end(), [&](const auto& p) {
            return p == std::pair{first, second} || p == std::pair{second, first};
        });
    };
    for (const auto& [a, b] : pairs) {  // the file excludes exactly these names
        EXPECT_TRUE(std::any_of(m.machine.exclusions.begin(), m.machine.exclusions.end(),
                                [&, x = a, y = b](const Exclusion& e) {
                                    return m.machine.bodies[e.a].name == x &&
                                           m.machine.bodies[e.b].name == y;
                                }))
            << a << " and " << b;
    }
    std::mt19937_64 random(axg::test::printed_seed(9));
    for (int i = 0; i < 40; ++i) {
        std::vector<double> q;
        for (const Axis& axis : m.machine.axes) {
            const double low = axis.unlimited ? -4 : axis.min, high = axis.unlimited ? 4 : axis.max;
            const double inside = std::uniform_real_distribution<double>(low, high)(random);
            const double end = random() % 2 == 0 ? low : high;
            q.push_back(i % 2 == 0 ? inside : end);
        }
        ASSERT_EQ(first_touch(m, q, is_queried), "") << "pose " << i;
    }
}

INSTANTIATE_TEST_SUITE_P(
    All, Distances,
    testing::Values(Apart{"paper-trunnion", {{"x", "c"}, {"y", "a"}, {"y", "c"}}},
                    Apart{"spindle-tilting",
                          {{"portal", "table"}, {"portal", "ram"}, {"table", "slide"}}},
                    Apart{"table-spindle-tilting", {{"bed", "plate"}}}));

}  // namespace
