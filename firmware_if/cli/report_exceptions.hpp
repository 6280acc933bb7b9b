// SPDX-License-Identifier: Apache-2.0
// The last resort of every program: what nobody caught is reported and becomes an exit code.
#pragma once

#include <cstdio>
#include <exception>
#include <new>

#include "firmware_if/cli/exit_codes.hpp"

namespace axg {

/// @param run  the program: its exit code
template <class Run>
int report_exceptions(const char* program, Run run) {
    try {
        return run();
    } catch (const std::bad_alloc&) {
        std::fprintf(stderr, "%s: no memory left; close other programs, or see ulimit -v\n",
                     program);
        return kExitUnfit;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s: internal error: %s\n", program, error.what());
        return kExitInternal;
    }
}

}  // namespace axg
