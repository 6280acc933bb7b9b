// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/system/guard_file.hpp"

#include <fmt/format.h>
#include <unistd.h>

namespace axg {

bool is_guard_file(const struct stat& status, uid_t owner) noexcept {
    return S_ISREG(status.st_mode) && status.st_nlink == 1 &&
           (status.st_uid == geteuid() || status.st_uid == owner) && (status.st_mode & 0077U) == 0;
}

std::string guard_file_fault(const struct stat& status, const std::string& path, const char* what) {
    return fmt::format(
        "{}: not a {} that only user {} can open (owner {}, mode {:03o}, {} "
        "names; expected a plain file of mode 600 and one name)",
        path, what, geteuid(), status.st_uid, status.st_mode & 0777U, status.st_nlink);
}

}  // namespace axg
