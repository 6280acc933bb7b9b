// SPDX-License-Identifier: Apache-2.0
// What a surface can have wrong with it, each alone: found, counted, and not confused with the
// rest.
#include "core/mesh/mesh_check.hpp"

#include <gtest/gtest.h>

#include "core/mesh/self_intersect.hpp"
#include "core/mesh/solid_of_revolution.hpp"
#include "core/mesh/zero_area.hpp"
#include "tests/support/solids.hpp"

namespace {

using namespace axg;
using axg::test::box;
using axg::test::moved;
using axg::test::together;
using axg::test::Triangles;
using axg::test::turned_over;

constexpr Vec3f kLow{0, 0, 0}, kHigh{10, 20, 30};

void expect_sound(const MeshReport& report) {
    EXPECT_TRUE(report.is_closed());
    EXPECT_EQ(report.degenerate_facets, 0U);
    EXPECT_EQ(report.doubled_facets, 0U);
    EXPECT_EQ(report.inverted_shells, 0U);
    EXPECT_EQ(report.nested_shells, 0U);
    EXPECT_EQ(report.flat_shells, 0U);
    EXPECT_EQ(report.self_intersections, 0U);
    EXPECT_TRUE(report.self_complete);
    EXPECT_TRUE(report.shells_complete);
}

TEST(MeshCheck, ABoxIsSound) {
    const MeshReport report = check_mesh(box(kLow, kHigh));
    expect_sound(report);
    EXPECT_EQ(report.facet_count, 12U);
    EXPECT_EQ(report.vertex_count, 8U);
    EXPECT_EQ(report.shells, 1U);
    EXPECT_DOUBLE_EQ(report.volume_mm3, 6000.0);
    EXPECT_EQ(report.max_mm, kHigh);
}

TEST(MeshCheck, NegativeZeroIsTheSameVertexAsZero) {
    Triangles mesh = box(kLow, kHigh);
    for (std::size_t i = 0; i < mesh.size(); i += 2) {
        for (Vec3f* p : {&mesh[i].a, &mesh[i].b, &mesh[i].c}) {
            p->x = p->x == 0 ? -0.0F : p->x;
        }
    }
    EXPECT_EQ(check_mesh(mesh).vertex_count, 8U);
    EXPECT_TRUE(check_mesh(mesh).is_closed());
}

TEST(MeshCheck, AMissingFacetLeavesThreeOpenEdges) {
    Triangles mesh = box(kLow, kHigh);
    mesh.erase(mesh.begin() + 5);
    const MeshReport report = check_mesh(mesh);
    EXPECT_EQ(report.open_edges, 3U);
    EXPECT_EQ(report.non_manifold_edges, 0U);
    EXPECT_FALSE(report.is_closed());
}

TEST(MeshCheck, AHairlineGapIsOpen) {
    Triangles mesh = box(kLow, kHigh);
    mesh[0].a.x = 1e-6F;
    EXPECT_GT(check_mesh(mesh).open_edges, 0U);
}

TEST(MeshCheck, ATJunctionIsOpenAndNamed) {
    // One triangle of the side is split at the middle of an outer edge; its neighbour is not.
    Triangles mesh = box(kLow, kHigh);
    const Triangle t = mesh[0];
    const Vec3f middle = 0.5F * (t.a + t.b);
    mesh[0] = {t.a, middle, t.c};
    mesh.push_back({middle, t.b, t.c});
    const MeshReport report = check_mesh(mesh);
    EXPECT_EQ(report.open_edges, 3U);
    EXPECT_EQ(report.t_junctions, 1U);
}

TEST(MeshCheck, ATurnedFacetIsFound) {
    Triangles mesh = box(kLow, kHigh);
    std::swap(mesh[3].b, mesh[3].c);
    const MeshReport report = check_mesh(mesh);
    EXPECT_EQ(report.flipped_edges, 3U);
    EXPECT_EQ(report.open_edges, 0U);
    EXPECT_EQ(report.inverted_shells, 0U);  // not closed: no orientation of the whole to speak of
}

TEST(MeshCheck, AnInvertedBodyIsFoundAndACavityIsNone) {
    const Triangles outer = box(kLow, kHigh);
    EXPECT_EQ(check_mesh(turned_over(outer)).inverted_shells, 1U);
    const Triangles hollow = together(outer, turned_over(box({2, 2, 2}, {8, 8, 8})));
    const MeshReport report = check_mesh(hollow);
    expect_sound(report);
    EXPECT_EQ(report.cavities, 1U);
    EXPECT_EQ(report.shells, 2U);
    // Beside the body the same shell is inverted; inside it, right side out, it counts twice.
    EXPECT_EQ(check_mesh(together(outer, turned_over(box({12, 2, 2}, {18, 8, 8})))).inverted_shells,
              1U);
    EXPECT_EQ(check_mesh(together(outer, box({2, 2, 2}, {8, 8, 8}))).nested_shells, 1U);
    // An island in the cavity is solid again.
    const MeshReport island = check_mesh(together(hollow, box({4, 4, 4}, {6, 6, 6})));
    expect_sound(island);
    EXPECT_EQ(island.shells, 3U);
}

TEST(MeshCheck, DegenerateFacetsAreFoundExactly) {
    Triangles mesh = box(kLow, kHigh);
    const Vec3f p = mesh[0].a, q = mesh[0].b;
    mesh.push_back({p, p, q});
    mesh.push_back({q, q, q});
    MeshReport report = check_mesh(mesh);
    EXPECT_EQ(report.degenerate_facets, 2U);
    EXPECT_EQ(report.droppable.size(), 2U);
    EXPECT_TRUE(report.is_closed());
    EXPECT_EQ(report.first_degenerate, 12U);
    mesh = {{{5, 5, 5}, {6, 5, 5}, {7, 5, 5}}};  // a needle in the air: nothing covers it
    report = check_mesh(mesh);
    EXPECT_EQ(report.degenerate_facets, 1U);
    EXPECT_TRUE(report.droppable.empty());
    EXPECT_EQ(report.shells, 0U);
}

TEST(MeshCheck, ACollinearFacetClosesAGapAndStays) {
    // The T-junction above, closed by a facet without area.
    Triangles mesh = box(kLow, kHigh);
    const Triangle t = mesh[0];
    const Vec3f middle = 0.5F * (t.a + t.b);
    mesh[0] = {t.a, middle, t.c};
    mesh.push_back({middle, t.b, t.c});
    mesh.push_back({t.a, t.b, middle});
    const MeshReport report = check_mesh(mesh);
    EXPECT_TRUE(report.is_closed());
    EXPECT_EQ(report.degenerate_facets, 1U);
    EXPECT_TRUE(report.droppable.empty()) << "without it three edges would be open";
}

TEST(ZeroArea, IsDecidedWithoutRounding) {
    // Three corners on a line in float32, far from the origin, then one moved by its last bit.
    EXPECT_TRUE(has_zero_area({{1e5F, 1, 3}, {1e5F, 2, 6}, {1e5F, 3, 9}}));
    EXPECT_FALSE(has_zero_area({{1e5F, 1, 3}, {1e5F, 2, 6}, {1e5F, 3, 9.000001F}}));
    // Differences that no double holds: 1 - 2^-80 and its kin.
    const float tiny = 0x1p-80F;
    EXPECT_TRUE(has_zero_area({{1, 1, 0}, {tiny, tiny, 0}, {-1, -1, 0}}));
    EXPECT_FALSE(has_zero_area({{1, 1, 0}, {tiny, 0, 0}, {-1, -1, 0}}));
    EXPECT_TRUE(has_zero_area({{1, 1, 0}, {0, 0, 0}, {-1, -1, 0}}));
}

TEST(MeshCheck, ADoubledFacetIsFound) {
    Triangles mesh = box(kLow, kHigh);
    mesh.push_back({mesh[4].b, mesh[4].c, mesh[4].a});
    const MeshReport report = check_mesh(mesh);
    EXPECT_EQ(report.doubled_facets, 1U);
    EXPECT_EQ(report.non_manifold_edges, 3U);
    EXPECT_EQ(report.self_intersections, 1U);
}

TEST(MeshCheck, ADoublyCoveredBodyIsNotSound) {
    const MeshReport report = check_mesh(together(box(kLow, kHigh), box(kLow, kHigh)));
    EXPECT_EQ(report.doubled_facets, 12U);
    EXPECT_EQ(report.non_manifold_edges, 18U);
    EXPECT_GE(report.self_intersections, 12U);
}

TEST(MeshCheck, CrossingBodiesIntersectAndTouchingOnesDoNot) {
    const Triangles cube = box({0, 0, 0}, {10, 10, 10});
    EXPECT_GT(check_mesh(together(cube, moved(cube, {5, 3, 4}))).self_intersections, 0U);
    const MeshReport apart = check_mesh(together(cube, moved(cube, {11, 3, 4})));
    expect_sound(apart);
    EXPECT_EQ(apart.touching_pairs, 0U);
    const MeshReport touching = check_mesh(together(cube, moved(cube, {10, 3, 4})));
    expect_sound(touching);
    EXPECT_GT(touching.touching_pairs, 0U);
    // Sunk by a thousandth they cross; that is far above the tolerance.
    const MeshReport sunk = check_mesh(together(cube, moved(cube, {9.999F, 3, 4})));
    EXPECT_GT(sunk.self_intersections, 0U);
    EXPECT_LT(sunk.tolerance_mm, 1e-5);
}

TEST(FacetContact, NeighboursThatFoldFlatOverlap) {
    const Triangle t{{0, 0, 0}, {10, 0, 0}, {0, 10, 0}};
    const double tolerance = 1e-6;
    EXPECT_EQ(facet_contact(t, {{0, 0, 0}, {10, 0, 0}, {5, -10, 0}}, tolerance),
              FacetContact::none);
    EXPECT_EQ(facet_contact(t, {{10, 0, 0}, {0, 0, 0}, {5, 5, 5}}, tolerance), FacetContact::none);
    EXPECT_EQ(facet_contact(t, {{10, 0, 0}, {0, 0, 0}, {5, 2, 0}}, tolerance),
              FacetContact::opposed);
    EXPECT_EQ(facet_contact(t, {{0, 0, 0}, {10, 0, 0}, {5, 2, 0}}, tolerance),
              FacetContact::same_way);
    EXPECT_EQ(facet_contact(t, t, tolerance), FacetContact::same_way);
}

TEST(FacetContact, NeighboursAtACornerMayCross) {
    const Triangle t{{0, 0, 0}, {10, 0, 0}, {0, 10, 0}};
    const double tolerance = 1e-6;
    EXPECT_EQ(facet_contact(t, {{0, 0, 0}, {5, 5, 3}, {5, 5, -3}}, tolerance),
              FacetContact::crosses);
    EXPECT_EQ(facet_contact(t, {{0, 0, 0}, {-5, -5, 3}, {-5, -5, -3}}, tolerance),
              FacetContact::none);
    EXPECT_EQ(facet_contact(t, {{1, 1, 1}, {2, 1, 1}, {1, 2, 1}}, tolerance), FacetContact::none);
    // A tip through the face, and the same tip just short of it.
    EXPECT_EQ(facet_contact(t, {{2, 2, -0.1F}, {2, 3, 5}, {3, 2, 5}}, tolerance),
              FacetContact::crosses);
    EXPECT_EQ(facet_contact(t, {{2, 2, 0.1F}, {2, 3, 5}, {3, 2, 5}}, tolerance),
              FacetContact::none);
    EXPECT_EQ(facet_contact(t, {{2, 2, 0}, {2, 3, 5}, {3, 2, 5}}, tolerance), FacetContact::none);
}

TEST(MeshCheck, ManyFacetsOverOneAnotherEndTheSearchAndAreSaid) {
    Triangles nested;  // 4000 sheets in one another's boxes, none crossing: eight million pairs
    Triangles crossing;
    for (int i = 0; i < 4000; ++i) {
        const float s = 1.0F + static_cast<float>(i) * 0.001F;
        nested.push_back({{-100, -s, -1}, {100, -s, 1}, {0, 100, s}});
        crossing.push_back({{-100, -1, -s}, {100, -1, s}, {0, 100, 0.01F * s}});
    }
    EXPECT_FALSE(check_mesh(nested).self_complete);
    const MeshReport report = check_mesh(crossing);
    EXPECT_FALSE(report.self_complete);
    EXPECT_EQ(report.self_intersections, 1U << 16U);
}

TEST(MeshCheck, EqualCentroidsAndGeometricChainsDoNotDeepenTheTree) {
    // Boxes in boxes by turns solid and hollow: all centroids equal. Then boxes each twice the size
    // of the last.
    Triangles nested, chain;
    for (int i = 0; i < 100; ++i) {
        const float s = 1.0F + static_cast<float>(100 - i);
        const Triangles shell = box({-s, -s, -s}, {s, s, s});
        nested = together(nested, i % 2 == 0 ? shell : turned_over(shell));
    }
    const MeshReport report = check_mesh(nested);
    expect_sound(report);
    EXPECT_EQ(report.cavities, 50U);
    float at = 0.001F;
    for (int i = 0; i < 24; ++i) {
        chain = together(chain, box({at, 0, 0}, {1.5F * at, at, at}));
        at *= 2;
    }
    expect_sound(check_mesh(chain));
}

TEST(MeshCheck, NothingIsNoSurface) {
    const MeshReport report = check_mesh({});
    EXPECT_EQ(report.facet_count, 0U);
    EXPECT_EQ(report.shells, 0U);
}

}  // namespace
