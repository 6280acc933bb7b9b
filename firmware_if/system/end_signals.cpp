// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/system/end_signals.hpp"

#include <ctime>
#include <initializer_list>

namespace axg {

EndSignals::EndSignals() {
    sigemptyset(&signals_);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) {
        sigaddset(&signals_, signal);
    }
    pthread_sigmask(SIG_BLOCK, &signals_, &before_);
    struct sigaction ignore {};
    ignore.sa_handler = SIG_IGN;
    sigaction(SIGPIPE, &ignore, &pipe_before_);
}

EndSignals::~EndSignals() {
    sigaction(SIGPIPE, &pipe_before_, nullptr);
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

bool EndSignals::was_sent() noexcept {
    const timespec at_once{};
    while (sigtimedwait(&signals_, nullptr, &at_once) > 0) {
        was_sent_ = true;
    }
    return was_sent_;
}

}  // namespace axg
