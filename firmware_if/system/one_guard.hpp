// SPDX-License-Identifier: Apache-2.0
// One guard for each interface and state directory: a lock on a file that only the guard's user can
// open, which the kernel releases whatever way the process ends. Any local user could claim another
// kind of name first, such as that of an abstract socket, and so prevent the guard's start.
#pragma once

#include <string>

namespace axg {

class OneGuard {
  public:
    enum class Status : unsigned char { mine, held, no_place };

    /// Locks `state_dir`/`bus`.lock. Refuses a folder that another user owns or may write to, and a
    /// lock file that is a link, no plain file, or open to another user.
    OneGuard(const std::string& state_dir, const std::string& bus);
    ~OneGuard();
    OneGuard(const OneGuard&) = delete;
    OneGuard& operator=(const OneGuard&) = delete;

    /// held: another process has the lock; no_place: there is no lock to be had. `fault` names the
    /// process, or what to mend.
    [[nodiscard]] Status status() const noexcept { return status_; }
    [[nodiscard]] const std::string& fault() const noexcept { return fault_; }

  private:
    int file_ = -1;
    Status status_ = Status::no_place;
    std::string fault_;
};

}  // namespace axg
