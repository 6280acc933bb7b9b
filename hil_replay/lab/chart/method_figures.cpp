// SPDX-License-Identifier: Apache-2.0
// Speed against accuracy, and the failure maps: every method on the same pairs of triangles.
#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "hil_replay/lab/cases/pair_cases.hpp"
#include "hil_replay/lab/chart/failures_picture.hpp"
#include "hil_replay/lab/chart/figures.hpp"
#include "hil_replay/lab/chart/figures_json.hpp"
#include "hil_replay/lab/chart/method_scores.hpp"
#include "hil_replay/lab/chart/processor.hpp"
#include "hil_replay/lab/chart/speed_accuracy_picture.hpp"

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

    const std::string cases =
        fmt::format("{} pairs: {} of each of {} kinds, answers from exact arithmetic, seed {}",
                    book.f32.truth.size(), per_category, lab::pair_category_count(), request.seed);
    const Score& any = scores.front().machine;
    const std::string machine_like = fmt::format(
        "{} pairs within 4 m and longer than 1 µm, of {} of each of {} kinds, seed {}",
        any.intersecting + any.apart, per_category, lab::pair_category_count(), request.seed);
    Figure speed{.name = "speed-accuracy"};
    speed.tables = {{"speed-accuracy.csv", speed_accuracy_table(scores)}};
    speed.script = speed_accuracy_script(
        scores, machine_like, fmt::format("{}, least of {} passes", format_processor(), passes));
    speed.summary = describe_methods(scores, passes, format_processor());
    Figure missed{.name = "missed-contacts"};
    missed.tables = {{"failure-map.csv", failure_map_table(scores)},
                     {"failing-cases.csv", failing_cases_table(scores, book, methods)}};
    missed.script = missed_script(scores, cases);
    missed.words = format_failing_cases(scores, book, methods);
    Figure apart{.name = "not-told-apart"};
    apart.script = not_told_apart_script(scores, cases);
    return {std::move(speed), std::move(missed), std::move(apart)};
}

}  // namespace axg::chart
