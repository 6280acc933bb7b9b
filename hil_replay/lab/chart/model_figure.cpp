// SPDX-License-Identifier: Apache-2.0
// The cost of a shorter cycle: model details of two machines, from the records of
// docs/measurements/levels.md. Labels each point that is slower than a finer one ("bends back").
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "hil_replay/lab/bench/csv_table.hpp"
#include "hil_replay/lab/chart/figures.hpp"
#include "hil_replay/lab/chart/scatter_picture.hpp"

namespace axg::chart {
namespace {

constexpr double kNotEarlierMm = 0.03;  // the place of the whole model
constexpr std::array<std::string_view, 5> kColumns = {"simplify_mm", "triangles", "rest_p99_us",
                                                      "contact_lost", "earlier_mm_p50"};

std::string with_thousands(double count) {
    const auto whole = static_cast<unsigned>(count);
    return whole < 1000 ? fmt::format("{}", whole)
                        : fmt::format("{},{:03}", whole / 1000, whole % 1000);
}

/// Adds the rows, from fine to coarse. False on failure, with place and remedy in `fault`.
bool add_levels(const Request& request, const char* machine, const char* file, ScatterPanel& panel,
                std::string& table, std::string& fault) {
    CsvTable levels;
    if (!levels.read(request.data + "/docs/figures/" + file, kColumns)) {
        fault = levels.error();
        return false;
    }
    double fastest_us = 0;
    for (std::size_t row = 0; row < levels.row_count(); ++row) {
        std::array<double, kColumns.size()> cells{};
        for (std::size_t i = 0; i < cells.size(); ++i) {
            if (!read_number(levels.cell(row, i), cells[i])) {
                fault = fmt::format("{}: {} is not a number. Correct the row.", levels.where(row),
                                    kColumns[i]);
                return false;
            }
        }
        const auto [simplify_mm, triangles, us, lost, earlier_mm] = cells;
        const bool bends_back = row > 0 && us > fastest_us;
        fastest_us = row > 0 ? std::min(fastest_us, us) : us;
        std::string words = simplify_mm > 0 ? fmt::format("{:g} mm", simplify_mm) : "whole";
        words += lost > 0 ? fmt::format(", {:g} lost", lost) : "";
        words += bends_back ? ", bends back" : "";
        panel.marks.push_back({us, std::max(earlier_mm, kNotEarlierMm),
                               bends_back ? MarkStyle::other : MarkStyle::ours, words});
        if (row == 0) {
            panel.title =
                fmt::format("The {} machine, {} triangles", machine, with_thousands(triangles));
        } else {
            panel.joined.emplace_back(row - 1, row);
        }
        table += fmt::format("{},{:g},{:g},{:.6g},{:.6g},{:g},{}\n", machine, simplify_mm,
                             triangles, us, earlier_mm, lost, bends_back ? 1 : 0);
    }
    return true;
}

}  // namespace

Figure model_figure(const Request& request) {
    Figure figure{.name = "model-curve"};
    std::string table = "machine,simplify_mm,triangles,rest_p99_us,earlier_mm,lost,bends_back\n";
    ScatterPanel fine, real;
    if (!add_levels(request, "fine", "model-levels.csv", fine, table, figure.fault) ||
        !add_levels(request, "real", "model-levels-real.csv", real, table, figure.fault)) {
        return figure;
    }
    ScatterPicture picture{
        .name = figure.name,
        .title = "What a shorter cycle costs: coarser models",
        .x_label = "time of a certificate at rest, p99, one core",
        .x_ticks = "'200 µs' 200, '500 µs' 500, '1 ms' 1000, '2 ms' 2000, '5 ms' 5000",
        .x_low = 200,
        .x_high = 7000,
        .size = {600, 760, 2},
        .legend = {{MarkStyle::ours, "a level of detail, by how far it may deviate"},
                   {MarkStyle::other, "bends back: takes longer than a finer one"}},
        .beneath = {"lost: clear positions called contact, of 300 (fine) and 1,000 (real);",
                    "records of docs/measurements/levels.md", "dotted: nothing is better in both"}};
    fine.bottom = 0.53, fine.top = 0.85;
    real.bottom = 0.14, real.top = 0.46;
    for (ScatterPanel* const panel : {&fine, &real}) {
        panel->y_label = "a stop comes earlier by";
        panel->y_ticks = "'none' 0.03, '0.1 mm' 0.1, '0.3 mm' 0.3, '1 mm' 1, '3 mm' 3";
        panel->y_low = 0.015, panel->y_high = 6;
        panel->wall_x = kDeadlineUs;
        panel->wall_words = kDeadlineWords;
        panel->pareto = pareto_of(panel->marks);
    }
    picture.panels = {std::move(fine), std::move(real)};
    figure.tables = {{"model-curve.csv", table}};
    figure.script = scatter_script(picture);
    return figure;
}

}  // namespace axg::chart
