// SPDX-License-Identifier: Apache-2.0
// Checks who may open a file of the guard's state: others could hold its lock, clear its latch, or
// redirect either.
#pragma once

#include <sys/stat.h>

#include <string>

namespace axg {

/// Whether it is a plain file that only the guard's user can open. The owner of the folder may own
/// it too: a file that root creates in the service's folder belongs to the service.
/// @param owner  of the folder, which the guard trusts
[[nodiscard]] bool is_guard_file(const struct stat& status, uid_t owner) noexcept;

/// Text of the fault: what was found, and what was expected.
/// @param what  lock, or latch
[[nodiscard]] std::string guard_file_fault(const struct stat& status, const std::string& path,
                                           const char* what);

}  // namespace axg
