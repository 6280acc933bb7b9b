// SPDX-License-Identifier: Apache-2.0
// What can go wrong with what leaves, with the engine and with the process itself (rows O, P and R
// of the fault tables), and a proof that fails: what the guard is there for.
#pragma once

#include <array>

#include "tests/support/fault_scene.hpp"
#include "tests/support/input_faults.hpp"

namespace axg::test {

/// The wire says so to every frame from now on.
inline void refuse(FaultScene& s, SendStatus status) {
    s.world.wire.reply = status;
    s.touch_now();
}
inline bool failed_to_send(FaultScene& s) {
    return s.has_stopped_for(GuardFault::output) && s.world.wire.applied > 0;
}

inline void fail_the_proof(FaultScene& s) {
    s.world.verdict = [&s](std::uint64_t) {
        s.touch_now();
        return CycleResult{.is_stop = true, .reason = StopReason::contact};
    };
}

/// A person who resets and arms all the same, and waits.
inline void reset_and_arm(LiveWorld& world) {
    world.guard->reset(world.wire.now_us);
    world.guard->arm(world.wire.now_us);
    world.run_periods(20);
    world.guard->arm(world.wire.now_us);
    world.run_periods(5);
}

inline void send_hashes(FaultScene& s) {
    s.world.machine.can.hashes_in_id = 0x582;
    s.world.machine.can.hashes_out_id = 0x602;
    for (std::uint32_t& hash : s.world.options.hashes.of) {
        hash = static_cast<std::uint32_t>(s.random());
    }
}

// With permit 2 the board's next session frame comes within 100 ms.
inline constexpr std::uint32_t kPeriodsToReady = 160;

inline constexpr std::array kOutputRows = std::to_array<LiveFaultRow>({
    {"", "a proof that fails", Reaction::stop, kAtOnceUs, fail_the_proof,
     [](FaultScene& s) { return s.has_stopped_for(GuardFault::verdict); }},
    {"O01", "the queue is full", Reaction::mute, kByAgeUs,
     [](FaultScene& s) { refuse(s, SendStatus::busy); }, failed_to_send},
    {"O02", "the interface is down", Reaction::mute, kByAgeUs,
     [](FaultScene& s) { refuse(s, SendStatus::down); }, failed_to_send},
    {"O02", "the interface is gone", Reaction::mute, kByAgeUs,
     [](FaultScene& s) { refuse(s, SendStatus::gone); }, failed_to_send},
    {"O03", "a frame written in part", Reaction::mute, kByAgeUs,
     [](FaultScene& s) { refuse(s, SendStatus::failed); }, failed_to_send},
    {"O04", "taken, and never on the wire", Reaction::mute, kByAgeUs,
     [](FaultScene& s) {
         s.world.wire.is_deaf = true;
         s.touch_now();
     },
     failed_to_send},
    {"O05", "the board does not confirm: the stop goes on, a reset is refused", Reaction::stop,
     kAtOnceUs, fail_the_proof,
     [](FaultScene& s) {
         const std::size_t before = s.world.count_sent(s.can().stop_id);
         reset_and_arm(s.world);
         return s.has_stopped_for(GuardFault::verdict) &&
                s.world.count_sent(s.can().stop_id) >= before + 24;
     }},
    {"O06", "a frame takes up to 0.5 ms", Reaction::borne, 0,
     [](FaultScene& s) {
         s.world.wire.echo_us = 150 + s.draw(350);
         s.touch_now();
     },
     nullptr},
    {"O06", "a frame takes longer than two periods", Reaction::stop, kByAgeUs,
     [](FaultScene& s) {
         s.world.wire.echo_us = 2200 + s.draw(20'000);
         s.touch_now();
     },
     [](FaultScene& s) { return s.has_stopped_for(GuardFault::output); }},
    {"O07", "stopped, and started again: latched", Reaction::stop, kAtOnceUs, fail_the_proof,
     [](FaultScene& s) {
         s.world.verdict = [](std::uint64_t) { return CycleResult{.has_permit = true}; };
         s.world.start();
         s.world.run_periods(20);
         s.world.guard->arm(s.world.wire.now_us);
         s.world.run_periods(5);
         return s.has_stopped_for(GuardFault::latched);
     }},
    {"O10", "reset and armed while the cause lasts", Reaction::stop, kByAgeUs,
     [](FaultScene& s) {
         s.always([](FaultScene& t, Frames& frames) {
             t.touch(frames[0].time_us);
             frames.clear();
         });
     },
     [](FaultScene& s) {
         reset_and_arm(s.world);
         return s.is_old();
     }},
});

inline constexpr std::array kProcessRows = std::to_array<LiveFaultRow>({
    {"P03 O09", "the engine is silent, the timer lives", Reaction::stop, kByAgeUs,
     [](FaultScene& s) {
         s.world.engine_runs = false;
         s.touch_now();
     },
     [](FaultScene& s) {
         return s.has_stopped_for(GuardFault::silence) || s.has_stopped_for(GuardFault::engine);
     }},
    {"P06", "every answer after the deadline", Reaction::stop, kByAgeUs,
     [](FaultScene& s) {
         s.world.response_us = s.world.machine.deadline_us + 50 + s.draw(3000);
         s.touch_now();
     },
     [](FaultScene& s) {
         return s.has_stopped_for(GuardFault::silence) || s.has_stopped_for(GuardFault::engine);
     }},
    {"R01 R11", "killed, and started again", Reaction::unarmed, 0,
     [](FaultScene& s) {
         s.world.start();
         s.touch_now();
     },
     [](FaultScene& s) { return s.has_stopped_for(GuardFault::latched); },
     LiveFaultRow::For::every_format, kPeriodsToReady},
    {"R02", "held for 4 to 53 periods", Reaction::stop, kAtOnceUs,
     [](FaultScene& s) {
         s.world.is_held = true;
         s.world.run_periods(4 + s.draw(50));
         s.world.is_held = false;
         s.touch_now();
     },
     [](FaultScene& s) { return s.has_stopped_for(GuardFault::gap); }},
    {"R03", "started again and again", Reaction::unarmed, 0,
     [](FaultScene& s) {
         s.touch_now();
         for (std::uint32_t i = 2 + s.draw(8); i > 0; --i) {
             s.world.start();
             s.world.guard->arm(s.world.wire.now_us);
             s.world.run_periods(s.draw(5));
         }
     },
     [](FaultScene& s) { return s.has_stopped_for(GuardFault::latched); },
     LiveFaultRow::For::every_format, kPeriodsToReady},
    {"R02", "the computer was suspended", Reaction::stop, kAtOnceUs,
     [](FaultScene& s) {
         s.world.guard->report(GuardFault::gap, s.world.wire.now_us);
         s.touch_now();
     },
     [](FaultScene& s) { return s.has_stopped_for(GuardFault::gap); }},
    {"O05", "a stop from another sender", Reaction::stop, kAtOnceUs,
     [](FaultScene& s) {
         CanFrame stop = s.foreign(s.can().stop_id);
         stop.length_bytes = static_cast<std::uint8_t>(s.draw(9));
         s.world.wire.arrive(stop);
         s.touch_now();
     },
     [](FaultScene& s) { return s.has_stopped_for(GuardFault::foreign_stop); }},
    {"R04", "a permit from another guard", Reaction::stop, kAtOnceUs,
     [](FaultScene& s) {
         s.world.wire.arrive(s.foreign(s.can().permit_id + s.draw(2)));
         s.touch_now();
     },
     [](FaultScene& s) { return s.has_stopped_for(GuardFault::second_guard); }},
    {"R05", "the recorder takes nothing", Reaction::stop, 40'000,
     [](FaultScene& s) {
         while (s.world.options.black_box->push({})) {
         }
         s.touch_now();
     },
     [](FaultScene& s) {
         return s.has_stopped_for(GuardFault::flapping) &&
                s.world.guard->counters().records_lost > 0;
     },
     LiveFaultRow::For::every_format, 50,
     [](FaultScene& s) {
         static BlackBoxQueue queue;
         for (BlackBoxEntry entry; queue.pop(entry);) {
         }
         s.world.options.black_box = &queue;
     }},
    {"R12", "the board says another hash", Reaction::stop, kAtOnceUs,
     [](FaultScene& s) {
         HashFrame said{.part = static_cast<std::uint8_t>(s.draw(kHashParts))};
         said.hash = s.world.options.hashes.of[said.part] ^ (1U << s.draw(32));
         s.world.wire.arrive(encode_hash(s.can().hashes_in_id, said, s.world.wire.now_us));
         s.touch_now();
     },
     [](FaultScene& s) { return s.has_stopped_for(GuardFault::refused); },
     LiveFaultRow::For::every_format, 20, send_hashes},
    {"A07 A11", "other units or axes from the start: another hash", Reaction::unarmed, 0,
     [](FaultScene& s) {
         s.world.says_hash = [&s](HashFrame& hash) {
             hash.hash = s.world.options.hashes.of[hash.part];
             hash.hash ^= hash.part == 1 ? 1U << s.draw(32) : 0U;
             return true;
         };
         s.world.guard->end();
         s.world.start();
         s.touch_now();
     },
     [](FaultScene& s) {
         s.world.guard->arm(s.world.wire.now_us);
         return s.has_stopped_for(GuardFault::refused);
     },
     LiveFaultRow::For::every_format, 40, send_hashes},
    {"C30", "another bit rate: errors and nothing else, from the start", Reaction::unarmed, 0,
     [](FaultScene& s) {
         s.world.wire.is_deaf = true;
         s.always([](FaultScene& t, Frames& frames) {
             CanFrame told = t.error_frame(kErrorBus);
             told.time_us = frames[0].time_us;
             frames.assign(3, told);
             t.touch(told.time_us);
         });
         s.world.guard->end();
         s.world.start();
     },
     [](FaultScene& s) {
         s.world.guard->arm(s.world.wire.now_us);
         return s.world.guard->guard().phase == GuardPhase::selftest;
     },
     LiveFaultRow::For::every_format, 40},
});

}  // namespace axg::test
