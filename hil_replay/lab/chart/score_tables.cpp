// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/chart/score_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "hil_replay/lab/cases/pair_cases.hpp"

namespace axg::chart {
namespace {

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

}  // namespace

std::string speed_accuracy_table(std::span<const MethodScore> scores) {
    std::string out =
        "method,certified,fused,ns_a_pair,ns_touching,ns_apart,intersecting,apart,missed,"
        "deepest_missed_um,false_hits,false_hits_beyond_1_um,farthest_false_hit_um,undecided_hits,"
        "undecided_apart,widest_undecided_um\n";
    for (const MethodScore& m : scores) {
        const Score& s = m.machine;
        // The larger of two means: contacts, which allow no early end, and pairs apart.
        out += fmt::format(
            "{},{:d},{:d},{:.2f},{:.2f},{:.2f},{},{},{},{:.6g},{},{},{:.6g},{},{},{:.6g}\n", m.name,
            m.is_certified, m.is_fused, std::max(m.ns_touching, m.ns_apart), m.ns_touching,
            m.ns_apart, s.intersecting, s.apart, s.missed, s.deepest_missed_um, s.false_hits,
            s.far_false_hits, s.farthest_false_hit_um, s.undecided_hits, s.undecided_apart,
            s.widest_undecided_um);
    }
    return out;
}

std::string failure_map_table(std::span<const MethodScore> scores) {
    std::string out =
        "method,category,intersecting,missed,deepest_missed_um,apart,false_hits,"
        "farthest_false_hit_um,undecided_apart,widest_undecided_um,undecided_hits,"
        "beyond_1_um,false_hits_beyond_1_um,undecided_beyond_1_um\n";
    for (const MethodScore& m : scores) {
        for (std::size_t i = 0; i < m.by_category.size(); ++i) {
            const Score& s = m.by_category[i];
            if (&m != &scores.front() && s.missed + s.false_hits + s.undecided_apart == 0) {
                continue;  // the first method lists all categories, in their order
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

}  // namespace axg::chart
