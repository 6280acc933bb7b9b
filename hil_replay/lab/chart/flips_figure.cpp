// SPDX-License-Identifier: Apache-2.0
// Whether a verdict depends on the representation of a pair: the 72 orders of its vertices and
// triangles, in four frames. A verdict that depends on them is an effect of rounding.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "core/base/pose.hpp"
#include "hil_replay/lab/cases/draw.hpp"
#include "hil_replay/lab/cases/pair_cases.hpp"
#include "hil_replay/lab/chart/figures.hpp"
#include "hil_replay/lab/chart/figures_json.hpp"
#include "hil_replay/lab/chart/method_scores.hpp"
#include "hil_replay/lab/judge/exact_judge.hpp"
#include "hil_replay/lab/methods/method.hpp"

namespace axg::chart {
namespace {

using lab::Draw;

enum Frame : std::size_t { kAsIs, kQuarterTurn, kOffset, kTurned, kFrames };
constexpr std::array<const char*, kFrames> kFrameNames = {"as it is", "quarter turn", "1.5 m away",
                                                          "turned"};
constexpr std::size_t kOrders = 72;  // 6 * 6 orders of the vertices, 2 of the triangles

/// Numbers of pairs for one method in one frame.
struct Flips {
    std::uint64_t pairs = 0;
    std::uint64_t differing = 0;  // several verdicts over all orders
    std::uint64_t wrong = 0;      // called separated in some order, though they touch
};

struct MethodFlips {
    std::string name;
    bool is_certified = false, is_fused = false;
    std::array<Flips, kFrames> frames{};
};

/// Rounds the coordinates to T.
template <class T>
lab::Pair<double> rounded(const lab::Pair<double>& pair) {
    lab::Pair<double> out;
    const auto narrow = [](double x) { return static_cast<double>(static_cast<T>(x)); };
    for (int i = 0; i < 3; ++i) {
        out.a[i] = {narrow(pair.a[i].x), narrow(pair.a[i].y), narrow(pair.a[i].z)};
        out.b[i] = {narrow(pair.b[i].x), narrow(pair.b[i].y), narrow(pair.b[i].z)};
    }
    return out;
}

/// The pose of a frame. Quarter turns only swap coordinates and signs, without rounding.
Pose pose_of(Frame frame, Draw& draw) {
    Pose pose;
    if (frame == kQuarterTurn) {
        return {{{0, -1, 0}, {0, 0, 1}, {-1, 0, 0}}, {0, 0, 0}};
    }
    if (frame == kOffset) {
        return {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {1100.1, -700.3, 800.7}};
    }
    if (frame == kTurned) {
        double q[4], square = 0;
        do {
            square = 0;
            for (double& x : q) {
                x = draw.between(-1, 1);
                square += x * x;
            }
        } while (square > 1 || square < 0.01);
        const double f = 2 / square;
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            pose.r[i][i] = 1 - f * (q[j] * q[j] + q[k] * q[k]);
            pose.r[i][j] = f * (q[i] * q[j] - q[k] * q[3]);
            pose.r[j][i] = f * (q[i] * q[j] + q[k] * q[3]);
        }
    }
    return pose;
}

template <class T>
lab::Pair<double> in_frame(const lab::Pair<double>& pair, const Pose& pose) {
    lab::Pair<double> out;
    for (int i = 0; i < 3; ++i) {
        out.a[i] = apply(pose, pair.a[i]);
        out.b[i] = apply(pose, pair.b[i]);
    }
    return rounded<T>(out);
}

void add_orders(const lab::Pair<double>& pair, lab::PairSet& out) {
    constexpr int kOrder[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    for (const auto& of_a : kOrder) {
        for (const auto& of_b : kOrder) {
            lab::Pair<double> ordered, swapped;
            for (int i = 0; i < 3; ++i) {
                ordered.a[i] = swapped.b[i] = pair.a[of_a[i]];
                ordered.b[i] = swapped.a[i] = pair.b[of_b[i]];
            }
            out.add(ordered);
            out.add(swapped);
        }
    }
}

/// The same pairs in one frame, each in its 72 orders, with the truth about the rounded pair.
struct FrameSet {
    lab::PairSet pairs;
    std::vector<bool> touches;  // one for each 72 orders
};

template <class T>
std::array<FrameSet, kFrames> frame_sets(const Request& request) {
    std::array<FrameSet, kFrames> out;
    Draw draw(request.seed);
    const std::uint64_t per_category = request.is_quick ? 1 : 24;
    for (std::size_t category = 0; category < lab::pair_category_count(); ++category) {
        for (std::uint64_t i = 0; i < per_category; ++i) {
            const auto pair = lab::in_double(lab::make_pair_case<T>(category, request.seed + 1, i));
            if (!is_machine_like(pair)) {
                continue;
            }
            for (std::size_t frame = 0; frame < kFrames; ++frame) {
                const Pose pose = pose_of(static_cast<Frame>(frame), draw);
                const lab::Pair<double> there = in_frame<T>(pair, pose);
                add_orders(there, out[frame].pairs);
                out[frame].touches.push_back(lab::intersect(there));
            }
        }
    }
    return out;
}

Flips count(const lab::Method& method, const FrameSet& set) {
    using lab::Verdict;
    const std::vector<Verdict> verdicts = lab::judge(method, set.pairs, false).verdicts;
    Flips out{.pairs = set.touches.size()};
    for (std::size_t i = 0; i < set.touches.size(); ++i) {
        const auto first = verdicts.begin() + static_cast<std::ptrdiff_t>(i * kOrders);
        const auto last = first + kOrders;
        const bool same = std::all_of(first, last, [&](Verdict v) { return v == *first; });
        const bool separated = std::find(first, last, Verdict::separated) != last;
        out.differing += same ? 0 : 1;
        out.wrong += set.touches[i] && separated ? 1 : 0;
    }
    return out;
}

std::string table_of(const std::vector<MethodFlips>& all) {
    std::string out =
        "method,certified,fused,frame,pairs,differing_in_72_orders,separated_though_touching\n";
    for (const MethodFlips& m : all) {
        for (std::size_t f = 0; f < kFrames; ++f) {
            out += fmt::format("{},{:d},{:d},{},{},{},{}\n", m.name, m.is_certified, m.is_fused,
                               kFrameNames[f], m.frames[f].pairs, m.frames[f].differing,
                               m.frames[f].wrong);
        }
    }
    return out;
}

}  // namespace

Figure flips_figure(const Request& request) {
    const std::array<FrameSet, kFrames> f32 = frame_sets<float>(request);
    const std::array<FrameSet, kFrames> f64 = frame_sets<double>(request);
    std::vector<MethodFlips> all;
    std::vector<FlipTotals> totals;
    Figure out{.name = "flips"};
    for (const lab::Method& method : lab::methods()) {
        if (method.bounding_volume || method.scalar == lab::Scalar::exact) {
            continue;
        }
        MethodFlips m{.name = std::string(method.name),
                      .is_certified = method.certified,
                      .is_fused = method.fused};
        std::uint64_t differing = 0, wrong = 0;
        for (std::size_t f = 0; f < kFrames; ++f) {
            m.frames[f] = count(method, (method.scalar == lab::Scalar::f64 ? f64 : f32)[f]);
            differing += m.frames[f].differing;
            wrong += m.frames[f].wrong;
        }
        totals.push_back({m.name, m.is_certified, differing, wrong});
        if (m.is_certified) {
            out.words += fmt::format("{}: {} contacts called separated in any of {} orders\n",
                                     m.name, wrong, kOrders);
        }
        all.push_back(m);
    }
    out.summary = describe_flips(totals, f32[0].touches.size(), kOrders);
    out.tables = {{"flips.csv", table_of(all)}};
    return out;
}

}  // namespace axg::chart
