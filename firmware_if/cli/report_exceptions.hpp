// SPDX-License-Identifier: Apache-2.0
// The last resort of every program: an uncaught exception is reported and becomes an exit code.
#pragma once

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>

#include "firmware_if/cli/exit_codes.hpp"

namespace axg {

/// The exit code of a program whose results may still be in the buffer of stdout: only the flush
/// here detects a full disk.
inline int exit_code_of_stdout(const char* program, int exit_code) {
    errno = 0;
    const bool is_flushed = std::fflush(stdout) == 0;
    if (is_flushed && std::ferror(stdout) == 0) {
        return exit_code;
    }
    std::fprintf(stderr, "%s: standard output could not be written to its end%s%s\n", program,
                 errno != 0 ? ": " : "", errno != 0 ? std::strerror(errno) : "");
    return kExitInternal;
}

/// @param run  the program: its exit code
template <class Run>
int report_exceptions(const char* program, Run run) {
    try {
        return exit_code_of_stdout(program, run());
    } catch (const std::bad_alloc&) {
        std::fprintf(stderr, "%s: out of memory. Close other programs, or see ulimit -v.\n",
                     program);
        return kExitUnfit;
    } catch (const std::exception& error) {
        const bool is_stdout = std::ferror(stdout) != 0;  // fmt::print throws then
        std::fprintf(stderr, "%s: %s: %s\n", program,
                     is_stdout ? "standard output" : "internal error", error.what());
        return kExitInternal;
    }
}

}  // namespace axg
