// SPDX-License-Identifier: Apache-2.0
#include "core/base/assert.hpp"

#include <atomic>
#include <cstdlib>

namespace axg {

namespace {
std::atomic<FailStop> handler_in_use{nullptr};
}

FailStop set_fail_stop(FailStop handler) noexcept {
    return handler_in_use.exchange(handler);
}

void fail_stop(const char* condition, const char* file, int line) noexcept {
    const FailStop handler =
        handler_in_use.exchange(nullptr);  // once: a failing handler must not loop
    if (handler != nullptr) {
        handler(condition, file, line);
    }
    std::abort();
}

}  // namespace axg
