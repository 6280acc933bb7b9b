// SPDX-License-Identifier: Apache-2.0
// Number of triangle pairs that float leaves to double in one query, against the capacity of their
// list. On the paper's machine: random, near contact, sliding, and after a climb to the most.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <vector>

#include "hil_replay/lab/chart/figures.hpp"
#include "hil_replay/lab/chart/figures_json.hpp"
#include "hil_replay/lab/chart/posed_machine.hpp"

namespace axg::chart {
namespace {

using lab::Draw;

enum Family : std::size_t { kAnywhere, kNear, kSliding, kUphill, kFamilies };
constexpr std::array<const char*, kFamilies> kNames = {"anywhere", "near contact", "sliding",
                                                       "climb to the most"};
// Bin 0: none; bin i: from 2^(i-1) to 2^i - 1.
constexpr std::size_t kBins = 15;
// So large that no list overflows: each count is the need of a query.
constexpr Capacities kRoomy{
    .node_pairs = 1U << 18U, .triangle_pairs = 1U << 24U, .rechecks = 1U << 20U};

/// The query of a cycle that needs most rechecks, and the machine's position.
struct Need {
    std::uint32_t rechecks = 0, touching = 0, pair = 0;
    AxisSnapshot snapshot;
};

struct Counts {
    std::array<std::array<std::uint64_t, kBins>, kFamilies> cycles{};
    std::array<Need, kFamilies> worst{};
    std::array<std::uint64_t, kFamilies> over{};  // cycles with a query beyond the capacity
    std::uint32_t capacity = 0;

    void add(Family family, const Need& need) {
        ++cycles[family][std::min<std::size_t>(std::bit_width(need.rechecks), kBins - 1)];
        over[family] += need.rechecks > capacity ? 1 : 0;
        if (need.rechecks >= worst[family].rechecks) {
            worst[family] = need;
        }
    }
};

/// Queries every pair for all its touching triangles, so that no early end hides a recheck.
Need need_at(PosedMachine& posed, const AxisSnapshot& snapshot) {
    PairQueries& pair_queries = posed.pair_queries(snapshot);
    Need need{.snapshot = snapshot};
    for (std::uint32_t i = 0; pair_queries.status == SnapshotStatus::ok && i < pair_queries.count;
         ++i) {
        pair_queries.queries[i].kind = QueryKind::touching;
        QueryResult result;
        posed.engine().run({&pair_queries.queries[i], 1}, {&result, 1});
        if (result.rechecks >= need.rechecks) {
            need.rechecks = result.rechecks;
            need.touching = result.touching;
            need.pair = pair_queries.pair[i];
        }
    }
    return need;
}

/// The end of an approach along one linear axis, from quarter turns or from a random position.
AxisSnapshot contact(PosedMachine& posed, Draw& draw, bool squarely, std::size_t& axis) {
    for (;;) {
        axis = posed.some_linear_axis(draw);
        const AxisSnapshot from = squarely ? posed.square(draw) : posed.anywhere(draw);
        if (const auto at = posed.last_clear(from, axis, draw.sign() > 0)) {
            return *at;
        }
    }
}

/// Up to 10 um to either side of first contact, most of them far less.
AxisSnapshot near_contact(PosedMachine& posed, Draw& draw) {
    std::size_t axis = 0;
    AxisSnapshot snapshot = contact(posed, draw, false, axis);
    const double away_mm = draw.sign() * std::exp2(draw.between(-33, -6.64));
    snapshot.position[axis] = posed.within_travel(axis, snapshot.position[axis] + away_mm);
    return snapshot;
}

/// From flat faces within a rounding of contact, slides the other linear axes by whole millimetres.
AxisSnapshot sliding(PosedMachine& posed, Draw& draw) {
    std::size_t axis = 0;
    AxisSnapshot snapshot = contact(posed, draw, true, axis);
    for (std::size_t i = 0; i < snapshot.axis_count; ++i) {
        if (i != axis && posed.machine().axes[i].kind == AxisKind::linear) {
            snapshot.position[i] =
                posed.within_travel(i, snapshot.position[i] + std::round(draw.between(-40, 40)));
        }
    }
    return snapshot;
}

/// Random steps of 2^-36 to 2^5 from the worst position so far and from sliding positions, in turn.
/// Continues from a step unless it needs fewer rechecks.
void climb(PosedMachine& posed, Draw& draw, Counts& counts, std::uint64_t steps) {
    constexpr int kStarts = 8;
    for (int start = 0; start < kStarts; ++start) {
        const Need& worst =
            *std::max_element(counts.worst.begin(), counts.worst.end(),
                              [](const Need& a, const Need& b) { return a.rechecks < b.rechecks; });
        Need best = need_at(posed, start % 2 == 0 ? worst.snapshot : sliding(posed, draw));
        for (std::uint64_t step = 0; step < steps / kStarts; ++step) {
            AxisSnapshot snapshot = best.snapshot;
            const std::uint32_t axis = draw.below(snapshot.axis_count);
            snapshot.position[axis] = posed.within_travel(
                axis, snapshot.position[axis] + draw.sign() * std::exp2(draw.between(-36, 5)));
            const Need need = need_at(posed, snapshot);
            counts.add(kUphill, need);
            if (need.rechecks >= best.rechecks) {
                best = need;
            }
        }
    }
}

std::string table_of(const Counts& counts) {
    std::string out = "least_rechecks,most_rechecks";
    for (const char* const name : kNames) {
        out += fmt::format(",{}", name);
    }
    out += "\n";
    for (std::size_t bin = 0; bin < kBins; ++bin) {
        const std::uint64_t low = bin == 0 ? 0 : std::uint64_t{1} << (bin - 1);
        const std::uint64_t high = bin == 0 ? 0 : (std::uint64_t{1} << bin) - 1;
        out += fmt::format("{},{}", low, high);
        for (const auto& family : counts.cycles) {
            out += fmt::format(",{}", family[bin]);
        }
        out += "\n";
    }
    return out;
}

std::uint64_t total(const Counts& counts, std::size_t family) {
    return std::accumulate(counts.cycles[family].begin(), counts.cycles[family].end(),
                           std::uint64_t{0});
}

void describe(const PosedMachine& posed, const Counts& counts, Figure& out) {
    std::vector<RecheckNeeds> families;
    const Need* worst = &counts.worst[0];
    for (std::size_t f = 0; f < kFamilies; ++f) {
        const Need& need = counts.worst[f];
        families.push_back({kNames[f], posed.pair_name(need.pair),
                            posed.format_position(need.snapshot), total(counts, f), need.rechecks,
                            counts.over[f]});
        worst = need.rechecks > worst->rechecks ? &need : worst;
    }
    out.summary = describe_rechecks(counts.capacity, families);
    const std::string worst_at =
        posed.pair_name(worst->pair) + " at " + posed.format_position(worst->snapshot);
    out.words = fmt::format("most rechecks of one question: {} of {}, {}\n", worst->rechecks,
                            counts.capacity, worst_at);
    out.tables = {{"rechecks.csv", table_of(counts)}};
    out.conditions.emplace_back("recheck_capacity", std::to_string(counts.capacity));
    for (std::size_t f = 0; f < kFamilies; ++f) {
        out.conditions.emplace_back(fmt::format("most_rechecks {}", kNames[f]),
                                    std::to_string(counts.worst[f].rechecks));
    }
    out.conditions.emplace_back("worst_rechecks", worst_at);
}

}  // namespace

Figure rechecks_figure(const Request& request) {
    Figure out{.name = "rechecks"};
    const auto posed = PosedMachine::load(request.data + "/config/machines/paper-trunnion.yaml",
                                          kRoomy, out.fault);
    if (posed == nullptr) {
        return out;
    }
    Draw draw(request.seed);
    Counts counts{.capacity = Capacities{}.rechecks};
    const std::uint64_t cycles = request.is_quick ? 300 : 100000;
    for (std::uint64_t i = 0; i < cycles; ++i) {
        counts.add(kAnywhere, need_at(*posed, posed->anywhere(draw)));
    }
    for (std::uint64_t i = 0; i < cycles / 10; ++i) {
        counts.add(kNear, need_at(*posed, near_contact(*posed, draw)));
        counts.add(kSliding, need_at(*posed, sliding(*posed, draw)));
    }
    climb(*posed, draw, counts, cycles / 2);
    describe(*posed, counts, out);
    return out;
}

}  // namespace axg::chart
