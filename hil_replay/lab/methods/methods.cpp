// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/methods/method.hpp"

#include <algorithm>
#include <deque>

#include "hil_replay/lab/methods/certified.hpp"
#ifdef AXG_EXACT
#include "hil_replay/lab/methods/exact_method.hpp"
#endif
#include "hil_replay/lab/methods/kernels.hpp"

namespace axg::lab {
namespace {

/// Name and source of a kernel, the same in every arithmetic. Order: that of methods().
struct Description {
    std::string_view kernel, source;
};

constexpr Description kDescriptions[] = {
    {"sat17", "Gottschalk, Lin, Manocha: OBBTree, 1996, and its program RAPID"},
    {"sat11", "the seed paper's eleven axes for triangles in general position, without its six"},
    {"paper-6-11", "the seed paper; Eberly, Geometric Tools: six or eleven axes by a threshold"},
    {"sat17-normalised-eps", "unit axes and a gap of 0.1 um, as tutorials and game engines do"},
    {"moller", "Moller: A Fast Triangle-Triangle Intersection Test, 1997"},
    {"held", "Held: ERIT, A Collection of Efficient and Reliable Intersection Tests, 1997"},
    {"guigue-devillers",
     "Guigue, Devillers: Fast and Robust Triangle-Triangle Overlap Test Using Orientation "
     "Predicates, 2003"},
    {"shen",
     "Shen, Heng, Tang: A Fast Triangle-Triangle Overlap Test Using Signed Distances, 2003, after "
     "its abstract"},
    {"tropp",
     "Tropp, Tal, Shimshoni: A Fast Triangle to Triangle Intersection Test for Collision "
     "Detection, 2006, after its abstract"},
    {"six-segment", "Moller, Trumbore: Fast, Minimum Storage Ray/Triangle Intersection, 1997"},
    {"pqp-distance",
     "Larsen, Gottschalk, Lin, Manocha: Fast Proximity Queries with Swept Sphere Volumes, 1999 "
     "(PQP, TriDist); a hit up to 1 um"},
    {"gjk",
     "Gilbert, Johnson, Keerthi: A Fast Procedure for Computing the Distance Between Complex "
     "Objects, 1988; a hit up to 1 um"},
    {"sphere", "smallest spheres alone; Ericson: Real-Time Collision Detection, 2005"},
    {"aabb", "axis-aligned boxes alone"},
    {"obb", "boxes along the longest edges alone; Gottschalk, Lin, Manocha: OBBTree, 1996"},
    {"18-dop", "nine slabs alone; Klosowski, Held, Mitchell, Sowizral, Zikan: k-DOPs, 1998"},
};

bool is_volume(std::string_view kernel) {
    return kernel == "sphere" || kernel == "aabb" || kernel == "obb" || kernel == "18-dop";
}

bool gives_distance(std::string_view kernel) {
    return kernel == "pqp-distance" || kernel == "gjk";
}

/// Adds the kernel of that name in float and in double.
void add_kernel(std::vector<Method>& all, std::span<const Kernel> kernels, const Description& about,
                bool fused) {
    static std::deque<std::string> names;  // a Method has only a view of its name
    for (const Kernel& kernel : kernels) {
        if (about.kernel != kernel.name) {
            continue;
        }
        Method method{.name = {},
                      .source = about.source,
                      .gives_distance = gives_distance(about.kernel),
                      .fused = fused,
                      .bounding_volume = is_volume(about.kernel)};
        const char* const ending = fused ? "-fma" : "";
        method.name = names.emplace_back(std::string(kernel.name) + "-f32" + ending);
        method.on_f32 = kernel.f32;
        all.push_back(method);
        method.name = names.emplace_back(std::string(kernel.name) + "-f64" + ending);
        method.scalar = Scalar::f64;
        method.on_f32 = nullptr;
        method.on_f64 = kernel.f64;
        all.push_back(method);
    }
}

bool has_fma() noexcept {
#if defined(__x86_64__)
    return __builtin_cpu_supports("fma") != 0 && __builtin_cpu_supports("avx2") != 0;
#else
    return true;
#endif
}

void add_kernels(std::vector<Method>& all) {
    for (const Description& about : kDescriptions) {
        add_kernel(all, plain_kernels(), about, false);
        if (has_fma() && !is_volume(about.kernel)) {  // too coarse for the last bits to matter
            add_kernel(all, fused_kernels(), about, true);
        }
    }
}

std::vector<Method> listed_methods() {
    std::vector<Method> all;
    add_certified(all);
    add_kernels(all);
#ifdef AXG_EXACT
    add_exact(all);
#endif
    return all;
}

}  // namespace

const std::vector<Method>& methods() {
    static const std::vector<Method> kAll = listed_methods();
    return kAll;
}

const Method* find_method(std::string_view name) {
    const std::vector<Method>& all = methods();
    const auto at = std::find_if(all.begin(), all.end(),
                                 [name](const Method& method) { return method.name == name; });
    return at == all.end() ? nullptr : &*at;
}

bool has_domain(const Method& method) noexcept {
    return method.certified && method.scalar != Scalar::exact;
}

void run_method(const Method& method, const PairSet& pairs, std::span<Verdict> verdicts,
                std::span<double> distances_mm) {
    double* const distances = distances_mm.empty() ? nullptr : distances_mm.data();
    if (method.on_f32 != nullptr) {
        method.on_f32(pairs.f32.data(), pairs.size(), verdicts.data(), distances);
    } else if (method.on_f64 != nullptr) {
        method.on_f64(pairs.f64.data(), pairs.size(), verdicts.data(), distances);
    } else {
        method.on_set(pairs, verdicts, distances_mm);
    }
}

Judged judge(const Method& method, const PairSet& pairs, bool wants_distances) {
    Judged out;
    out.verdicts.resize(pairs.size());
    out.distances_mm.resize(wants_distances && method.gives_distance ? pairs.size() : 0);
    run_method(method, pairs, out.verdicts, out.distances_mm);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const bool rejected = pairs.fitness[i] == Fitness::rejected;
        const bool outside = pairs.fitness[i] == Fitness::outside && has_domain(method);
        if (rejected || outside) {
            out.verdicts[i] = rejected ? Verdict::rejected : Verdict::undecided;
            if (!out.distances_mm.empty()) {
                out.distances_mm[i] = 0;
            }
        }
    }
    return out;
}

}  // namespace axg::lab
