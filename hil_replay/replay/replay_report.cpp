// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/replay/replay_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "core/base/sincos.hpp"
#include "hil_replay/replay/body_triangles.hpp"
#include "hil_replay/replay/format_escapes.hpp"
#include "hil_replay/replay/replay_csv.hpp"

namespace axg {
namespace {

constexpr std::size_t kListed = 4096;  // touching pairs of triangles that are sorted and named
constexpr double kWithinMm = 50.0;

double us(std::int64_t ns) {
    return static_cast<double>(ns) * 1e-3;
}

std::string axes_text(const Machine& machine, const AxisSnapshot& snapshot) {
    if (snapshot.axis_count == 0) {
        return "no complete sample before it";
    }
    std::string text;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const bool rotary = machine.axes[i].kind == AxisKind::rotary;
        text += fmt::format("{}{} {:.4f}{}", text.empty() ? "" : ", ", machine.axes[i].name,
                            snapshot.position[i] * (rotary ? 180.0 / kPi : 1.0),
                            rotary ? " deg" : " mm");
    }
    return text;
}

nlohmann::ordered_json axes_json(const Machine& machine, const AxisSnapshot& snapshot) {
    auto axes = nlohmann::ordered_json::object();
    for (std::size_t i = 0; i < snapshot.axis_count; ++i) {  // none: no complete sample before
        const bool rotary = machine.axes[i].kind == AxisKind::rotary;
        axes[machine.axes[i].name + (rotary ? "_deg" : "_mm")] =
            snapshot.position[i] * (rotary ? 180.0 / kPi : 1.0);
    }
    return axes;
}

/// One pair at the moment of a stop, queried again in full.
struct PairAtStop {
    std::uint32_t pair = kNoIndex;
    std::uint32_t touching = 0;
    bool is_cut_short = false;           // a list was full: at least so many
    std::vector<TriangleIds> triangles;  // the first few, lowest indices first
    double clearance_mm = 0;             // kWithinMm: nothing nearer
    double margin_mm = 0;
    Containment containment = Containment::not_proven;
};

PairAtStop look_at(const ReplayReport& report, const BodyTriangles& named,
                   const PairQueries& pair_queries, std::uint32_t place) {
    PairAtStop out;
    out.pair = pair_queries.pair[place];
    out.margin_mm = report.loaded.machine.pairs[out.pair].margin_mm;
    Query query = pair_queries.queries[place];
    QueryResult result;
    ContainmentResult contained;
    report.engine.run({&query, 1}, {&result, 1});
    report.containment_test.run({&query, 1}, {&result, 1}, {&contained, 1});
    out.containment = contained.containment;
    query.kind = QueryKind::clearance;
    query.r_mm = kWithinMm;
    report.engine.run({&query, 1}, {&result, 1});
    out.clearance_mm = result.clearance_mm;
    std::vector<TriangleIds> list(kListed);
    query.kind = QueryKind::touching;
    query.r_mm = 0;
    query.list = list;
    report.engine.run({&query, 1}, {&result, 1});
    out.touching = result.touching;
    out.is_cut_short = result.status != QueryStatus::ok;
    list.resize(std::min<std::size_t>(result.touching, kListed));
    for (TriangleIds& ids : list) {
        ids = named.of(query, ids);
    }
    std::sort(list.begin(), list.end());
    list.resize(std::min<std::size_t>(list.size(), 8));
    out.triangles = std::move(list);
    return out;
}

bool is_contained(const PairAtStop& pair) {
    return pair.containment == Containment::a_in_b || pair.containment == Containment::b_in_a;
}

/// The inner body's name first.
std::pair<std::string, std::string> nested_names(const Machine& machine, const PairAtStop& pair) {
    const std::string& a = machine.bodies[machine.pairs[pair.pair].a].name;
    const std::string& b = machine.bodies[machine.pairs[pair.pair].b].name;
    return pair.containment == Containment::a_in_b ? std::pair{a, b} : std::pair{b, a};
}

/// Every pair within kWithinMm or nested at the moment of a stop, nearest first.
std::vector<PairAtStop> pairs_at(const ReplayReport& report, const StopEvent& stop) {
    std::vector<PairAtStop> out;
    const BodyTriangles named(report.loaded);
    const auto pair_queries = std::make_unique<PairQueries>();
    make_contact_queries(report.loaded.machine, stop.snapshot, *pair_queries);
    for (std::uint32_t i = 0; pair_queries->status == SnapshotStatus::ok && i < pair_queries->count;
         ++i) {
        PairAtStop pair = look_at(report, named, *pair_queries, i);
        if (pair.clearance_mm < kWithinMm || is_contained(pair)) {
            out.push_back(std::move(pair));
        }
    }
    std::stable_sort(out.begin(), out.end(), [](const PairAtStop& a, const PairAtStop& b) {
        return a.clearance_mm < b.clearance_mm;
    });
    return out;
}

bool is_about_distance(StopReason reason) {
    return reason == StopReason::contact || reason == StopReason::contained ||
           reason == StopReason::predicted;
}

/// Were the machine to stand where it was then.
Escapes escapes_at(const ReplayReport& report, const StopEvent& stop) {
    AxisSnapshot snapshot = stop.snapshot;
    snapshot.mode = kModeStandstill;
    return find_escapes(report.loaded, report.engine.engine(), report.containment_test, snapshot);
}

std::string triangles_text(const PairAtStop& pair) {
    std::string text;
    for (const TriangleIds& t : pair.triangles) {
        text += fmt::format("{}{}/{}", text.empty() ? "" : " ", t.a, t.b);
    }
    return text + (pair.touching > pair.triangles.size() ? " ..." : "");
}

void print_stop(const ReplayReport& report, const StopEvent& stop, const char* title,
                std::FILE* words) {
    const Machine& machine = report.loaded.machine;
    fmt::print(words, "\n{} {:.6f} s, sample {}: {}", title,
               static_cast<double>(stop.time_us) * 1e-6, stop.snapshot.sample,
               to_text(stop.reason));
    if (stop.pair != kNoIndex) {
        fmt::print(words, ", {}", pair_name(machine, stop.pair));
    }
    if (stop.reason == StopReason::input) {
        const FaultRow& row = fault_row(stop.fault);
        fmt::print(words, ", {}: {}", row.name, row.meaning);
    }
    fmt::print(words, "\n  {}\n", axes_text(machine, stop.snapshot));
    if (!is_about_distance(stop.reason)) {
        return;
    }
    for (const PairAtStop& pair : pairs_at(report, stop)) {
        if (pair.touching != 0) {
            fmt::print(words, "  {:<18} {}{} pairs of triangles touch: {}\n",
                       pair_name(machine, pair.pair), pair.is_cut_short ? "at least " : "",
                       pair.touching, triangles_text(pair));
        } else if (is_contained(pair)) {
            const auto [inner, outer] = nested_names(machine, pair);
            fmt::print(words, "  {:<18} {} is inside {}, their surfaces at least {:.4f} mm apart\n",
                       pair_name(machine, pair.pair), inner, outer, pair.clearance_mm);
        } else {
            fmt::print(words, "  {:<18} clear by at least {:.4f} mm, margin {:g} mm\n",
                       pair_name(machine, pair.pair), pair.clearance_mm, pair.margin_mm);
        }
    }
    const std::string escapes = format_escapes(machine, escapes_at(report, stop));
    if (!escapes.empty()) {
        fmt::print(words, "  {}\n", escapes);
    }
}

nlohmann::ordered_json stop_json(const ReplayReport& report, const StopEvent& stop) {
    const Machine& machine = report.loaded.machine;
    nlohmann::ordered_json out{{"time_us", stop.time_us},
                               {"sample", stop.snapshot.sample},
                               {"samples", stop.samples},
                               {"reason", to_text(stop.reason)}};
    if (stop.pair != kNoIndex) {
        out["pair"] = pair_name(machine, stop.pair);
    }
    if (stop.reason == StopReason::input) {
        out["fault"] = fault_row(stop.fault).name;
    }
    out["axes"] = axes_json(machine, stop.snapshot);
    if (is_about_distance(stop.reason)) {
        auto& pairs = out["pairs"] = nlohmann::ordered_json::array();
        for (const PairAtStop& pair : pairs_at(report, stop)) {
            nlohmann::ordered_json triangles = nlohmann::ordered_json::array();
            for (const TriangleIds& t : pair.triangles) {
                triangles.push_back({t.a, t.b});
            }
            pairs.push_back({{"pair", pair_name(machine, pair.pair)},
                             {"clearance_mm", pair.clearance_mm},
                             {"margin_mm", pair.margin_mm},
                             {"touching", pair.touching},
                             {"touching_cut_short", pair.is_cut_short},
                             {"triangles", std::move(triangles)}});
            if (is_contained(pair)) {
                pairs.back()["inside"] = nested_names(machine, pair).first;
            }
        }
        out["escapes"] = escapes_json(machine, escapes_at(report, stop));
    }
    return out;
}

nlohmann::ordered_json time_json(const TimeHistogram& time) {
    return {{"count", time.count()},
            {"avg_us", time.mean_ns() * 1e-3},
            {"min_us", us(time.least_ns())},
            {"max_us", us(time.most_ns())},
            {"p99_us", us(time.at_share_ns(0.99))}};
}

void print_times(const ReplayReport& report, std::FILE* words) {
    const Machine& machine = report.loaded.machine;
    fmt::print(words, "\nus per question   {:>9} {:>9} {:>9} {:>9}   samples not proven\n", "AVG",
               "MIN", "MAX", "p99");
    const auto line = [words](const std::string& name, const TimeHistogram& t) {
        fmt::print(words, "{:<17} {:>9.3f} {:>9.3f} {:>9.3f} {:>9.3f}", name, t.mean_ns() * 1e-3,
                   us(t.least_ns()), us(t.most_ns()), us(t.at_share_ns(0.99)));
    };
    double sum_ns = 0;
    for (std::uint32_t i = 0; i < machine.pairs.size(); ++i) {
        const PairStatistics& pair = report.run.pairs()[i];
        if (pair.time.count() == 0) {  // of some machines with travel proofs, or an empty spindle
            fmt::print(words, "{:<17} not asked about\n", pair_name(machine, i));
            continue;
        }
        line(pair_name(machine, i), pair.time);
        fmt::print(words, "   {}\n", pair.not_proven);
        sum_ns += pair.time.mean_ns();
    }
    line("cycle", report.run.cycles());
    fmt::print(words, "   sum of averages {:.3f}\n", sum_ns * 1e-3);
}

/// Of whole batches: a pair has no time of its own.
void print_not_proven(const ReplayReport& report, std::FILE* words) {
    const Machine& machine = report.loaded.machine;
    fmt::print(words, "samples not proven\n");
    for (std::uint32_t i = 0; i < machine.pairs.size(); ++i) {
        fmt::print(words, "  {:<17} {}\n", pair_name(machine, i), report.run.pairs()[i].not_proven);
    }
}

void print_cycles(const ReplayReport& report, std::FILE* words) {
    const TimeHistogram& t = report.run.cycles();
    fmt::print(words, "us a cycle: median {:.1f}, p99 {:.1f}, most {:.1f}\n",
               us(t.at_share_ns(0.5)), us(t.at_share_ns(0.99)), us(t.most_ns()));
}

void print_batches(const ReplayReport& report, std::FILE* words) {
    fmt::print(words, "\nall pairs of a sample are one batch\n");
    print_not_proven(report, words);
    print_cycles(report, words);
}

void print_proofs(const ReplayReport& report, std::FILE* words) {
    const Machine& machine = report.loaded.machine;
    const ProofStatistics& proofs = report.run.proofs();
    fmt::print(words, "\nproven to standstill, {:.3f} ms after each sample at the latest\n",
               free_seconds(machine) * 1e3);
    print_not_proven(report, words);
    const auto line = [words](const char* name, const CountTable& table, std::uint32_t most) {
        fmt::print(words, "{} a cycle: median {}, p99 {}, most {}\n", name, table.at_share(0.5),
                   table.at_share(0.99), most);
    };
    line("questions", proofs.queries, proofs.queries_most);
    line("rounds", proofs.rounds, proofs.rounds_most);
    print_cycles(report, words);
    if (proofs.withheld != 0) {
        fmt::print(words, "the permit was kept back for {} samples without a stop\n",
                   proofs.withheld);
    }
}

nlohmann::ordered_json proofs_json(const ReplayReport& report) {
    const ProofStatistics& proofs = report.run.proofs();
    const auto counts = [](const CountTable& table, std::uint32_t most) {
        return nlohmann::ordered_json{
            {"median", table.at_share(0.5)}, {"p99", table.at_share(0.99)}, {"max", most}};
    };
    return {{"horizon_ms", free_seconds(report.loaded.machine) * 1e3},
            {"questions", counts(proofs.queries, proofs.queries_most)},
            {"rounds", counts(proofs.rounds, proofs.rounds_most)},
            {"withheld", proofs.withheld}};
}

void print_clearance_levels(const ReplayReport& report, std::FILE* words) {
    const Machine& machine = report.loaded.machine;
    const ClearanceLevelStatistics& clearance_levels = report.run.clearance_levels();
    fmt::print(words, "samples              {:>9} {:>9}\n", "slow", "warn");
    for (std::uint32_t i = 0; i < machine.pairs.size(); ++i) {
        const PairStatistics& pair = report.run.pairs()[i];
        fmt::print(words, "  {:<17}  {:>9} {:>9}\n", pair_name(machine, i), pair.slow, pair.warn);
    }
    fmt::print(words, "  {:<17}  {:>9} {:>9}   questions a sample: median {}, p99 {}, most {}\n",
               "worst of all", clearance_levels.slow, clearance_levels.warn,
               clearance_levels.queries.at_share(0.5), clearance_levels.queries.at_share(0.99),
               clearance_levels.queries_most);
}

nlohmann::ordered_json clearance_levels_json(const ReplayReport& report) {
    const ClearanceLevelStatistics& clearance_levels = report.run.clearance_levels();
    return {{"slow", clearance_levels.slow},
            {"warn", clearance_levels.warn},
            {"questions",
             {{"median", clearance_levels.queries.at_share(0.5)},
              {"p99", clearance_levels.queries.at_share(0.99)},
              {"max", clearance_levels.queries_most}}}};
}

const char* format_no_stop(bool is_stoppable) {
    return is_stoppable ? "\nno stop: every checked pair proven to keep its margin until the "
                          "machine stands, at all {} samples with a permit\n"
                        : "\nno stop: every checked pair proven clear of its margin at all {} "
                          "samples\n";
}

void print_deadline(const ReplayReport& report, std::FILE* words) {
    const ReplayRun& run = report.run;
    fmt::print(words, "deadline {} us: {} of {} cycles late\n", report.deadline_us, run.overruns(),
               run.cycles().count());
    if (run.interrupted() != 0) {
        fmt::print(
            words,
            "  {} more were late once and in time when repeated at once: another program had "
            "the processor\n",
            run.interrupted());
    }
    for (const SlowCycle& slow : run.slowest()) {
        if (slow.spent_ns > report.deadline_us * 1000) {
            fmt::print(words, "  {:.1f} us at {:.6f} s: {}\n", us(slow.spent_ns),
                       static_cast<double>(slow.snapshot.arrived_us) * 1e-6,
                       axes_text(report.loaded.machine, slow.snapshot));
        }
    }
}

void print_faults(const ReplayReport& report, std::FILE* words) {
    const ReceiverCounters& counters = report.run.receiver().counters();
    for (std::uint32_t i = 1; i < kReceiverFaults; ++i) {
        if (counters.faults[i] != 0) {
            const FaultRow& row = fault_row(static_cast<ReceiverFault>(i));
            fmt::print(words, "  {:<16} {:>8}   {} ({})\n", row.name, counters.faults[i],
                       row.meaning, to_text(row.severity));
        }
    }
}

}  // namespace

void print_replay(const ReplayReport& report, std::FILE* words) {
    const ReplayRun& run = report.run;
    const ReceiverCounters& counters = run.receiver().counters();
    fmt::print(words, "{}: {} frames, {} samples, {} lost, mode {}, engine {} {}\n", report.trace,
               run.frame_count(), counters.snapshots, counters.samples_lost,
               run.is_stoppable() ? "stoppable" : "contact", report.gpu.empty() ? "cpu" : "cuda",
               report.gpu.empty() ? report.engine.lanes() : report.gpu);
    print_faults(report, words);
    if (counters.snapshots == 0 && run.stop_count() == 0) {
        fmt::print(words,
                   "no complete sample of this machine's axes: wrong ids, format or data ids? "
                   "compare 'can:' in the machine file with the trace\n");
        return;
    }
    if (counters.snapshots != 0) {
        (run.is_stoppable()   ? print_proofs
         : report.gpu.empty() ? print_times
                              : print_batches)(report, words);
        if (run.has_clearance_levels()) {
            print_clearance_levels(report, words);
        }
        print_deadline(report, words);
    }
    if (run.withheld().samples != 0) {
        print_stop(report, run.withheld(), "NO PERMIT from", words);
        fmt::print(words, "  kept back for {} samples: the machine would not have moved\n",
                   run.withheld().samples);
    }
    if (run.stop_count() == 0 && (run.state().permits != 0 || run.withheld().samples == 0)) {
        fmt::print(words, fmt::runtime(format_no_stop(run.is_stoppable())),
                   run.is_stoppable() ? run.state().permits : run.cycles().count());
    }
    for (const StopEvent& stop : run.stops()) {
        print_stop(report, stop, "STOP at", words);
    }
    if (run.stop_count() > run.stops().size()) {
        fmt::print(words, "\n... and {} more\n", run.stop_count() - run.stops().size());
    }
}

nlohmann::ordered_json describe_replay(const ReplayReport& report) {
    const ReplayRun& run = report.run;
    const Machine& machine = report.loaded.machine;
    const ReceiverCounters& counters = run.receiver().counters();
    nlohmann::ordered_json out{{"trace", report.trace},
                               {"machine", machine.name},
                               {"mode", run.is_stoppable() ? "stoppable" : "contact"},
                               {"engine", report.gpu.empty() ? "cpu" : "cuda"},
                               {"lanes", report.engine.lanes()},
                               {"gpu", report.gpu},
                               {"frames", run.frame_count()},
                               {"samples", counters.snapshots},
                               {"samples_lost", counters.samples_lost},
                               {"permits", run.state().permits},
                               {"deadline_us", report.deadline_us},
                               {"overruns", run.overruns()},
                               {"interrupted", run.interrupted()}};
    auto& faults = out["receiver_faults"] = nlohmann::ordered_json::object();
    for (std::uint32_t i = 1; i < kReceiverFaults; ++i) {
        if (counters.faults[i] != 0) {
            faults[fault_row(static_cast<ReceiverFault>(i)).name] = counters.faults[i];
        }
    }
    auto& pairs = out["pairs"] = nlohmann::ordered_json::object();
    const bool has_times = !run.is_stoppable() && report.gpu.empty();
    for (std::uint32_t i = 0; i < machine.pairs.size(); ++i) {
        pairs[pair_name(machine, i)] =
            has_times ? time_json(run.pairs()[i].time) : nlohmann::ordered_json::object();
        pairs[pair_name(machine, i)]["not_proven"] = run.pairs()[i].not_proven;
        if (run.has_clearance_levels()) {
            pairs[pair_name(machine, i)]["slow"] = run.pairs()[i].slow;
            pairs[pair_name(machine, i)]["warn"] = run.pairs()[i].warn;
        }
    }
    if (run.has_clearance_levels()) {
        out["levels"] = clearance_levels_json(report);
    }
    if (run.is_stoppable()) {
        out["proofs"] = proofs_json(report);
    }
    out["cycle"] = time_json(run.cycles());
    out["cycle"]["median_us"] = us(run.cycles().at_share_ns(0.5));
    auto& slowest = out["slowest"] = nlohmann::ordered_json::array();
    for (const SlowCycle& slow : run.slowest()) {
        slowest.push_back({{"us", us(slow.spent_ns)},
                           {"time_us", slow.snapshot.arrived_us},
                           {"axes", axes_json(machine, slow.snapshot)}});
    }
    auto& stops = out["stops"] = nlohmann::ordered_json::array();
    for (const StopEvent& stop : run.stops()) {
        stops.push_back(stop_json(report, stop));
    }
    out["stop_count"] = run.stop_count();
    if (run.withheld().samples != 0) {
        out["kept_back"] = stop_json(report, run.withheld());
    }
    return out;
}

}  // namespace axg
