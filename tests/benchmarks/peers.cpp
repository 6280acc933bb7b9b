// SPDX-License-Identifier: Apache-2.0
// Yes or no for all pairs of every pose of a scene: axguard's engine beside FCL, Bullet, ODE, Coal,
// one volume a body and the seed paper's test, on the same meshes, in one process, in the same
// passes. Time of a pose: the least of its passes, so that an interruption of the machine is not
// held against a library; caches are warm. Answers are compared with axguard's, which CGAL judges
// (tests/oracle/exact_scene.sh): contacts missed, and the widest clearance called a contact.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/benchmarks/peer.hpp"

namespace {

using namespace axg;
using axg::test::Peer;
using axg::test::Scene;

struct Options {
    std::string scene, csv, json, records;
    int passes = 9;
};

constexpr std::unique_ptr<Peer> (*kPeers[])(const Scene&) = {
    axg::test::make_axguard, axg::test::make_fcl,
#ifdef AXG_COAL
    axg::test::make_coal,
#endif
    axg::test::make_bullet,  axg::test::make_ode,     axg::test::make_paper,
    axg::test::make_boxes,   axg::test::make_spheres,
};

struct Column {
    std::unique_ptr<Peer> peer;
    std::vector<double> pose_us;     // least of the passes
    std::vector<std::uint8_t> hits;  // [pose][pair], of the last pass
};

double quantile(std::vector<double> values, double q) {
    std::sort(values.begin(), values.end());
    const auto last = static_cast<double>(values.size() - 1);
    return values[static_cast<std::size_t>(q * last + 0.5)];
}

constexpr double kWithinMm = 500;  // clearances are measured up to there

/// Against axguard's answers: contacts that a library does not see, and how far off it sees one.
struct Loss {
    long missed = 0, false_hits = 0;
    double widest_mm = 0;
};

Loss loss_of(const Column& column, const Column& judge, const std::vector<double>& clearances_mm) {
    Loss loss;
    for (std::size_t i = 0; i < column.hits.size(); ++i) {
        loss.missed += column.hits[i] < judge.hits[i] ? 1 : 0;
        if (column.hits[i] > judge.hits[i]) {
            ++loss.false_hits;
            loss.widest_mm = std::max(loss.widest_mm, clearances_mm[i]);
        }
    }
    return loss;
}

double clock_pair_us() {
    double least = 1e9;
    for (int i = 0; i < 1000; ++i) {
        const auto start = std::chrono::steady_clock::now();
        const auto end = std::chrono::steady_clock::now();
        least = std::min(least, std::chrono::duration<double, std::micro>(end - start).count());
    }
    return least;
}

void run_pass(const Scene& scene, Column& column) {
    const std::size_t bodies = scene.bodies.size();
    const std::size_t pairs = scene.pairs.size();
    // The library before this one has taken the cache: a few cycles without a clock bring it back,
    // or the first pose would be the slowest of every library.
    const std::uint32_t warm = std::min(10U, scene.pose_count);
    for (std::uint32_t pose = 0; pose < warm; ++pose) {
        column.peer->cycle({scene.placed.data() + pose * bodies, bodies},
                           {column.hits.data() + pose * pairs, pairs});
    }
    for (std::uint32_t pose = 0; pose < scene.pose_count; ++pose) {
        const std::span<const Pose> placed{scene.placed.data() + pose * bodies, bodies};
        const std::span<std::uint8_t> hit{column.hits.data() + pose * pairs, pairs};
        const auto start = std::chrono::steady_clock::now();
        column.peer->cycle(placed, hit);
        const auto end = std::chrono::steady_clock::now();
        const double us = std::chrono::duration<double, std::micro>(end - start).count();
        column.pose_us[pose] = std::min(column.pose_us[pose], us);
    }
}

/// Each pose and pair where a library differs from the first column; the first ones by name.
void print_disagreements(const Scene& scene, const std::vector<Column>& columns) {
    constexpr int kListed = 5;
    const std::size_t pairs = scene.pairs.size();
    for (std::size_t c = 1; c < columns.size(); ++c) {
        int count = 0;
        for (std::size_t i = 0; i < columns[c].hits.size(); ++i) {
            if (columns[c].hits[i] == columns[0].hits[i]) {
                continue;
            }
            if (count++ < kListed) {
                std::printf("  pose %zu pair %s: %s %d, %s %d\n", i / pairs,
                            scene.pairs[i % pairs].name.c_str(), columns[0].peer->name().c_str(),
                            columns[0].hits[i], columns[c].peer->name().c_str(),
                            columns[c].hits[i]);
            }
        }
        std::printf("%s differs from %s in %d of %zu answers\n", columns[c].peer->name().c_str(),
                    columns[0].peer->name().c_str(), count, columns[c].hits.size());
    }
}

void print_table(const Scene& scene, const std::vector<Column>& columns,
                 const std::vector<double>& clearances_mm, int passes) {
    std::printf("%u poses, %zu pairs, least of %d passes; a clock pair of %.3f us is included\n",
                scene.pose_count, scene.pairs.size(), passes, clock_pair_us());
    std::printf("%-24s %10s %10s %10s %10s %8s %10s %12s\n", "us a cycle, yes/no", "median", "p99",
                "slowest", "contacts", "missed", "false hits", "widest, mm");
    for (const Column& column : columns) {
        const Loss loss = loss_of(column, columns[0], clearances_mm);
        std::printf("%-24s %10.2f %10.2f %10.2f %10ld %8ld %10ld %12.2f\n",
                    column.peer->name().c_str(), quantile(column.pose_us, 0.5),
                    quantile(column.pose_us, 0.99), quantile(column.pose_us, 1.0),
                    static_cast<long>(std::count(column.hits.begin(), column.hits.end(), 1)),
                    loss.missed, loss.false_hits, loss.widest_mm);
    }
}

/// Rows for `axguard-lab chart --records`: one a library.
void write_records(const Options& options, const std::vector<Column>& columns,
                   const std::vector<double>& clearances_mm) {
    std::ofstream csv(options.records);
    csv << "panel,name,kind,statistic,us,early_mm,missed,source\n";
    for (const Column& column : columns) {
        const Loss loss = loss_of(column, columns[0], clearances_mm);
        const bool is_ours = &column == &columns[0];
        csv << "contact," << (is_ours ? "axguard" : column.peer->name()) << ','
            << (is_ours ? "ours" : "peer") << ",p99," << quantile(column.pose_us, 0.99) << ','
            << loss.widest_mm << ',' << loss.missed << ",peers\n";
    }
    if (!csv.flush()) {
        throw std::runtime_error(options.records + ": cannot write");
    }
}

void write_files(const Options& options, const Scene& scene, const std::vector<Column>& columns) {
    if (!options.csv.empty()) {
        std::ofstream csv(options.csv);
        csv << "pose";
        for (const Column& column : columns) {
            csv << ',' << column.peer->name() << " us";
        }
        csv << '\n';
        for (std::uint32_t pose = 0; pose < scene.pose_count; ++pose) {
            csv << pose;
            for (const Column& column : columns) {
                csv << ',' << column.pose_us[pose];
            }
            csv << '\n';
        }
        if (!csv.flush()) {
            throw std::runtime_error(options.csv + ": cannot write");
        }
    }
    if (!options.json.empty()) {
        std::ofstream json(options.json);
        json << "{\"poses\": " << scene.pose_count << ", \"pairs\": " << scene.pairs.size()
             << ", \"passes\": " << options.passes << ", \"us_per_cycle\": {";
        for (std::size_t c = 0; c < columns.size(); ++c) {
            json << (c == 0 ? "" : ", ") << '"' << columns[c].peer->name()
                 << "\": {\"median\": " << quantile(columns[c].pose_us, 0.5)
                 << ", \"p99\": " << quantile(columns[c].pose_us, 0.99)
                 << ", \"slowest\": " << quantile(columns[c].pose_us, 1.0) << '}';
        }
        json << "}}\n";
        if (!json.flush()) {
            throw std::runtime_error(options.json + ": cannot write");
        }
    }
}

Options parse(int argc, char** argv) {
    Options options;
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        if (argument == "--csv" && i + 1 < argc) {
            options.csv = argv[++i];
        } else if (argument == "--records" && i + 1 < argc) {
            options.records = argv[++i];
        } else if (argument == "--json" && i + 1 < argc) {
            options.json = argv[++i];
        } else if (argument == "--passes" && i + 1 < argc) {
            options.passes = std::atoi(argv[++i]);
        } else if (argument.rfind("--", 0) != 0 && options.scene.empty()) {
            options.scene = argument;
        } else {
            options.passes = 0;
        }
    }
    if (options.scene.empty() || options.passes < 1) {
        std::fprintf(stderr,
                     "usage: peers SCENE_DIR [--passes 9] [--csv F] [--json F] [--records F]\n"
                     "make a scene with axg_make_scene MACHINE.yaml SCENE_DIR --near\n");
        std::exit(2);
    }
    return options;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const Options options = parse(argc, argv);
        const Scene scene = axg::test::read_scene(options.scene);
        std::vector<Column> columns;
        for (const auto& make : kPeers) {
            Column column;
            column.peer = make(scene);
            column.pose_us.assign(scene.pose_count, std::numeric_limits<double>::infinity());
            column.hits.assign(scene.pose_count * scene.pairs.size(), 0);
            columns.push_back(std::move(column));
        }
        for (int pass = 0; pass < options.passes; ++pass) {
            for (Column& column : columns) {
                run_pass(scene, column);
            }
        }
        const std::vector<double> clearances_mm = axg::test::clearances_mm(scene, kWithinMm);
        print_table(scene, columns, clearances_mm, options.passes);
        print_disagreements(scene, columns);
        write_files(options, scene, columns);
        if (!options.records.empty()) {
            write_records(options, columns, clearances_mm);
        }
    } catch (const std::exception& error) {
        std::fprintf(stderr, "peers: %s\n", error.what());
        return 1;
    }
    return 0;
}
