// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/trace/kept_input.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <map>

namespace axg {
namespace {

constexpr const char* kStandardInput = "/dev/stdin";

/// The bytes of `from` up to its end, which this closes; null with errno.
std::FILE* keep(std::FILE* from) {
    std::FILE* kept = std::tmpfile();
    std::array<char, 1U << 16U> bytes;
    std::size_t count = 1;
    while (kept != nullptr && count != 0) {
        count = std::fread(bytes.data(), 1, bytes.size(), from);
        if (std::ferror(from) != 0 || std::fwrite(bytes.data(), 1, count, kept) != count ||
            std::fflush(kept) != 0) {
            const int error = errno;
            std::fclose(kept);
            kept = nullptr;
            errno = error;
        }
    }
    const int error = errno;
    std::fclose(from);
    errno = error;
    return kept;
}

}  // namespace

std::FILE* open_input(const std::string& path) {
    static std::map<std::string, std::FILE*> all_kept;
    auto kept = all_kept.find(path);
    if (kept == all_kept.end()) {
        std::FILE* file = std::fopen(path == "-" ? kStandardInput : path.c_str(), "rb");
        struct stat status {};
        if (file == nullptr || fstat(fileno(file), &status) != 0 || S_ISREG(status.st_mode) ||
            S_ISDIR(status.st_mode)) {
            return file;
        }
        file = keep(file);
        if (file == nullptr) {
            return nullptr;
        }
        kept = all_kept.emplace(path, file).first;
    }
    // Opened anew, so that each reader has a place of its own.
    return std::fopen(("/proc/self/fd/" + std::to_string(fileno(kept->second))).c_str(), "rb");
}

bool is_readable_input(const std::string& path) {
    return access(path == "-" ? kStandardInput : path.c_str(), R_OK) == 0;
}

}  // namespace axg
