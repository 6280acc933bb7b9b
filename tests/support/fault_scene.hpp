// SPDX-License-Identifier: Apache-2.0
// One fault in the world of a live guard: set up at a random moment, with a count of how often it
// had an effect and the instant of the first. Rows are named as in the fault tables of
// docs/reference/states.md; what each must come to is a bound in time. us.
#pragma once

#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "firmware_if/protocol/e2e.hpp"
#include "tests/support/live_world.hpp"

namespace axg::test {

struct FaultScene {
    LiveWorld& world;
    std::mt19937_64& random;
    std::int64_t first_us = INT64_MAX;  // what was done to the guard began to be there
    std::uint64_t applied = 0;
    ReceiverCounters before{};  // at the moment in which the fault was set up
    std::vector<CanFrame> kept{};

    std::uint32_t draw(std::uint32_t below) {
        return std::uniform_int_distribution<std::uint32_t>(0, below - 1)(random);
    }
    void touch(std::int64_t at_us) {
        ++applied;
        first_us = std::min(first_us, at_us);
    }
    void touch_now() { touch(world.wire.now_us); }

    [[nodiscard]] const CanLayout& can() const { return world.machine.can; }
    [[nodiscard]] bool is_fd() const { return can().format == CanFormat::fd; }
    [[nodiscard]] GuardFault cause() const { return world.guard->guard().cause; }
    [[nodiscard]] bool has_stopped_for(GuardFault fault) const {
        return world.guard->guard().phase == GuardPhase::stopped && cause() == fault;
    }
    [[nodiscard]] std::uint64_t grown(ReceiverFault fault) const {
        return world.guard->receiver().counters().of(fault) - before.of(fault);
    }
    /// The receiver gave up for this.
    [[nodiscard]] bool gave_up_for(ReceiverFault fault) const {
        return has_stopped_for(GuardFault::input) && world.guard->receiver().stop_cause() == fault;
    }
    /// No whole snapshot for too long: whoever finds it first.
    [[nodiscard]] bool is_old() const {
        return has_stopped_for(GuardFault::silence) || gave_up_for(ReceiverFault::stale);
    }

    [[nodiscard]] bool is_axis(const CanFrame& frame) const {
        const std::size_t count = is_fd() ? 1 : 3;
        return std::find(can().axis_ids.begin(), can().axis_ids.begin() + count, frame.id) !=
               can().axis_ids.begin() + static_cast<std::ptrdiff_t>(count);
    }
    /// One of the axis frames of a sample; SYNC stands before them.
    CanFrame& some_axis_frame(std::vector<CanFrame>& frames) {
        return frames[1 + draw(is_fd() ? 1 : 3)];
    }
    CanFrame& last_axis_frame(std::vector<CanFrame>& frames) { return frames[is_fd() ? 1 : 3]; }

    /// Does it to the next sample.
    template <class Change>
    void once(Change change) {
        world.alters = [this, change](std::vector<CanFrame>& frames) mutable {
            if (applied == 0) {
                change(*this, frames);
            }
        };
    }
    /// Does it to every sample from now on.
    template <class Change>
    void always(Change change) {
        world.alters = [this, change](std::vector<CanFrame>& frames) mutable {
            change(*this, frames);
        };
    }
    /// The board says something else; it arrives with the sample's last axis frame.
    template <class Change>
    void says(Change change) {
        world.says = [this, change](AxisSnapshot& snapshot) mutable { change(*this, snapshot); };
        always([](FaultScene& s, std::vector<CanFrame>& frames) {
            s.touch(s.last_axis_frame(frames).time_us);
        });
    }

    /// A checksum that fits the payload; `data_id_change`: of another frame's Data ID.
    void protect(CanFrame& frame, std::uint16_t data_id_change = 0) const {
        std::size_t i = 0;
        while (can().axis_ids[i] != frame.id) {
            ++i;
        }
        const auto data_id = static_cast<std::uint16_t>(can().data_ids[i] ^ data_id_change);
        if (is_fd()) {
            p05_protect({frame.data.data(), frame.length_bytes}, data_id, frame.data[2]);
        } else {
            frame.data[0] =
                classical_crc(std::span<const std::uint8_t, 8>(frame.data.data(), 8), data_id);
        }
    }
    /// A frame that the board did not send.
    CanFrame foreign(std::uint32_t id) {
        CanFrame frame;
        frame.id = id;
        frame.length_bytes = 8;
        frame.time_us = world.wire.now_us;
        for (std::uint8_t& byte : frame.data) {
            byte = static_cast<std::uint8_t>(draw(256));
        }
        return frame;
    }
    /// As the kernel tells of the controller: class, and for class 4 its state.
    CanFrame error_frame(std::uint32_t kind, std::uint8_t state = 0) {
        CanFrame frame = foreign(kind);
        frame.error = true;
        frame.data[1] = state;
        return frame;
    }
    /// Such a frame now, and no other.
    void inject_error(std::uint32_t kind, std::uint8_t state = 0) {
        world.wire.arrive(error_frame(kind, state));
        touch_now();
    }
};

/// What must come of a fault.
enum class Reaction : std::uint8_t {
    stop,     // stopped, stored, the stop on the wire within the limit, and no permit after it
    mute,     // the same, but the wire takes nothing: the last permit left within the limit
    borne,    // armed still, and never without a permit for longer than a permit lasts
    either,   // one or the other: chance decides whether the frame passes for one of the board's
    unarmed,  // from the start: never armed, and no permit, whatever a person does
};

struct LiveFaultRow {
    const char* id;  // of the fault tables
    const char* what;
    Reaction reaction;
    std::int64_t limit_us;  // from the first effect to the stop, and to the last permit
    void (*inject)(FaultScene&);
    bool (*is_seen)(FaultScene&);  // for what it is; null: there is nothing to be seen
    enum class For : std::uint8_t { every_format, classical, fd } format = For::every_format;
    std::int64_t periods = 20;               // to run after it
    void (*prepare)(FaultScene&) = nullptr;  // before the guard starts
};

}  // namespace axg::test
