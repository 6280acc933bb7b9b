// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/system/latch_file.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace axg {
namespace {

constexpr std::size_t kPageBytes = 4096;

std::string words(const std::string& path, const char* what) {
    return path + ": " + what + ": " + std::strerror(errno) +
           "; a folder that this user may write: --state-dir DIR";
}

/// A new file appears under its name only when it says "clear": cut off before, there is none.
bool make_clear(const std::string& path) {
    const std::string part = path + ".part";
    const int file = open(part.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    if (file < 0) {
        return false;
    }
    LatchCell cell;
    set_latch(cell, false);
    const bool is_written = write(file, &cell, sizeof cell) == sizeof cell &&
                            ftruncate(file, kPageBytes) == 0 && fsync(file) == 0;
    close(file);
    return is_written && rename(part.c_str(), path.c_str()) == 0;
}

}  // namespace

void UnmapLatch::operator()(LatchCell* cell) const noexcept {
    munmap(cell, kPageBytes);
}

LatchFile open_latch(const std::string& path, std::string& fault) {
    int file = open(path.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW);
    if (file < 0 && errno == ENOENT && make_clear(path)) {
        file = open(path.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW);
    }
    if (file < 0) {
        fault = words(path, "no place for the latch");
        return nullptr;
    }
    struct stat status {};
    // A file cut short is latched: what is missing reads as zeros.
    const bool has_page =
        fstat(file, &status) == 0 && (status.st_size >= static_cast<off_t>(kPageBytes) ||
                                      ftruncate(file, static_cast<off_t>(kPageBytes)) == 0);
    void* const page = has_page
                           ? mmap(nullptr, kPageBytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0)
                           : MAP_FAILED;
    if (page == MAP_FAILED) {
        fault = words(path, "the latch could not be mapped");
        close(file);
        return nullptr;
    }
    close(file);
    return LatchFile(static_cast<LatchCell*>(page));
}

void keep_latch(LatchCell& cell) noexcept {
    msync(&cell, kPageBytes, MS_SYNC);
}

}  // namespace axg
