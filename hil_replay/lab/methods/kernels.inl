// SPDX-License-Identifier: Apache-2.0
// Every plain method as a template on its scalar. The including file names the unit with
// AXG_LAB_UNIT: each unit has functions of its own, so that code compiled with contraction never
// replaces code without. The code here calls no function that another unit could also compile, such
// as a template of the standard library.

#include <type_traits>

#include "core/base/host_device.hpp"
#include "core/base/vec3.hpp"
#include "hil_replay/lab/methods/kernels.hpp"

// Always inlined: the linker finds no second copy to choose.
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

template <class T>
AXG_LAB_FUNCTION T size_of(const T& a) {
    return a < T(0) ? T(-a) : a;
}

template <class T>
AXG_LAB_FUNCTION int sign_of(const T& a) {
    return (a > T(0) ? 1 : 0) - (a < T(0) ? 1 : 0);
}

/// A published threshold; 0 for a scalar that does not round.
template <class T>
AXG_LAB_FUNCTION T tolerance(double for_float, double for_double) {
    if constexpr (std::is_same_v<T, float>) {
        return static_cast<float>(for_float);
    } else if constexpr (std::is_same_v<T, double>) {
        return for_double;
    } else {
        return T(0);
    }
}

AXG_LAB_FUNCTION float root(float a) {
    return __builtin_sqrtf(a);
}
AXG_LAB_FUNCTION double root(double a) {
    return __builtin_sqrt(a);
}

AXG_LAB_FUNCTION Verdict verdict_of(bool apart) {
    return apart ? Verdict::separated : Verdict::intersecting;
}

#include "hil_replay/lab/methods/sat.inl"

#include "hil_replay/lab/methods/planar.inl"

#include "hil_replay/lab/methods/intervals.inl"

#include "hil_replay/lab/methods/orientations.inl"

#include "hil_replay/lab/methods/equations.inl"

#include "hil_replay/lab/methods/segments.inl"

#include "hil_replay/lab/methods/distances.inl"

#include "hil_replay/lab/methods/gjk.inl"

#include "hil_replay/lab/methods/volumes.inl"

}  // namespace axg::lab::AXG_LAB_UNIT
