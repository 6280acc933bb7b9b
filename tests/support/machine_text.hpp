// SPDX-License-Identifier: Apache-2.0
// A small machine file with every section, for tests that break it in one place.
#pragma once

#include <string>
#include <vector>

#include "config/machine/parse_machine.hpp"

namespace axg::test {

inline constexpr const char* kSmallMachine =
    R"(version: 1
name: small
axes:
  X: {kind: linear, travel_mm: [-300, 300], speed_mm_min: 10000, acceleration_mm_s2: 2000,
      jerk_mm_s3: 50000, stopping_mm_s2: 1500, position_error_mm: 0.001, following_error_mm: 0}
  A: {kind: rotary, travel_deg: [-110, 30], speed_deg_s: 90, acceleration_deg_s2: 500,
      jerk_deg_s3: 10000, stopping_deg_s2: 400}
  C: {kind: rotary, travel_deg: unlimited, speed_deg_s: 180, acceleration_deg_s2: 900,
      jerk_deg_s3: 20000, stopping_deg_s2: 700}
bodies:
  - {name: base, mesh: {file: base.stl, unit: mm}}
  - {name: slide, axis: X, direction: [1, 0, 0], mesh: {file: slide.stl, unit: inch}}
  - {name: cradle, parent: slide, axis: A, direction: [1, 0, 0], pivot_mm: [0, 0, -100],
     mesh: {file: cradle.stl, unit: m, size_mm: [10, 20, 30], allow_open: true}}
  - {name: plate, parent: cradle, axis: C, direction: [0, 0, 1], pivot_mm: [0, 0, 0],
     mesh: {file: plate.stl, unit: um}, at_mm: [0, 0, 5], rotate_deg: [90, 0, 0]}
  - {name: cutter, parent: base, tool: true}
tools:
  - {number: 1, name: ball nose, length_mm: 50, mesh: {file: tool.stl, unit: mm}}
  - {number: 2, length_mm: 90, profile_mm: [[0, -90], [4, -86], [4, 0], [0, 0]], segments: 24}
first_tool: 2
pairs:
  - {a: cutter, b: [base, slide, cradle, plate], margin_mm: 0.5}
exclusions:
  - {a: base, b: [slide, cradle, plate], reason: too far away}
  - {a: slide, b: [cradle, plate], reason: bearings}
  - {a: cradle, b: plate, reason: bearing}
can:
  format: classical
  sample_us: 1000
  ids: {sync: 0x080, axes: [0x181, 0x281], permit: 0x103, stop: 0x001}
  data_ids: [0x0181, 641]
  stale_after_us: 3000
capacities: {node_pairs: 8192, triangle_pairs: 65536, rechecks: 1024}
guard: {promise: independent, board_reaction_ms: 2, latch_jitter_us: 20, free_jerk: any,
  travel_enforced: false, speed_cap: false, cap_lead_ms: 20,
  slow_mm: 0, warn_mm: 0, level_band_mm: 0.5, level_hold_samples: 50,
  travel_proofs: false, overrun_mm: 2, overrun_deg: 0.5}
)";

/// The first `from` of a text made `to`; a text without it comes back empty, so that no test can
/// pass by accident.
inline std::string with(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    return at == std::string::npos ? "" : text.replace(at, from.size(), to);
}

/// A machine file with a section `can` of one key a line, with more keys in it, as "  format:
/// fd\n".
inline std::string with_can(std::string text, const std::string& keys) {
    const std::size_t at = text.find("\ncan:");
    return at == std::string::npos ? "" : text.insert(text.find('\n', at + 1) + 1, keys);
}

/// All faults of a text, one a line, as a person sees them.
inline std::string faults_of(const std::string& text) {
    Machine machine;
    std::string out;
    for (const ConfigFault& fault : parse_machine(text, "m", machine)) {
        out += to_string(fault) + '\n';
    }
    return out;
}

}  // namespace axg::test
