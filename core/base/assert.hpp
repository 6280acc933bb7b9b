// SPDX-License-Identifier: Apache-2.0
// What only a bug can break is asserted, in release too, and ends in a safe stop: nothing goes on
// after a broken assumption. The default stop is abort(), which withdraws the permit because the
// process is gone.
#pragma once

namespace axg {

using FailStop = void (*)(const char* condition, const char* file, int line) noexcept;

/// Called once before the process ends; the live program sends its stop frame here. Returns the
/// handler before.
FailStop set_fail_stop(FailStop handler) noexcept;

[[noreturn]] void fail_stop(const char* condition, const char* file, int line) noexcept;

}  // namespace axg

#define AXG_ASSERT(condition)                                 \
    do {                                                      \
        if (!(condition)) [[unlikely]] {                      \
            ::axg::fail_stop(#condition, __FILE__, __LINE__); \
        }                                                     \
    } while (false)
