// SPDX-License-Identifier: Apache-2.0
// Mills of random shapes at random positions: where a cycle says that the tool keeps away from the
// stock, no sampled point of a true round section that does not cut is within the margin of it, or
// inside it, and none of the stock inside such a section; where it says that it keeps away from the
// fixture, the same holds of all sections. The judge knows nothing of triangles: sections are
// discs, blocks are intervals. The same with what was proven for the whole travel pruned; and of
// certificates at rest, for positions in the box that they are about, some beyond the travel. And
// where sampled points are far the result is "far" nearly always, or the test would say nothing.
// AXG_COUNT changes.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "config/machine/parse_machine.hpp"
#include "config/mesh/cutting_parts.hpp"
#include "core/base/sincos.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "firmware_if/setup/travel_proof.hpp"
#include "tests/support/count.hpp"
#include "tests/support/machine_text.hpp"
#include "tests/support/seed.hpp"

namespace axg::test {
namespace {

constexpr int kPositionsOfMachine = 200;
constexpr double kSlackMm = 2;  // by which polygons and sampling may differ from the round ones

struct Section {
    double low_mm, high_mm, low_radius_mm, high_radius_mm;
    bool is_cutting;
    int segments;  // many: more triangles than are left whole
};

struct Block {
    Vec3d size, at;
    double turn_deg;
};

using Dice = std::mt19937_64;

double drawn_between(Dice& dice, double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(dice);
}

struct Mill {
    std::vector<Section> sections;  // from the tip up
    std::vector<Block> stock, fixture;
    double margin_mm = 0;

    explicit Mill(Dice& dice) {
        double height = -drawn_between(dice, 40, 120);
        for (std::uint64_t left = 2 + dice() % 4; left-- > 0;) {
            const double end = height + drawn_between(dice, 2, 40);
            const double low = drawn_between(dice, 1, 25);
            const double high = dice() % 3 == 0 ? drawn_between(dice, 1, 25) : low;
            sections.push_back(
                {height, end, low, high, dice() % 2 == 0, dice() % 4 == 0 ? 400 : 48});
            height = end - (dice() % 4 == 0 ? drawn_between(dice, 0, 2) : 0);  // some overlap
        }
        sections.back().is_cutting = false;
        for (std::vector<Block>* const blocks : {&stock, &fixture}) {
            for (std::uint64_t left = 1 + dice() % 3; left-- > 0;) {
                const double size = dice() % 3 == 0 ? 6 : 80;  // some fit into a holder
                blocks->push_back({{drawn_between(dice, 2, size), drawn_between(dice, 2, size),
                                    drawn_between(dice, 2, size)},
                                   {drawn_between(dice, -30, 30), drawn_between(dice, -30, 30),
                                    drawn_between(dice, -30, 30)},
                                   dice() % 2 == 0 ? 0 : drawn_between(dice, -180, 180)});
            }
        }
        margin_mm = dice() % 2 == 0 ? 0 : drawn_between(dice, 0, 5);
    }

    static std::string text_of(const std::vector<Block>& blocks) {
        std::string out;
        for (const Block& b : blocks) {
            out += fmt::format(
                "{}{{box_mm: [{}, {}, {}], at_mm: [{}, {}, {}], "
                "rotate_deg: [0, 0, {}]}}",
                out.empty() ? "" : ", ", b.size.x, b.size.y, b.size.z, b.at.x, b.at.y, b.at.z,
                b.turn_deg);
        }
        return out;
    }

    [[nodiscard]] std::string text() const {
        std::string tool;
        for (std::size_t i = 0; i < sections.size(); ++i) {
            const Section& s = sections[i];
            tool += fmt::format(
                "      - {{name: s{}, cutting: {}, cone: {{radius_mm: {}, top_radius_mm: {}, "
                "height_mm: {}}}, segments: {}, at_mm: [0, 0, {}]}}\n",
                i, s.is_cutting, s.low_radius_mm, s.high_radius_mm, s.high_mm - s.low_mm,
                s.segments, s.low_mm);
        }
        const std::string limits =
            "speed_mm_min: 9000, acceleration_mm_s2: 2000, jerk_mm_s3: 50000, stopping_mm_s2: "
            "1500}\n";
        std::string out = "version: 1\nname: mill\naxes:\n";
        for (const char* const axis : {"X", "Y", "Z"}) {
            out += fmt::format("  {}: {{kind: linear, travel_mm: [-60, 60], {}", axis, limits);
        }
        out +=
            "bodies:\n  - {name: y, axis: Y, direction: [0, 1, 0]}\n"
            "  - {name: x, parent: y, axis: X, direction: [1, 0, 0]}\n"
            "  - {name: z, parent: x, axis: Z, direction: [0, 0, 1]}\n"
            "  - {name: cutter, parent: z, tool: true}\n";
        out += "  - {name: stock, stock: true, mesh: {shapes: [" + text_of(stock) + "]}}\n";
        out += "  - {name: fixture, mesh: {shapes: [" + text_of(fixture) + "]}}\n";
        out += "tools:\n  - number: 1\n    length_mm: 100\n    sections:\n" + tool;
        out += fmt::format("pairs:\n  - {{a: cutter, b: [stock, fixture], margin_mm: {}}}\n",
                           margin_mm);
        return out + "exclusions: [{a: stock, b: fixture, reason: clamped}]\n";
    }
};

/// From the point to the block; 0 inside.
double distance_mm(const Block& b, Vec3d p) {
    const SinCos turn = sin_cos(-b.turn_deg * kPi / 180);
    const Vec3d off = p - b.at;
    const double x = std::fabs(turn.cos * off.x - turn.sin * off.y) - 0.5 * b.size.x;
    const double y = std::fabs(turn.sin * off.x + turn.cos * off.y) - 0.5 * b.size.y;
    const double z = std::max(off.z - b.size.z, -off.z);
    return std::sqrt(std::max(x, 0.0) * std::max(x, 0.0) + std::max(y, 0.0) * std::max(y, 0.0) +
                     std::max(z, 0.0) * std::max(z, 0.0));
}

bool holds(const Section& s, Vec3d nose, Vec3d p) {
    const Vec3d at = p - nose;
    const double share = (at.z - s.low_mm) / (s.high_mm - s.low_mm);
    return share >= 0 && share <= 1 &&
           std::hypot(at.x, at.y) <= s.low_radius_mm + share * (s.high_radius_mm - s.low_radius_mm);
}

/// Of sampled points: never less than the true distance, and 0 where one is inside the other.
double sampled_mm(const Mill& mill, const std::vector<Block>& blocks, Vec3d nose, bool all) {
    double least = 1e9;
    for (const Section& s : mill.sections) {
        if (s.is_cutting && !all) {
            continue;
        }
        for (const Block& b : blocks) {
            for (int i = 0; i <= 12; ++i) {
                const double share = i / 12.0;
                const double radius =
                    s.low_radius_mm + share * (s.high_radius_mm - s.low_radius_mm);
                const double z = nose.z + s.low_mm + share * (s.high_mm - s.low_mm);
                for (int k = 0; k < 36; ++k) {
                    const SinCos turn = sin_cos(k * kPi / 18);
                    for (const double inner : {1.0, 0.5, 0.0}) {
                        least = std::min(least,
                                         distance_mm(b, {nose.x + inner * radius * turn.cos,
                                                         nose.y + inner * radius * turn.sin, z}));
                    }
                }
            }
            const SinCos turn = sin_cos(b.turn_deg * kPi / 180);
            for (int i = 0; i < 27; ++i) {
                const double x = 0.5 * (i % 3 - 1) * b.size.x, y = 0.5 * (i / 3 % 3 - 1) * b.size.y;
                const Vec3d p{b.at.x + turn.cos * x - turn.sin * y,
                              b.at.y + turn.sin * x + turn.cos * y,
                              b.at.z + 0.5 * (i / 9) * b.size.z};
                least = holds(s, nose, p) ? 0 : least;
            }
        }
    }
    return least;
}

/// A machine, and what a cycle of contact mode says of its two pairs.
class Judge {
  public:
    explicit Judge(const std::string& text, bool proves_travel) {
        EXPECT_TRUE(parse_machine(text, "m", loaded_.machine).empty());
        EXPECT_TRUE(load_meshes(loaded_.machine, "/", loaded_.meshes).empty());
        part_cutters(loaded_.machine, loaded_.meshes);
        if (proves_travel) {
            double done = 0;
            apply_travel(*prove_travel(loaded_, {}, [&done](double share) { done = share; }),
                         loaded_);
            EXPECT_EQ(done, 1) << "told as it went on";
        }
        engine_.emplace(std::move(*make_engine(loaded_)));
        containment_test_.emplace(std::move(*make_containment_test(loaded_, *engine_)));
        stop_.emplace(std::move(*make_stop_certificate(loaded_)));
    }
    Judge(const Judge&) = delete;
    Judge& operator=(const Judge&) = delete;

    struct Said {
        bool is_far = true;  // also of a pair that is not queried
        bool is_inside = false;
    };
    std::array<Said, 2> at(Vec3d nose) {
        AxisSnapshot snapshot;
        snapshot.axis_count = 3;
        snapshot.tool = 1;
        snapshot.position = {nose.x, nose.y, nose.z};
        make_contact_queries(loaded_.machine, snapshot, *pair_queries_, QueryScope::needed);
        EXPECT_EQ(pair_queries_->status, SnapshotStatus::ok);
        std::array<Said, 2> out;
        for (std::uint32_t i = 0; i < pair_queries_->count; ++i) {
            QueryResult result;
            ContainmentResult contained;
            const std::span<const Query> query(&pair_queries_->queries[i], 1);
            engine_->run(query, {&result, 1});
            containment_test_->run(query, {&result, 1}, {&contained, 1});
            const bool is_apart = result.proof == Proof::far;
            const bool is_outside = contained.containment == Containment::none;
            out[pair_queries_->pair[i]] = {is_apart && is_outside, is_apart && !is_outside};
        }
        return out;
    }
    struct Certified {
        std::array<bool, 2> is_proven{};
        JointBox box;  // all positions that it is about
    };
    /// After standing there for as long as samples are kept.
    Certified certified_at(Vec3d nose) {
        AxisSnapshot snapshot;
        snapshot.axis_count = 3;
        snapshot.tool = 1;
        snapshot.position = {nose.x, nose.y, nose.z};
        for (std::uint32_t i = 0; i < kSamplesKept; ++i) {
            snapshot.sample = i + 1;
            stop_->note(snapshot, i == 0);
        }
        stop_->prove(engine_->engine(), *containment_test_);
        Certified out{.is_proven = {}, .box = stop_->reach(3)};
        EXPECT_EQ(stop_->cycle().status, SnapshotStatus::ok);
        for (const PairProof& proof : stop_->cycle().proofs) {
            out.is_proven[proof.pair] = proof.surfaces.proof == JointBoxProof::proven &&
                                        proof.containment_result.containment == Containment::none;
        }
        return out;
    }
    /// Surfaces of which something is pruned, and pairs that are.
    [[nodiscard]] std::size_t left_out() const {
        std::size_t count = 0;
        for (const TravelProof& proof : loaded_.machine.travel.proofs) {
            count += (proof.surface_a != kNoIndex ? 1 : 0) + (proof.surface_b != kNoIndex ? 1 : 0) +
                     (proof.is_apart ? 1 : 0);
        }
        return count;
    }

  private:
    LoadedMachine loaded_;
    std::optional<CpuEngine> engine_;
    std::optional<ContainmentTest> containment_test_;
    std::optional<StopCertificate> stop_;
    std::unique_ptr<PairQueries> pair_queries_ = std::make_unique<PairQueries>();
};

TEST(Cutting, WhatIsCalledFarIsFarOfTheTrueSections) {
    Dice dice(printed_seed(71));
    const std::uint64_t machines = count_from_environment(30);
    std::uint64_t far = 0, inside = 0, in_stock = 0, false_near = 0, could_be_far = 0, less = 0;
    for (std::uint64_t m = 0; m < machines; ++m) {
        const Mill mill(dice);
        ASSERT_EQ(faults_of(mill.text()), "") << mill.text();
        Judge whole(mill.text(), false), pruned(mill.text(), true);
        less += pruned.left_out();
        for (int i = 0; i < kPositionsOfMachine; ++i) {
            const Vec3d nose{drawn_between(dice, -60, 60), drawn_between(dice, -60, 60),
                             drawn_between(dice, -60, 60)};
            const auto said = whole.at(nose), said_of_less = pruned.at(nose);
            for (std::size_t pair = 0; pair < 2; ++pair) {
                const bool is_stock = pair == 0;
                const double sampled =
                    sampled_mm(mill, is_stock ? mill.stock : mill.fixture, nose, !is_stock);
                const bool is_far = said[pair].is_far;
                ASSERT_FALSE((is_far || said_of_less[pair].is_far) && sampled <= mill.margin_mm)
                    << (is_far ? "" : "pruned alone: ") << sampled << " mm, margin "
                    << mill.margin_mm << ", nose " << nose.x << ' ' << nose.y << ' ' << nose.z
                    << '\n'
                    << mill.text();
                ASSERT_EQ(is_far, said_of_less[pair].is_far) << mill.text();
                far += is_far ? 1 : 0;
                inside += said[pair].is_inside ? 1 : 0;
                if (sampled > mill.margin_mm + kSlackMm) {
                    ++could_be_far;
                    false_near += is_far ? 0 : 1;
                    const bool cuts =
                        is_stock && is_far && sampled_mm(mill, mill.stock, nose, true) == 0;
                    in_stock += cuts ? 1 : 0;
                }
            }
        }
    }
    std::printf(
        "%llu far (%llu with a cutting section in the stock), %llu inside, %llu of %llu "
        "false; %llu left out\n",
        static_cast<unsigned long long>(far), static_cast<unsigned long long>(in_stock),
        static_cast<unsigned long long>(inside), static_cast<unsigned long long>(false_near),
        static_cast<unsigned long long>(could_be_far), static_cast<unsigned long long>(less));
    if (machines >= 30) {
        EXPECT_GT(in_stock, 20U) << "or cutting was not looked at";
        EXPECT_GT(inside, 2U) << "or insides were not";
        EXPECT_GT(less, 5U) << "or nothing was left out";
        EXPECT_LT(false_near * 50, could_be_far);
    }
}

/// Anywhere in the travel, each axis at an end of it in a quarter of them.
Vec3d any_nose(Dice& dice) {
    const auto one = [&dice] {
        const auto way = dice() % 8;
        return way == 0 ? -60.0 : way == 1 ? 60.0 : drawn_between(dice, -60, 60);
    };
    const double x = one(), y = one();
    return {x, y, one()};
}

TEST(Cutting, WhatIsCertifiedIsFarWhereverTheAxesMayGetTo) {
    Dice dice(printed_seed(73));
    const std::uint64_t machines = count_from_environment(20);
    std::uint64_t proven = 0, beyond = 0, alike = 0;
    for (std::uint64_t m = 0; m < machines; ++m) {
        const Mill mill(dice);
        Judge whole(mill.text(), false), pruned(mill.text(), true);
        for (int i = 0; i < kPositionsOfMachine / 4; ++i) {
            const Vec3d nose = any_nose(dice);
            const auto certified = whole.certified_at(nose), of_less = pruned.certified_at(nose);
            alike += certified.is_proven == of_less.is_proven ? 1 : 0;
            const JointBox& box = of_less.box;
            for (int k = 0; k < 6; ++k) {
                const auto in_box = [&](std::size_t axis) {
                    const double share =
                        k < 3 ? (dice() % 2 == 0 ? -1 : 1) : drawn_between(dice, -1, 1);
                    return box.centre[axis] + share * box.half[axis];
                };
                const double x = in_box(0), y = in_box(1);
                const Vec3d there{x, y, in_box(2)};
                beyond += std::max({std::fabs(x), std::fabs(y), std::fabs(there.z)}) > 60 ? 1 : 0;
                for (std::size_t pair = 0; pair < 2; ++pair) {
                    if (!certified.is_proven[pair] && !of_less.is_proven[pair]) {
                        continue;
                    }
                    ++proven;
                    const bool is_stock = pair == 0;
                    ASSERT_GT(
                        sampled_mm(mill, is_stock ? mill.stock : mill.fixture, there, !is_stock),
                        mill.margin_mm)
                        << there.x << ' ' << there.y << ' ' << there.z << '\n'
                        << mill.text();
                }
            }
        }
    }
    std::printf("%llu proven, %llu positions beyond the travel, %llu certificates alike\n",
                static_cast<unsigned long long>(proven), static_cast<unsigned long long>(beyond),
                static_cast<unsigned long long>(alike));
    EXPECT_GT(beyond, machines);
    EXPECT_GT(proven, machines * 100);
}

}  // namespace
}  // namespace axg::test
