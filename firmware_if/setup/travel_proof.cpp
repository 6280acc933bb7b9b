// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/setup/travel_proof.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

#include "core/certificate/stop_certificate.hpp"
#include "core/certificate/travel.hpp"
#include "core/collision/tree.hpp"
#include "core/guard/margin_advisory.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "firmware_if/setup/surface_list.hpp"
#include "firmware_if/setup/travel_sample.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kWholePair = 64;   // times the queries of a cluster
constexpr std::size_t kListed = 1U << 16;  // touching pairs of triangles looked at, a pose
// A surface of its own pays where a tree has more than two levels and loses half of its triangles:
// smaller ones are left whole (docs/measurements/travel.md).
constexpr std::size_t kSmallSurface = std::size_t{kNodeWidth} * kNodeWidth;

/// Neighbours on a surface: part of a list of its triangles.
struct Cluster {
    std::size_t first, count;
};

bool is_far(CpuEngine& engine, const Query& query) {
    QueryResult result;
    engine.run({&query, 1}, {&result, 1});
    return result.status == QueryStatus::ok && result.proof == Proof::far;
}

/// Whether the pair is farther apart than its margin everywhere in the box. Searches depth first,
/// so that it soon finds a pair that comes near. False also when `most` queries did not decide.
bool is_always_far(const Machine& machine, CpuEngine& engine, const JointBoxTask& task,
                   std::uint64_t most, std::uint64_t& queries) {
    std::array<Pose, kBodiesMax> moved;
    std::vector<JointBox> open{task.box};
    const std::uint64_t last = queries + most;
    while (!open.empty()) {
        if (queries >= last) {
            return false;
        }
        const JointBox box = open.back();
        open.pop_back();
        move_bodies(machine, box.centre, moved);
        const PlacedPair pair = placed_pair(task, moved);
        const PathMotion motion = motion_along(machine, task.path, moved, pair.a, pair.b, box);
        queries += 2;
        if (is_far(engine, query_of(task, pair, task.margin_mm + motion.total_mm))) {
            continue;
        }
        if (motion.widest_axis == kNoIndex ||
            !is_far(engine, query_of(task, pair, task.margin_mm))) {
            return false;  // near in the middle of the box already
        }
        for (const bool is_upper : {false, true}) {
            open.push_back(half_of(box, motion.widest_axis, is_upper, box));
        }
    }
    return true;
}

/// The triangles of a surface in the order of its tree: neighbours are next to each other.
std::vector<std::uint32_t> in_tree_order(const Mesh& mesh) {
    std::vector<std::uint32_t> out;
    const TreeData tree = build_tree(mesh.triangles);
    std::vector<bool> is_listed(mesh.triangles.size());
    for (const TreeLeaf& leaf : tree.leaves) {
        for (const std::uint32_t triangle : leaf.triangle) {  // copies fill it up
            if (!is_listed[triangle]) {
                is_listed[triangle] = true;
                out.push_back(triangle);
            }
        }
    }
    return out;
}

Mesh part_of(const Mesh& mesh, std::span<const std::uint32_t> triangles) {
    Mesh out{mesh.name, {}};
    for (const std::uint32_t i : triangles) {
        out.triangles.push_back(mesh.triangles[i]);
    }
    return out;
}

/// One pair with one tool.
class PairPruner {
  public:
    PairPruner(const LoadedMachine& loaded, const TravelEffort& effort, const JointBoxTask& task,
               const Mesh& a, const Mesh& b)
        : machine_(loaded.machine),
          capacities_(loaded.machine.capacities),
          effort_(effort),
          task_(task),
          mesh_{&a, &b} {
        capacities_.node_pairs = std::max(capacities_.node_pairs, 1U << 16);
        capacities_.triangle_pairs = std::max(capacities_.triangle_pairs, 1U << 18);
    }

    /// False: memory ran out.
    bool prune(KeptTriangles& out) {
        for (int side = 0; side < 2; ++side) {
            kept_[side] = in_tree_order(*mesh_[side]);
            is_near_[side].resize(mesh_[side]->triangles.size());
        }
        if (!look_around() || !prune_side(0, out.queries) || !prune_side(1, out.queries)) {
            return false;
        }
        out.a = std::move(kept_[0]);
        out.b = std::move(kept_[1]);
        std::sort(out.a.begin(), out.a.end());
        std::sort(out.b.begin(), out.b.end());
        return true;
    }

  private:
    /// Marks triangles that touch at some positions: no proof about them is possible.
    bool look_around() {
        std::optional<CpuEngine> engine = CpuEngine::create(mesh_, capacities_);
        if (!engine) {
            return false;
        }
        std::vector<TriangleIds> list(kListed);
        std::array<Pose, kBodiesMax> moved;
        JointBoxTask task = task_;
        task.mesh_a = 0;
        task.mesh_b = 1;
        for (std::uint32_t pose = 0; pose < effort_.poses; ++pose) {
            move_bodies(machine_, sampled_position(machine_, pose).position, moved);
            Query query = query_of(task, placed_pair(task, moved), task.margin_mm);
            query.kind = QueryKind::touching;
            query.list = list;
            QueryResult result;
            engine->run({&query, 1}, {&result, 1});
            for (std::size_t i = 0; i < std::min<std::size_t>(result.touching, list.size()); ++i) {
                is_near_[0][list[i].a] = true;
                is_near_[1][list[i].b] = true;
            }
        }
        return true;
    }

    /// Drops the clusters of one side that never collide with the remaining triangles of the other;
    /// halves the others, as long as `effort` allows.
    bool prune_side(int side, std::uint64_t& queries) {
        const std::vector<std::uint32_t>& order = kept_[side];
        const std::size_t least = std::max<std::size_t>(1, order.size() / effort_.clusters);
        std::vector<std::uint32_t> kept;
        std::vector<Cluster> open{{0, order.size()}}, next;
        while (!open.empty() && !order.empty()) {
            const std::optional<std::vector<bool>> never = are_never_colliding(side, open, queries);
            if (!never) {
                return false;
            }
            next.clear();
            for (std::size_t i = 0; i < open.size(); ++i) {
                const Cluster& cluster = open[i];
                const auto begin = order.begin() + static_cast<std::ptrdiff_t>(cluster.first);
                if ((*never)[i]) {
                    continue;
                }
                if (cluster.count <= least) {
                    kept.insert(kept.end(), begin,
                                begin + static_cast<std::ptrdiff_t>(cluster.count));
                    continue;
                }
                const std::size_t half = cluster.count / 2;
                next.push_back({cluster.first, half});
                next.push_back({cluster.first + half, cluster.count - half});
            }
            open.swap(next);
        }
        kept_[side] = std::move(kept);
        return true;
    }

    [[nodiscard]] bool has_near(int side, const Cluster& cluster) const {
        const auto begin = kept_[side].begin() + static_cast<std::ptrdiff_t>(cluster.first);
        return std::any_of(begin, begin + static_cast<std::ptrdiff_t>(cluster.count),
                           [&](std::uint32_t triangle) { return is_near_[side][triangle]; });
    }

    /// Whether each cluster never meets the other side's remaining triangles. Empty: no memory.
    std::optional<std::vector<bool>> are_never_colliding(int side,
                                                         std::span<const Cluster> clusters,
                                                         std::uint64_t& queries) {
        std::vector<bool> out(clusters.size());
        std::vector<Mesh> meshes{part_of(*mesh_[1 - side], kept_[1 - side])};
        std::vector<std::size_t> queried;
        for (std::size_t i = 0; i < clusters.size(); ++i) {
            if (meshes[0].triangles.empty()) {
                out[i] = true;  // the other side has no triangles left
            } else if (!has_near(side, clusters[i])) {
                queried.push_back(i);
                meshes.push_back(
                    part_of(*mesh_[side],
                            std::span(kept_[side]).subspan(clusters[i].first, clusters[i].count)));
            }
        }
        if (queried.empty()) {
            return out;
        }
        std::vector<const Mesh*> pointers;
        std::vector<BodyExtent> extents;
        for (const Mesh& mesh : meshes) {
            pointers.push_back(&mesh);
            extents.push_back(extent_of(mesh));
        }
        std::optional<CpuEngine> engine = CpuEngine::create(pointers, capacities_);
        if (!engine) {
            return std::nullopt;
        }
        JointBoxTask task = task_;
        const bool is_a = side == 0;
        (is_a ? task.mesh_b : task.mesh_a) = 0;
        (is_a ? task.extent_b : task.extent_a) = extents.data();
        for (std::uint32_t k = 0; k < queried.size(); ++k) {
            (is_a ? task.mesh_a : task.mesh_b) = k + 1;
            (is_a ? task.extent_a : task.extent_b) = &extents[k + 1];
            const bool is_whole = clusters.size() == 1;
            out[queried[k]] = is_always_far(
                machine_, *engine, task,
                std::uint64_t{effort_.queries} * (is_whole ? kWholePair : 1), queries);
        }
        return out;
    }

    const Machine& machine_;
    Capacities capacities_;
    TravelEffort effort_;
    JointBoxTask task_;
    std::array<const Mesh*, 2> mesh_;
    std::array<std::vector<std::uint32_t>, 2> kept_;
    std::array<std::vector<bool>, 2> is_near_;
};

/// Whether neither body is inside the other, of a pair whose surfaces never meet: the same at every
/// position, so one is queried.
bool is_outside(const Machine& machine, const JointBoxTask& task, CpuEngine& engine,
                const ContainmentTest& containment_test) {
    std::array<Pose, kBodiesMax> moved;
    move_bodies(machine, task.box.centre, moved);
    const Query query = query_of(task, placed_pair(task, moved), task.margin_mm);
    QueryResult result;
    engine.run({&query, 1}, {&result, 1});
    ContainmentResult inside;
    containment_test.run({&query, 1}, {&result, 1}, {&inside, 1});
    return inside.status == QueryStatus::ok && inside.containment == Containment::none;
}

}  // namespace

std::optional<std::vector<KeptTriangles>> prove_travel(
    const LoadedMachine& loaded, const TravelEffort& effort,
    const std::function<void(double share)>& on_progress) {
    const Machine& machine = loaded.machine;
    std::optional<CpuEngine> engine = make_engine(loaded);
    const std::optional<ContainmentTest> containment_test =
        engine ? make_containment_test(loaded, *engine) : std::nullopt;
    if (!containment_test) {
        return std::nullopt;
    }
    const std::vector<const Mesh*> meshes = surface_list(loaded).engines;
    std::vector<BodyExtent> extents;
    for (const Mesh* mesh : meshes) {
        extents.push_back(extent_of(*mesh));
    }
    std::vector<KeptTriangles> out;
    for (std::uint32_t i = 0; i < machine.pairs.size(); ++i) {
        const Pair& pair = machine.pairs[i];
        for (std::uint32_t k = 0; k < tasks_of(machine, pair); ++k) {
            KeptTriangles kept;
            kept.pair = i;
            kept.tool = has_tool(machine, pair) ? k : kNoIndex;
            JointBoxTask task = pair_task(machine, i, kept.tool, extents);
            task.box = travel_box(machine);
            task.margin_mm = kept.distance_mm = largest_query_mm(machine, pair);
            const Mesh &a = *meshes[task.mesh_a], &b = *meshes[task.mesh_b];
            kept.whole_a = static_cast<std::uint32_t>(a.triangles.size());
            kept.whole_b = static_cast<std::uint32_t>(b.triangles.size());
            if (has_usable_triangles(a) && has_usable_triangles(b) &&
                !PairPruner(loaded, effort, task, a, b).prune(kept)) {
                return std::nullopt;
            }
            kept.is_apart = kept.a.empty() || kept.b.empty();
            if (kept.is_apart && !is_outside(machine, task, *engine, *containment_test)) {
                kept.is_apart = false;  // cycles must detect whatever is wrong there
                kept.a.resize(kept.whole_a);
                kept.b.resize(kept.whole_b);
                std::iota(kept.a.begin(), kept.a.end(), 0U);
                std::iota(kept.b.begin(), kept.b.end(), 0U);
            }
            out.push_back(std::move(kept));
            if (on_progress) {
                on_progress(static_cast<double>(out.size()) / stop_tasks(machine));
            }
        }
    }
    return out;
}

void apply_travel(const std::vector<KeptTriangles>& kept, LoadedMachine& loaded) {
    Machine& machine = loaded.machine;
    const std::vector<const Mesh*> whole = surface_list(loaded).engines;
    std::vector<Mesh> fewer;
    const auto first = static_cast<std::uint32_t>(loaded.meshes.of_pairs.size());
    const auto keep = [&](const std::vector<std::uint32_t>& triangles, std::uint32_t mesh) {
        const Mesh& of = *whole[mesh];
        if (of.triangles.size() <= kSmallSurface || 2 * triangles.size() > of.triangles.size()) {
            return kNoIndex;
        }
        fewer.push_back(part_of(of, triangles));
        return first + static_cast<std::uint32_t>(fewer.size() - 1);
    };
    Travel travel = travel_of(machine);
    for (const KeptTriangles& of : kept) {
        const Pair& pair = machine.pairs[of.pair];
        TravelProof proof{.distance_mm = of.distance_mm, .is_apart = of.is_apart};
        if (!of.is_apart) {
            proof.surface_a = keep(of.a, mesh_in_pair(machine, pair.a, pair.b, of.tool));
            proof.surface_b = keep(of.b, mesh_in_pair(machine, pair.b, pair.a, of.tool));
        }
        travel.proofs.push_back(proof);
    }
    machine.travel = std::move(travel);
    loaded.meshes.of_pairs.insert(loaded.meshes.of_pairs.end(),
                                  std::make_move_iterator(fewer.begin()),
                                  std::make_move_iterator(fewer.end()));
}

}  // namespace axg
