// SPDX-License-Identifier: Apache-2.0
// Share of pairs that the certified methods leave undecided, against the true gap: a step whose
// foot is the undecided band, and which thin triangles must not move. Pairs of 100 mm: vertex and
// face, edge and edge, vertex and edge, vertex and vertex. Draws a gap, turns the pair, rounds it
// to float, and computes the true gap of the result in exact arithmetic.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/base/pose.hpp"
#include "hil_replay/lab/cases/draw.hpp"
#include "hil_replay/lab/chart/figures.hpp"
#include "hil_replay/lab/chart/figures_json.hpp"
#include "hil_replay/lab/judge/exact_judge.hpp"
#include "hil_replay/lab/methods/method.hpp"

namespace axg::chart {
namespace {

using lab::Draw;

constexpr double kSizeMm = 100;
constexpr std::array<double, 3> kAspects = {1, 1e2, 1e4};
// Bins of the true gap: 1e-3 to 1e3 um in quarters of a decade.
constexpr double kLeastUm = 1e-3;
constexpr int kBinsADecade = 4;
constexpr int kBins = 6 * kBinsADecade;

struct Bin {
    std::uint64_t pairs = 0, undecided = 0;
};

struct Curve {
    std::string method;
    double aspect = 1;
    std::array<Bin, kBins> bins{};
    double widest_undecided_um = 0;
};

/// Mirrors v in the plane with normal n. Two mirrors with normals drawn from a cube make a turn
/// (Rodrigues' formula), rigid to about 2^-52, which is enough here.
Vec3d mirrored(const Vec3d& v, const Vec3d& n) {
    return v - (2 * dot(n, v) / dot(n, n)) * n;
}

Vec3d some_direction(Draw& draw) {
    for (;;) {
        const Vec3d v{draw.between(-1, 1), draw.between(-1, 1), draw.between(-1, 1)};
        const double square = dot(v, v);
        if (square > 0.01 && square < 1) {
            return v;
        }
    }
}

/// Nearest points at the origin and (0, 0, gap), sizes about 1; thin: width over length.
lab::Pair<double> contact(Draw& draw, double gap, double thin) {
    const auto some = [&draw](double low, double high) { return draw.between(low, high); };
    const double down = -some(0.2, 1), up = gap + some(0.2, 1);
    const auto along = [&](double turn, double at, double side, double z) {
        return Vec3d{at * std::cos(turn) - side * std::sin(turn),
                     at * std::sin(turn) + side * std::cos(turn), z};
    };
    const double turn_a = some(0, 6.28), turn_b = some(0, 6.28);
    const Vec3d vertex_a{0, 0, 0}, vertex_b{0, 0, gap};
    const std::uint32_t kind = draw.below(4);
    lab::Pair<double> pair;
    if (kind == 0) {  // a's face below b's vertex
        pair.a[0] = along(turn_a, -some(0.3, 1), -thin * some(0.1, 0.3), 0);
        pair.a[1] = along(turn_a, some(0.3, 1), -thin * some(0.1, 0.3), 0);
        pair.a[2] = along(turn_a, some(-0.1, 0.1), thin * some(0.3, 0.6), 0);
    } else if (kind == 3) {  // a's vertex
        pair.a[0] = vertex_a;
        pair.a[1] = along(turn_a, some(-1, 1), thin * some(-0.5, 0.5), down);
        pair.a[2] = along(turn_a, some(-1, 1), thin * some(-0.5, 0.5), down - some(0, 0.3));
    } else {  // a's edge
        pair.a[0] = along(turn_a, -some(0.3, 1), 0, 0);
        pair.a[1] = along(turn_a, some(0.3, 1), 0, 0);
        pair.a[2] = along(turn_a, some(-0.2, 0.2), thin * some(-0.3, 0.3), thin * down);
    }
    if (kind == 1) {  // b's edge
        pair.b[0] = along(turn_b, -some(0.3, 1), 0, gap);
        pair.b[1] = along(turn_b, some(0.3, 1), 0, gap);
        pair.b[2] = along(turn_b, some(-0.2, 0.2), thin * some(-0.3, 0.3), gap + thin * (up - gap));
    } else {  // b's vertex
        pair.b[0] = vertex_b;
        pair.b[1] = along(turn_b, some(-1, 1), some(-0.5, 0.5), up);
        pair.b[2] = pair.b[1] + Vec3d{thin * some(-0.5, 0.5), thin * some(-0.5, 0.5), 0.01};
    }
    return pair;
}

/// Scaled, turned and rounded to float.
lab::Pair<float> some_pair(Draw& draw, double gap_um, double aspect) {
    lab::Pair<double> pair = contact(draw, gap_um * 1e-3 / kSizeMm, 1 / aspect);
    const Vec3d m = some_direction(draw), n = some_direction(draw);
    lab::Pair<float> out;
    const auto placed = [&](const Vec3d& v) {
        const Vec3d p = kSizeMm * mirrored(mirrored(v, m), n);
        return Vec3f{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
    };
    for (int i = 0; i < 3; ++i) {
        out.a[i] = placed(pair.a[i]);
        out.b[i] = placed(pair.b[i]);
    }
    return out;
}

int bin_of(double gap_um) {
    return gap_um < kLeastUm
               ? -1
               : static_cast<int>(std::floor(kBinsADecade * std::log10(gap_um / kLeastUm)));
}

std::vector<const lab::Method*> certified_methods() {
    std::vector<const lab::Method*> out;
    for (const lab::Method& method : lab::methods()) {
        const bool is_exact = method.scalar == lab::Scalar::exact;
        if (method.certified && !method.bounding_volume && !is_exact) {
            out.push_back(&method);
        }
    }
    return out;
}

void measure(const Request& request, double aspect, std::vector<Curve>& curves) {
    Draw draw(request.seed + static_cast<std::uint64_t>(aspect));
    const int pairs_a_bin = request.is_quick ? 20 : 4000;
    lab::PairSet pairs;
    std::vector<double> gaps_um;
    for (int bin = 0; bin < kBins; ++bin) {
        for (int i = 0; i < pairs_a_bin; ++i) {
            const double wanted =
                kLeastUm * std::pow(10, (bin + draw.unit()) / double{kBinsADecade});
            pairs.add(some_pair(draw, wanted, aspect));
            const lab::Pair<double>& given = pairs.given.back();
            gaps_um.push_back(1e3 * lab::distance_mm(lab::squared_distance(given)));
        }
    }
    for (const lab::Method* const method : certified_methods()) {
        Curve curve{.method = std::string(method->name), .aspect = aspect};
        const lab::Judged judged = lab::judge(*method, pairs, false);
        for (std::size_t i = 0; i < gaps_um.size(); ++i) {
            const int bin = bin_of(gaps_um[i]);
            const bool undecided = judged.verdicts[i] != lab::Verdict::separated;
            if (undecided) {
                curve.widest_undecided_um = std::max(curve.widest_undecided_um, gaps_um[i]);
            }
            if (bin >= 0 && bin < kBins) {
                ++curve.bins[static_cast<std::size_t>(bin)].pairs;
                curve.bins[static_cast<std::size_t>(bin)].undecided += undecided ? 1 : 0;
            }
        }
        curves.push_back(curve);
    }
}

std::string table_of(const std::vector<Curve>& curves) {
    std::string out = "method,aspect,least_gap_um,most_gap_um,pairs,undecided,undecided_percent\n";
    for (const Curve& curve : curves) {
        for (int i = 0; i < kBins; ++i) {
            const Bin& bin = curve.bins[static_cast<std::size_t>(i)];
            const auto edge = [](int at) {
                return kLeastUm * std::pow(10, at / double{kBinsADecade});
            };
            const double percent = bin.pairs == 0 ? 0
                                                  : 100 * static_cast<double>(bin.undecided) /
                                                        static_cast<double>(bin.pairs);
            out += fmt::format("{},{:g},{:.5g},{:.5g},{},{},{:.4g}\n", curve.method, curve.aspect,
                               edge(i), edge(i + 1), bin.pairs, bin.undecided, percent);
        }
    }
    return out;
}

}  // namespace

Figure undecided_gap_figure(const Request& request) {
    std::vector<Curve> curves;
    for (const double aspect : kAspects) {
        measure(request, aspect, curves);
    }
    std::stable_sort(curves.begin(), curves.end(),
                     [](const Curve& a, const Curve& b) { return a.method < b.method; });
    Figure out{.name = "undecided-gap"};
    std::vector<UndecidedGap> gaps;
    std::uint64_t pairs = 0;
    for (const Curve& curve : curves) {
        pairs = 0;
        for (const Bin& bin : curve.bins) {
            pairs += bin.pairs;
        }
        gaps.push_back({curve.method, curve.aspect, pairs, curve.widest_undecided_um});
        out.words += fmt::format("{}, slivers 1:{:g}: widest gap undecided {:.3g} um\n",
                                 curve.method, curve.aspect, curve.widest_undecided_um);
    }
    out.summary = describe_undecided_gaps(gaps);
    out.tables = {{"undecided-gap.csv", table_of(curves)}};
    return out;
}

}  // namespace axg::chart
