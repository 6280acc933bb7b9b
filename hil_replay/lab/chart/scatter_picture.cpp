// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/chart/scatter_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "hil_replay/lab/chart/place_labels.hpp"

namespace axg::chart {
namespace {

constexpr double kLeft = 0.15, kRight = 0.975;  // of the panels, shares of the width
constexpr double kMarkPx = 6, kLinePx = 15, kLetterPx = 7.1, kBoldPx = 7.9, kLegendPx = 18;

struct Look {
    const char* point;
    const char* colour;
};

constexpr std::array<Look, 5> kLooks = {{
    {"pointtype 5 pointsize mark", "blue"},
    {"pointtype 13 pointsize 1.7*mark", "ink"},
    {"pointtype 7 pointsize mark", "red"},
    {"pointtype 6 pointsize mark linewidth 1.5", "red"},
    {"pointtype 8 pointsize 1.3*mark linewidth 1.5", "blue"},
}};

const Look& look_of(MarkStyle style) {
    return kLooks[static_cast<std::size_t>(style)];
}

/// Number of letters; UTF-8 may need several bytes for one.
std::size_t letters_in(const std::string& words) {
    return static_cast<std::size_t>(std::count_if(words.begin(), words.end(), [](char c) {
        return (static_cast<unsigned char>(c) & 0xc0U) != 0x80U;
    }));
}

double share_of(double value, double low, double high) {
    return std::clamp(std::log(value / low) / std::log(high / low), 0.0, 1.0);
}

/// A mark's place in pixels, y upwards.
struct Place {
    double x = 0, y = 0;
};

struct PanelDrawer {
    const ScatterPicture& picture;
    const ScatterPanel& panel;

    [[nodiscard]] Place place_of(double x, double y) const {
        const double across = share_of(x, picture.x_low, picture.x_high);
        const double up = share_of(y, panel.y_low, panel.y_high);
        return {(kLeft + across * (kRight - kLeft)) * picture.size.width,
                (panel.bottom + up * (panel.top - panel.bottom)) * picture.size.height};
    }

    /// Adds small boxes along a line, so that no label covers it.
    static void add_line(std::vector<LabelBox>& taken, const Place& a, const Place& b) {
        constexpr int kSteps = 60;
        for (int step = 0; step <= kSteps; ++step) {
            const double t = static_cast<double>(step) / kSteps;
            const double x = a.x + t * (b.x - a.x), y = a.y + t * (b.y - a.y);
            taken.push_back({x - 2, y - 2, x + 2, y + 2});
        }
    }

    [[nodiscard]] Place place_of(std::size_t mark) const {
        return place_of(panel.marks[mark].x, panel.marks[mark].y);
    }

    [[nodiscard]] std::vector<LabelBox> taken() const {
        std::vector<LabelBox> taken;
        for (const auto& [a, b] : panel.joined) {
            add_line(taken, place_of(a), place_of(b));
        }
        for (std::size_t i = 1; i < panel.pareto.size(); ++i) {
            const Place a = place_of(panel.pareto[i - 1]), b = place_of(panel.pareto[i]);
            add_line(taken, a, {b.x, a.y});
            add_line(taken, {b.x, a.y}, b);
        }
        for (const ScatterMark& mark : panel.marks) {
            if (mark.words.empty()) {  // place_labels() adds the labelled marks
                const Place at = place_of(mark.x, mark.y);
                taken.push_back({at.x - kMarkPx, at.y - kMarkPx, at.x + kMarkPx, at.y + kMarkPx});
            }
        }
        if (panel.wall_x > 0) {
            const Place foot = place_of(panel.wall_x, panel.y_low);
            const Place head = place_of(panel.wall_x, panel.y_high);
            add_line(taken, foot, head);
            const double width = kLetterPx * static_cast<double>(letters_in(panel.wall_words));
            taken.push_back({head.x - width - 8, head.y - 20, head.x, head.y});
        }
        const Place low = place_of(picture.x_low, panel.y_low);
        const double wide = (kRight - kLeft) * picture.size.width,
                     high = (panel.top - panel.bottom) * picture.size.height;
        const double x = low.x + panel.better_x * wide, y = low.y + panel.better_y * high;
        taken.push_back({x - 6, y - 8, x + 84, y + 24});
        return taken;
    }

    [[nodiscard]] std::string words() const {
        std::vector<Label> labels;
        std::vector<const ScatterMark*> marks;
        for (const ScatterMark& mark : panel.marks) {
            if (!mark.words.empty()) {
                const Place at = place_of(mark.x, mark.y);
                labels.push_back(
                    {.x = at.x, .y = at.y, .width = width_of(mark), .height = kLinePx});
                marks.push_back(&mark);
            }
        }
        const LabelBox frame{kLeft * picture.size.width + 2, panel.bottom * picture.size.height + 2,
                             0.99 * picture.size.width, panel.top * picture.size.height - 2};
        place_labels(labels, frame, kMarkPx, taken());
        std::string out;
        for (std::size_t i = 0; i < labels.size(); ++i) {
            out += line_of(labels[i], *marks[i]);
        }
        return out;
    }

    [[nodiscard]] static bool is_bold(const ScatterMark& mark) {
        return mark.style == MarkStyle::ours || mark.style == MarkStyle::paper;
    }

    [[nodiscard]] static double width_of(const ScatterMark& mark) {
        return (is_bold(mark) ? kBoldPx : kLetterPx) * static_cast<double>(letters_in(mark.words)) +
               12;
    }

    [[nodiscard]] std::string line_of(const Label& at, const ScatterMark& mark) const {
        const double width = picture.size.width, height = picture.size.height;
        std::string out = fmt::format(
            "set label {} at screen {:.4f},{:.4f} left front font {} textcolor rgb {}\n",
            quoted_for_gnuplot(is_bold(mark) ? "{/:Bold " + mark.words + "}" : mark.words),
            (at.text_left + 2) / width, at.text_mid / height, "',' . small",
            look_of(mark.style).colour);
        if (at.is_away) {
            const double end = std::clamp(at.x, at.text_left, at.text_left + at.width);
            out += fmt::format(
                "set arrow from screen {:.4f},{:.4f} to screen {:.4f},{:.4f} nohead back linecolor "
                "rgb grey linewidth 0.7\n",
                at.x / width, at.y / height, end / width,
                (at.text_mid + (at.y > at.text_mid ? 7 : -7)) / height);
        }
        return out;
    }

    /// The corner where a method is fast and loses nothing.
    [[nodiscard]] std::string better() const {
        const double x = kLeft + panel.better_x * (kRight - kLeft);
        const double y = panel.bottom + panel.better_y * (panel.top - panel.bottom);
        const double dx = 24.0 / picture.size.width, dy = 18.0 / picture.size.height;
        return fmt::format(
            "set arrow from screen {:.4f},{:.4f} to screen {:.4f},{:.4f} filled linewidth 2 "
            "linecolor rgb green\nset label '{{/:Bold better}}' at screen {:.4f},{:.4f} left font "
            "',' . small textcolor rgb green\n",
            x + dx, y + dy, x, y, x + 1.2 * dx, y + 0.6 * dy);
    }

    [[nodiscard]] std::string wall() const {
        if (!(panel.wall_x > 0)) {
            return {};
        }
        return fmt::format(
            "set arrow from first {0:.6g}, graph 0 to first {0:.6g}, graph 1 nohead back dashtype "
            "2 linewidth 2 linecolor rgb ink\nset label {1} at screen {2:.4f},{3:.4f} right font "
            "',' . small textcolor rgb ink\n",
            panel.wall_x, quoted_for_gnuplot(panel.wall_words),
            place_of(panel.wall_x, panel.y_low).x / picture.size.width - 5.0 / picture.size.width,
            panel.top - 11.0 / picture.size.height);
    }
};

/// The marks of a panel in the script: x, y, style.
std::string data_of(const ScatterPanel& panel, std::size_t number) {
    std::string out = fmt::format("$marks{} << EOD\n", number);
    for (const ScatterMark& mark : panel.marks) {
        out += fmt::format("{:.6g},{:.6g},{}\n", mark.x, mark.y, static_cast<int>(mark.style));
    }
    out += fmt::format("EOD\n$joined{} << EOD\n1,1\n\n", number);
    for (const auto& [a, b] : panel.joined) {
        out += fmt::format("{:.6g},{:.6g}\n{:.6g},{:.6g}\n\n", panel.marks[a].x, panel.marks[a].y,
                           panel.marks[b].x, panel.marks[b].y);
    }
    out += fmt::format("EOD\n$pareto{} << EOD\n", number);
    for (std::size_t i = 0; i < panel.pareto.size(); ++i) {
        const ScatterMark& at = panel.marks[panel.pareto[i]];
        if (i > 0) {  // a step: no mark is better up to the next one
            out += fmt::format("{:.6g},{:.6g}\n", at.x, panel.marks[panel.pareto[i - 1]].y);
        }
        out += fmt::format("{:.6g},{:.6g}\n", at.x, at.y);
    }
    return out + (panel.pareto.empty() ? "1,NaN\nEOD\n" : "EOD\n");
}

std::string panel_of(const ScatterPicture& picture, std::size_t number) {
    const ScatterPanel& panel = picture.panels[number];
    const PanelDrawer drawer{picture, panel};
    const bool is_last = number + 1 == picture.panels.size();
    std::string out = fmt::format(
        "{}set tmargin at screen {:.4f}; set bmargin at screen {:.4f}\n"
        "set yrange [{:.6g}:{:.6g}]\nset ytics ({})\n"
        "set label {} at screen {:.4f},{:.4f} left font ',14' textcolor rgb ink\n"
        "set label {} at screen {:.4f},{:.4f} center rotate by 90 textcolor rgb ink\n{}",
        data_of(panel, number), panel.top, panel.bottom, panel.y_low, panel.y_high, panel.y_ticks,
        quoted_for_gnuplot("{/:Bold " + panel.title + "}"), kLeft,
        panel.top + 12.0 / picture.size.height, quoted_for_gnuplot(panel.y_label),
        14.0 / picture.size.width, (panel.top + panel.bottom) / 2,
        is_last ? fmt::format("set xlabel {}\n", quoted_for_gnuplot(picture.x_label))
                : "unset xlabel\n");
    out += drawer.words() + drawer.better() + drawer.wall();
    out += fmt::format(
        "plot $pareto{0} using 1:2 with lines linewidth 1.5 dashtype 3 linecolor rgb blue, \\\n"
        "     $joined{0} using 1:2 with lines linewidth 0.8 linecolor rgb grey",
        number);
    for (std::size_t style = 0; style < kLooks.size(); ++style) {
        out += fmt::format(
            ", \\\n     $marks{} using ($3=={} ? $1 : NaN):2 with points {} linecolor rgb {}",
            number, style, kLooks[style].point, kLooks[style].colour);
    }
    return out + "\nunset label; unset arrow\n";
}

/// One line per style, below the title.
std::string legend_of(const ScatterPicture& picture) {
    std::string out;
    double y = 1 - 44.0 / picture.size.height;
    for (const auto& [style, words] : picture.legend) {
        out += fmt::format(
            "set label {} at screen {:.4f},{:.4f} left point {} linecolor rgb {} offset 1.6,0 font "
            "',' . small textcolor rgb ink\n",
            quoted_for_gnuplot(words), kLeft + 0.01, y, look_of(style).point,
            look_of(style).colour);
        y -= kLegendPx / picture.size.height;
    }
    return out;
}

}  // namespace

std::vector<std::size_t> pareto_of(const std::vector<ScatterMark>& marks) {
    std::vector<std::size_t> order(marks.size());
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(), [&marks](std::size_t a, std::size_t b) {
        return std::pair(marks[a].x, marks[a].y) < std::pair(marks[b].x, marks[b].y);
    });
    std::vector<std::size_t> out;
    for (const std::size_t i : order) {
        if (marks[i].style != MarkStyle::predicted &&
            (out.empty() || marks[i].y < marks[out.back()].y)) {
            out.push_back(i);
        }
    }
    return out;
}

std::string scatter_script(const ScatterPicture& picture) {
    std::string body = fmt::format(
        "small = kind eq 'svg' ? '12' : '9'\nmark = kind eq 'svg' ? 0.6 : 1.0\n"
        "set lmargin at screen {}; set rmargin at screen {}\nunset key\n"
        "set logscale xy\nset xrange [{:.6g}:{:.6g}]\nset xtics ({})\nset mxtics 10\n"
        "set label {} at screen 0.5,{:.4f} center font ',16' textcolor rgb ink\n",
        kLeft, kRight, picture.x_low, picture.x_high, picture.x_ticks,
        quoted_for_gnuplot("{/:Bold " + picture.title + "}"), 1 - 20.0 / picture.size.height);
    body += legend_of(picture);
    double y = (4.0 + 15.0 * static_cast<double>(picture.beneath.size())) / picture.size.height;
    for (const std::string& line : picture.beneath) {
        y -= 15.0 / picture.size.height;
        body += fmt::format(
            "set label {} at screen 0.5,{:.4f} center font ',' . small noenhanced textcolor rgb "
            "ink\n",
            quoted_for_gnuplot(line), y + 6.0 / picture.size.height);
    }
    body += "set multiplot\n";
    for (std::size_t number = 0; number < picture.panels.size(); ++number) {
        body += panel_of(picture, number);
    }
    return gnuplot_script(picture.name, picture.size, body + "unset multiplot\n");
}

}  // namespace axg::chart
