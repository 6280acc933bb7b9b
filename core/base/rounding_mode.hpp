// SPDX-License-Identifier: Apache-2.0
// Whether the calling thread rounds as every proof here assumes: to nearest, subnormals kept. A
// library that was linked with fast-math start-up code, or a caller that changed the mode, breaks
// that only for its thread.
#pragma once

#include <cstdint>

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace axg {

/// True in the mode every thread starts with. Cost: one register read.
[[nodiscard, gnu::always_inline]] inline bool rounds_to_nearest() noexcept {
#if defined(__x86_64__)
    constexpr std::uint32_t kRoundingFlushZero = 0xe040U;  // RC, FTZ and DAZ of MXCSR
    return (_mm_getcsr() & kRoundingFlushZero) == 0;
#elif defined(__aarch64__)
    constexpr std::uint64_t kRoundingFlush = 0x01c00003U;  // FZ, RMode, AH and FIZ of FPCR
    std::uint64_t fpcr = 0;
    asm volatile("mrs %0, fpcr" : "=r"(fpcr));
    return (fpcr & kRoundingFlush) == 0;
#else
    return false;  // no engine runs here
#endif
}

}  // namespace axg
