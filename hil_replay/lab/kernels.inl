// SPDX-License-Identifier: Apache-2.0
// Every plain method as a template on its scalar, and the tables of their batches. The including
// file names the unit with AXG_LAB_UNIT: each unit has functions of its own, so that code compiled
// with contraction never stands in for code without. Nothing here calls a function that another
// unit could have compiled; the standard library's templates are such functions.

#include "core/hd.hpp"
#include "core/vec3.hpp"
#include "hil_replay/lab/kernels.hpp"

// Inlined always: no copy of it is left for a linker to choose.
#define AXG_LAB_FUNCTION AXG_HD

namespace axg::lab::AXG_LAB_UNIT {

template <class T>
AXG_LAB_FUNCTION T least(const T& a, const T& b) {
    return a < b ? a : b;
}

template <class T>
AXG_LAB_FUNCTION T most(const T& a, const T& b) {
    return a > b ? a : b;
}

AXG_LAB_FUNCTION Verdict verdict_of(bool apart) {
    return apart ? Verdict::separated : Verdict::intersecting;
}

#include "hil_replay/lab/sat.inl"

}  // namespace axg::lab::AXG_LAB_UNIT
