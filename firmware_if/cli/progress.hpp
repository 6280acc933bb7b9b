// SPDX-License-Identifier: Apache-2.0
// One line on the terminal, now and then, for work that may last longer than a second: progress,
// speed, and the time left. Prints nothing if standard error is no terminal.
#pragma once

#include <chrono>
#include <string>

namespace axg {

/// "1 min 5 s" of a number of seconds.
[[nodiscard]] std::string duration_text(double seconds);

class Progress {
  public:
    Progress();
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// Whether a line is due. Cost: a look at the clock; nothing without a terminal.
    [[nodiscard]] bool is_due() const;
    /// @param machine_s  processed machine time
    /// @param share  of the whole, 0 to 1; 0: unknown, and then the time left is unknown too
    void show(double machine_s, double share, const std::string& what);
    /// The same of work that has no machine time.
    void show(double share, const std::string& what);
    [[nodiscard]] bool is_terminal() const noexcept { return is_terminal_; }

  private:
    void put(const std::string& begin, double share, const std::string& end);

    using Clock = std::chrono::steady_clock;

    bool is_terminal_, was_shown_ = false;
    Clock::time_point start_ = Clock::now(), shown_ = start_;
};

}  // namespace axg
