// SPDX-License-Identifier: Apache-2.0
// Speed against accuracy, and the failure maps: every method on the same pairs of triangles.
#include <algorithm>
#include <vector>

#include "hil_replay/lab/cases/pair_cases.hpp"
#include "hil_replay/lab/chart/figures.hpp"
#include "hil_replay/lab/chart/figures_json.hpp"
#include "hil_replay/lab/chart/method_scores.hpp"
#include "hil_replay/lab/chart/processor.hpp"
#include "hil_replay/lab/chart/score_tables.hpp"

namespace axg::chart {
namespace {

/// Omits boxes and spheres: they are filters, and no bound limits the gaps they leave undecided.
std::vector<const lab::Method*> methods_to_chart() {
    std::vector<const lab::Method*> out;
    for (const lab::Method& method : lab::methods()) {
        if (!method.bounding_volume) {
            out.push_back(&method);
        }
    }
    return out;
}

}  // namespace

std::vector<Figure> method_figures(const Request& request) {
    const std::size_t per_category = request.is_quick ? 8 : 1000;
    const unsigned passes = request.is_quick ? 1 : 9;
    const CaseBook book = make_case_book(request.seed, per_category);
    const std::vector<const lab::Method*> methods = methods_to_chart();
    std::vector<MethodScore> scores;
    for (const lab::Method* const method : methods) {
        scores.push_back(score_of(*method, book));
    }
    time_methods(book, methods, passes, scores);

    Figure speed{.name = "speed-accuracy"};
    speed.tables = {{"speed-accuracy.csv", speed_accuracy_table(scores)}};
    speed.conditions = {{"pairs_of_each_kind", std::to_string(per_category)},
                        {"kinds", std::to_string(lab::pair_category_count())},
                        {"passes", std::to_string(passes)}};
    speed.summary = describe_methods(scores, passes, format_processor());
    Figure missed{.name = "missed-contacts"};
    missed.tables = {{"failure-map.csv", failure_map_table(scores)},
                     {"failing-cases.csv", failing_cases_table(scores, book, methods)}};
    missed.words = format_failing_cases(scores, book, methods);
    return {std::move(speed), std::move(missed), {.name = "not-told-apart"}};
}

}  // namespace axg::chart
