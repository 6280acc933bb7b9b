// SPDX-License-Identifier: Apache-2.0
// What is true of two bodies over the whole travel, overrun included: never near, in contact
// everywhere, or near at one place and apart at another. For pairs that no cycle checks. Offline:
// allocates, and limits its effort in queries instead of time.
// Source: docs/theory/travel.md, "Exclusions".
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "firmware_if/setup/loaded_machine.hpp"

namespace axg {

/// Two bodies count as in contact within this distance: more than the rounding of an STL file, less
/// than a gap that anyone leaves between parts that pass each other.
inline constexpr double kContactMm = 0.1;

enum class TravelVerdict : std::uint8_t {
    undecided = 0,  // within the effort
    never_near,     // farther apart than apart_mm everywhere, neither inside the other: proven
    always_near,    // within kContactMm, or one inside the other, everywhere: proven
    both,           // near at one place and apart at another: a witness of each
};
[[nodiscard]] constexpr const char* to_text(TravelVerdict verdict) noexcept {
    return verdict == TravelVerdict::never_near    ? "never_near"
           : verdict == TravelVerdict::always_near ? "always_near"
           : verdict == TravelVerdict::both        ? "both"
                                                   : "undecided";
}

/// A position where the pair is certified to be near, or apart.
struct TravelWitness {
    bool is_known = false;
    std::uint32_t tool = kNoIndex;            // Machine::tools; kNoIndex: none is in the pair
    std::array<double, kAxesMax> position{};  // mm or rad
};

struct PairOverTravel {
    TravelVerdict verdict = TravelVerdict::undecided;
    double apart_mm = 0;  // never_near: farther apart than this everywhere, with every tool
    TravelWitness near, apart;
    std::uint64_t queries = 0;
};

struct ExclusionEffort {
    std::uint32_t poses = 256;                     // looked at first
    std::uint32_t queries = 1U << 16U;             // about a pair with each of its tools
    std::function<void(double share)> progress{};  // called now and then; 0 to 1 of all pairs
};

/// Judges pairs of bodies with surfaces, on whole surfaces. results[i] belongs to pairs[i]; empty:
/// this processor has no lane set, or memory ran out.
[[nodiscard]] std::optional<std::vector<PairOverTravel>> judge_over_travel(
    const LoadedMachine& loaded, std::vector<Pair> pairs, const ExclusionEffort& effort = {});

}  // namespace axg
