// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/system/latch_file.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <span>

#include "firmware_if/system/guard_file.hpp"

namespace axg {
namespace {

constexpr std::size_t kPageBytes = 4096;

std::string words(const std::string& path, const char* what) {
    return path + ": " + what + ": " + std::strerror(errno) +
           ". Pass a writable folder with --state-dir DIR.";
}

/// OneGuard (one_guard.hpp) has already checked that the folder is the guard's.
uid_t owner_of_folder(const std::string& path) noexcept {
    const std::size_t end = path.rfind('/');
    const std::string folder = end == std::string::npos ? "." : path.substr(0, end + 1);
    struct stat status {};
    return stat(folder.c_str(), &status) == 0 ? status.st_uid : geteuid();
}

/// A new file gets its name only after it contains "clear": an interrupted creation leaves none. A
/// file that root creates in the service's folder gets the folder's owner.
bool make_clear(const std::string& path, uid_t owner) {
    const std::string part = path + ".part";
    const int file = open(part.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (file < 0) {
        return false;
    }
    LatchCell cell;
    set_latch(cell, false);
    const bool is_given =
        geteuid() != 0 || owner == 0 || fchown(file, owner, static_cast<gid_t>(-1)) == 0;
    const bool is_written = is_given && fchmod(file, 0600) == 0 &&
                            write(file, &cell, sizeof cell) == sizeof cell &&
                            ftruncate(file, kPageBytes) == 0 && fsync(file) == 0;
    close(file);
    return is_written && rename(part.c_str(), path.c_str()) == 0;
}

int open_page(const std::string& path) noexcept {
    return open(path.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
}

/// A file of another length is no latch that a guard has written: stores a latched cell first, then
/// sets the length.
bool has_page(int file, off_t size_bytes) noexcept {
    LatchCell cell;
    set_latch(cell, true);
    return size_bytes == static_cast<off_t>(kPageBytes) ||
           (pwrite(file, &cell, sizeof cell, 0) == sizeof cell &&
            ftruncate(file, static_cast<off_t>(kPageBytes)) == 0);
}

/// Latches a page with any byte other than 0 behind the cell, and clears those bytes.
void refuse_the_rest(LatchCell& cell) noexcept {
    const auto rest =
        std::span(reinterpret_cast<std::uint8_t*>(&cell), kPageBytes).subspan(sizeof(LatchCell));
    if (std::any_of(rest.begin(), rest.end(), [](std::uint8_t byte) { return byte != 0; })) {
        set_latch(cell, true);
        std::fill(rest.begin(), rest.end(), std::uint8_t{0});
    }
}

}  // namespace

void UnmapLatch::operator()(LatchCell* cell) const noexcept {
    munmap(cell, kPageBytes);
}

LatchFile open_latch(const std::string& path, std::string& fault) {
    const uid_t owner = owner_of_folder(path);
    int file = open_page(path);
    if (file < 0 && errno == ENOENT && make_clear(path, owner)) {
        file = open_page(path);
    }
    struct stat status {};
    if (file < 0 || fstat(file, &status) != 0) {
        fault = words(path, "cannot create the latch file");
        if (file >= 0) {
            close(file);
        }
        return nullptr;
    }
    if (!is_guard_file(status, owner)) {
        fault = guard_file_fault(status, path, "latch") +
                ". Find its owner, then remove it; removal clears the latch.";
        close(file);
        return nullptr;
    }
    void* const page = has_page(file, status.st_size)
                           ? mmap(nullptr, kPageBytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0)
                           : MAP_FAILED;
    if (page == MAP_FAILED) {
        fault = words(path, "cannot map the latch file");
        close(file);
        return nullptr;
    }
    close(file);
    LatchFile latch(static_cast<LatchCell*>(page));
    refuse_the_rest(*latch);
    return latch;
}

void keep_latch(LatchCell& cell) noexcept {
    msync(&cell, kPageBytes, MS_SYNC);
}

}  // namespace axg
