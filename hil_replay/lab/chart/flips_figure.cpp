// SPDX-License-Identifier: Apache-2.0
// Whether a verdict depends on the representation of a pair: the 72 orders of its vertices and
// triangles, in four frames. A verdict that depends on them is an effect of rounding.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/base/pose.hpp"
#include "hil_replay/lab/cases/draw.hpp"
#include "hil_replay/lab/cases/pair_cases.hpp"
#include "hil_replay/lab/chart/figures.hpp"
#include "hil_replay/lab/chart/figures_json.hpp"
#include "hil_replay/lab/chart/method_scores.hpp"
#include "hil_replay/lab/judge/exact_judge.hpp"
#include "hil_replay/lab/methods/method.hpp"
#include "hil_replay/plan/gnuplot.hpp"

namespace axg::chart {
namespace {

using lab::Draw;

enum Frame : std::size_t { kAsIs, kQuarterTurn, kOffset, kTurned, kFrames };
constexpr std::array<const char*, kFrames> kFrameNames = {"as it is", "quarter turn", "1.5 m away",
                                                          "turned"};
constexpr std::size_t kOrders = 72;  // 6 * 6 orders of the vertices, 2 of the triangles
constexpr unsigned kRowPx = 22, kCellPx = 72, kLeftPx = 190, kRightPx = 20, kTopPx = 150,
                   kBottomPx = 50;

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

/// A row: a method compiled like the project, and its build with contraction if there is one.
struct Row {
    const MethodFlips *plain = nullptr, *fused = nullptr;
};

std::vector<Row> rows_of(const std::vector<MethodFlips>& all) {
    std::vector<Row> rows;
    for (const MethodFlips& m : all) {
        if (m.is_fused) {
            continue;
        }
        Row row{.plain = &m};
        for (const MethodFlips& other : all) {
            row.fused = other.is_fused && other.name == m.name + "-fma" ? &other : row.fused;
        }
        rows.push_back(row);
    }
    return rows;
}

constexpr std::size_t kColumns = 2 * (kFrames + 1);

/// The cells of the figure: column, row, count, percent.
std::string cells_of(const std::vector<Row>& rows) {
    std::string out = "$cells << END\n";
    for (std::size_t row = 0; row < rows.size(); ++row) {
        for (const bool fused : {false, true}) {
            const MethodFlips* const m = fused ? rows[row].fused : rows[row].plain;
            std::uint64_t wrong = 0, pairs = 0;
            for (std::size_t f = 0; m != nullptr && f < kFrames; ++f) {
                const Flips& flips = m->frames[f];
                out += fmt::format("{},{},{},{:.4g}\n", f + (fused ? kFrames + 1 : 0), row,
                                   flips.differing,
                                   100.0 * double(flips.differing) / double(flips.pairs));
                wrong += flips.wrong;
                pairs += flips.pairs;
            }
            if (m != nullptr) {
                out += fmt::format("{},{},{},{:.4g}\n", kFrames + (fused ? kFrames + 1 : 0), row,
                                   wrong, 100.0 * double(wrong) / double(pairs));
            }
        }
    }
    return out + "END\n";
}

std::string ticks_of(const std::vector<Row>& rows) {
    std::string out = "set ytics scale 0 (";
    for (std::size_t row = 0; row < rows.size(); ++row) {
        out += fmt::format("{}{} {}", row == 0 ? "" : ", ",
                           quoted_for_gnuplot(rows[row].plain->name), row);
    }
    out += ") noenhanced\nset x2tics scale 0 (";
    for (std::size_t column = 0; column < kColumns; ++column) {
        const std::size_t f = column % (kFrames + 1);
        out += fmt::format("{}\"{}\" {}", column == 0 ? "" : ", ",
                           f < kFrames ? kFrameNames[f] : "contacts\\ncalled apart", column);
    }
    return out + ")\n";
}

std::string script_of(const std::vector<MethodFlips>& all, const std::string& beneath) {
    const std::vector<Row> rows = rows_of(all);
    const PictureSize size{kLeftPx + kRightPx + kCellPx * static_cast<unsigned>(kColumns) + kCellPx,
                           kTopPx + kBottomPx + kRowPx * static_cast<unsigned>(rows.size())};
    return gnuplot_script(
        "flips", size,
        fmt::format(R"gp({0}{1}small = kind eq 'svg' ? '11.5' : '8.5'
set lmargin at screen {2:.4f}; set rmargin at screen {3:.4f}
set bmargin at screen {4:.4f}; set tmargin at screen {5:.4f}
set label "Pairs whose verdict changes with the order of vertices and triangles" \
    at screen 0.5,{6:.4f} center font ',16'
set label {7} at screen 0.5,{8:.4f} center font ',' . small
set label "compiled without contraction" at first 1.5, screen {9:.4f} center font ',' . small
set label "contraction allowed (FMA)" at first 6.5, screen {9:.4f} center font ',' . small
unset xtics; unset grid; unset border; unset key
set link x2
set ytics font ',' . small; set x2tics font ',' . small
set xrange [-0.5:{10}]
set yrange [{11}:-0.5]
set palette defined (0 '#fdeec4', 1 '#f5b041', 2 '#d1480b', 3 '#7a1d08')
set logscale cb
set cbrange [0.1:100]
unset colorbox
set style fill solid 1 noborder
set arrow from 4.5,graph 0 to 4.5,graph 1 nohead front linecolor rgb grey linewidth 2
plot $cells using ($3>0 ? $1 : NaN):2:($1-0.47):($1+0.47):($2-0.45):($2+0.45):4 with boxxyerror \
       linecolor palette, \
     '' using 1:2:(sprintf('%d',$3)):($3==0 ? 0x0b5394 : $4>10 ? 0xffffff : 0x202020) \
       with labels textcolor rgb variable font ',' . small
)gp",
                    cells_of(rows), ticks_of(rows), double(kLeftPx) / size.width,
                    1 - double(kRightPx) / size.width, double(kBottomPx) / size.height,
                    1 - double(kTopPx) / size.height, 1 - 22.0 / size.height,
                    quoted_for_gnuplot(beneath), 20.0 / size.height, 1 - 75.0 / size.height,
                    kColumns - 0.5, double(rows.size()) - 0.5));
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
    const std::size_t pairs = f32[0].touches.size();
    out.summary = describe_flips(totals, pairs, kOrders);
    out.tables = {{"flips.csv", table_of(all)}};
    out.script = script_of(
        all, fmt::format("of {} pairs in {} orders each, in each frame rounded to what the method "
                         "computes in; last columns: all frames",
                         pairs, kOrders));
    return out;
}

}  // namespace axg::chart
