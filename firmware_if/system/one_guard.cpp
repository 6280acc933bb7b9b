// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/system/one_guard.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "firmware_if/system/guard_file.hpp"

namespace axg {
namespace {

/// The path may be a link: systemd creates one for a dynamic user. No other user may write in the
/// folder, for they could replace the lock and the latch. Root may use the service's folder.
int open_folder(const std::string& folder, uid_t& owner, std::string& fault) {
    const int opened = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    struct stat status {};
    if (opened < 0 || fstat(opened, &status) != 0) {
        fault = fmt::format(
            "{}: cannot open the folder of the lock: {}. Pass a writable folder with --state-dir "
            "DIR.",
            folder, std::strerror(errno));
    } else if (status.st_uid != geteuid() && status.st_uid != 0 && geteuid() != 0) {
        fault = fmt::format(
            "{}: wrong owner of the folder (found user {}, expected {} or root). Pass a folder of "
            "the guard's user with --state-dir DIR.",
            folder, status.st_uid, geteuid());
    } else if ((status.st_mode & (S_IWGRP | S_IWOTH)) != 0) {
        fault = fmt::format(
            "{}: other users may write to this folder (found mode {:03o}, expected 755 or less). "
            "Run chmod go-w {}.",
            folder, status.st_mode & 0777U, folder);
    } else {
        owner = status.st_uid;
        return opened;
    }
    if (opened >= 0) {
        close(opened);
    }
    return -1;
}

/// A lock that root creates in the service's folder gets the folder's owner.
int open_lock(int folder, uid_t owner, const std::string& name, const std::string& path,
              std::string& fault) {
    const int file =
        openat(folder, name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0600);
    struct stat status {};
    const bool is_open = file >= 0 && fstat(file, &status) == 0;
    if (is_open && geteuid() == 0 && status.st_uid == 0 && owner != 0 && status.st_size == 0 &&
        fchown(file, owner, static_cast<gid_t>(-1)) == 0) {
        status.st_uid = owner;
    }
    if (!is_open) {
        fault = fmt::format(
            "{}: cannot open the lock: {}. Remove this file, or pass another folder with "
            "--state-dir DIR.",
            path, std::strerror(errno));
    } else if (!is_guard_file(status, owner)) {
        fault = guard_file_fault(status, path, "lock") + ". Remove it.";
    } else {
        return file;
    }
    if (file >= 0) {
        close(file);
    }
    return -1;
}

/// Process id that the holder wrote into the lock file; used in messages only.
std::string holder_of(int file) {
    std::array<char, 32> text{};
    const ssize_t size = pread(file, text.data(), text.size() - 1, 0);
    const std::string pid(text.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
    const std::size_t end = pid.find_first_not_of("0123456789");
    return end == 0 || pid.empty() ? "" : pid.substr(0, end);
}

void write_holder(int file) {
    const std::string pid = std::to_string(getpid()) + '\n';
    if (ftruncate(file, 0) != 0 ||
        pwrite(file, pid.data(), pid.size(), 0) != static_cast<ssize_t>(pid.size())) {
        return;  // the lock holds without it
    }
}

}  // namespace

OneGuard::OneGuard(const std::string& state_dir, const std::string& bus) {
    const std::string name = bus + ".lock";
    const std::string path = state_dir + '/' + name;
    uid_t owner = 0;
    const int folder = open_folder(state_dir, owner, fault_);
    if (folder < 0) {
        return;
    }
    file_ = open_lock(folder, owner, name, path, fault_);
    close(folder);
    if (file_ < 0) {
        return;
    }
    if (flock(file_, LOCK_EX | LOCK_NB) == 0) {
        status_ = Status::mine;
        write_holder(file_);
        return;
    }
    const bool is_held = errno == EWOULDBLOCK;
    const std::string holder = is_held ? holder_of(file_) : "";
    status_ = is_held ? Status::held : Status::no_place;
    fault_ = !is_held ? fmt::format("{}: cannot lock: {}", path, std::strerror(errno))
             : holder.empty()
                 ? fmt::format("another axguardd guards {}. End it first; find it with fuser {}",
                               bus, path)
                 : fmt::format("another axguardd, process {}, guards {}. End it first: kill {}",
                               holder, bus, holder);
    close(file_);
    file_ = -1;
}

OneGuard::~OneGuard() {
    if (file_ >= 0) {
        close(file_);  // the file stays: removed, two processes could each lock one of that name
    }
}

}  // namespace axg
