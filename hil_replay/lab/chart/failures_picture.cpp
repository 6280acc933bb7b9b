// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/chart/failures_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "hil_replay/lab/cases/pair_cases.hpp"
#include "hil_replay/plan/gnuplot.hpp"

namespace axg::chart {
namespace {

constexpr unsigned kCellWidthPx = 21, kCellHeightPx = 13;
constexpr unsigned kLeftPx = 275, kRightPx = 120, kTopPx = 190, kBottomPx = 50;

double percent(std::uint64_t part, std::uint64_t whole) {
    return whole == 0 ? 0 : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
}

std::string vertices_of(const lab::Pair<double>& pair) {
    std::string out;
    for (const Vec3d* v :
         {&pair.a[0], &pair.a[1], &pair.a[2], &pair.b[0], &pair.b[1], &pair.b[2]}) {
        out += fmt::format("{}{:a},{:a},{:a}", out.empty() ? "" : ",", v->x, v->y, v->z);
    }
    return out;
}

struct FailingCase {
    const char* what;
    std::size_t at;
};

std::vector<FailingCase> failing_cases(const MethodScore& score) {
    std::vector<FailingCase> out;
    for (const FailingCase& one : {FailingCase{"first missed", score.first_missed},
                                   {"deepest missed", score.deepest_missed},
                                   {"first false hit", score.first_false_hit},
                                   {"farthest false hit", score.farthest_false_hit}}) {
        if (one.at != kNoCase) {
            out.push_back(one);
        }
    }
    return out;
}

/// Two lines, one triangle each, to paste into a program.
std::string format_pair(const lab::Pair<double>& pair) {
    std::string out;
    for (const Vec3d(*triangle)[3] : {&pair.a, &pair.b}) {
        out += triangle == &pair.a ? "    a" : "    b";
        for (const Vec3d& v : *triangle) {
            out += fmt::format("  {:a} {:a} {:a}", v.x, v.y, v.z);
        }
        out += '\n';
    }
    return out;
}

/// Columns and rows of a map. Omits rows without a fault of any method.
struct Layout {
    std::vector<const MethodScore*> columns;
    std::vector<std::size_t> rows;
    PictureSize size;
};

template <class Rate>
Layout layout_of(std::span<const MethodScore> scores, const Rate& rate) {
    Layout out;
    for (const MethodScore& m : scores) {
        if (!m.is_fused) {
            out.columns.push_back(&m);
        }
    }
    for (std::size_t row = 0; row < lab::pair_category_count(); ++row) {
        if (std::any_of(out.columns.begin(), out.columns.end(),
                        [&](const MethodScore* m) { return rate(m->by_category[row]) > 0; })) {
            out.rows.push_back(row);
        }
    }
    out.size = {kLeftPx + kRightPx + kCellWidthPx * static_cast<unsigned>(out.columns.size()),
                kTopPx + kBottomPx + kCellHeightPx * static_cast<unsigned>(out.rows.size())};
    return out;
}

/// The filled cells as a block of data: column, row, percent, um.
template <class Rate, class Depth>
std::string cells_of(const Layout& layout, const Rate& rate, const Depth& depth_um) {
    std::string out = "$cells << END\n";
    for (std::size_t row = 0; row < layout.rows.size(); ++row) {
        for (std::size_t column = 0; column < layout.columns.size(); ++column) {
            const Score& score = layout.columns[column]->by_category[layout.rows[row]];
            if (rate(score) > 0) {
                out +=
                    fmt::format("{},{},{:.4g},{:.4g}\n", column, row, rate(score), depth_um(score));
            }
        }
    }
    return out + "END\n";
}

std::string ticks_of(const Layout& layout) {
    std::string out = "set ytics scale 0 (";
    for (std::size_t row = 0; row < layout.rows.size(); ++row) {
        out += fmt::format("{}{} {}", row == 0 ? "" : ", ",
                           quoted_for_gnuplot(lab::pair_category_name(layout.rows[row])), row);
    }
    out += ") noenhanced\nset x2tics scale 0 rotate by 60 left (";
    for (std::size_t column = 0; column < layout.columns.size(); ++column) {
        out += fmt::format("{}{} {}", column == 0 ? "" : ", ",
                           quoted_for_gnuplot(layout.columns[column]->name), column);
    }
    return out + ") noenhanced\n";
}

struct MapText {
    std::string name, title, of_what, deep, beneath;
};

template <class Rate, class Depth>
std::string map_script(std::span<const MethodScore> scores, const MapText& text, const Rate& rate,
                       const Depth& depth_um) {
    const Layout layout = layout_of(scores, rate);
    const PictureSize size = layout.size;
    return gnuplot_script(
        text.name, size,
        fmt::format(
            R"gp({0}{1}small = kind eq 'svg' ? '11' : '8'; mark = kind eq 'svg' ? 0.55 : 0.85
set lmargin at screen {2:.4f}; set rmargin at screen {3:.4f}
set bmargin at screen {4:.4f}; set tmargin at screen {5:.4f}
set label {6} at screen 0.5,{7:.4f} center font ',16'
set label {8} at screen 0.5,{9:.4f} center font ',' . small textcolor rgb ink
set label {10} at screen 0.5,{11:.4f} center font ',' . small textcolor rgb ink
unset xtics
set ytics font ',' . small; set x2tics font ',' . small
set border 15 linecolor rgb pale
set xrange [-0.5:{12}]; set link x2
set yrange [{13}:-0.5]
set grid front noxtics noytics
faint = '#eeeeee'
do for [i=1:{14}] {{
    set arrow from i-0.5,graph 0 to i-0.5,graph 1 nohead back linecolor rgb faint
}}
do for [i=1:{15}] {{
    set arrow from graph 0,first i-0.5 to graph 1,first i-0.5 nohead back linecolor rgb faint
}}
set palette defined (0 '#fdeec4', 1 '#f5b041', 2 '#d1480b', 3 '#3a0a05')
set logscale cb
set colorbox user origin {17:.4f},{18:.4f} size {19:.4f},{20:.4f}
set cbrange [0.1:100]
set cbtics ('≤ 0.1 %%' 0.1, '1 %%' 1, '10 %%' 10, '100 %%' 100) font ',' . small
set cblabel {16} font ',' . small
set style fill solid 1 noborder
unset key
plot $cells using 1:2:($1-0.46):($1+0.46):($2-0.46):($2+0.46):3 with boxxyerror \
       linecolor palette, \
     '' using 1:($4>1 ? $2 : NaN) with points pointtype 7 pointsize mark linecolor rgb 'white', \
     '' using 1:($4>1 ? $2 : NaN) with points pointtype 6 pointsize mark linewidth 1.5 \
       linecolor rgb blue, \
     '' using 1:($4>1000 ? $2 : NaN) with points pointtype 7 pointsize mark linecolor rgb blue
)gp",
            cells_of(layout, rate, depth_um), ticks_of(layout), double(kLeftPx) / size.width,
            1 - double(kRightPx) / size.width, double(kBottomPx) / size.height,
            1 - double(kTopPx) / size.height, quoted_for_gnuplot(text.title),
            1 - 20.0 / size.height, quoted_for_gnuplot(text.deep), 1 - 45.0 / size.height,
            quoted_for_gnuplot(text.beneath), 18.0 / size.height,
            double(layout.columns.size()) - 0.5, double(layout.rows.size()) - 0.5,
            layout.columns.size() - 1, layout.rows.size() - 1, quoted_for_gnuplot(text.of_what),
            1 - (kRightPx - 14.0) / size.width, 1 - (kTopPx + 230.0) / size.height,
            12.0 / size.width, 220.0 / size.height));
}

}  // namespace

std::string failure_map_table(std::span<const MethodScore> scores) {
    std::string out =
        "method,category,intersecting,missed,deepest_missed_um,apart,false_hits,"
        "farthest_false_hit_um,undecided_apart,widest_undecided_um,undecided_hits,"
        "beyond_1_um,false_hits_beyond_1_um,undecided_beyond_1_um\n";
    for (const MethodScore& m : scores) {
        for (std::size_t i = 0; i < m.by_category.size(); ++i) {
            const Score& s = m.by_category[i];
            if (s.missed + s.false_hits + s.undecided_apart == 0) {
                continue;
            }
            out += fmt::format("{},\"{}\",{},{},{:.6g},{},{},{:.6g},{},{:.6g},{},{},{},{}\n",
                               m.name, lab::pair_category_name(i), s.intersecting, s.missed,
                               s.deepest_missed_um, s.apart, s.false_hits, s.farthest_false_hit_um,
                               s.undecided_apart, s.widest_undecided_um, s.undecided_hits, s.far,
                               s.far_false_hits, s.far_undecided);
        }
    }
    return out;
}

std::string failing_cases_table(std::span<const MethodScore> scores, const CaseBook& book,
                                std::span<const lab::Method* const> methods) {
    std::string out = "method,what,category,index,depth_um,distance_um";
    for (const char triangle : {'a', 'b'}) {
        for (int vertex = 0; vertex < 3; ++vertex) {
            for (const char axis : {'x', 'y', 'z'}) {
                out += fmt::format(",{}{}{}_mm", triangle, vertex, axis);
            }
        }
    }
    out += '\n';
    for (std::size_t i = 0; i < scores.size(); ++i) {
        const Cases& cases = book.of(*methods[i]);
        for (const FailingCase& one : failing_cases(scores[i])) {
            const Truth& truth = cases.truth[one.at];
            out += fmt::format("{},{},\"{}\",{},{:.6g},{:.6g},{}\n", scores[i].name, one.what,
                               lab::pair_category_name(cases.category[one.at]),
                               one.at % book.per_category, truth.depth_um, truth.distance_um,
                               vertices_of(cases.pairs.given[one.at]));
        }
    }
    return out;
}

std::string format_failing_cases(std::span<const MethodScore> scores, const CaseBook& book,
                                 std::span<const lab::Method* const> methods) {
    std::string out;
    for (std::size_t i = 0; i < scores.size(); ++i) {
        const MethodScore& m = scores[i];
        const std::vector<FailingCase> failing = failing_cases(m);
        if (m.is_fused || failing.empty()) {
            continue;
        }
        const Cases& cases = book.of(*methods[i]);
        out += fmt::format(
            "{}: {} contacts missed, deepest {:.3g} um; {} false hits, farthest "
            "{:.3g} um\n",
            m.name, m.machine.missed, m.machine.deepest_missed_um, m.machine.false_hits,
            m.machine.farthest_false_hit_um);
        for (const FailingCase& one : failing) {
            const Truth& truth = cases.truth[one.at];
            out += fmt::format(
                "  {}: {} {}, {:.3g} um {}\n{}", one.what,
                lab::pair_category_name(cases.category[one.at]), one.at % book.per_category,
                truth.intersects ? truth.depth_um : truth.distance_um,
                truth.intersects ? "deep" : "apart", format_pair(cases.pairs.given[one.at]));
        }
    }
    return out;
}

std::string missed_script(std::span<const MethodScore> scores, const std::string& beneath) {
    return map_script(
        scores,
        {.name = "missed-contacts",
         .title = "Contacts that a test calls separated",
         .of_what = "of the contacts in the category",
         .deep = "circle: one of them deeper than 1 µm; disc: deeper than 1 mm; blank: none missed",
         .beneath = beneath},
        [](const Score& s) { return percent(s.missed, s.intersecting); },
        [](const Score& s) { return s.deepest_missed_um; });
}

std::string not_told_apart_script(std::span<const MethodScore> scores, const std::string& beneath) {
    return map_script(
        scores,
        {.name = "not-told-apart",
         .title = "Pairs more than 1 µm apart that a test does not tell apart",
         .of_what = "of the pairs more than 1 µm apart",
         .deep = "called touching, or left undecided; disc: one of them more than 1 mm apart; "
                 "blank: none",
         .beneath = beneath},
        [](const Score& s) { return percent(s.far_false_hits + s.far_undecided, s.far); },
        [](const Score& s) {
            const double um = std::max(s.farthest_false_hit_um, s.widest_undecided_um);
            return um > 1000 ? um : 0;  // every cell here is beyond 1 um
        });
}

}  // namespace axg::chart
