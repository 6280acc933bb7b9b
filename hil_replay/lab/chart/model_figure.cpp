// SPDX-License-Identifier: Apache-2.0
// The cost of a shorter cycle: model details of two machines, from the records of
// docs/measurements/levels.md. Labels each point that is slower than a finer one ("bends back").
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "hil_replay/lab/bench/csv_table.hpp"
#include "hil_replay/lab/chart/figures.hpp"

namespace axg::chart {
namespace {

constexpr std::array<std::string_view, 5> kColumns = {"simplify_mm", "triangles", "rest_p99_us",
                                                      "contact_lost", "earlier_mm_p50"};

/// Adds the rows, from fine to coarse. False on failure, with place and remedy in `fault`.
bool add_levels(const Request& request, const char* machine, const char* file, std::string& table,
                std::string& fault) {
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
        table += fmt::format("{},{:g},{:g},{:.6g},{:.6g},{:g},{}\n", machine, simplify_mm,
                             triangles, us, earlier_mm, lost, bends_back ? 1 : 0);
    }
    return true;
}

}  // namespace

Figure model_figure(const Request& request) {
    Figure figure{.name = "model-curve"};
    std::string table = "machine,simplify_mm,triangles,rest_p99_us,earlier_mm,lost,bends_back\n";
    if (add_levels(request, "fine", "model-levels.csv", table, figure.fault) &&
        add_levels(request, "real", "model-levels-real.csv", table, figure.fault)) {
        figure.tables = {{"model-curve.csv", table}};
    }
    return figure;
}

}  // namespace axg::chart
