// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/method.hpp"

#include <algorithm>
#include <deque>

#include "hil_replay/lab/certified.hpp"
#include "hil_replay/lab/kernels.hpp"

namespace axg::lab {
namespace {

/// What is said of a kernel in every arithmetic. Order: as they are listed.
struct Description {
    std::string_view kernel, source;
};

constexpr Description kDescriptions[] = {
    {"sat17", "Gottschalk, Lin, Manocha: OBBTree, 1996, and its program RAPID"},
};

void add_kernels(std::vector<Method>& all) {
    static std::deque<std::string> names;  // a Method keeps a view of its own
    for (const Description& about : kDescriptions) {
        for (const Kernel& kernel : plain_kernels()) {
            if (about.kernel != kernel.name) {
                continue;
            }
            const std::string_view f32 = names.emplace_back(std::string(kernel.name) + "-f32");
            const std::string_view f64 = names.emplace_back(std::string(kernel.name) + "-f64");
            all.push_back(
                {.name = f32, .source = about.source, .scalar = Scalar::f32, .on_f32 = kernel.f32});
            all.push_back(
                {.name = f64, .source = about.source, .scalar = Scalar::f64, .on_f64 = kernel.f64});
        }
    }
}

std::vector<Method> listed_methods() {
    std::vector<Method> all;
    add_certified(all);
    add_kernels(all);
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
        if (rejected || (method.certified && pairs.fitness[i] == Fitness::outside)) {
            out.verdicts[i] = rejected ? Verdict::rejected : Verdict::undecided;
            if (!out.distances_mm.empty()) {
                out.distances_mm[i] = 0;
            }
        }
    }
    return out;
}

}  // namespace axg::lab
