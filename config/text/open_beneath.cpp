// SPDX-License-Identifier: Apache-2.0
#include "config/text/open_beneath.hpp"

#include <fcntl.h>
#include <linux/openat2.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace axg {
namespace {

/// Owns one descriptor.
class Descriptor {
  public:
    explicit Descriptor(int fd) : fd_(fd) {}
    Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
    Descriptor& operator=(Descriptor&& other) noexcept {
        std::swap(fd_, other.fd_);
        return *this;
    }
    ~Descriptor() {
        if (fd_ >= 0) {
            ::close(fd_);
        }
    }
    [[nodiscard]] int get() const { return fd_; }

  private:
    int fd_;
};

int open_with_kernel(int root, const char* file, int flags) {
    open_how how{};
    how.flags = static_cast<std::uint64_t>(flags | O_CLOEXEC);
    how.resolve = RESOLVE_BENEATH | RESOLVE_NO_MAGICLINKS;
    long fd = -1;
    for (int attempt = 0; attempt < 8; ++attempt) {  // EAGAIN: a rename raced with the look-up
        fd = ::syscall(SYS_openat2, root, file, &how, sizeof how);
        if (fd >= 0 || (errno != EAGAIN && errno != EINTR)) {
            break;
        }
    }
    return static_cast<int>(fd);
}

/// One component at a time, no symbolic link and no .. on the way.
int open_by_walking(int root, const std::string& file, int flags) {
    Descriptor folder(::fcntl(root, F_DUPFD_CLOEXEC, 0));
    std::size_t start = 0;
    for (;;) {
        const std::size_t slash = file.find('/', start);
        const std::string part = file.substr(start, slash - start);
        if (part == "..") {
            errno = EXDEV;
            return -1;
        }
        if (slash == std::string::npos) {
            return ::openat(folder.get(), part.c_str(), flags | O_NOFOLLOW | O_CLOEXEC);
        }
        start = slash + 1;
        if (part.empty() || part == ".") {
            continue;
        }
        folder = Descriptor(
            ::openat(folder.get(), part.c_str(), O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
        if (folder.get() < 0) {
            return -1;
        }
    }
}

Descriptor open_beneath(int root, const std::string& file, int flags, PathLookup lookup) {
    if (lookup == PathLookup::kernel_or_walk) {
        const int fd = open_with_kernel(root, file.c_str(), flags);
        // Old kernels lack the call; some sandboxes forbid it with EPERM.
        if (fd >= 0 || (errno != ENOSYS && errno != EPERM)) {
            return Descriptor(fd);
        }
    }
    return Descriptor(open_by_walking(root, file, flags));
}

std::string kind_of(mode_t mode) {
    if (S_ISDIR(mode)) {
        return "a folder";
    }
    if (S_ISFIFO(mode)) {
        return "a FIFO";
    }
    if (S_ISLNK(mode)) {
        return "a symbolic link (this kernel cannot resolve it safely)";
    }
    if (S_ISCHR(mode) || S_ISBLK(mode)) {
        return "a device";
    }
    return "not a regular file";
}

FileRead refuse(std::string got, std::string wanted) {
    FileRead result;
    result.got = std::move(got);
    result.wanted = std::move(wanted);
    return result;
}

FileRead refuse_open(const std::string& root, int error) {
    if (error == EXDEV || error == ELOOP) {
        return refuse("a path that leaves " + root + " (.. or a symbolic link)",
                      "a file below it; copy the file there, or pass another --mesh-root");
    }
    return refuse(std::string("an unreadable file: ") + std::strerror(error),
                  "a readable STL file below " + root + "; pass another folder with --mesh-root");
}

FileRead read_all(int fd, std::uint64_t size_bytes) {
    FileRead result;
    result.bytes.resize(size_bytes);
    std::uint64_t filled = 0;
    while (filled < size_bytes) {
        const ssize_t count = ::read(fd, result.bytes.data() + filled, size_bytes - filled);
        if (count < 0 && errno == EINTR) {
            continue;
        }
        if (count <= 0) {
            return refuse("a read that failed or ended early",
                          "a file that no other program writes");
        }
        filled += static_cast<std::uint64_t>(count);
    }
    return result;
}

}  // namespace

FileRead read_beneath(const std::string& root, const std::string& file, std::uint64_t bytes_max,
                      PathLookup lookup) {
    const std::string folder = root.empty() ? "." : root;
    if (file.empty() || file.front() == '/' || file.find('\0') != std::string::npos) {
        return refuse(
            file.empty() ? "no file name" : "an absolute path",
            "a path relative to " + folder + " (the machine file's folder or --mesh-root)");
    }
    const Descriptor root_fd(::open(folder.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
    if (root_fd.get() < 0) {
        return refuse("no mesh folder " + folder + ": " + std::strerror(errno),
                      "an existing folder as --mesh-root");
    }
    // O_PATH first: looking at a FIFO or a device that way neither waits nor wakes it.
    const Descriptor look(open_beneath(root_fd.get(), file, O_PATH, lookup));
    struct stat seen {};
    if (look.get() < 0 || ::fstat(look.get(), &seen) != 0) {
        return refuse_open(folder, errno);
    }
    if (!S_ISREG(seen.st_mode)) {
        return refuse(kind_of(seen.st_mode), "a regular file");
    }
    const auto size_bytes = static_cast<std::uint64_t>(seen.st_size);
    if (size_bytes > bytes_max) {
        return refuse(std::to_string(size_bytes) + " bytes",
                      "at most " + std::to_string(bytes_max) +
                          "; simplify the mesh, or write it as binary STL");
    }
    const Descriptor fd(
        open_beneath(root_fd.get(), file, O_RDONLY | O_NONBLOCK | O_NOCTTY, lookup));
    struct stat opened {};
    if (fd.get() < 0 || ::fstat(fd.get(), &opened) != 0) {
        return refuse_open(folder, errno);
    }
    if (opened.st_dev != seen.st_dev || opened.st_ino != seen.st_ino ||
        opened.st_size != seen.st_size) {
        return refuse("a file that was replaced while it was opened",
                      "a file that no other program writes");
    }
    return read_all(fd.get(), size_bytes);
}

}  // namespace axg
