// SPDX-License-Identifier: Apache-2.0
// Chooses the model of a machine: measures the whole surfaces and coarser ones
// (config/mesh/simplify_meshes.hpp) on this device, and chooses the coarsest that stops nowhere
// where the whole ones do not. Source: docs/reference/plan.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "hil_replay/plan/plan_measure.hpp"

namespace axg {

/// Largest deviation of each mesh, mm; 0: the whole surfaces.
inline constexpr double kModelDetailsMm[] = {0, 0.05, 0.1, 0.2, 0.4};

/// A result of the whole surfaces that a model does not give.
struct LostResult {
    enum class Kind : std::uint8_t { contact, rest, trace };
    Kind kind = Kind::contact;
    std::uint32_t pair = kNoIndex;  // Machine::pairs; kNoIndex: the trace was given up before
    std::vector<double> axes{};     // where, mm and rad
    std::uint64_t sample = 0;       // of a trace
};

struct ModelCandidate {
    double simplify_mm = 0;
    std::size_t triangles = 0;            // that engines get
    double inflation_mm = 0;              // of the pair that has most: both deviations
    std::vector<std::string> simplified;  // keys of the meshes that got fewer triangles
    ModelMeasurement measured;
    // Against the whole surfaces: what was far, or proven, and is not any more.
    std::size_t contact_lost = 0, rest_lost = 0, trace_lost = 0;
    // The same one by one; of a certificate each pair that is open now and was not.
    std::vector<LostResult> lost_results;
    // How much earlier the stop of each approach comes, mm of way.
    double earlier_mm_p50 = 0, earlier_mm_max = 0;

    [[nodiscard]] std::size_t lost() const noexcept {
        return contact_lost + rest_lost + trace_lost;
    }
};

struct ModelChoice {
    // For each of kModelDetailsMm whose model is coarser than the one before.
    std::vector<ModelCandidate> models;
    std::size_t chosen = 0;
    Capacities capacities;      // for the chosen one
    std::uint32_t queries = 0;  // cycle.queries for it: fewer, where more do not fit
    ModelCandidate confirmed;   // it with these capacities and queries
};

/// The time that 99 of 100 cycles keep to, us.
[[nodiscard]] double p99_us(const ModelMeasurement& measured) noexcept;

/// The slowest cycle that was seen, or constructed, us.
[[nodiscard]] double slowest_us(const ModelMeasurement& measured) noexcept;

/// The engine's share of a cycle, us: firmware_if/setup/choose_engine.hpp.
[[nodiscard]] double room_us(const Machine& machine) noexcept;

/// The machine as its file has it, but for `simplify_mm` of every mesh.
/// False, with `fault` set: this build cannot simplify.
[[nodiscard]] bool simplified_to(double simplify_mm, LoadedMachine& loaded, std::string& fault);

/// Measures and chooses. False, with `fault` set: as measure_model.
[[nodiscard]] bool make_model_choice(const LoadedMachine& loaded, ModelScene scene, bool on_gpu,
                                     ModelChoice& out, std::string& fault);

/// Whether the slowest cycle of the confirmed model is within room_us().
[[nodiscard]] bool does_fit(const ModelChoice& choice, const Machine& machine) noexcept;

/// Whether a coarser model takes clearly less time, or less memory: its inflation is not for
/// nothing. Time is what most cycles take: one slow sample, with either model, decides nothing.
[[nodiscard]] bool saves(const ModelCandidate& coarser, const ModelCandidate& finer) noexcept;

/// A coarser model is worth its inflation where it has at most so many of the triangles.
inline constexpr double kWorthShare = 0.7;

/// Index of the coarsest model that has lost nothing and is worth it: it also saves something
/// against the whole surfaces and the model that it replaces. 0 if there is none.
[[nodiscard]] std::size_t choose_model(const std::vector<ModelCandidate>& models) noexcept;

/// Index of the next coarser model that saves against `chosen` and the whole surfaces; the count
/// of models if there is none.
[[nodiscard]] std::size_t next_coarser(const std::vector<ModelCandidate>& models,
                                       std::size_t chosen) noexcept;

/// Twice the measured work, at least an engine's smallest lists, as powers of two; `now` if a list
/// was full. The capacities of a launch on a GPU do not change.
[[nodiscard]] Capacities capacities_for(const ModelWork& work, const Capacities& now) noexcept;

}  // namespace axg
