// SPDX-License-Identifier: Apache-2.0
// A method of the laboratory judges pairs of triangles in batches; it has a name, a source and
// claimed properties. Closed triangles: a touch is an intersection. docs/theory/methods.md.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hil_replay/lab/cases/pair_set.hpp"

namespace axg::lab {

/// The letter of the verdict in the files of data/tritri: 0, 1, 2 or R.
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

/// Judges every pair of the set. verdicts: one a pair. distances_mm: one a pair, or empty to skip
/// the distances.
using JudgeSet = void (*)(const PairSet& pairs, std::span<Verdict> verdicts,
                          std::span<double> distances_mm);

struct Method {
    std::string_view name;    // value of `axguard-lab accuracy --method`
    std::string_view source;  // paper or program, author, year
    Scalar scalar = Scalar::f32;
    bool certified = false;        // `separated` is a theorem
    bool gives_distance = false;   // fills distances_mm
    bool fused = false;            // compiled with contraction allowed (x86-64: FMA)
    bool bounding_volume = false;  // compares only boxes, spheres or slabs
    // Exactly one is set: it receives the pairs as its arithmetic represents them.
    JudgePairs<float> on_f32 = nullptr;
    JudgePairs<double> on_f64 = nullptr;
    JudgeSet on_set = nullptr;
};

/// Every method that this build and this processor can run, in the order of docs/theory/methods.md.
[[nodiscard]] const std::vector<Method>& methods();

/// Null if there is no such method.
[[nodiscard]] const Method* find_method(std::string_view name);

/// Whether the proof behind a method is limited to kLabDomainMm.
[[nodiscard]] bool has_domain(const Method& method) noexcept;

/// Runs only the method on every pair of the set: the work that is timed. Pairs that are not usable
/// get an arbitrary verdict. verdicts: one a pair; distances_mm: one a pair, or empty to skip them;
/// those of a certified method never exceed the distance.
void run_method(const Method& method, const PairSet& pairs, std::span<Verdict> verdicts,
                std::span<double> distances_mm);

struct Judged {
    std::vector<Verdict> verdicts;
    std::vector<double> distances_mm;  // empty unless requested and given by the method
};

/// Calls run_method, then marks pairs with a NaN or an infinity as rejected, and pairs beyond the
/// domain of a certified method as undecided.
[[nodiscard]] Judged judge(const Method& method, const PairSet& pairs, bool wants_distances);

}  // namespace axg::lab
