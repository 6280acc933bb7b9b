// SPDX-License-Identifier: Apache-2.0
// Time of a whole cycle against its loss, in two panels: contact (yes or no), compared with other
// libraries, and a stop in time. This host measures axguard's cycles; all others come from records
// (cycle-records.csv), each row with its source.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <string_view>

#include "core/certificate/stop_certificate.hpp"
#include "firmware_if/setup/choose_plan.hpp"
#include "firmware_if/setup/measure_cycle.hpp"
#include "hil_replay/lab/bench/csv_table.hpp"
#include "hil_replay/lab/chart/figures.hpp"
#include "hil_replay/lab/chart/processor.hpp"
#include "hil_replay/lab/chart/scatter_picture.hpp"
#include "hil_replay/plan/plan_measure.hpp"

namespace axg::chart {
namespace {

constexpr double kExactMm = 0.01;  // the place of exact methods
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

MarkStyle style_of(std::string_view kind) {
    return kind == "ours"        ? MarkStyle::ours
           : kind == "paper"     ? MarkStyle::paper
           : kind == "predicted" ? MarkStyle::predicted
                                 : MarkStyle::other;
}

/// Adds the row as a mark to its panel, and as a line with the measured time to `table`.
bool add_row(const CsvTable& records, std::size_t row, const OwnTimes& own, ScatterPanel& contact,
             ScatterPanel& stop, std::string& table) {
    double us = 0, early_mm = 0, missed = 0;
    if (!read_us(records.cell(row, 4), own, us) || !read_number(records.cell(row, 5), early_mm) ||
        !read_number(records.cell(row, 6), missed)) {
        return false;
    }
    const std::string_view statistic = records.cell(row, 3);
    std::string words(records.cell(row, 1));
    if (statistic != "p99" && statistic != "constructed") {
        words += fmt::format(" ({})", statistic);
    }
    ScatterPanel& panel = records.cell(row, 0) == "contact" ? contact : stop;
    panel.marks.push_back(
        {us, std::max(early_mm, kExactMm), style_of(records.cell(row, 2)), words});
    table += fmt::format("{},{},{},{},{:.6g},{:.6g},{:.0f},{}\n", records.cell(row, 0),
                         records.cell(row, 1), records.cell(row, 2), statistic, us, early_mm,
                         missed, records.cell(row, 7));
    return true;
}

ScatterPicture picture_of(ScatterPanel contact, ScatterPanel stop) {
    ScatterPicture picture{
        .name = "cycle-accuracy",
        .title = "Whole cycles: time against early stops",
        .x_label = "time of a cycle of eight pairs; p99 unless stated",
        .x_ticks =
            "'0.1' 0.1, '1 µs' 1, '10 µs' 10, '100 µs' 100, '1 ms' 1e3, '10 ms' 1e4, "
            "'100 ms' 1e5",
        .x_low = 0.1,
        .x_high = 3e5,
        .size = {600, 860, 2},
        .legend = {{MarkStyle::ours, "axguard, proven"},
                   {MarkStyle::paper, "the seed paper's test of every pair of triangles"},
                   {MarkStyle::other, "other libraries, volumes, contact mode"},
                   {MarkStyle::predicted, "predicted, not measured"}},
        .beneath = {"measured here: contact mode, positions only, longest cycle;",
                    format_processor() + "; the rest: records",
                    "dotted: nothing is better in both"}};
    contact.title = "Is there a contact? (yes or no)";
    contact.y_label = "clearance called contact";
    contact.y_ticks = "'none' 0.01, '0.1 mm' 0.1, '1 mm' 1, '10 mm' 10, '100 mm' 100";
    contact.y_low = 0.003, contact.y_high = 3000;
    contact.bottom = 0.52, contact.top = 0.83;
    stop.title = "Can it still stop in time?";
    stop.y_label = "stops early by (median)";
    stop.y_ticks = "'0.1 mm' 0.1, '1 mm' 1, '10 mm' 10, '100 mm' 100, 'touches' 1000";
    stop.y_low = 0.03, stop.y_high = 30000;
    stop.bottom = 0.13, stop.top = 0.46;
    contact.better_y = 0.3;
    for (ScatterPanel* const panel : {&contact, &stop}) {
        panel->wall_x = kDeadlineUs;
        panel->wall_words = kDeadlineWords;
        panel->pareto = pareto_of(panel->marks);
    }
    picture.panels = {std::move(contact), std::move(stop)};
    return picture;
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
    ScatterPanel contact, stop;
    for (std::size_t row = 0; row < records.row_count(); ++row) {
        if (!add_row(records, row, own, contact, stop, table)) {
            figure.fault = records.where(row) +
                           ": us, early_mm or missed is not a number (us may be contact, rest or "
                           "longest, which are measured). Correct the row.";
            return figure;
        }
    }
    figure.tables = {{"cycle-accuracy.csv", table}};
    figure.script = scatter_script(picture_of(std::move(contact), std::move(stop)));
    figure.words = fmt::format(
        "cycles here: contact p99 {:.1f} us, certificate at rest p99 {:.1f}, constructed longest "
        "{:.1f}\n",
        own.contact_us, own.rest_us, own.longest_us);
    return figure;
}

}  // namespace axg::chart
