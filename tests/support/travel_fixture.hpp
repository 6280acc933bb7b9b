// SPDX-License-Identifier: Apache-2.0
// Judges what travel proofs prune from a machine's pairs: by random positions of the whole
// travel, and by what cycles decide with and without them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/certificate/stop_certificate.hpp"
#include "core/certificate/travel.hpp"
#include "core/guard/margin_advisory.hpp"
#include "core/machine/kinematics.hpp"
#include "firmware_if/setup/surface_list.hpp"
#include "tests/support/count.hpp"
#include "tests/support/dice.hpp"
#include "tests/support/replay_fixture.hpp"
#include "tests/support/seed.hpp"

#include "firmware_if/setup/travel_proof.hpp"

namespace axg::test {

inline LoadedMachine load_or_fail(const std::string& file, const std::string& mesh_root = "") {
    LoadedMachine loaded;
    EXPECT_TRUE(load(file, mesh_root, loaded, stderr));
    return loaded;
}

/// The triangles of a surface that are not among `kept`.
inline Mesh left_out(const Mesh& mesh, const std::vector<std::uint32_t>& kept) {
    Mesh out{mesh.name, {}};
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        if (!std::binary_search(kept.begin(), kept.end(), i)) {
            out.triangles.push_back(mesh.triangles[i]);
        }
    }
    return out;
}

/// What was pruned from each pair, against all of its partner.
class Judge {
  public:
    Judge(const LoadedMachine& loaded, const std::vector<KeptTriangles>& kept)
        : machine_(loaded.machine) {
        const std::vector<const Mesh*> whole = surface_list(loaded).engines;
        meshes_.reserve(2 * kept.size());
        std::vector<const Mesh*> meshes = whole;
        for (const Mesh* mesh : whole) {
            extents_.push_back(extent_of(*mesh));
        }
        for (const KeptTriangles& of : kept) {
            const JointBoxTask task = pair_task(machine_, of.pair, of.tool, extents_);
            for (const bool is_a : {true, false}) {
                const std::uint32_t mesh = is_a ? task.mesh_a : task.mesh_b;
                meshes_.push_back(left_out(*whole[mesh], is_a ? of.a : of.b));
                if (meshes_.back().triangles.empty()) {
                    continue;
                }
                tasks_.push_back(task);
                tasks_.back().margin_mm = of.distance_mm;
                (is_a ? tasks_.back().mesh_a : tasks_.back().mesh_b) =
                    static_cast<std::uint32_t>(meshes.size());
                meshes.push_back(&meshes_.back());
            }
        }
        engine_.emplace(*CpuEngine::create(meshes, loaded.machine.capacities));
    }

    [[nodiscard]] std::size_t queries() const { return tasks_.size(); }

    /// Of the queries about `position`, those whose triangles came near.
    std::uint32_t hits(std::span<const double> position) {
        std::array<Pose, kBodiesMax> moved;
        move_bodies(machine_, position, moved);
        std::uint32_t count = 0;
        for (const JointBoxTask& task : tasks_) {
            Query query = query_of(task, placed_pair(task, moved), task.margin_mm);
            query.kind = QueryKind::touching;
            QueryResult result;
            engine_->run({&query, 1}, {&result, 1});
            count += result.proof == Proof::far ? 0 : 1;  // a full list is near, too
        }
        return count;
    }

  private:
    const Machine& machine_;
    std::vector<Mesh> meshes_;
    std::vector<BodyExtent> extents_;
    std::vector<JointBoxTask> tasks_;
    std::optional<CpuEngine> engine_;
};

/// Anywhere in the travel; each axis at one of its ends in a quarter of the positions, for there
/// things come nearest.
inline std::array<double, kAxesMax> drawn_position(const Machine& machine, Dice& dice) {
    const Travel travel = travel_of(machine);
    std::array<double, kAxesMax> out{};
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const double low = travel.low[i], high = travel.high[i];
        out[i] = machine.axes[i].unlimited ? dice.in(-10, 10)
                 : dice.chance(0.25)       ? (dice.chance(0.5) ? low : high)
                                           : dice.in(low, high);
    }
    return out;
}

struct Shown {
    std::uint64_t hits = 0, query_count = 0;
};
inline Shown judge(const LoadedMachine& loaded, const std::vector<KeptTriangles>& kept,
                   std::uint64_t positions) {
    Judge judge(loaded, kept);
    Dice dice(printed_seed(8));
    Shown out;
    for (std::uint64_t i = 0; i < positions; ++i) {
        out.hits += judge.hits(drawn_position(loaded.machine, dice));
        out.query_count += judge.queries();
    }
    return out;
}

inline void print_shares(const Machine& machine, const std::vector<KeptTriangles>& kept) {
    for (const KeptTriangles& of : kept) {
        const Pair& pair = machine.pairs[of.pair];
        std::printf("%s-%s: %s%zu of %u, %zu of %u kept; %llu questions\n",
                    machine.bodies[pair.a].name.c_str(), machine.bodies[pair.b].name.c_str(),
                    of.is_apart ? "apart; " : "", of.a.size(), of.whole_a, of.b.size(), of.whole_b,
                    static_cast<unsigned long long>(of.queries));
    }
}

/// The machine with half of each axis' travel, and nothing beyond.
inline LoadedMachine halved(LoadedMachine loaded) {
    loaded.machine.guard.overrun_mm = loaded.machine.guard.overrun_rad = 0;
    for (Axis& axis : loaded.machine.axes) {
        const double quarter = 0.25 * (axis.max - axis.min);
        axis.min += quarter;
        axis.max -= quarter;
    }
    return loaded;
}

inline void expect_nothing_near(const LoadedMachine& loaded, const std::vector<KeptTriangles>& kept,
                                const TravelEffort& effort, std::uint64_t positions) {
    const Shown shown = judge(loaded, kept, positions);
    std::printf("%llu positions, %llu questions: %llu hits\n",
                static_cast<unsigned long long>(positions),
                static_cast<unsigned long long>(shown.query_count),
                static_cast<unsigned long long>(shown.hits));
    EXPECT_GT(shown.query_count, 0U) << "nothing was left out: nothing was shown";
    EXPECT_EQ(shown.hits, 0U);
    const auto wrong = prove_travel(halved(loaded), effort);
    ASSERT_TRUE(wrong.has_value());
    const Shown found = judge(loaded, *wrong, std::min<std::uint64_t>(positions, 100'000));
    std::printf("of half the travel: %llu hits of %llu questions\n",
                static_cast<unsigned long long>(found.hits),
                static_cast<unsigned long long>(found.query_count));
    if (positions >= 1000) {
        EXPECT_GT(found.hits, 0U);
    }
}

/// What cycles at the same positions came to.
struct Cycles {
    std::vector<std::string> verdicts;  // a letter a pair: far, near
    std::vector<double> us;
    std::uint64_t queries = 0, node_pairs = 0, triangle_pairs = 0;
};

inline void print_cycles(const char* name, Cycles& cycles) {
    std::sort(cycles.us.begin(), cycles.us.end());
    const double count = static_cast<double>(cycles.us.size());
    std::printf(
        "%s: median %.2f us, p99 %.2f us; a cycle %.2f questions, %.1f pairs of nodes, %.1f "
        "of triangles\n",
        name, cycles.us[cycles.us.size() / 2], cycles.us[cycles.us.size() * 99 / 100],
        static_cast<double>(cycles.queries) / count, static_cast<double>(cycles.node_pairs) / count,
        static_cast<double>(cycles.triangle_pairs) / count);
}

/// One machine's guard, with or without its proofs, on an engine that counts.
class Guard {
  public:
    explicit Guard(const LoadedMachine& loaded)
        : machine_(loaded.machine),
          engine_(std::move(*make_engine(loaded))),
          containment_test_(std::move(*make_containment_test(loaded, engine_))),
          certificate_(std::move(*make_stop_certificate(loaded))) {
        counting_ = {this, [](void* self, std::span<const Query> queries,
                              std::span<QueryResult> results) noexcept {
                         auto& guard = *static_cast<Guard*>(self);
                         guard.engine_.run(queries, results);
                         guard.out.queries += queries.size();
                         for (const QueryResult& result : results) {
                             guard.out.node_pairs += result.node_pairs;
                             guard.out.triangle_pairs += result.triangle_pairs;
                         }
                     }};
    }

    void contact(const AxisSnapshot& snapshot) {
        const auto start = std::chrono::steady_clock::now();
        make_contact_queries(machine_, snapshot, contact_, QueryScope::needed);
        const std::span<const Query> queries{contact_.queries.data(), contact_.count + 2};
        counting_(queries, {results_.data(), queries.size()});
        containment_test_.run(queries.first(contact_.count), {results_.data(), contact_.count},
                              {inside_.data(), contact_.count});
        note_time(start);
        std::string verdict(machine_.pairs.size(), 'f');
        for (std::uint32_t i = 0; i < contact_.count; ++i) {
            if (results_[i].proof != Proof::far || inside_[i].containment != Containment::none) {
                verdict[contact_.pair[i]] = 'n';
            }
        }
        out.verdicts.push_back(verdict);
    }

    /// Of a machine that stands.
    void stoppable(AxisSnapshot snapshot) {
        for (std::uint32_t i = 0; i < kSamplesKept; ++i) {
            ++snapshot.sample;
            certificate_.note(snapshot, i == 0);
        }
        const auto start = std::chrono::steady_clock::now();
        certificate_.prove(counting_, containment_test_);
        note_time(start);
        certificate_.keep();
        std::string verdict(machine_.pairs.size(), 'f');
        for (const PairProof& proof : certificate_.cycle().proofs) {
            if (proof.surfaces.proof != JointBoxProof::proven ||
                proof.containment_result.containment != Containment::none) {
                verdict[proof.pair] = 'n';
            }
        }
        out.verdicts.push_back(verdict);
    }

    Cycles out;

  private:
    void note_time(std::chrono::steady_clock::time_point start) {
        const std::chrono::duration<double, std::micro> spent =
            std::chrono::steady_clock::now() - start;
        out.us.push_back(spent.count());
    }

    const Machine& machine_;
    CpuEngine engine_;
    ContainmentTest containment_test_;
    StopCertificate certificate_;
    Engine counting_;
    PairQueries contact_;
    std::vector<QueryResult> results_{kQueriesMax};
    std::vector<ContainmentResult> inside_{kPairsMax};
};

/// With proofs every pair is judged as without them, but for a stop's box that is proven a little
/// sooner with fewer triangles.
inline void expect_same_verdicts(const LoadedMachine& whole, const std::vector<KeptTriangles>& kept,
                                 std::uint64_t positions) {
    LoadedMachine proven = whole;
    apply_travel(kept, proven);
    for (const bool is_contact : {true, false}) {
        const auto before = std::make_unique<Guard>(whole), after = std::make_unique<Guard>(proven);
        Dice dice(printed_seed(9));
        AxisSnapshot snapshot;
        snapshot.axis_count = static_cast<std::uint32_t>(whole.machine.axes.size());
        for (std::uint64_t i = 0; i < positions; ++i) {
            snapshot.position = drawn_position(whole.machine, dice);
            for (Guard* guard : {before.get(), after.get()}) {
                is_contact ? guard->contact(snapshot) : guard->stoppable(snapshot);
            }
        }
        std::uint64_t sooner = 0, later = 0;
        for (std::size_t i = 0; i < positions; ++i) {
            for (std::size_t k = 0; k < before->out.verdicts[i].size(); ++k) {
                const char was = before->out.verdicts[i][k], is = after->out.verdicts[i][k];
                sooner += was == 'n' && is == 'f' ? 1 : 0;
                later += was == 'f' && is == 'n' ? 1 : 0;
            }
        }
        std::printf("%s: %llu pairs proven with the proofs alone, %llu without alone\n",
                    is_contact ? "contact" : "stoppable", static_cast<unsigned long long>(sooner),
                    static_cast<unsigned long long>(later));
        print_cycles("  whole", before->out);
        print_cycles("  with proofs", after->out);
        EXPECT_EQ(later, 0U);
        EXPECT_TRUE(!is_contact || sooner == 0) << "no position was judged otherwise";
        EXPECT_LE(after->out.queries, before->out.queries);
    }
}

/// What the records are made with: many times the usual effort.
inline constexpr TravelEffort kThorough{.poses = 2048, .clusters = 1024, .queries = 2048};

/// All of that about one machine.
inline void judge_travel(const LoadedMachine& loaded, std::uint64_t positions) {
    const TravelEffort effort = positions > 100'000 ? kThorough : TravelEffort{};
    const auto start = std::chrono::steady_clock::now();
    const auto kept = prove_travel(loaded, effort);
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
    ASSERT_TRUE(kept.has_value());
    print_shares(loaded.machine, *kept);
    std::printf("proven in %.1f s\n", spent.count());
    expect_nothing_near(loaded, *kept, effort, positions);
    expect_same_verdicts(loaded, *kept, std::min<std::uint64_t>(positions, 20'000));
}

}  // namespace axg::test
