// SPDX-License-Identifier: Apache-2.0
// Judges the answers of `axguard-lab query` in exact arithmetic: the coordinates of the meshes and
// the matrices of the poses are taken as the exact numbers they are, and CGAL's predicates decide.
//   missed contact     the surfaces share a point, the answer says proven apart       (a failure)
//   false hit          not proven apart, though the exact distance is above 1 um      (a failure)
//   count, clearance   fewer touching pairs than there are; a bound above the distance (a failure)
// The distance behind the clearance is that of tests/support, never below the true one but by the
// rounding of double. Exit code 0: all hold; 1: not; 2: the input is no scene or no answers to it.
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/scene.hpp"
#include "tests/support/surface_distance.hpp"

namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using axg::Pose;
using axg::Vec3d;
using axg::Vec3f;
using axg::test::DistanceTree;
using axg::test::QueryAnswer;
using axg::test::Scene;

constexpr double kFalseHitMm = 1e-3;           // 1 um
constexpr double kRoundingMm = 1e-6;           // of a coordinate placed in double: far above it
constexpr double kClearanceRoundingMm = 1e-9;  // of a distance computed in double

struct Aabb {
    std::array<double, 3> low, high;

    [[nodiscard]] bool meets(const Aabb& other, double by) const {
        for (std::size_t i = 0; i < 3; ++i) {
            if (low[i] > other.high[i] + by || other.low[i] > high[i] + by) {
                return false;
            }
        }
        return true;
    }
};

/// One body in one pose: boxes in double, triangles exactly and only where asked for.
class PlacedBody {
  public:
    PlacedBody(const axg::Mesh& mesh, const Pose& pose)
        : mesh_{mesh}, pose_{pose}, boxes_(mesh.triangles.size()), exact_(mesh.triangles.size()) {
        constexpr double kInfinity = std::numeric_limits<double>::infinity();
        all_.low.fill(kInfinity);
        all_.high.fill(-kInfinity);
        for (std::size_t i = 0; i < boxes_.size(); ++i) {
            const axg::Triangle& t = mesh.triangles[i];
            boxes_[i].low.fill(kInfinity);
            boxes_[i].high.fill(-kInfinity);
            for (const Vec3f& v : {t.a, t.b, t.c}) {
                const Vec3d p = apply(pose, widen(v));
                const std::array<double, 3> xyz{p.x, p.y, p.z};
                for (std::size_t k = 0; k < 3; ++k) {
                    boxes_[i].low[k] = std::min(boxes_[i].low[k], xyz[k]);
                    boxes_[i].high[k] = std::max(boxes_[i].high[k], xyz[k]);
                    all_.low[k] = std::min(all_.low[k], xyz[k]);
                    all_.high[k] = std::max(all_.high[k], xyz[k]);
                }
            }
        }
    }

    [[nodiscard]] const Aabb& all() const { return all_; }
    [[nodiscard]] const std::vector<Aabb>& boxes() const { return boxes_; }
    const Kernel::Triangle_3& exact(std::size_t i) {
        if (!exact_[i]) {
            const axg::Triangle& t = mesh_.triangles[i];
            exact_[i].emplace(point(t.a), point(t.b), point(t.c));
            if (exact_[i]->is_degenerate()) {
                throw std::runtime_error(mesh_.name + ": triangle " + std::to_string(i) +
                                         " has no area: CGAL's predicates do not take it");
            }
        }
        return *exact_[i];
    }

  private:
    [[nodiscard]] Kernel::Point_3 point(const Vec3f& v) const {
        const Kernel::FT x{v.x};
        const Kernel::FT y{v.y};
        const Kernel::FT z{v.z};
        std::array<Kernel::FT, 3> p;
        for (std::size_t i = 0; i < 3; ++i) {
            p[i] = Kernel::FT{pose_.r[i][0]} * x + Kernel::FT{pose_.r[i][1]} * y +
                   Kernel::FT{pose_.r[i][2]} * z + Kernel::FT{pose_.t[i]};
        }
        return {p[0], p[1], p[2]};
    }

    const axg::Mesh& mesh_;
    const Pose& pose_;
    Aabb all_{};
    std::vector<Aabb> boxes_;
    std::vector<std::optional<Kernel::Triangle_3>> exact_;
};

template <class Use>
void for_boxes_that_meet(const PlacedBody& a, const PlacedBody& b, double by, const Use& use) {
    if (!a.all().meets(b.all(), by)) {
        return;
    }
    for (std::size_t i = 0; i < a.boxes().size(); ++i) {
        if (!a.boxes()[i].meets(b.all(), by)) {
            continue;
        }
        for (std::size_t j = 0; j < b.boxes().size(); ++j) {
            if (a.boxes()[i].meets(b.boxes()[j], by)) {
                use(i, j);
            }
        }
    }
}

long exact_count(PlacedBody& a, PlacedBody& b) {
    long count = 0;
    for_boxes_that_meet(a, b, kRoundingMm, [&](std::size_t i, std::size_t j) {
        count += CGAL::do_intersect(a.exact(i), b.exact(j)) ? 1 : 0;
    });
    return count;
}

/// Whether some pair of triangles is at most `limit_mm` apart, exactly.
bool exactly_within(PlacedBody& a, PlacedBody& b, double limit_mm) {
    const Kernel::FT limit2 = Kernel::FT{limit_mm} * Kernel::FT{limit_mm};
    bool within = false;
    for_boxes_that_meet(a, b, limit_mm + kRoundingMm, [&](std::size_t i, std::size_t j) {
        within = within || CGAL::squared_distance(a.exact(i), b.exact(j)) <= limit2;
    });
    return within;
}

struct Tally {
    long answers = 0, contacts = 0, missed = 0, false_hits = 0, within_1_um = 0;
    long short_counts = 0, long_clearances = 0, clearances = 0;
    double loosest_mm = 0;  // distance less clearance, where both are known

    [[nodiscard]] bool passes() const {
        return missed == 0 && false_hits == 0 && short_counts == 0 && long_clearances == 0;
    }
};

void complain(const char* what, const QueryAnswer& answer, double number) {
    std::printf("%s: pose %u pair %s: %.9g\n", what, answer.pose, answer.pair.c_str(), number);
}

void judge_clearance(const QueryAnswer& answer, double within_mm, double distance, bool contact,
                     Tally& tally) {
    const double claimed = answer.clearance_mm < 0 ? within_mm : answer.clearance_mm;
    const double least = contact ? 0 : distance;
    if (claimed > least + kClearanceRoundingMm) {
        ++tally.long_clearances;
        complain("clearance above the distance", answer, claimed - least);
    }
    ++tally.clearances;
    tally.loosest_mm = std::max(tally.loosest_mm, least - claimed);
}

void judge(PlacedBody& a, PlacedBody& b, const QueryAnswer& answer, Tally& tally) {
    const long exact = exact_count(a, b);
    ++tally.answers;
    tally.contacts += exact > 0 ? 1 : 0;
    if (exact > 0 && answer.hit == 0) {
        ++tally.missed;
        complain("missed contact, touching pairs", answer, static_cast<double>(exact));
    }
    if (exact == 0 && answer.hit == 1) {
        if (exactly_within(a, b, kFalseHitMm)) {
            ++tally.within_1_um;
        } else {
            ++tally.false_hits;
            complain("false hit, beyond mm", answer, kFalseHitMm);
        }
    }
    if (answer.count >= 0 && answer.count < exact) {
        ++tally.short_counts;
        complain("count too small by", answer, static_cast<double>(exact - answer.count));
    }
}

/// Answers by (pose, pair); every query exactly one answer.
std::vector<QueryAnswer> sorted_answers(const Scene& scene, const std::string& file) {
    std::map<std::string, std::size_t> pair_index;
    for (std::size_t i = 0; i < scene.pairs.size(); ++i) {
        pair_index[scene.pairs[i].name] = i;
    }
    std::vector<QueryAnswer> out(scene.pose_count * scene.pairs.size());
    for (const QueryAnswer& answer : axg::test::read_answers(file)) {
        const auto pair = pair_index.find(answer.pair);
        if (pair == pair_index.end() || answer.pose >= scene.pose_count) {
            throw std::runtime_error(file + ": answers what was not asked: pose " +
                                     std::to_string(answer.pose) + " pair " + answer.pair);
        }
        QueryAnswer& place = out[answer.pose * scene.pairs.size() + pair->second];
        if (place.hit >= 0) {
            throw std::runtime_error(file + ": two answers to pose " + std::to_string(answer.pose) +
                                     " pair " + answer.pair);
        }
        if (answer.hit != 0 && answer.hit != 1) {
            throw std::runtime_error(file + ": no hit column: ask for hit, count or clearance");
        }
        place = answer;
    }
    for (std::size_t i = 0; i < out.size(); ++i) {
        if (out[i].hit < 0) {
            throw std::runtime_error(file + ": no answer to pose " +
                                     std::to_string(i / scene.pairs.size()) + " pair " +
                                     scene.pairs[i % scene.pairs.size()].name);
        }
    }
    return out;
}

Tally judge_all(const Scene& scene, const std::vector<QueryAnswer>& answers, double within_mm) {
    std::vector<DistanceTree> trees;
    for (const axg::Mesh& mesh : scene.bodies) {
        trees.emplace_back(mesh.triangles);
    }
    const bool clearances = std::any_of(answers.begin(), answers.end(), [](const QueryAnswer& one) {
        return one.clearance_mm >= 0;
    });
    Tally tally;
    for (std::uint32_t pose = 0; pose < scene.pose_count; ++pose) {
        std::vector<PlacedBody> placed;
        placed.reserve(scene.bodies.size());
        for (std::uint32_t body = 0; body < scene.bodies.size(); ++body) {
            placed.emplace_back(scene.bodies[body], scene.at(pose, body));
        }
        for (std::size_t pair = 0; pair < scene.pairs.size(); ++pair) {
            const auto& p = scene.pairs[pair];
            const QueryAnswer& answer = answers[pose * scene.pairs.size() + pair];
            const long contacts_before = tally.contacts;
            judge(placed[p.a], placed[p.b], answer, tally);
            if (clearances) {
                const Pose relative = compose(inverse(scene.at(pose, p.b)), scene.at(pose, p.a));
                judge_clearance(answer, within_mm,
                                surface_distance(trees[p.a], trees[p.b], relative, within_mm),
                                tally.contacts > contacts_before, tally);
            }
        }
    }
    return tally;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 3 || argc > 4) {
        std::fprintf(stderr, "usage: axg_exact_scene SCENE_DIR ANSWERS.csv [WITHIN_MM of query]\n");
        return 2;
    }
    try {
        const Scene scene = axg::test::read_scene(argv[1]);
        const double within_mm = argc == 4 ? std::strtod(argv[3], nullptr) : 50.0;
        const Tally tally = judge_all(scene, sorted_answers(scene, argv[2]), within_mm);
        std::printf(
            "%u poses, %ld answers, %ld exact contacts: %ld missed, %ld false hits, "
            "%ld hits within 1 um, %ld counts too small\n",
            scene.pose_count, tally.answers, tally.contacts, tally.missed, tally.false_hits,
            tally.within_1_um, tally.short_counts);
        if (tally.clearances > 0) {
            std::printf("%ld clearances: %ld above the distance, loosest bound %.6g mm below\n",
                        tally.clearances, tally.long_clearances, tally.loosest_mm);
        }
        return tally.passes() ? 0 : 1;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "axg_exact_scene: %s\n", error.what());
        return 2;
    }
}
