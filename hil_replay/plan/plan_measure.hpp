// SPDX-License-Identifier: Apache-2.0
// Measures one model of a machine on this device: times of a cycle in contact mode and of a
// certificate at rest, the work of a query, where the machine would stop. For
// `axguard check --plan`, which compares models (hil_replay/plan/model_choice.hpp). us, mm.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/collision/engine.hpp"
#include "core/machine/machine.hpp"
#include "firmware_if/setup/loaded_machine.hpp"

namespace axg {

/// Times of many cycles, each the least of some passes: so delays by other programs do not count.
struct CycleTimes {
    std::size_t cycles = 0;
    double p50_us = 0, p99_us = 0, max_us = 0;
};
[[nodiscard]] CycleTimes times_of(std::vector<double> cycle_us);

/// Two positions between which linear axes alone move: clear at the first, stopped at the second.
struct LinearApproach {
    std::vector<double> clear, stopped;
    double way_mm = 0;  // between the two
};

/// Positions and trace at which a machine is measured; the same for every model of it.
struct ModelScene {
    std::uint32_t positions = 1000;  // spread over the travel
    std::string trace;               // measured too, in stoppable mode; empty: none
    std::uint32_t passes = 3;
    std::uint32_t multiprocessors = 0;       // of the GPU, where it runs; 0: all
    std::vector<LinearApproach> approaches;  // found with the whole surfaces
};

/// A pair at one of the positions.
struct PairVerdict {
    std::uint32_t position = 0, pair = 0;  // of sampled_position(); of Machine::pairs
    bool is_far = false;
};
struct CertificateVerdict {
    bool is_proven = false;
    std::vector<std::uint32_t> open{};  // Machine::pairs: those that were not proven
    // If not proven: positions of the axes, mm and rad, and the sample of a trace.
    std::vector<double> axes{};
    std::uint64_t sample = 0;
};

/// Whether each query was far, or proven: one entry a query, in the order of the queries.
struct CandidateVerdicts {
    std::vector<PairVerdict> contact;       // each pair at each position
    std::vector<CertificateVerdict> rest;   // each certificate at rest, all pairs
    std::vector<CertificateVerdict> trace;  // each certificate of the trace
    std::vector<double> stop_share;         // of each approach's way, where contact mode stops
};

/// The most that any query used, and what did not fit.
struct ModelWork {
    std::uint32_t node_pairs = 0, triangle_pairs = 0, rechecks = 0;  // of one query
    std::uint32_t queries = 0;                                       // of one cycle
    std::uint64_t over_capacity = 0;                                 // queries
};

struct ModelMeasurement {
    CycleTimes contact, rest, trace;
    ModelWork work;
    CandidateVerdicts verdicts;
    std::size_t memory_bytes = 0;  // engine (GPU: its own and pinned memory), containment test
    double longest_us = 0;         // the constructed longest cycle, on a GPU; 0: none constructed
    std::string device;            // whose times these are
};

/// Finds positions spread over the travel between which the result of contact mode changes, with
/// `loaded` as it is.
[[nodiscard]] std::vector<LinearApproach> find_approaches(const LoadedMachine& loaded,
                                                          std::uint32_t positions);

/// False, with `fault` set: no engine, no memory, or a trace that cannot be read.
/// @param on_gpu  run the engine on a GPU; the CPU's otherwise
[[nodiscard]] bool measure_model(const LoadedMachine& loaded, const ModelScene& scene, bool on_gpu,
                                 ModelMeasurement& out, std::string& fault);

}  // namespace axg
