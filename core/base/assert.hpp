// SPDX-License-Identifier: Apache-2.0
// Assertions of conditions that only a bug can break, in release too. A failed one ends in a safe
// stop: the program does not continue. The default stop is abort(), which withdraws the permit
// because the process is gone.
#pragma once

namespace axg {

using FailStop = void (*)(const char* condition, const char* file, int line) noexcept;

/// Sets the handler that is called once before the process ends; the live program sends its stop
/// frame there. Returns the previous handler.
FailStop set_fail_stop(FailStop handler) noexcept;

[[noreturn]] void fail_stop(const char* condition, const char* file, int line) noexcept;

}  // namespace axg

#define AXG_ASSERT(condition)                                 \
    do {                                                      \
        if (!(condition)) [[unlikely]] {                      \
            ::axg::fail_stop(#condition, __FILE__, __LINE__); \
        }                                                     \
    } while (false)
