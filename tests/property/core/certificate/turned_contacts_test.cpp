// SPDX-License-Identifier: Apache-2.0
// Turns that touch at a known angle: edges and faces on whole numbers, turned by a rotation that
// keeps them whole (a quaternion of whole numbers), so that the contact is exact and its angle is
// known to the last bits. No box of angles that holds it may be proven. Parallel edges, ends and
// corners, contact at either end of the turn, tangents; and tangents with a known gap, which have
// to be proven but for little. AXG_COUNT: turns.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <optional>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "core/certificate/joint_box_proof.hpp"
#include "tests/support/between.hpp"
#include "tests/support/count.hpp"
#include "tests/support/engine_fixture.hpp"
#include "tests/support/one_axis_pair.hpp"
#include "tests/support/seed.hpp"

namespace axg::test {
namespace {

using Whole = std::array<std::int64_t, 3>;

Whole operator+(const Whole& a, const Whole& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
Whole operator*(std::int64_t s, const Whole& a) {
    return {s * a[0], s * a[1], s * a[2]};
}
Whole across(const Whole& a, const Whole& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

std::int64_t whole_in(std::mt19937_64& random, std::int64_t low, std::int64_t high) {
    return low + static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(high - low + 1));
}
Whole whole_point(std::mt19937_64& random, std::int64_t size) {
    return {whole_in(random, -size, size), whole_in(random, -size, size),
            whole_in(random, -size, size)};
}

/// A rotation about `axis` whose matrix is `m` / `n`, whole numbers.
struct WholeTurn {
    Whole axis{0, 0, 1};
    std::int64_t n = 1;
    std::array<Whole, 3> m{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    double angle_rad = 0;  // good to a few units of its last place

    WholeTurn() = default;
    /// Of the quaternion w + v. Precondition: v is not 0.
    WholeTurn(std::int64_t w, const Whole& v) : axis(v) {
        const std::int64_t square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
        n = w * w + square;
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t k = 0; k < 3; ++k) {
                m[i][k] = 2 * v[i] * v[k];
            }
            m[i][i] += w * w - square;
            const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
            m[i][j] -= 2 * w * v[k];
            m[i][k] += 2 * w * v[j];
        }
        angle_rad = 2 * std::atan2(std::sqrt(static_cast<double>(square)), static_cast<double>(w));
    }
    /// Where n p is before the turn.
    [[nodiscard]] Whole back(const Whole& p) const {
        Whole out{};
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t k = 0; k < 3; ++k) {
                out[i] += m[k][i] * p[k];
            }
        }
        return out;
    }
    [[nodiscard]] Vec3d direction() const {
        const Vec3d v{static_cast<double>(axis[0]), static_cast<double>(axis[1]),
                      static_cast<double>(axis[2])};
        return (1 / std::sqrt(dot(v, v))) * v;
    }
};

WholeTurn random_whole_turn(std::mt19937_64& random) {
    Whole v{};
    while (v == Whole{}) {
        v = whole_point(random, 5);
    }
    if (random() % 4 == 0) {  // contact before the axis moves
        WholeTurn out;
        out.axis = v;
        return out;
    }
    return {whole_in(random, -5, 5), v};
}

enum class TurnedKind : std::uint8_t {
    edges,
    parallel_edges,
    end_on_edge,
    ends,
    tangent_edges,
    vertex_in_face,
    vertex_on_side,
    vertex_on_corner,
    vertex_tangent,
    face_onto_vertex,
    count,
};
constexpr const char* kTurnedKinds[] = {
    "edges",        "parallel edges", "end on an edge", "end on an end",        "tangent edges",
    "vertex, face", "vertex, side",   "vertex, corner", "vertex, tangent face", "face, vertex"};
static_assert(std::size(kTurnedKinds) == static_cast<std::size_t>(TurnedKind::count));

/// In contact, from the axis: the corners that turn, in n-ths, and the others. One to three each.
struct WholeContact {
    std::vector<Whole> turns, stands;
};

/// A short vector along the way of a point at `p`, or 0 on the axis.
Whole along_the_way(const Whole& axis, const Whole& p) {
    Whole out = across(axis, p);
    const std::int64_t by = std::gcd(std::gcd(out[0], out[1]), out[2]);
    return by > 1 ? Whole{out[0] / by, out[1] / by, out[2] / by} : out;
}

WholeContact make_contact(std::mt19937_64& random, TurnedKind kind, const WholeTurn& turn) {
    const std::int64_t size = std::int64_t{1} << (random() % 7);
    const Whole k = whole_point(random, 512), p = turn.n * k;
    const Whole u = whole_point(random, size), s = whole_point(random, 64 * size);
    const Whole e = whole_point(random, 64 * size), way = along_the_way(turn.axis, k);
    const std::int64_t i = whole_in(random, 1, 3), j = whole_in(random, 1, 3);
    const Whole nearly = random() % 2 == 0 ? Whole{} : whole_point(random, 1);  // of a tangent
    switch (kind) {
        case TurnedKind::edges:
            return {{k + -i * u, k + j * u}, {p + -j * s, p + i * s}};
        case TurnedKind::parallel_edges:
            return {{k + -i * u, k + j * u}, {p + -j * u, p + i * 3 * u}};
        case TurnedKind::end_on_edge:
            return random() % 2 == 0 ? WholeContact{{k, k + j * u}, {p + -j * s, p + i * s}}
                                     : WholeContact{{k + -i * u, k + j * u}, {p, p + i * s}};
        case TurnedKind::ends:
            return {{k, k + j * u}, {p, p + i * s}};
        case TurnedKind::tangent_edges:
            return {{k + -i * turn.axis, k + j * turn.axis},
                    {p + -j * (way + nearly), p + i * (way + nearly)}};
        case TurnedKind::vertex_in_face:
            return {{k}, {p + s, p + e, p + -1 * (s + e)}};
        case TurnedKind::vertex_on_side:
            return {{k}, {p + -i * s, p + j * s, p + e}};
        case TurnedKind::vertex_on_corner:
            return {{k}, {p, p + s, p + e}};
        case TurnedKind::vertex_tangent:
            return {{k},
                    {p + way + i * turn.axis + nearly, p + -1 * way + j * turn.axis,
                     p + -(i + j) * turn.axis + -1 * nearly}};
        default:
            return {{k + i * u, k + way + turn.axis, k + -1 * (i * u + way + turn.axis)}, {p}};
    }
}

/// A primitive of one to three corners as a triangle, `unit` mm apart and moved by `from`.
Mesh whole_mesh(const std::vector<Whole>& corners, const Whole& from, double unit_mm) {
    std::array<Vec3f, 3> p;
    for (std::size_t i = 0; i < 3; ++i) {
        const Whole at = from + corners[std::min(i, corners.size() - 1)];
        for (const std::int64_t x : at) {
            EXPECT_LE(std::abs(x), std::int64_t{1} << 24) << "no float";
        }
        const auto mm = [&](std::size_t k) {
            return static_cast<float>(unit_mm * static_cast<double>(at[k]));
        };
        p[i] = {mm(0), mm(1), mm(2)};
    }
    return {"primitive", {{p[0], p[1], p[2]}}};
}

struct TurnedPair {
    Mesh turns, stands;
    Joint joint;
    JointBox box;
};

TurnedPair pair_of(const WholeContact& contact, const WholeTurn& turn, const Whole& pivot,
                   double unit_mm) {
    std::vector<Whole> before;
    for (const Whole& p : contact.turns) {
        before.push_back(turn.back(p));
    }
    TurnedPair out{
        whole_mesh(before, pivot, unit_mm), whole_mesh(contact.stands, pivot, unit_mm), {}, {}};
    out.joint.direction = turn.direction();
    out.joint.pivot_mm = {unit_mm * static_cast<double>(pivot[0]),
                          unit_mm * static_cast<double>(pivot[1]),
                          unit_mm * static_cast<double>(pivot[2])};
    return out;
}

/// Angles that hold that of the contact: about it, or one of their ends is it, but for a few units
/// of the last place where it is no double.
void choose_angles(std::mt19937_64& random, const WholeTurn& turn, std::uint32_t axis,
                   JointBox& box) {
    const double half = std::exp2(between(random, -30, 1));
    const double outwards = turn.angle_rad == 0 ? 0 : 0x1p-47;
    const double where[] = {between(random, -0.99, 0.99), 1, -1};
    box.centre[axis] = turn.angle_rad + half * where[random() % 3];
    box.half[axis] = half + outwards;
}

constexpr std::uint32_t kPairsAtOnce = 15;  // each an axis and two bodies of one machine

/// Machines of as many axes, and what was proven of them.
class TurnedMachines {
  public:
    explicit TurnedMachines(std::mt19937_64& random) : random_(random) {}

    void judge(std::uint32_t count) {
        Machine machine;  // half of them check again in double
        machine.cycle.lists.rechecks = static_cast<std::uint32_t>(64 * (random_() % 2));
        std::vector<Mesh> meshes;
        std::array<TurnedKind, kPairsAtOnce> kinds{};
        JointBox box;
        for (std::uint32_t i = 0; i < count; ++i) {
            kinds[i] = static_cast<TurnedKind>(next_kind_++ %
                                               static_cast<std::uint32_t>(TurnedKind::count));
            const WholeTurn turn = random_whole_turn(random_);
            const double unit_mm = std::exp2(-static_cast<double>(4 + random_() % 11));
            TurnedPair pair = pair_of(make_contact(random_, kinds[i], turn), turn,
                                      whole_point(random_, 1 << (random_() % 18)), unit_mm);
            pair.joint.axis = i;
            choose_angles(random_, turn, i, box);
            machine.axes.push_back({});
            machine.axes.back().kind = AxisKind::rotary;
            machine.bodies.resize(2 * i + 2);
            machine.bodies[2 * i].joint = pair.joint;
            meshes.push_back(std::move(pair.turns));
            meshes.push_back(std::move(pair.stands));
        }
        prove(machine, meshes, box, kinds, count);
    }
    [[nodiscard]] std::uint64_t queries() const { return queries_; }
    [[nodiscard]] std::uint64_t turns() const { return next_kind_; }

  private:
    void prove(const Machine& machine, const std::vector<Mesh>& meshes, const JointBox& box,
               const std::array<TurnedKind, kPairsAtOnce>& kinds, std::uint32_t count) {
        std::optional<CpuEngine> engine =
            engine_over(meshes, {.node_pairs = 64, .triangle_pairs = 64, .rechecks = 64});
        std::vector<BodyExtent> extents;
        for (const Mesh& mesh : meshes) {
            extents.push_back(extent_of(mesh));
        }
        std::array<JointBoxTask, kPairsAtOnce> tasks;
        std::array<JointBoxResult, kPairsAtOnce> results;
        for (std::uint32_t i = 0; i < count; ++i) {
            JointBoxTask& task = tasks[i];
            task.body_a = task.mesh_a = 2 * i;
            task.body_b = task.mesh_b = 2 * i + 1;
            task.extent_a = &extents[2 * i];
            task.extent_b = &extents[2 * i + 1];
            task.path = path_between(machine, 2 * i, 2 * i + 1);
            task.box = box;
        }
        const auto rounds = static_cast<std::uint32_t>(1 + random_() % 8);
        std::optional<JointBoxProver> prover =
            JointBoxProver::create(machine, count, {.rounds = rounds, .queries = 1024});
        ASSERT_TRUE(engine && prover);
        queries_ += prover
                        ->prove(engine->engine(), std::span(tasks).first(count),
                                std::span(results).first(count))
                        .queries;
        for (std::uint32_t i = 0; i < count; ++i) {
            EXPECT_EQ(results[i].proof, JointBoxProof::budget_spent)
                << kTurnedKinds[static_cast<std::size_t>(kinds[i])] << ", turn "
                << next_kind_ - count + i << ": false far";
        }
    }

    std::mt19937_64& random_;
    std::uint64_t next_kind_ = 0, queries_ = 0;
};

TEST(TurnedContacts, NoBoxThatHoldsTheAngleOfContactIsProven) {
    std::mt19937_64 random(printed_seed(20261201));
    const std::uint64_t count = count_from_environment(1'000'000);
    TurnedMachines machines(random);
    while (machines.turns() < count && !HasFailure()) {
        const std::uint64_t left = count - machines.turns();
        machines.judge(static_cast<std::uint32_t>(std::min<std::uint64_t>(left, kPairsAtOnce)));
    }
    std::printf("%llu turns of %zu kinds, %llu queries, none proven\n",
                static_cast<unsigned long long>(machines.turns()), std::size(kTurnedKinds),
                static_cast<unsigned long long>(machines.queries()));
}

/// A vertex or an edge along the axis goes round at a whole radius; a face is `gap` units outside
/// the circle where they pass. The distance over any angles about that place is the gap.
TurnedPair with_gap(std::mt19937_64& random, const WholeTurn& turn, std::int64_t gap,
                    double unit_mm) {
    const std::size_t z = turn.axis[0] != 0 ? 0 : turn.axis[1] != 0 ? 1 : 2;
    const std::size_t x = (z + 1) % 3, y = (z + 2) % 3;
    Whole out{}, along{}, way{};
    out[x] = along[z] = way[y] = 1;
    const Whole k = whole_in(random, 512, 4096) * out + whole_in(random, -512, 512) * along;
    const Whole face = turn.n * k + gap * out;
    const std::int64_t wide = whole_in(random, 1, 4096), high = whole_in(random, 1, 4096);
    WholeContact contact{{k},
                         {face + wide * way + high * along, face + -wide * way + high * along,
                          face + -2 * high * along}};
    if (random() % 2 == 0) {
        contact.turns = {k + -4 * along, k + 2 * along};
    }
    return pair_of(contact, turn, whole_point(random, 4096), unit_mm);
}

TEST(TurnedContacts, TangentsWithAGapAreProvenButForLittle) {
    std::mt19937_64 random(printed_seed(20261202));
    const std::uint64_t count = count_from_environment(1'000'000) / 1000;
    constexpr int kGaps = 16;
    std::array<unsigned, kGaps> asked{}, proven{}, in_a_cycle{};
    for (std::uint64_t i = 0; i < count && !HasFailure(); ++i) {
        Whole axis{};
        axis[random() % 3] = whole_in(random, 1, 5);
        const WholeTurn turn(whole_in(random, 1, 5), axis);
        const auto power = static_cast<int>(random() % kGaps);
        const TurnedPair pair = with_gap(random, turn, std::int64_t{1} << power, 0x1p-11);
        OneAxisPair judged(pair.turns, pair.stands, AxisKind::rotary, pair.joint.direction,
                           pair.joint.pivot_mm);
        const double low = turn.angle_rad - between(random, 0.01, 1.5);
        const double high = turn.angle_rad + between(random, 0.01, 1.5);
        const double gap_mm = std::exp2(power - 11);
        ++asked[power];
        proven[power] += judged.is_apart(low, high) ? 1 : 0;
        in_a_cycle[power] += judged.is_apart_in_a_cycle(low, high) ? 1 : 0;
        // Both sides: no more than the gap is ever proven, and most of it is.
        EXPECT_FALSE(judged.is_apart(low, high, gap_mm, {12, 4096})) << power;
        EXPECT_TRUE(power < 8 || judged.is_apart(low, high, 0.5 * gap_mm)) << power;
    }
    for (std::size_t power = 0; power < kGaps; ++power) {
        std::printf("gap %10.4f um: %u, proven %u, in a cycle %u\n",
                    1e3 * std::exp2(static_cast<double>(power) - 11), asked[power], proven[power],
                    in_a_cycle[power]);
        EXPECT_EQ(proven[power], asked[power]);
    }
}

}  // namespace
}  // namespace axg::test
