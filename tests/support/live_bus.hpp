// SPDX-License-Identifier: Apache-2.0
// A bus in real time without either: a clock that only waits advance, a wire with faults, and a
// guard without geometry behind it. For boards that play live.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "hil_replay/board/live_loop.hpp"
#include "tests/support/permit_guard.hpp"
#include "tests/support/test_wire.hpp"

namespace axg::test {

class LiveBus {
  public:
    LiveBus(const Machine& machine, std::int64_t response_us, ConfigurationHashes hashes = {})
        : guard_(machine, response_us, hashes), now_us_(50'000'000) {}

    TestWire wire;
    bool has_guard = true;
    std::int64_t oversleep_us = 0;  // of the next wait that lasts to its end; then 0 again
    bool is_deaf_asleep = false;    // no frame ends a wait

    [[nodiscard]] LiveClock clock() {
        return {.now_us = [this] { return now_us_; },
                .wait = [this](std::int64_t until_us) { wait(until_us); }};
    }
    [[nodiscard]] std::int64_t now_us() const { return now_us_; }

  private:
    /// The guard hears each frame when it was sent; its own arrive when they are ready.
    void hear() {
        std::vector<CanFrame> answers;
        for (; heard_ < wire.sent.size() && has_guard; ++heard_) {
            guard_.on_frame(wire.sent[heard_], answers);
        }
        heard_ = wire.sent.size();
        for (const CanFrame& answer : answers) {
            wire.arrive(answer);
        }
    }
    void wait(std::int64_t until_us) {
        hear();
        const bool has_frame = wire.next_us() <= until_us && !is_deaf_asleep;
        const std::int64_t end_us = has_frame ? wire.next_us() : until_us + oversleep_us;
        oversleep_us = has_frame ? oversleep_us : 0;
        now_us_ = wire.now_us = std::max(now_us_, end_us);
    }

    PermitGuard guard_;
    std::int64_t now_us_;
    std::size_t heard_ = 0;
};

}  // namespace axg::test
