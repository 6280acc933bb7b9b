// SPDX-License-Identifier: Apache-2.0
// A table that the signal handler reads: unlink() is safe in a handler, std::string is not.
// O_TMPFILE would need no handler, but not every file system has it, and linkat() cannot replace.
#include "firmware_if/cli/temporary_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <utility>

namespace axg {
namespace {

constexpr std::size_t kSlots = 32;  // more at a time than any command has outputs
constexpr std::size_t kNoSlot = kSlots;
constexpr std::array kSignals = {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGXFSZ};

struct Slot {
    std::atomic<bool> is_taken{false}, is_set{false};
    std::array<char, PATH_MAX> path{};
};
std::array<Slot, kSlots> g_slots;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler reads it");

extern "C" void remove_and_end(int signal) {
    for (const Slot& slot : g_slots) {
        if (slot.is_set.load()) {
            unlink(slot.path.data());
        }
    }
    raise(signal);  // held back until the handler returns; the action is the default one again
}

void catch_signals() {
    for (const int signal : kSignals) {
        struct sigaction now {};
        if (sigaction(signal, nullptr, &now) != 0 || now.sa_handler != SIG_DFL) {
            continue;
        }
        struct sigaction action {};
        action.sa_handler = remove_and_end;
        action.sa_flags = static_cast<int>(SA_RESETHAND);
        sigfillset(&action.sa_mask);
        sigaction(signal, &action, nullptr);
    }
}

/// While a file is created, and its name not yet in the table.
class SignalsHeld {
  public:
    SignalsHeld() {
        sigset_t all;
        sigfillset(&all);
        pthread_sigmask(SIG_BLOCK, &all, &before_);
    }
    ~SignalsHeld() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
    SignalsHeld(const SignalsHeld&) = delete;
    SignalsHeld& operator=(const SignalsHeld&) = delete;

  private:
    sigset_t before_{};
};

}  // namespace

TemporaryFile::TemporaryFile(std::string path) : path_(std::move(path)) {
    enrol();
}

TemporaryFile::~TemporaryFile() {
    if (!path_.empty()) {
        unlink(path_.c_str());
    }
    forget();
}

TemporaryFile::TemporaryFile(TemporaryFile&& other) noexcept
    : path_(std::exchange(other.path_, {})), slot_(std::exchange(other.slot_, kNoSlot)) {}

TemporaryFile& TemporaryFile::operator=(TemporaryFile&& other) noexcept {
    std::swap(path_, other.path_);
    std::swap(slot_, other.slot_);
    return *this;
}

void TemporaryFile::enrol() {
    slot_ = kNoSlot;
    if (path_.size() >= PATH_MAX) {
        return;
    }
    catch_signals();
    for (std::size_t i = 0; i < kSlots; ++i) {
        if (!g_slots[i].is_taken.exchange(true)) {
            std::memcpy(g_slots[i].path.data(), path_.c_str(), path_.size() + 1);
            g_slots[i].is_set.store(true);
            slot_ = i;
            return;
        }
    }
}

void TemporaryFile::forget() noexcept {
    if (!path_.empty() && slot_ < kSlots) {
        g_slots[slot_].is_set.store(false);
        g_slots[slot_].is_taken.store(false);
    }
    path_.clear();
    slot_ = kNoSlot;
}

bool TemporaryFile::take_name(const std::string& target) {
    struct stat before {};
    if (lstat(target.c_str(), &before) == 0 && !S_ISREG(before.st_mode)) {
        errno = EEXIST;
        return false;
    }
    if (std::rename(path_.c_str(), target.c_str()) != 0) {
        return false;
    }
    forget();
    return true;
}

int TemporaryFile::create(const std::string& folder) {
    const SignalsHeld held;
    const std::string stem = folder + "/.axguard-" + std::to_string(getpid()) + "-";
    for (int i = 0; i < 1000; ++i) {  // names of a program that was killed may be left over
        std::string path = stem + std::to_string(i) + ".part";
        const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (file >= 0) {
            path_ = std::move(path);
            enrol();
            return file;
        }
        if (errno != EEXIST) {
            return -1;
        }
    }
    return -1;
}

}  // namespace axg
