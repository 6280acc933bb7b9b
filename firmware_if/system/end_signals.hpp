// SPDX-License-Identifier: Apache-2.0
// Signals that end a program, held back while it must not just end: SIGINT, SIGTERM, SIGHUP and
// SIGQUIT are noted, SIGPIPE is ignored. For programs of one thread.
#pragma once

#include <csignal>

namespace axg {

class EndSignals {
  public:
    EndSignals();
    /// A signal that arrived after the last was_sent() ends the program here.
    ~EndSignals();
    EndSignals(const EndSignals&) = delete;
    EndSignals& operator=(const EndSignals&) = delete;

    /// Whether one was sent so far; consumes the pending ones.
    [[nodiscard]] bool was_sent() noexcept;

  private:
    sigset_t signals_{}, before_{};
    struct sigaction pipe_before_ {};
    bool was_sent_ = false;
};

}  // namespace axg
