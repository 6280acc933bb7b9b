// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/chart/speed_accuracy_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "hil_replay/lab/chart/scatter_picture.hpp"

namespace axg::chart {
namespace {

// Smallest depth drawn (double rounds smaller ones away), the place of "none", the upper end.
constexpr double kLeastUm = 1e-9, kNoneUm = 1e-11, kMostUm = 1e6;

/// Labels of methods. Any other method's label is its kernel's name.
constexpr std::array<std::pair<std::string_view, std::string_view>, 16> kWords = {{
    {"certified-shared-f32", "axguard stage 1"},
    {"certified-f32", "axguard float"},
    {"certified-f32+f64", "axguard recheck"},
    {"paper-6-11", "seed paper"},
    {"sat17-normalised-eps", "17 axes, epsilon"},
    {"sat17", "17 axes"},
    {"sat11", "11 axes"},
    {"moller", "Möller"},
    {"held", "Held"},
    {"guigue-devillers", "Guigue-Devillers"},
    {"shen", "Shen"},
    {"tropp", "Tropp"},
    {"six-segment", "six segments"},
    {"pqp-distance", "PQP"},
    {"gjk", "GJK"},
    {"exact", "exact"},
}};

/// The larger of two means: contacts, which allow no early end, and pairs apart.
double ns_of(const MethodScore& m) {
    return std::max(m.ns_touching, m.ns_apart);
}

double drawn(double um, bool is_any) {
    return is_any ? std::max(um, kLeastUm) : kNoneUm;
}

/// The name without the suffixes for arithmetic and contraction.
std::string_view kernel_of(std::string_view name) {
    return name.substr(0, std::min(name.find("-f32"), name.find("-f64")));
}

bool is_double(const MethodScore& m) {
    return m.name.find("-f64") != std::string::npos;
}

std::string words_of(const MethodScore& m) {
    for (const auto& [name, words] : kWords) {
        if (name == (m.is_certified ? std::string_view(m.name) : kernel_of(m.name))) {
            return std::string(words);
        }
    }
    return std::string(kernel_of(m.name));
}

/// The fastest build of each method on this processor: with FMA if the processor has it.
std::vector<const MethodScore*> to_draw(std::span<const MethodScore> scores) {
    const bool has_fused =
        std::any_of(scores.begin(), scores.end(), [](const MethodScore& m) { return m.is_fused; });
    std::vector<const MethodScore*> out;
    for (const MethodScore& m : scores) {
        if (m.is_certified || m.is_fused == has_fused) {
            out.push_back(&m);
        }
    }
    return out;
}

MarkStyle style_of(const MethodScore& m) {
    return m.is_certified                      ? MarkStyle::ours
           : is_double(m)                      ? MarkStyle::other_double
           : kernel_of(m.name) == "paper-6-11" ? MarkStyle::paper
                                               : MarkStyle::other;
}

/// Marks and the lines from a method in float to the same in double.
void add_marks(ScatterPanel& panel, const std::vector<const MethodScore*>& methods,
               double (*height)(const MethodScore&), std::string (*words)(const MethodScore&)) {
    for (const MethodScore* const m : methods) {
        panel.marks.push_back({ns_of(*m), height(*m), style_of(*m),
                               is_double(*m) && !m->is_certified ? std::string() : words(*m)});
        for (std::size_t i = 0; i + 1 < panel.marks.size(); ++i) {
            if (!m->is_certified && !methods[i]->is_certified &&
                kernel_of(methods[i]->name) == kernel_of(m->name)) {
                panel.joined.emplace_back(i, panel.marks.size() - 1);
            }
        }
    }
    panel.pareto = pareto_of(panel.marks);
}

double missed_depth_um(const MethodScore& m) {
    return drawn(m.machine.deepest_missed_um, m.machine.missed > 0);
}

std::string missed_words(const MethodScore& m) {
    return m.machine.missed == 0 ? words_of(m)
                                 : fmt::format("{} {}", words_of(m), m.machine.missed);
}

/// Widest gap left undecided or called a contact: a guard stops in both cases.
double gap_um(const MethodScore& m) {
    return drawn(std::max(m.machine.widest_undecided_um, m.machine.farthest_false_hit_um),
                 m.machine.undecided_apart + m.machine.false_hits > 0);
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
    const std::vector<const MethodScore*> methods = to_draw(scores);
    double fast = HUGE_VAL, slow = 0;
    for (const MethodScore* const m : methods) {
        fast = std::min(fast, ns_of(*m));
        slow = std::max(slow, ns_of(*m));
    }
    ScatterPicture picture{
        .name = "speed-accuracy",
        .title = "Tests of two triangles: time against error",
        .x_label = "mean time of a pair, touching or apart, whichever is slower",
        .x_ticks =
            "'5 ns' 5, '10' 10, '20' 20, '50' 50, '100 ns' 100, '200' 200, '500' 500, "
            "'1 µs' 1e3, '10 µs' 1e4, '100 µs' 1e5",
        .x_low = fast / 1.5,
        .x_high = slow * 1.6,
        .size = {600, 880, 2},
        .legend = {{MarkStyle::ours, "axguard and exact arithmetic: proven, misses no contact"},
                   {MarkStyle::paper, "the seed paper's test, float"},
                   {MarkStyle::other, "other tests, float; number: contacts missed"},
                   {MarkStyle::other_double, "the same in double"}},
        .beneath = {cases, machine,
                    "all compiled with FMA; axguard in lanes, others a pair at a "
                    "time; dotted: no test is better in both"}};
    ScatterPanel missed{
        .title = "Danger: contacts missed",
        .y_label = "deepest contact missed",
        .y_ticks =
            "'none' 1e-11, '≤ 1 fm' 1e-9, '1 pm' 1e-6, '1 nm' 1e-3, '1 µm' 1, '1 mm' 1e3, "
            "'1 m' 1e6",
        .y_low = kNoneUm / 10,
        .y_high = kMostUm,
        .bottom = 0.515,
        .top = 0.83,
        .better_x = 0.03,
        .better_y = 0.2};
    ScatterPanel undecided = missed;
    undecided.title = "Cost: gaps not told from a contact";
    undecided.y_label = "widest gap undecided";
    undecided.bottom = 0.125, undecided.top = 0.455;
    undecided.better_y = 0.04;
    add_marks(missed, methods, &missed_depth_um, &missed_words);
    add_marks(undecided, methods, &gap_um, &words_of);
    picture.panels = {std::move(missed), std::move(undecided)};
    return scatter_script(picture);
}

}  // namespace axg::chart
