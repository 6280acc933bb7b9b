// SPDX-License-Identifier: Apache-2.0
// Time of a whole cycle against its loss, in two panels: contact (yes or no), compared with other
// libraries, and a stop in time. This host measures axguard's cycles; all others come from records
// (cycle-records.csv), each row with its source.
#include <fmt/format.h>

#include <array>
#include <string_view>

#include "core/certificate/stop_certificate.hpp"
#include "firmware_if/setup/choose_plan.hpp"
#include "firmware_if/setup/measure_cycle.hpp"
#include "hil_replay/lab/bench/csv_table.hpp"
#include "hil_replay/lab/chart/figures.hpp"
#include "hil_replay/plan/plan_measure.hpp"

namespace axg::chart {
namespace {

constexpr std::array<std::string_view, 8> kColumns = {"panel", "name",     "kind",   "statistic",
                                                      "us",    "early_mm", "missed", "source"};

/// Times of axguard on this host.
struct OwnTimes {
    double contact_us = 0, rest_us = 0, longest_us = 0;  // p99, p99, constructed
};

bool measure(const Request& request, OwnTimes& out, std::string& fault) {
    const std::string file = request.data + "/config/machines/paper-trunnion.yaml";
    LoadedMachine loaded;
    if (!load(file, "", loaded, stderr)) {
        fault = file + ": not usable; --data FOLDER names the folder that holds config/machines";
        return false;
    }
    ModelScene scene;
    scene.positions = request.is_quick ? 20 : 1000;
    ModelMeasurement model;
    if (!measure_model(loaded, scene, false, model, fault)) {
        return false;
    }
    CycleMeasureOptions options;
    if (request.is_quick) {
        options.conditions = {CacheCondition::warm};
    }
    const CyclePlan plan = plan_at(loaded.machine, stop_tasks(loaded.machine), kPlanStepAsStated);
    const auto longest = measure_cycle(loaded, plan, options, fault);
    if (!longest) {
        return false;
    }
    out = {model.contact.p99_us, model.rest.p99_us, longest->longest_us()};
    return true;
}

/// Reads a time of the table, or the name of a time measured on this host.
bool read_us(std::string_view cell, const OwnTimes& own, double& us) {
    us = cell == "contact"   ? own.contact_us
         : cell == "rest"    ? own.rest_us
         : cell == "longest" ? own.longest_us
                             : 0;
    return us > 0 || read_number(cell, us);
}

/// Adds the row as a line with the measured time to `table`.
bool add_row(const CsvTable& records, std::size_t row, const OwnTimes& own, std::string& table) {
    double us = 0, early_mm = 0, missed = 0;
    if (!read_us(records.cell(row, 4), own, us) || !read_number(records.cell(row, 5), early_mm) ||
        !read_number(records.cell(row, 6), missed)) {
        return false;
    }
    table += fmt::format("{},{},{},{},{:.6g},{:.6g},{:.0f},{}\n", records.cell(row, 0),
                         records.cell(row, 1), records.cell(row, 2), records.cell(row, 3), us,
                         early_mm, missed, records.cell(row, 7));
    return true;
}

}  // namespace

Figure cycle_figure(const Request& request) {
    Figure figure{.name = "cycle-accuracy"};
    CsvTable records;
    if (!records.read(request.data + "/docs/figures/cycle-records.csv", kColumns)) {
        figure.fault = records.error();
        return figure;
    }
    OwnTimes own;
    if (!measure(request, own, figure.fault)) {
        return figure;
    }
    std::string table = "panel,name,kind,statistic,us,early_mm,missed,source\n";
    for (std::size_t row = 0; row < records.row_count(); ++row) {
        if (!add_row(records, row, own, table)) {
            figure.fault = records.where(row) +
                           ": us, early_mm or missed is not a number (us may be contact, rest or "
                           "longest, which are measured). Correct the row.";
            return figure;
        }
    }
    figure.tables = {{"cycle-accuracy.csv", table}};
    figure.words = fmt::format(
        "cycles here: contact p99 {:.1f} us, certificate at rest p99 {:.1f}, constructed longest "
        "{:.1f}\n",
        own.contact_us, own.rest_us, own.longest_us);
    return figure;
}

}  // namespace axg::chart
