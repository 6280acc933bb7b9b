// SPDX-License-Identifier: Apache-2.0
// A process around the C interface: plays frames to a guard, echoes what the guard sends, and
// allocates nothing after construction.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <span>
#include <string>

#include "firmware_if/axguard.h"
#include "tests/support/replay_fixture.hpp"

namespace axg::test {

inline axg_options c_options(axg_mode mode) {
    axg_options options{};
    options.version = AXG_INTERFACE_VERSION;
    options.machine_file = kPaperMachine.c_str();
    options.engine = AXG_ENGINE_CPU;
    options.mode = mode;
    return options;
}

/// The paper's machine, with a speed cap; its meshes stay where they are.
inline std::string capped_machine(const Workshop& shop) {
    std::string text = content_of(kPaperMachine);
    text.insert(text.find("\nguard:\n") + 8, "  speed_cap: true\n");
    return shop.write("capped.yaml", text);
}
inline const std::string kPaperMeshes = source_file("config/machines");

/// The program after half a second at rest, in which a guard is armed.
inline std::string after_rest(const Workshop& shop, const std::string& program) {
    return shop.write("after-rest.ngc", "G4 P0.5\n" + content_of(program));
}

inline axg_frame c_frame(const CanFrame& frame) {
    axg_frame out{};
    out.time_us = frame.time_us;
    out.id = frame.id;
    out.flags = frame.fd ? AXG_FRAME_FD : 0;
    out.length_bytes = frame.length_bytes;
    std::copy(frame.data.begin(), frame.data.end(), out.data);
    return out;
}

class CHost {
  public:
    explicit CHost(const axg_options& options) {
        std::array<char, 4096> text{};
        EXPECT_EQ(axg_guard_create(&options, &guard, text.data(), text.size()), AXG_STATUS_OK)
            << text.data();
    }
    ~CHost() { axg_guard_destroy(guard); }
    CHost(const CHost&) = delete;
    CHost& operator=(const CHost&) = delete;

    /// Everything that is due.
    void cycle(std::int64_t now_us) {
        now = now_us;
        for (bool has_sent = true; has_sent;) {
            ok = ok && axg_guard_process(guard, now_us, &state) == AXG_STATUS_OK;
            if (answers && state.has_query != 0) {
                ok = ok && axg_guard_evaluate(guard) == AXG_STATUS_OK &&
                     axg_guard_process(guard, now_us, &state) == AXG_STATUS_OK;
            }
            axg_frame frame;
            for (has_sent = false; axg_guard_next_tx_frame(guard, &frame) == AXG_STATUS_OK;
                 has_sent = true) {
                ++sent;
                if (on_sent) {
                    on_sent(frame, now_us);
                }
                const bool is_permit = frame.id == 0x103 && frame.data[0] != 0x5A;  // word stop
                last_permit_us = is_permit ? now_us : last_permit_us;
                cap_least = is_permit ? std::min(cap_least, frame.data[5]) : cap_least;
                frame.flags |= AXG_FRAME_OWN;
                ok = ok && (!echoes || axg_guard_receive(guard, &frame) == AXG_STATUS_OK);
                if (frame.id == 0x602) {  // the board says the same hash
                    frame.id = 0x582;
                    frame.flags = 0;
                    ok = ok && axg_guard_receive(guard, &frame) == AXG_STATUS_OK;
                }
            }
            if (arms && now_us >= arms_from_us && state.phase == AXG_PHASE_READY) {
                ok = ok && axg_guard_notify(guard, AXG_EVENT_ARM, now_us) == AXG_STATUS_OK;
            }
        }
    }

    /// Until a stop, or the end: how many frames were played.
    std::size_t play(std::span<const CanFrame> frames, bool ends_at_stop = true) {
        for (std::size_t i = 0; i < frames.size(); ++i) {
            play_one(frames[i]);
            if (!ok || (ends_at_stop && state.phase == AXG_PHASE_STOPPED)) {
                return i + 1;
            }
        }
        return frames.size();
    }

    axg_guard* guard = nullptr;
    axg_state state{};
    bool echoes = true, answers = true, arms = true;
    bool ok = true;                                               // every call so far
    std::function<void(const axg_frame&, std::int64_t)> on_sent;  // may be empty
    std::uint64_t sent = 0;
    std::int64_t now = 0, last_permit_us = 0, arms_from_us = 0;
    std::uint8_t cap_least = 255;  // of the permits: 1/250 of rapid

  private:
    void play_one(const CanFrame& frame) {
        if (!has_started_) {
            has_started_ = true;
            ok = axg_guard_start(guard, frame.time_us) == AXG_STATUS_OK;
            state.next_due_us = frame.time_us;
        }
        while (ok && state.next_due_us < frame.time_us) {
            cycle(state.next_due_us);
        }
        const axg_frame given = c_frame(frame);
        ok = ok && axg_guard_receive(guard, &given) == AXG_STATUS_OK;
        cycle(frame.time_us);
    }

    bool has_started_ = false;
};

}  // namespace axg::test
