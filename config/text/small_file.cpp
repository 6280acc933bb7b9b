// SPDX-License-Identifier: Apache-2.0
// POSIX calls, not streams: only open() with O_NONBLOCK can refuse a pipe that nobody writes to
// without waiting for a writer, and only fstat() on the open file cannot be fooled by a swap after
// the check.
#include "config/text/small_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace axg {
namespace {

const char* kind_of(mode_t mode) noexcept {
    if (S_ISDIR(mode)) {
        return "a folder";
    }
    if (S_ISFIFO(mode)) {
        return "a pipe";
    }
    return S_ISCHR(mode) || S_ISBLK(mode) ? "a device" : "not a regular file";
}

SmallFileFault too_large(std::size_t size_bytes_max) {
    return {.got = "more than " + std::to_string(size_bytes_max) + " bytes",
            .wanted = "at most " + std::to_string(size_bytes_max) + " bytes"};
}

SmallFileFault read_open_file(int file, std::size_t size_bytes_max, std::string& out) {
    struct stat status {};
    if (fstat(file, &status) != 0) {
        return {.got = std::strerror(errno), .wanted = "a file that can be read"};
    }
    if (!S_ISREG(status.st_mode)) {
        return {.got = kind_of(status.st_mode), .wanted = "a regular file"};
    }
    if (status.st_size > 0 && static_cast<std::size_t>(status.st_size) > size_bytes_max) {
        return too_large(size_bytes_max);
    }
    // One byte more than there should be, to see that there is none; more only as more comes.
    std::string bytes(static_cast<std::size_t>(std::max<off_t>(status.st_size, 0)) + 1, '\0');
    std::size_t count = 0;
    while (count <= size_bytes_max) {
        if (count == bytes.size()) {
            bytes.resize(std::min(2 * bytes.size() + 4096, size_bytes_max + 1));
        }
        const ssize_t more = read(file, bytes.data() + count, bytes.size() - count);
        if (more < 0 && errno == EINTR) {
            continue;
        }
        if (more < 0) {
            return {.got = std::strerror(errno), .wanted = "a file that can be read to its end"};
        }
        if (more == 0) {
            bytes.resize(count);
            out = std::move(bytes);
            return {};
        }
        count += static_cast<std::size_t>(more);
    }
    return too_large(size_bytes_max);
}

}  // namespace

SmallFileFault read_small_file(const std::string& path, std::size_t size_bytes_max,
                               std::string& out) {
    if (path.empty() || path.find('\0') != std::string::npos) {
        return {.got = "no file name", .wanted = "the name of a file"};
    }
    const int file = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
    if (file < 0) {
        return {.got = std::strerror(errno), .wanted = "a file that can be opened; check the name"};
    }
    SmallFileFault fault = read_open_file(file, size_bytes_max, out);
    close(file);
    return fault;
}

}  // namespace axg
