// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/chart/speed_accuracy_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "hil_replay/lab/chart/place_labels.hpp"
#include "hil_replay/plan/gnuplot.hpp"

namespace axg::chart {
namespace {

constexpr PictureSize kSize{1000, 680};
// Where the axes lie, as shares of the picture: fixed, so that words can be placed in pixels.
constexpr double kLeft = 0.11, kRight = 0.975, kBottom = 0.185, kTop = 0.885;
constexpr double kFloorUm = 1e-9;  // less is drawn there: a thousandth of a picometre
constexpr double kMarkPx = 6, kLinePx = 15, kLetterPx = 6.5;

/// What the test cannot tell: proven tests may be undecided, others miss contacts.
double blind_um(const MethodScore& m) {
    return m.is_certified ? m.machine.widest_undecided_um : m.machine.deepest_missed_um;
}

/// The worst of two means: contacts, where no early end helps, and pairs apart.
double ns_of(const MethodScore& m) {
    return std::max(m.ns_touching, m.ns_apart);
}

std::string format_score(const MethodScore& m) {
    if (m.machine.missed > 0) {
        return fmt::format("{}: {} missed", m.name, m.machine.missed);
    }
    return m.machine.false_hits == 0
               ? m.name
               : fmt::format("{}: {} false hits", m.name, m.machine.false_hits);
}

/// A logarithmic axis between two shares of the picture.
struct Axis {
    double low, high, from, to;

    [[nodiscard]] double share(double value) const {
        const double part = std::log(value / low) / std::log(high / low);
        return from + std::clamp(part, 0.0, 1.0) * (to - from);
    }
};

struct Axes {
    Axis x, y;
};

Axes axes_of(std::span<const MethodScore> scores) {
    double fast = HUGE_VAL, slow = 0, blind = 1;
    for (const MethodScore& m : scores) {
        fast = std::min(fast, ns_of(m));
        slow = std::max(slow, ns_of(m));
        blind = std::max(blind, blind_um(m));
    }
    return {.x = {fast / 1.6, slow * 1.8, kLeft, kRight},
            .y = {kFloorUm / 6, blind * 8, kBottom, kTop}};
}

/// Stepping stones along the line that joins the proven methods, for words to stay off.
std::vector<LabelBox> line_boxes(std::vector<Label> proven) {
    std::sort(proven.begin(), proven.end(),
              [](const Label& a, const Label& b) { return a.x < b.x; });
    std::vector<LabelBox> boxes;
    constexpr int kSteps = 60;
    for (std::size_t i = 1; i < proven.size(); ++i) {
        for (int step = 0; step <= kSteps; ++step) {
            const double t = static_cast<double>(step) / kSteps;
            const double x = proven[i - 1].x + t * (proven[i].x - proven[i - 1].x);
            const double y = proven[i - 1].y + t * (proven[i].y - proven[i - 1].y);
            boxes.push_back({x - 3, y - 3, x + 3, y + 3});
        }
    }
    return boxes;
}

/// Words beside the marks, with a thin line to those that had to move away.
std::string label_lines(std::span<const MethodScore> scores, const Axes& axes) {
    std::vector<Label> labels, proven;
    for (const MethodScore& m : scores) {
        labels.push_back({.x = axes.x.share(ns_of(m)) * kSize.width,
                          .y = axes.y.share(std::max(blind_um(m), kFloorUm)) * kSize.height,
                          .width = kLetterPx * static_cast<double>(format_score(m).size()) + 4,
                          .height = kLinePx});
        if (m.is_certified) {
            proven.push_back(labels.back());
        }
    }
    std::vector<LabelBox> taken = line_boxes(proven);
    const LabelBox frame{kLeft * kSize.width, kBottom * kSize.height, 0.995 * kSize.width,
                         kTop * kSize.height};
    place_labels(labels, frame, kMarkPx, taken);
    std::string out;
    for (std::size_t i = 0; i < scores.size(); ++i) {
        const Label& at = labels[i];
        const char* const colour = scores[i].is_certified         ? "blue"
                                   : scores[i].machine.missed > 0 ? "red"
                                                                  : "grey";
        out += fmt::format(
            "set label {} at screen {:.4f},{:.4f} left front font ',' . small "
            "textcolor rgb {}\n",
            quoted_for_gnuplot(format_score(scores[i])), (at.text_left + 2) / kSize.width,
            at.text_mid / kSize.height, colour);
        if (at.is_away) {
            const double end = std::clamp(at.x, at.text_left, at.text_left + at.width);
            out += fmt::format(
                "set arrow from screen {:.4f},{:.4f} to screen {:.4f},{:.4f} nohead "
                "back linecolor rgb grey linewidth 0.6\n",
                at.x / kSize.width, at.y / kSize.height, end / kSize.width,
                (at.text_mid + (at.y > at.text_mid ? 6 : -6)) / kSize.height);
        }
    }
    return out;
}

}  // namespace

std::string speed_accuracy_table(std::span<const MethodScore> scores) {
    std::string out =
        "method,certified,fused,ns_a_pair,ns_touching,ns_apart,intersecting,apart,missed,"
        "deepest_missed_um,false_hits,false_hits_beyond_1_um,farthest_false_hit_um,undecided_hits,"
        "undecided_apart,widest_undecided_um\n";
    for (const MethodScore& m : scores) {
        const Score& s = m.machine;
        out += fmt::format(
            "{},{:d},{:d},{:.2f},{:.2f},{:.2f},{},{},{},{:.6g},{},{},{:.6g},{},{},{:.6g}\n", m.name,
            m.is_certified, m.is_fused, ns_of(m), m.ns_touching, m.ns_apart, s.intersecting,
            s.apart, s.missed, s.deepest_missed_um, s.false_hits, s.far_false_hits,
            s.farthest_false_hit_um, s.undecided_hits, s.undecided_apart, s.widest_undecided_um);
    }
    return out;
}

std::string speed_accuracy_script(std::span<const MethodScore> scores, const std::string& cases,
                                  const std::string& machine) {
    std::vector<MethodScore> drawn;
    std::copy_if(scores.begin(), scores.end(), std::back_inserter(drawn),
                 [](const MethodScore& m) { return !m.is_fused; });
    const Axes axes = axes_of(drawn);
    return gnuplot_script(
        "speed-accuracy", kSize,
        fmt::format(R"gp(
small = kind eq 'svg' ? '12.5' : '9'
set lmargin at screen {0}; set rmargin at screen {1}
set bmargin at screen {2}; set tmargin at screen {3}
mark = kind eq 'svg' ? 0.75 : 1.2
set label "What a test of two triangles costs, and what it cannot tell" at screen 0.5,0.965 \
    center font ',17'
unset key
set label "  proven: no contact is ever missed" at screen 0.13,0.915 left \
    point pointtype 5 pointsize mark linecolor rgb blue
set label "  not proven, none missed here" at screen 0.45,0.915 left \
    point pointtype 7 pointsize mark linecolor rgb grey
set label "  misses contacts" at screen 0.74,0.915 left \
    point pointtype 6 pointsize mark linewidth 2 linecolor rgb red
set logscale xy
set xrange [{4:.6g}:{5:.6g}]
set yrange [{6:.6g}:{7:.6g}]
set xlabel "mean time of a pair (all on the same pairs; touching or apart, whichever is slower)"
set ylabel "deepest contact missed, or where proven: widest gap undecided"
set ytics ('≤ 1 fm' 1e-9, '1 pm' 1e-6, '1 nm' 1e-3, '1 µm' 1, '1 mm' 1e3, '1 m' 1e6)
set xtics ('1 ns' 1, '10 ns' 10, '100 ns' 100, '1 µs' 1e3, '10 µs' 1e4, '100 µs' 1e5, '1 ms' 1e6, \
           '10 ms' 1e7)
set mxtics 10
set label {8} at screen 0.5,0.048 center font ',' . small textcolor rgb ink noenhanced
set label {11} at screen 0.5,0.02 center font ',' . small textcolor rgb ink noenhanced
{9}floor = {10:.0e}
blind(certified, missed, undecided) = (d = certified == 1 ? undecided : missed, \
    d < floor ? floor : d)
file = 'speed-accuracy.csv'
plot file skip 1 using ($2==1 && $3==0 ? $4 : NaN):(blind($2,$10,$16)) with linespoints \
       linetype 1 linewidth 1.5 pointtype 5 pointsize mark linecolor rgb blue, \
     '' skip 1 using ($2==0 && $3==0 && $9==0 ? $4 : NaN):(blind($2,$10,$16)) with points \
       pointtype 7 pointsize mark linecolor rgb grey, \
     '' skip 1 using ($2==0 && $3==0 && $9>0 ? $4 : NaN):(blind($2,$10,$16)) with points \
       pointtype 6 pointsize mark linewidth 2 \
       linecolor rgb red
)gp",
                    kLeft, kRight, kBottom, kTop, axes.x.low, axes.x.high, axes.y.low, axes.y.high,
                    quoted_for_gnuplot(cases), label_lines(drawn, axes), kFloorUm,
                    quoted_for_gnuplot(machine)));
}

}  // namespace axg::chart
