// SPDX-License-Identifier: Apache-2.0
// What a method of the laboratory is: a way to judge pairs of triangles in batches, with its name,
// its source, and what it claims. Closed triangles: a touch is an intersection.
// docs/theory/methods.md.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hil_replay/lab/cases/pair_set.hpp"

namespace axg::lab {

/// As the answers of data/tritri write it: 0, 1, 2 or R.
[[nodiscard]] constexpr char letter_of(Verdict verdict) noexcept {
    switch (verdict) {
        case Verdict::separated:
            return '0';
        case Verdict::intersecting:
            return '1';
        case Verdict::rejected:
            return 'R';
        case Verdict::undecided:
            break;
    }
    return '2';
}

enum class Scalar : std::uint8_t { f32, f64, f32_then_f64, exact };

/// Judges every pair of the set. verdicts: one a pair. distances_mm: one a pair, or empty: not
/// asked for.
using JudgeSet = void (*)(const PairSet& pairs, std::span<Verdict> verdicts,
                          std::span<double> distances_mm);

struct Method {
    std::string_view name;    // as `axguard-lab accuracy --method` takes it
    std::string_view source;  // paper or program, author, year
    Scalar scalar = Scalar::f32;
    bool certified = false;        // `separated` is a theorem
    bool gives_distance = false;   // fills distances_mm
    bool fused = false;            // compiled with contraction allowed (x86-64: FMA)
    bool bounding_volume = false;  // looks at boxes, spheres and the like alone
    // One of these: what it is handed is what its arithmetic holds.
    JudgePairs<float> on_f32 = nullptr;
    JudgePairs<double> on_f64 = nullptr;
    JudgeSet on_set = nullptr;
};

/// Every method that this build and this processor can run, in the order of docs/theory/methods.md.
[[nodiscard]] const std::vector<Method>& methods();

/// Null: there is no such method.
[[nodiscard]] const Method* find_method(std::string_view name);

/// Whether the proof behind a method holds within kLabDomainMm alone.
[[nodiscard]] bool has_domain(const Method& method) noexcept;

/// The bare method on every pair of the set, and nothing else: what is measured. Pairs that are not
/// usable get some verdict. verdicts: one a pair; distances_mm: one a pair, or empty: not asked
/// for; a certified method's are never more than the distance.
void run_method(const Method& method, const PairSet& pairs, std::span<Verdict> verdicts,
                std::span<double> distances_mm);

struct Judged {
    std::vector<Verdict> verdicts;
    std::vector<double> distances_mm;  // empty unless asked for and given by the method
};

/// run_method, with what is no number rejected, and what is beyond the domain of a certified
/// method undecided.
[[nodiscard]] Judged judge(const Method& method, const PairSet& pairs, bool wants_distances);

}  // namespace axg::lab
