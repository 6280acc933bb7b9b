// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/cli/whole_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "config/text/quote_text.hpp"

namespace axg {
namespace {

namespace fs = std::filesystem;

bool is_same(const struct stat& a, const struct stat& b) noexcept {
    return a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

/// The descriptor of stdout or stderr where the name leads there; else -1. Such a file is in use:
/// it is appended to, not replaced. A terminal and /dev/null allow a second stream as well.
int standard_stream(const std::string& path) {
    if (path == "-" || path == "/dev/stdout") {
        return STDOUT_FILENO;
    }
    struct stat named {};
    struct stat stream {};
    for (const int descriptor : {STDOUT_FILENO, STDERR_FILENO}) {
        if (stat(path.c_str(), &named) == 0 && fstat(descriptor, &stream) == 0 &&
            is_same(named, stream) && !S_ISCHR(named.st_mode)) {
            return descriptor;
        }
    }
    return -1;
}

std::string folder_of(const fs::path& path) {
    const std::string folder = path.parent_path().string();
    return folder.empty() ? "." : folder;
}

std::string folder_fault(const std::string& folder) {
    if (access(folder.c_str(), W_OK | X_OK) != 0) {
        return "folder " + escaped(folder, 4096) + ": " + std::strerror(errno);
    }
    return {};
}

}  // namespace

std::string output_fault(const std::string& path) {
    if (path.empty()) {
        return "empty file name (expected a file, or - for stdout)";
    }
    if (standard_stream(path) >= 0) {
        return {};
    }
    struct stat status {};
    if (stat(path.c_str(), &status) != 0) {
        struct stat link {};
        if (lstat(path.c_str(), &link) == 0) {
            return "is a broken link. Remove it.";
        }
        return errno == ENOENT && path.back() != '/' ? folder_fault(folder_of(path))
                                                     : std::string(std::strerror(errno));
    }
    if (S_ISDIR(status.st_mode)) {
        return "is a folder (expected a file)";
    }
    if (S_ISBLK(status.st_mode) || S_ISSOCK(status.st_mode)) {
        return "is a block device or a socket (expected a file)";
    }
    if (access(path.c_str(), W_OK) != 0) {
        return std::strerror(errno);
    }
    std::error_code error;
    return S_ISREG(status.st_mode) ? folder_fault(folder_of(fs::canonical(path, error)))
                                   : std::string();
}

std::string output_folder_fault(const std::string& path) {
    if (path.empty()) {
        return "empty folder name (expected a folder)";
    }
    std::error_code error;
    for (fs::path place = path;; place = folder_of(place)) {
        const fs::file_status status = fs::status(place, error);
        if (fs::is_directory(status)) {
            return folder_fault(place.string());
        }
        if (fs::exists(fs::symlink_status(place, error)) || place == folder_of(place)) {
            return escaped(place.string(), 4096) + " is not a folder";
        }
    }
}

bool is_stdout(const std::string& path) {
    return standard_stream(path) == STDOUT_FILENO;
}

bool is_same_file(const std::string& a, const std::string& b) {
    struct stat of_a {};
    struct stat of_b {};
    if (is_stdout(a) && is_stdout(b)) {
        return true;
    }
    if (a == "-" || b == "-") {
        return false;
    }
    const bool has_a = stat(a.c_str(), &of_a) == 0, has_b = stat(b.c_str(), &of_b) == 0;
    if (has_a && has_b) {
        return is_same(of_a, of_b) && !S_ISCHR(of_a.st_mode);
    }
    std::error_code error;  // two files that do not exist: by name
    return !has_a && !has_b &&
           fs::weakly_canonical(fs::absolute(a, error), error) ==
               fs::weakly_canonical(fs::absolute(b, error), error);
}

WholeFile::~WholeFile() {
    if (file_ != nullptr) {
        std::fclose(file_);
    }
}

bool WholeFile::fail(const char* what, int error) {
    error_ = escaped(path_, 4096) + ": " + what + ": " + std::strerror(error) +
             ". Check that the folder exists, is writable and is not full.";
    if (file_ != nullptr) {
        std::fclose(std::exchange(file_, nullptr));
    }
    temporary_ = {};
    return false;
}

bool WholeFile::open(const std::string& path) {
    path_ = path;
    error_ = output_fault(path);
    if (!error_.empty()) {
        error_ = escaped(path, 4096) + ": " + error_;
        return false;
    }
    int file = -1;
    struct stat status {};
    if (const int stream = standard_stream(path); stream >= 0) {
        std::fflush(stdout);
        file = fcntl(stream, F_DUPFD_CLOEXEC, 3);
    } else if (stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode)) {
        file = ::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
    } else {
        std::error_code error;
        const bool is_new = status.st_nlink == 0;
        target_ = is_new ? path : fs::canonical(path, error).string();
        file = temporary_.create(folder_of(target_));
        if (file >= 0 && !is_new) {
            (void)fchmod(file, status.st_mode & 07777U);  // as the file that it replaces
        }
    }
    file_ = file < 0 ? nullptr : fdopen(file, "wb");
    return file_ != nullptr || fail("cannot be written", errno);
}

bool WholeFile::write(std::string_view text) {
    if (file_ == nullptr) {
        error_ = error_.empty() ? escaped(path_, 4096) + ": is already finished" : error_;
        return false;
    }
    return std::fwrite(text.data(), 1, text.size(), file_) == text.size() ||
           fail("could not be written to its end", errno);
}

bool WholeFile::finish() {
    if (file_ == nullptr) {
        return false;
    }
    if (std::fclose(std::exchange(file_, nullptr)) != 0) {  // what was buffered is written here
        return fail("could not be written to its end", errno);
    }
    if (temporary_.path().empty()) {
        return true;
    }
    return temporary_.take_name(target_) || fail("cannot be renamed", errno);
}

bool write_whole_file(const std::string& path, std::string_view text, std::FILE* messages) {
    WholeFile file;
    const bool is_written = file.open(path) && file.write(text) && file.finish();
    if (!is_written) {
        std::fprintf(messages, "%s\n", file.error().c_str());
    }
    return is_written;
}

}  // namespace axg
