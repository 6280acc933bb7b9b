// SPDX-License-Identifier: Apache-2.0
// Random solids survive writing and reading bit for bit, binary and text; random damage never
// crashes the reader or the checks, never yields triangles beside a fault, and never takes longer
// than a second.
#include "core/mesh/stl.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <random>
#include <string>

#include "core/mesh/mesh_check.hpp"
#include "core/mesh/solid_of_revolution.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/solids.hpp"

namespace {

using namespace axg;
using Random = std::mt19937_64;

double draw(Random& random, double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
}

/// A sound solid: a stack of turned steps, somewhere.
std::vector<Triangle> random_solid(Random& random) {
    std::vector<Vec3d> profile{{0, 0, draw(random, -500, 500)}};
    const int steps = 1 + static_cast<int>(random() % 6);
    double height = profile[0].z;
    for (int i = 0; i < steps; ++i) {
        const double radius = draw(random, 0.1, 200);
        profile.push_back({radius, 0, height});
        height += draw(random, 0.01, 50);
        profile.push_back({radius, 0, height});
    }
    profile.push_back({0, 0, height});
    return solid_of_revolution(profile, 8 + static_cast<std::uint32_t>(random() % 20)).triangles;
}

std::string as_text(const std::vector<Triangle>& triangles) {
    std::string out = "solid x\n";
    char line[128];
    for (const Triangle& t : triangles) {
        out += "facet normal 0 0 0\nouter loop\n";
        for (const Vec3f p : {t.a, t.b, t.c}) {
            std::snprintf(line, sizeof line, "vertex %.9g %.9g %.9g\n", static_cast<double>(p.x),
                          static_cast<double>(p.y), static_cast<double>(p.z));
            out += line;
        }
        out += "endloop\nendfacet\n";
    }
    return out + "endsolid x\n";
}

std::span<const std::byte> bytes_of(const std::string& text) {
    return std::as_bytes(std::span(text));
}

TEST(StlProperty, RandomSolidsAreSoundAndRoundTripBitForBit) {
    Random random(axg::test::printed_seed(21));
    for (int i = 0; i < 150; ++i) {
        const auto solid = random_solid(random);
        ASSERT_FALSE(solid.empty());
        const MeshReport report = check_mesh(solid);
        ASSERT_TRUE(report.is_closed() && report.volume_mm3 > 0 && report.shells == 1 &&
                    report.self_intersections == 0 && report.degenerate_facets == 0)
            << "solid " << i;
        ASSERT_EQ(read_stl(write_stl(solid), 1.0).triangles, solid) << "solid " << i;
        ASSERT_EQ(read_stl(bytes_of(as_text(solid)), 1.0).triangles, solid) << "solid " << i;
    }
}

void damage(std::vector<std::byte>& bytes, Random& random) {
    const auto at = [&] { return random() % bytes.size(); };
    switch (random() % 5) {
        case 0:
            bytes[at()] ^= static_cast<std::byte>(1U << (random() % 8));
            break;
        case 1:
            bytes.resize(1 + at());
            break;
        case 2:
            bytes.insert(bytes.end(), 1 + random() % 100, static_cast<std::byte>(random()));
            break;
        case 3: {
            const std::size_t from = at(), to = at();
            const std::size_t count = std::min({bytes.size() - from, bytes.size() - to,
                                                static_cast<std::size_t>(1 + random() % 200)});
            std::memmove(bytes.data() + to, bytes.data() + from, count);
            break;
        }
        default:
            for (int i = 0; i < 20; ++i) {
                bytes[at()] = static_cast<std::byte>(random());
            }
    }
}

TEST(StlProperty, RandomDamageEndsInTrianglesOrFaultsWithinASecond) {
    Random random(axg::test::printed_seed(22));
    int refused = 0, read = 0;
    for (int i = 0; i < 3000; ++i) {
        const auto solid = random_solid(random);
        std::vector<std::byte> bytes;
        if (i % 2 == 0) {
            bytes = write_stl(solid);
        } else {
            const std::string text = as_text(solid);
            bytes.assign(bytes_of(text).begin(), bytes_of(text).end());
        }
        for (std::uint64_t n = 1 + random() % 3; n > 0; --n) {
            damage(bytes, random);
        }
        const auto start = std::chrono::steady_clock::now();
        const StlResult result = read_stl(bytes, 1.0);
        ASSERT_NE(result.faults.empty(), result.triangles.empty()) << "file " << i;
        if (result.faults.empty()) {
            const MeshReport report = check_mesh(result.triangles);
            ASSERT_EQ(report.facet_count, result.triangles.size());
            ++read;
        } else {
            ++refused;
        }
        ASSERT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(1))
            << "file " << i;
    }
    EXPECT_GT(refused, 500);
    EXPECT_GT(read, 200);
}

}  // namespace
