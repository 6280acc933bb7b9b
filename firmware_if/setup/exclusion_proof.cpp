// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/setup/exclusion_proof.hpp"

#include <algorithm>
#include <utility>

#include "core/certificate/pair_queries.hpp"
#include "core/certificate/pair_tasks.hpp"
#include "core/certificate/travel.hpp"
#include "core/collision/containment.hpp"
#include "core/collision/cpu_engine.hpp"
#include "firmware_if/setup/near_proof.hpp"
#include "firmware_if/setup/pose_errors.hpp"
#include "firmware_if/setup/surface_list.hpp"
#include "firmware_if/setup/travel_sample.hpp"

namespace axg {
namespace {

constexpr std::size_t kTriedPairs = 512;  // touching pairs of triangles looked at, a pose
constexpr std::size_t kRemembered = 16;   // pairs that proved a box lately
constexpr double kFarthestMm = 1000;      // no pair is proven farther apart
// Of the least clearance found: what is to be proven, as each quarter of the queries is used; and
// no less than this. A gap just above kContactMm leaves each box only the rest of it for its
// motion, however long the travel: the last quarter proves less than kContactMm.
constexpr std::array<double, 4> kShares{0.9, 0.5, 0.2, 0};
constexpr std::array<double, 4> kLeastMm{kContactMm, kContactMm, kContactMm, kContactMm / 4};
constexpr std::uint64_t kShownEach = 64;  // queries

enum class Place : std::uint8_t { unknown, near, apart };

struct Surfaces {
    std::vector<const Mesh*> meshes;
    std::vector<BodyExtent> extents;
    CpuEngine engine;
    ContainmentTest containment_test;
};

/// The whole surfaces of bodies and tools, in the order of mesh_in_pair.
std::optional<Surfaces> whole_surfaces(const LoadedMachine& loaded) {
    const SurfaceList list = surface_list(loaded);
    std::vector<const Mesh*> meshes = list.whole;
    meshes.resize(list.body_count + list.tool_count);
    Capacities capacities = loaded.machine.capacities;
    capacities.node_pairs = std::max(capacities.node_pairs, 1U << 16U);
    capacities.triangle_pairs = std::max(capacities.triangle_pairs, 1U << 18U);
    std::optional<CpuEngine> engine = CpuEngine::create(meshes, capacities);
    if (!engine) {
        return std::nullopt;
    }
    std::optional<ContainmentTest> test =
        ContainmentTest::create(meshes, engine->trees(), capacities);
    if (!test) {
        return std::nullopt;
    }
    std::vector<BodyExtent> extents;
    for (const Mesh* mesh : meshes) {
        extents.push_back(extent_of(*mesh));
    }
    return Surfaces{std::move(meshes), std::move(extents), std::move(*engine), std::move(*test)};
}

/// One pair with one tool.
class PairJudge {
  public:
    PairJudge(const Machine& machine, Surfaces& surfaces, const JointBoxTask& task,
              const ExclusionEffort& effort)
        : machine_(machine),
          surfaces_(surfaces),
          task_(task),
          effort_(effort),
          list_(kTriedPairs) {}

    PairOverTravel judge() {
        for (std::uint32_t pose = 0; pose < effort_.poses && !is_settled(); ++pose) {
            note(sampled_position(machine_, pose).position);
        }
        if (is_settled()) {
            out_.verdict = TravelVerdict::both;
        } else if (unknown_ == 0) {
            task_.box = travel_box(machine_);
            const bool is_proven = out_.apart.is_known ? is_never_near() : is_always_near();
            out_.verdict = is_settled()          ? TravelVerdict::both
                           : !is_proven          ? TravelVerdict::undecided
                           : out_.apart.is_known ? TravelVerdict::never_near
                                                 : TravelVerdict::always_near;
        }
        return out_;
    }

  private:
    [[nodiscard]] bool is_settled() const { return out_.near.is_known && out_.apart.is_known; }

    QueryResult ask(Query query) {
        QueryResult result;
        surfaces_.engine.run({&query, 1}, {&result, 1});
        if (++out_.queries % kShownEach == 0 && effort_.progress) {
            effort_.progress(
                std::min(1.0, static_cast<double>(out_.queries) / std::max(effort_.queries, 1U)));
        }
        return result;
    }
    static bool is_far(const QueryResult& result) {
        return result.status == QueryStatus::ok && result.proof == Proof::far;
    }

    Containment nesting(const Query& query, const QueryResult& surfaces) {
        ContainmentResult result;
        surfaces_.containment_test.run({&query, 1}, {&surfaces, 1}, {&result, 1});
        return result.status == QueryStatus::ok ? result.containment : Containment::not_proven;
    }

    /// The least bound of the pairs of triangles that are near at the middle of the box; stops at
    /// the first within kContactMm. Empty: the surfaces are proven apart there.
    std::optional<NearBound> least_bound(const NearBox& near_box) {
        const Mesh &a = *surfaces_.meshes[task_.mesh_a], &b = *surfaces_.meshes[task_.mesh_b];
        NearBound least{2 * kFarthestMm, kNoIndex};
        const auto takes = [&](const TriangleIds& ids) {
            const NearBound one = near_box.bound(a.triangles[ids.a], b.triangles[ids.b]);
            least = one.mm < least.mm || least.widest_axis == kNoIndex ? one : least;
            return one.mm <= kContactMm;
        };
        if (std::any_of(remembered_.begin(), remembered_.end(), takes)) {
            return least;
        }
        Query query = query_of(task_, placed_pair(task_, near_box.moved()), kContactMm);
        query.kind = QueryKind::touching;
        query.list = list_;
        const QueryResult result = ask(query);
        if (is_far(result)) {
            return std::nullopt;
        }
        const std::size_t found = std::min<std::size_t>(result.touching, list_.size());
        const auto end = list_.begin() + static_cast<std::ptrdiff_t>(found);
        if (const auto proves = std::find_if(list_.begin(), end, takes); proves != end) {
            remembered_.insert(remembered_.begin(), *proves);
            remembered_.resize(std::min(remembered_.size(), kRemembered));
        }
        return least;
    }

    /// Whether the pair is near or apart at one position; keeps the first witness of each.
    Place note(const std::array<double, kAxesMax>& position) {
        JointBox point;
        point.centre = position;
        const NearBox near_box(machine_, task_, point);
        const Query query = query_of(task_, placed_pair(task_, near_box.moved()), kContactMm);
        const QueryResult result = ask(query);
        Place place = Place::unknown;
        if (is_far(result)) {
            const Containment inside = nesting(query, result);
            place = inside == Containment::none         ? Place::apart
                    : inside == Containment::not_proven ? Place::unknown
                                                        : Place::near;
        } else if (const auto bound = least_bound(near_box); bound && bound->mm <= kContactMm) {
            place = Place::near;
        }
        TravelWitness& witness = place == Place::near ? out_.near : out_.apart;
        if (place == Place::unknown) {
            ++unknown_;
        } else if (!witness.is_known) {
            witness = {true, kNoIndex, position};
        }
        return place;
    }

    /// Halves the box for later. False: it cannot be cut, or the queries are used up.
    bool cut(std::vector<JointBox>& open, const JointBox& box, std::uint32_t axis) const {
        if (axis == kNoIndex || out_.queries >= effort_.queries) {
            return false;
        }
        for (const bool is_upper : {false, true}) {
            open.push_back(half_of(box, axis, is_upper, box));
        }
        return true;
    }

    /// What the queries left may prove.
    /// @param least_mm  the least clearance found
    [[nodiscard]] double provable_mm(double least_mm) const {
        const std::uint64_t quarter = std::min<std::uint64_t>(
            4 * out_.queries / std::max(effort_.queries, 1U), kShares.size() - 1);
        return std::max(kLeastMm[quarter], kShares[quarter] * least_mm);
    }

    /// Proves a distance everywhere: most of the least clearance found, and less where that takes
    /// too many queries.
    bool is_never_near() {
        double wanted_mm = kFarthestMm, least_mm = kFarthestMm;
        std::array<Pose, kBodiesMax> moved;
        std::vector<JointBox> open{task_.box};
        while (!open.empty()) {
            const JointBox box = open.back();
            open.pop_back();
            move_bodies(machine_, box.centre, moved);
            const PlacedPair pair = placed_pair(task_, moved);
            const PathMotion motion =
                motion_along(machine_, task_.path, moved, pair.a, pair.b, box);
            if (is_far(ask(query_of(task_, pair, wanted_mm + motion.total_mm)))) {
                continue;
            }
            const double before_mm = wanted_mm;
            if (motion.total_mm <= least_mm) {  // else a smaller part has to be asked
                Query query = query_of(task_, pair, least_mm);
                query.kind = QueryKind::clearance;
                least_mm = std::min(least_mm, ask(query).clearance_mm);
                wanted_mm = std::min(wanted_mm, provable_mm(least_mm));
            }
            if (least_mm <= kContactMm) {
                note(box.centre);
                return false;
            }
            const bool is_proven = wanted_mm < before_mm &&
                                   is_far(ask(query_of(task_, pair, wanted_mm + motion.total_mm)));
            if (!is_proven && !cut(open, box, motion.widest_axis)) {
                return false;
            }
        }
        out_.apart_mm = wanted_mm;
        return true;
    }

    /// Whether the surfaces stay apart in the box and one body is inside the other.
    bool is_nested(const JointBox& box, std::span<const Pose> moved) {
        const PlacedPair pair = placed_pair(task_, moved);
        const PathMotion motion = motion_along(machine_, task_.path, moved, pair.a, pair.b, box);
        const Query query = query_of(task_, pair, motion.total_mm);
        const QueryResult result = ask(query);
        const Containment inside =
            is_far(result) ? nesting(query, result) : Containment::not_proven;
        return inside == Containment::a_in_b || inside == Containment::b_in_a;
    }

    bool is_always_near() {
        std::vector<JointBox> open{task_.box};
        while (!open.empty()) {
            const JointBox box = open.back();
            open.pop_back();
            const NearBox near_box(machine_, task_, box);
            const std::optional<NearBound> bound = least_bound(near_box);
            const bool is_proven =
                bound ? bound->mm <= kContactMm : is_nested(box, near_box.moved());
            if (is_proven) {
                continue;
            }
            std::uint32_t axis = bound ? bound->widest_axis : kNoIndex;
            if (axis == kNoIndex) {
                const PlacedPair pair = placed_pair(task_, near_box.moved());
                axis = motion_along(machine_, task_.path, near_box.moved(), pair.a, pair.b, box)
                           .widest_axis;
            }
            if ((!bound && note(box.centre) != Place::near) || !cut(open, box, axis)) {
                return false;
            }
        }
        return true;
    }

    const Machine& machine_;
    Surfaces& surfaces_;
    JointBoxTask task_;
    ExclusionEffort effort_;
    std::vector<TriangleIds> list_, remembered_;
    std::uint32_t unknown_ = 0;
    PairOverTravel out_;
};

/// Both tools' results as one: a pair that is near with one tool and apart with another is both.
void add(const PairOverTravel& one, bool is_first, PairOverTravel& all) {
    const bool is_both =
        (one.near.is_known || all.near.is_known) && (one.apart.is_known || all.apart.is_known);
    all.verdict = is_both                                  ? TravelVerdict::both
                  : is_first || one.verdict == all.verdict ? one.verdict
                                                           : TravelVerdict::undecided;
    all.apart_mm = is_first ? one.apart_mm : std::min(all.apart_mm, one.apart_mm);
    all.near = all.near.is_known ? all.near : one.near;
    all.apart = all.apart.is_known ? all.apart : one.apart;
    all.queries += one.queries;
}

}  // namespace

std::optional<std::vector<PairOverTravel>> judge_over_travel(const LoadedMachine& loaded,
                                                             std::vector<Pair> pairs,
                                                             const ExclusionEffort& effort) {
    std::optional<Surfaces> surfaces = whole_surfaces(loaded);
    if (!surfaces) {
        return std::nullopt;
    }
    Machine machine = loaded.machine;
    machine.pairs = std::move(pairs);
    machine.pair_surfaces.clear();  // those of checked pairs
    machine.travel = {};
    machine.pose_errors = find_pose_errors(machine, loaded.meshes);
    std::vector<PairOverTravel> out(machine.pairs.size());
    std::uint32_t done = 0;
    const std::uint32_t count = stop_tasks(machine);
    ExclusionEffort of_pair = effort;
    if (effort.progress) {
        of_pair.progress = [&](double share) { effort.progress((done + share) / count); };
    }
    for (std::uint32_t i = 0; i < machine.pairs.size(); ++i) {
        const bool has_its_tool = has_tool(machine, machine.pairs[i]);
        for (std::uint32_t k = 0; k < tasks_of(machine, machine.pairs[i]); ++k) {
            const std::uint32_t tool = has_its_tool ? k : kNoIndex;
            JointBoxTask task = pair_task(machine, i, tool, surfaces->extents);
            task.pose_error_mm = kPlacementErrorMm + pose_error_of(machine, i);  // all are whole
            PairOverTravel one;
            if (has_usable_triangles(*surfaces->meshes[task.mesh_a]) &&
                has_usable_triangles(*surfaces->meshes[task.mesh_b])) {
                one = PairJudge(machine, *surfaces, task, of_pair).judge();
            }
            ++done;
            one.near.tool = one.apart.tool = tool;
            add(one, k == 0, out[i]);
        }
    }
    return out;
}

}  // namespace axg
