// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/cli/interrupt.hpp"

#include <atomic>
#include <cstdio>
#include <cstdlib>

namespace axg {
namespace {

std::atomic<bool> g_was_sent{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler writes it");

extern "C" void note_interrupt(int /*signal*/) {
    g_was_sent.store(true);
}

}  // namespace

Interrupt::Interrupt() noexcept {
    g_was_sent.store(false);
    if (sigaction(SIGINT, nullptr, &before_) != 0 || before_.sa_handler == SIG_IGN) {
        return;
    }
    struct sigaction action {};
    action.sa_handler = note_interrupt;
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    is_caught_ = sigaction(SIGINT, &action, nullptr) == 0;
}

Interrupt::~Interrupt() {
    if (is_caught_) {
        sigaction(SIGINT, &before_, nullptr);
    }
}

bool Interrupt::was_sent() const noexcept {
    return g_was_sent.load(std::memory_order_relaxed);
}

void Interrupt::end() noexcept {
    std::fflush(nullptr);
    sigaction(SIGINT, &before_, nullptr);
    raise(SIGINT);
    std::_Exit(128 + SIGINT);  // where the signal is blocked
}

}  // namespace axg
