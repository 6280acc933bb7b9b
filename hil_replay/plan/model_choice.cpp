// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/plan/model_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <utility>

#include "config/mesh/simplify_meshes.hpp"
#include "core/certificate/stop_certificate.hpp"
#include "firmware_if/setup/choose_engine.hpp"
#include "firmware_if/setup/surface_list.hpp"
#include "firmware_if/setup/travel_proof.hpp"
#include "firmware_if/setup/travel_sample.hpp"

namespace axg {
namespace {

constexpr double kSavedTimeShare = 0.95;  // passes of one model differ by less

std::size_t contact_lost_of(const Machine& machine, const std::vector<PairVerdict>& whole,
                            const std::vector<PairVerdict>& coarse, std::vector<LostResult>& out) {
    std::size_t lost = 0;
    for (std::size_t i = 0; i < std::min(whole.size(), coarse.size()); ++i) {
        if (whole[i].is_far && !coarse[i].is_far) {
            const AxisSnapshot at = sampled_position(machine, coarse[i].position);
            out.push_back({LostResult::Kind::contact,
                           coarse[i].pair,
                           {at.position.begin(), at.position.begin() + at.axis_count}});
            ++lost;
        }
    }
    return lost;
}

/// A trace ends early if the chain refuses it: certificates behind that sample count as lost.
std::size_t certificates_lost_of(LostResult::Kind kind,
                                 const std::vector<CertificateVerdict>& whole,
                                 const std::vector<CertificateVerdict>& coarse,
                                 std::vector<LostResult>& out) {
    std::size_t lost = 0;
    for (std::size_t i = 0; i < whole.size(); ++i) {
        if (!whole[i].is_proven || (i < coarse.size() && coarse[i].is_proven)) {
            continue;
        }
        ++lost;
        if (i >= coarse.size() || coarse[i].open.empty()) {
            out.push_back({kind, kNoIndex, {}, whole[i].sample});
            continue;
        }
        for (const std::uint32_t pair : coarse[i].open) {
            out.push_back({kind, pair, coarse[i].axes, coarse[i].sample});
        }
    }
    return lost;
}

void compare(const Machine& machine, const ModelScene& scene, const CandidateVerdicts& whole,
             ModelCandidate& model) {
    const CandidateVerdicts& own = model.measured.verdicts;
    std::vector<LostResult>& list = model.lost_results;
    list.clear();
    model.contact_lost = contact_lost_of(machine, whole.contact, own.contact, list);
    model.rest_lost = certificates_lost_of(LostResult::Kind::rest, whole.rest, own.rest, list);
    model.trace_lost = certificates_lost_of(LostResult::Kind::trace, whole.trace, own.trace, list);
    std::vector<double> earlier_mm;
    for (std::size_t i = 0; i < scene.approaches.size(); ++i) {
        earlier_mm.push_back((whole.stop_share[i] - own.stop_share[i]) *
                             scene.approaches[i].way_mm);
    }
    std::sort(earlier_mm.begin(), earlier_mm.end());
    if (!earlier_mm.empty()) {
        model.earlier_mm_p50 = earlier_mm[earlier_mm.size() / 2];
        model.earlier_mm_max = earlier_mm.back();
    }
}

/// Stores triangles, keys and the largest inflation of the surfaces for the engines.
void describe(const LoadedMachine& loaded, ModelCandidate& model) {
    const Machine& machine = loaded.machine;
    const SurfaceList surfaces = surface_list(loaded);
    for (const auto& meshes : {surfaces.bodies(), surfaces.tools()}) {
        for (const Mesh* mesh : meshes) {
            model.triangles += mesh->triangles.size();
        }
    }
    for (const Body& body : machine.bodies) {
        if (body.mesh.deviation_mm > 0) {
            model.simplified.push_back("bodies." + body.name);
        }
    }
    for (const Tool& tool : machine.tools) {
        if (tool.mesh.deviation_mm > 0) {
            model.simplified.push_back(fmt::format("tools.{}", tool.number));
        }
    }
    for (const Pair& pair : machine.pairs) {
        const auto most = [&](std::uint32_t body) {
            double mm = machine.bodies[body].is_tool ? 0 : deviation_of(machine, body, kNoIndex);
            for (std::uint32_t tool = 0; tool < machine.tools.size(); ++tool) {
                mm = std::max(mm, deviation_of(machine, body, tool));
            }
            return mm;
        };
        model.inflation_mm = std::max(model.inflation_mm, most(pair.a) + most(pair.b));
    }
}

std::uint32_t power_above(std::uint32_t count, std::uint32_t least) noexcept {
    return std::bit_ceil(std::max(2 * count, least));
}

/// Measures a model with the capacities for it, and with fewer queries as long as its slowest
/// cycle does not fit; fewer than one for each pair prove nothing.
bool confirm(const LoadedMachine& whole, const ModelScene& scene, bool on_gpu, ModelChoice& out,
             std::string& fault) {
    const ModelCandidate& chosen = out.models[out.chosen];
    out.capacities = capacities_for(chosen.measured.work, whole.machine.capacities);
    out.queries = whole.machine.cycle.queries;
    LoadedMachine candidate = whole;
    candidate.machine.capacities = out.capacities;
    if (!simplified_to(chosen.simplify_mm, candidate, fault)) {
        return false;
    }
    const std::uint32_t least = std::max(1U, stop_tasks(whole.machine));
    for (;;) {
        candidate.machine.cycle.queries = out.queries;
        out.confirmed = chosen;
        out.confirmed.measured = {};
        if (!measure_model(candidate, scene, on_gpu, out.confirmed.measured, fault)) {
            return false;
        }
        compare(whole.machine, scene, out.models.front().measured.verdicts, out.confirmed);
        if (does_fit(out, whole.machine) || out.queries / 2 < least) {
            return true;
        }
        out.queries /= 2;
    }
}

/// The coarsest model that loses nothing; if it does not fit, the next coarser one that saves
/// something and does.
bool choose_and_confirm(const LoadedMachine& whole, const ModelScene& scene, bool on_gpu,
                        ModelChoice& out, std::string& fault) {
    const std::size_t lossless = choose_model(out.models);
    for (out.chosen = lossless; out.chosen < out.models.size();
         out.chosen = next_coarser(out.models, out.chosen)) {
        if (!confirm(whole, scene, on_gpu, out, fault)) {
            return false;
        }
        if (does_fit(out, whole.machine)) {
            return true;
        }
    }
    out.chosen = lossless;
    return confirm(whole, scene, on_gpu, out, fault);
}

}  // namespace

double p99_us(const ModelMeasurement& m) noexcept {
    return std::max({m.contact.p99_us, m.rest.p99_us, m.trace.p99_us});
}

double slowest_us(const ModelMeasurement& m) noexcept {
    return std::max({m.contact.max_us, m.rest.max_us, m.trace.max_us, m.longest_us});
}

bool does_fit(const ModelChoice& choice, const Machine& machine) noexcept {
    return slowest_us(choice.confirmed.measured) <= room_us(machine);
}

double room_us(const Machine& machine) noexcept {
    return time_limits(machine).engine_us;
}

bool simplified_to(double simplify_mm, LoadedMachine& loaded, std::string& fault) {
    // Shapes are as fine as they were stated: a machine file has no simplify_mm beside them.
    for (Body& body : loaded.machine.bodies) {
        body.mesh.simplify_mm = body.mesh.file.empty() ? 0 : simplify_mm;
    }
    for (Tool& tool : loaded.machine.tools) {
        tool.mesh.simplify_mm = tool.mesh.file.empty() ? 0 : simplify_mm;
    }
    // Proofs about other surfaces are not valid for these.
    std::size_t own = 0;
    for (const PairSurface& surface : loaded.machine.pair_surfaces) {
        own = std::max(own, std::size_t{surface.surface} + 1);
    }
    loaded.meshes.of_pairs.resize(own);
    loaded.machine.travel = {};
    const std::vector<ConfigFault> faults = simplify_meshes(loaded.machine, loaded.meshes);
    fault = faults.empty() ? "" : to_string(faults.front());
    if (faults.empty() && loaded.machine.guard.travel_proofs) {
        if (const auto kept = prove_travel(loaded)) {
            apply_travel(*kept, loaded);
        }
    }
    return faults.empty();
}

bool saves(const ModelCandidate& coarser, const ModelCandidate& finer) noexcept {
    const ModelMeasurement &a = coarser.measured, &b = finer.measured;
    return a.memory_bytes < b.memory_bytes || p99_us(a) < kSavedTimeShare * p99_us(b) ||
           a.longest_us < kSavedTimeShare * b.longest_us;
}

std::size_t choose_model(const std::vector<ModelCandidate>& models) noexcept {
    std::size_t chosen = 0;
    for (std::size_t i = 1; i < models.size(); ++i) {
        const bool is_worth_it = static_cast<double>(models[i].triangles) <=
                                     kWorthShare * static_cast<double>(models[chosen].triangles) &&
                                 saves(models[i], models[chosen]) &&
                                 saves(models[i], models.front());
        chosen = models[i].lost() == 0 && is_worth_it ? i : chosen;
    }
    return chosen;
}

std::size_t next_coarser(const std::vector<ModelCandidate>& models, std::size_t chosen) noexcept {
    std::size_t next = chosen + 1;
    while (next < models.size() &&
           !(saves(models[next], models[chosen]) && saves(models[next], models.front()))) {
        ++next;
    }
    return next;
}

Capacities capacities_for(const ModelWork& work, const Capacities& now) noexcept {
    Capacities out = now;
    if (work.over_capacity != 0) {
        return now;  // the need is unknown, and the results that did not fit count as lost
    }
    out.node_pairs = power_above(work.node_pairs, 64);
    out.triangle_pairs = power_above(work.triangle_pairs, 1024);
    out.rechecks = power_above(work.rechecks, 64);
    return out;
}

bool make_model_choice(const LoadedMachine& loaded, ModelScene scene, bool on_gpu, ModelChoice& out,
                       std::string& fault) {
    LoadedMachine whole = loaded;
    if (!simplified_to(0, whole, fault)) {
        return false;
    }
    scene.approaches = find_approaches(whole, scene.positions);
    for (const double simplify_mm : kModelDetailsMm) {
        LoadedMachine model = whole;
        ModelCandidate candidate;
        candidate.simplify_mm = simplify_mm;
        if (!simplified_to(simplify_mm, model, fault)) {
            return false;
        }
        describe(model, candidate);
        if (!out.models.empty() && candidate.triangles >= out.models.back().triangles) {
            continue;  // not coarser than the model before
        }
        if (!measure_model(model, scene, on_gpu, candidate.measured, fault)) {
            return false;
        }
        out.models.push_back(std::move(candidate));
        compare(whole.machine, scene, out.models.front().measured.verdicts, out.models.back());
    }
    return choose_and_confirm(whole, scene, on_gpu, out, fault);
}

}  // namespace axg
