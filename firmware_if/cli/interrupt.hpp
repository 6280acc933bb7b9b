// SPDX-License-Identifier: Apache-2.0
// Ctrl-C during long work whose results so far are of use: the command first prints them, then ends
// as the signal would have ended it.
#pragma once

#include <csignal>

namespace axg {

class Interrupt {
  public:
    /// Holds the first SIGINT until end(); the second one ends the program at once. An ignored
    /// signal (nohup) remains ignored.
    Interrupt() noexcept;
    ~Interrupt();
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;

    [[nodiscard]] bool was_sent() const noexcept;
    /// Ends the program as SIGINT does: partly written files are removed.
    [[noreturn]] void end() noexcept;

  private:
    struct sigaction before_ {};
    bool is_caught_ = false;
};

}  // namespace axg
