// SPDX-License-Identifier: Apache-2.0
// What can be wrong with the frames that come in and the axes that they speak of (rows C and A of
// the fault tables). Limits: at once means the period in which it arrives; what is found by age,
// three periods and one.
#pragma once

#include <array>

#include "tests/support/fault_scene.hpp"

namespace axg::test {

inline constexpr std::int64_t kAtOnceUs = 1000, kByAgeUs = 4000;
// linux/can/error.h: classes, and states of the controller.
inline constexpr std::uint32_t kErrorController = 0x004, kErrorAck = 0x020, kErrorBusOff = 0x040,
                               kErrorBus = 0x080, kErrorRestarted = 0x100;
inline constexpr std::uint8_t kRxOverflow = 0x01, kRxWarning = 0x04, kTxWarning = 0x08,
                              kRxPassive = 0x10, kTxPassive = 0x20;
using Frames = std::vector<CanFrame>;

/// Everything is held up until then, and arrives at once.
inline void hold(FaultScene& s, std::int64_t held_us) {
    s.touch_now();
    s.always([until_us = s.world.wire.now_us + held_us](FaultScene&, Frames& frames) {
        for (CanFrame& frame : frames) {
            frame.time_us = std::max(frame.time_us, until_us);
        }
    });
}

inline void flip_bits(FaultScene& s, CanFrame& frame) {
    const std::uint32_t first = s.draw(8U * frame.length_bytes);
    const std::uint32_t second = s.draw(8U * frame.length_bytes);
    frame.data[first / 8] ^= static_cast<std::uint8_t>(1U << first % 8);
    if (second != first) {
        frame.data[second / 8] ^= static_cast<std::uint8_t>(1U << second % 8);
    }
    s.touch(frame.time_us);
}

/// Frames as the board's own, but for what `change` does to them, beside the sample.
template <class Change>
void add_copies(FaultScene& s, Frames& frames, Change change) {
    const std::size_t count = frames.size();
    for (std::size_t i = 0; i < count; ++i) {
        if (s.is_axis(frames[i])) {
            CanFrame copy = frames[i];
            change(copy);
            s.touch(copy.time_us);
            frames.push_back(copy);
        }
    }
}

inline constexpr std::array kLostRows = std::to_array<LiveFaultRow>({
    {"C01", "one frame lost", Reaction::borne, 0,
     [](FaultScene& s) {
         s.once([](FaultScene& t, Frames& frames) {
             const std::uint32_t id = t.some_axis_frame(frames).id;
             t.touch(frames[0].time_us);
             std::erase_if(frames, [id](const CanFrame& frame) { return frame.id == id; });
         });
     },
     [](FaultScene& s) {
         const ReceiverCounters& now = s.world.guard->receiver().counters();
         return now.samples_lost == s.before.samples_lost + 1;
     }},
    {"C02", "one whole sample lost", Reaction::borne, 0,
     [](FaultScene& s) {
         s.once([](FaultScene& t, Frames& frames) {
             t.touch(frames[0].time_us);
             frames.clear();
         });
     },
     [](FaultScene& s) {
         const ReceiverCounters& now = s.world.guard->receiver().counters();
         return now.samples_lost == s.before.samples_lost + 1;
     }},
    {"C03", "one frame of each sample never comes", Reaction::stop, kByAgeUs,
     [](FaultScene& s) {
         s.always([id = s.can().axis_ids[s.draw(s.is_fd() ? 1 : 3)]](FaultScene& t, Frames& f) {
             t.touch(f[0].time_us);
             std::erase_if(f, [id](const CanFrame& frame) { return frame.id == id; });
         });
     },
     [](FaultScene& s) { return s.is_old(); }},
    {"C04", "board silent", Reaction::stop, kByAgeUs,
     [](FaultScene& s) {
         s.always([](FaultScene& t, Frames& frames) {
             t.touch(frames[0].time_us);
             frames.clear();
         });
     },
     [](FaultScene& s) { return s.is_old(); }},
    {"C05", "late by up to a period", Reaction::borne, 0,
     [](FaultScene& s) { hold(s, 100 + s.draw(900)); }, nullptr},
    {"C06", "held up for 4 to 20 periods, then a burst", Reaction::stop, kByAgeUs,
     [](FaultScene& s) { hold(s, 4000 + s.draw(16'000)); },
     [](FaultScene& s) { return s.is_old(); }, LiveFaultRow::For::every_format, 30},
    {"C35", "every second sample lost", Reaction::stop, 80'000,
     [](FaultScene& s) {
         s.always([](FaultScene& t, Frames& frames) {
             t.touch(frames[0].time_us);
             if (t.applied % 2 == 0) {
                 frames.clear();
             }
         });
     },
     [](FaultScene& s) {
         return s.has_stopped_for(GuardFault::flapping) || s.gave_up_for(ReceiverFault::loss_limit);
     },
     LiveFaultRow::For::every_format, 90},
});

inline constexpr std::array kFrameRows = std::to_array<LiveFaultRow>({
    {"C07", "duplicate", Reaction::borne, 0,
     [](FaultScene& s) {
         s.once([](FaultScene& t, Frames& frames) { add_copies(t, frames, [](CanFrame&) {}); });
     },
     [](FaultScene& s) { return s.grown(ReceiverFault::repeated) > 0; }},
    {"C08", "the same sample again for ever", Reaction::stop, kByAgeUs,
     [](FaultScene& s) {
         s.always([](FaultScene& t, Frames& frames) {
             if (t.kept.empty()) {
                 t.kept = frames;
                 return;
             }
             const std::int64_t later_us = frames[0].time_us - t.kept[0].time_us;
             t.touch(frames[0].time_us);
             frames = t.kept;
             for (CanFrame& frame : frames) {
                 frame.time_us += later_us;
             }
         });
     },
     [](FaultScene& s) { return s.is_old() && s.grown(ReceiverFault::repeated) > 0; }},
    {"C09", "a frame of the last sample after the next", Reaction::borne, 0,
     [](FaultScene& s) {
         s.always([](FaultScene& t, Frames& frames) {
             if (t.kept.empty()) {
                 t.kept = {t.some_axis_frame(frames)};
             } else if (t.applied == 0) {
                 t.kept[0].time_us = t.last_axis_frame(frames).time_us;
                 frames.push_back(t.kept[0]);
                 t.touch(t.kept[0].time_us);
             }
         });
     },
     [](FaultScene& s) { return s.grown(ReceiverFault::wrong_sequence) > 0; }},
    {"C10", "one or two bits changed, once", Reaction::borne, 0,
     [](FaultScene& s) {
         s.once([](FaultScene& t, Frames& f) { flip_bits(t, t.some_axis_frame(f)); });
     },
     [](FaultScene& s) { return s.grown(ReceiverFault::bad_crc) == 1; }},
    {"C10", "one or two bits changed, in every sample", Reaction::stop, kByAgeUs,
     [](FaultScene& s) {
         s.always([](FaultScene& t, Frames& f) { flip_bits(t, t.some_axis_frame(f)); });
     },
     [](FaultScene& s) { return s.is_old() && s.grown(ReceiverFault::bad_crc) > 0; }},
    {"C11", "a random payload, once", Reaction::either, kByAgeUs,
     [](FaultScene& s) {
         s.once([](FaultScene& t, Frames& frames) {
             CanFrame& frame = t.some_axis_frame(frames);
             frame.data = t.foreign(0).data;
             t.touch(frame.time_us);
         });
     },
     [](FaultScene& s) {
         const ReceiverCounters& now = s.world.guard->receiver().counters();
         return now.faults != s.before.faults;
     }},
    {"C12", "a second sender with the right checksum", Reaction::stop, kAtOnceUs,
     [](FaultScene& s) {
         s.world.has_second_board = true;
         s.always([](FaultScene& t, Frames& frames) { t.touch(frames[1].time_us); });
     },
     [](FaultScene& s) { return s.gave_up_for(ReceiverFault::spoofed); }},
    {"C13", "the payload of another id, in every sample", Reaction::stop, kByAgeUs,
     [](FaultScene& s) {
         const auto other = static_cast<std::uint16_t>(1 + s.draw(0xFFFF));
         s.always([other](FaultScene& t, Frames& frames) {
             CanFrame& frame = t.some_axis_frame(frames);
             const std::array was = frame.data;
             t.protect(frame, other);
             frame.data[0] ^= std::uint8_t{frame.data == was};  // one in 256: the same checksum
             t.touch(frame.time_us);
         });
     },
     [](FaultScene& s) { return s.is_old() && s.grown(ReceiverFault::bad_crc) > 0; }},
    {"C14", "extended ids with our low bits", Reaction::borne, 0,
     [](FaultScene& s) {
         s.always([](FaultScene& t, Frames& frames) {
             add_copies(t, frames, [&t](CanFrame& frame) {
                 frame.extended = true;
                 frame.id |= t.draw(0x3FFFF) << 11U;
             });
         });
     },
     [](FaultScene& s) { return s.grown(ReceiverFault::extended_id) > 0; }},
    {"C15", "remote frames with our ids", Reaction::borne, 0,
     [](FaultScene& s) {
         s.always([](FaultScene& t, Frames& frames) {
             add_copies(t, frames, [](CanFrame& frame) { frame.remote = true; });
         });
     },
     [](FaultScene& s) { return s.grown(ReceiverFault::remote_frame) > 0; }},
    {"C16", "frames of this host", Reaction::stop, kAtOnceUs,
     [](FaultScene& s) {
         s.always([](FaultScene& t, Frames& frames) {
             frames[0].sent_by_host = true;
             t.touch(frames[0].time_us);
         });
     },
     [](FaultScene& s) { return s.gave_up_for(ReceiverFault::local_sender); }},
});

inline constexpr std::array kShapeRows = std::to_array<LiveFaultRow>({
    {"C17", "another length, once", Reaction::borne, 0,
     [](FaultScene& s) {
         s.once([](FaultScene& t, Frames& frames) {
             CanFrame& frame = t.some_axis_frame(frames);
             frame.length_bytes = static_cast<std::uint8_t>(t.draw(frame.length_bytes));
             t.touch(frame.time_us);
         });
     },
     [](FaultScene& s) { return s.grown(ReceiverFault::bad_length) == 1; }},
    {"C17", "another length, in every sample", Reaction::stop, kByAgeUs,
     [](FaultScene& s) {
         s.always([](FaultScene& t, Frames& frames) {
             CanFrame& frame = t.some_axis_frame(frames);
             frame.length_bytes = static_cast<std::uint8_t>(t.draw(frame.length_bytes));
             t.touch(frame.time_us);
         });
     },
     [](FaultScene& s) { return s.is_old() && s.grown(ReceiverFault::bad_length) > 0; }},
    {"C18", "flexible for classical, or the reverse, in every sample", Reaction::stop, kByAgeUs,
     [](FaultScene& s) {
         s.always([](FaultScene& t, Frames& frames) {
             CanFrame& frame = t.some_axis_frame(frames);
             frame.fd = !frame.fd;
             t.touch(frame.time_us);
         });
     },
     [](FaultScene& s) { return s.is_old() && s.grown(ReceiverFault::bad_format) > 0; }},
    {"C19", "a raw length code, once", Reaction::borne, 0,
     [](FaultScene& s) {
         s.once([](FaultScene& t, Frames& frames) {
             CanFrame& frame = t.some_axis_frame(frames);
             frame.raw_dlc = static_cast<std::uint8_t>(9 + t.draw(7));
             t.touch(frame.time_us);
         });
     },
     [](FaultScene& s) { return s.grown(ReceiverFault::raw_dlc) == 1; }},
    {"C20", "a babbling node: nobody else gets through", Reaction::mute, kByAgeUs,
     [](FaultScene& s) {
         s.world.wire.is_deaf = true;
         s.touch_now();
         s.always([](FaultScene& t, Frames& frames) {
             const std::int64_t from_us = frames[0].time_us;
             frames.assign(20, t.foreign(0));
             for (std::size_t i = 0; i < frames.size(); ++i) {
                 frames[i].time_us = from_us + 50 * static_cast<std::int64_t>(i);
             }
         });
     },
     [](FaultScene& s) { return s.is_old() || s.has_stopped_for(GuardFault::output); }},
    {"C21", "a flood of our ids", Reaction::stop, kAtOnceUs,
     [](FaultScene& s) {
         CanFrame frame = s.foreign(s.can().axis_ids[0]);
         frame.fd = s.is_fd();
         frame.length_bytes = 7;  // no payload passes the checksum by chance
         for (int i = 0; i < 20; ++i) {
             s.world.wire.arrive(frame);
         }
         s.touch_now();
     },
     [](FaultScene& s) { return s.gave_up_for(ReceiverFault::flood); }},
    {"C32", "more frames at once than are read at once", Reaction::borne, 0,
     [](FaultScene& s) {
         for (int i = 0; i < 300; ++i) {
             s.world.wire.arrive(s.foreign(0x7AA));
         }
         s.touch_now();
     },
     [](FaultScene& s) { return s.world.guard->counters().frames_left > 0; }},
    {"C34", "the sample counter runs backwards", Reaction::stop, kByAgeUs,
     [](FaultScene& s) {
         s.says([from = std::uint64_t{s.world.samples() + 2398}](FaultScene& t, AxisSnapshot& p) {
             p.sample = from - t.applied;
         });
     },
     // With permit 2 its session frames count other laps.
     [](FaultScene& s) { return s.is_old() || s.gave_up_for(ReceiverFault::held_up); }},
});

inline constexpr std::array kControllerRows = std::to_array<LiveFaultRow>({
    {"C22", "receive queue overflowed: a sample lost, and told", Reaction::borne, 0,
     [](FaultScene& s) {
         s.once([](FaultScene& t, Frames& frames) {
             CanFrame told = t.error_frame(kErrorController, kRxOverflow);
             told.time_us = t.last_axis_frame(frames).time_us;
             t.touch(frames[0].time_us);
             frames.assign(1, told);
         });
     },
     [](FaultScene& s) { return s.grown(ReceiverFault::rx_overflow) == 1; }},
    {"C23", "the controller overflows in every sample", Reaction::stop, 40'000,
     [](FaultScene& s) {
         s.always([](FaultScene& t, Frames& frames) {
             CanFrame told = t.error_frame(kErrorController, kRxOverflow);
             told.time_us = frames.back().time_us;
             t.touch(told.time_us);
             frames.push_back(told);
         });
     },
     [](FaultScene& s) {
         return s.has_stopped_for(GuardFault::flapping) || s.gave_up_for(ReceiverFault::loss_limit);
     },
     LiveFaultRow::For::every_format, 50},
    {"C24", "error-warning", Reaction::borne, 0,
     [](FaultScene& s) {
         s.inject_error(kErrorController, s.draw(2) == 0 ? kRxWarning : kTxWarning);
     },
     [](FaultScene& s) { return s.grown(ReceiverFault::error_frame) == 1; }},
    {"C25", "receiver error-passive", Reaction::borne, 0,
     [](FaultScene& s) { s.inject_error(kErrorController, kRxPassive); },
     [](FaultScene& s) { return s.grown(ReceiverFault::rx_passive) == 1; }},
    {"C25", "sender error-passive", Reaction::stop, kAtOnceUs,
     [](FaultScene& s) { s.inject_error(kErrorController, kTxPassive); },
     [](FaultScene& s) { return s.gave_up_for(ReceiverFault::tx_passive); }},
    {"C26", "no acknowledge", Reaction::mute, kByAgeUs,
     [](FaultScene& s) {
         s.world.wire.is_deaf = true;
         s.inject_error(kErrorAck);
     },
     [](FaultScene& s) {
         return s.has_stopped_for(GuardFault::output) && s.world.wire.applied > 0;
     }},
    {"C27", "bus-off", Reaction::stop, kAtOnceUs,
     [](FaultScene& s) { s.inject_error(kErrorBusOff); },
     [](FaultScene& s) { return s.gave_up_for(ReceiverFault::bus_off); }},
    {"C27", "restarted after bus-off", Reaction::stop, kAtOnceUs,
     [](FaultScene& s) { s.inject_error(kErrorRestarted); },
     [](FaultScene& s) { return s.gave_up_for(ReceiverFault::bus_restarted); }},
    {"C28", "interface down", Reaction::mute, kAtOnceUs,
     [](FaultScene& s) {
         s.world.wire.reply = SendStatus::down;
         s.world.wire.inject(ReadStatus::down);
         s.touch_now();
     },
     [](FaultScene& s) {
         return s.has_stopped_for(GuardFault::input) || s.has_stopped_for(GuardFault::output);
     }},
    {"C28", "interface removed", Reaction::mute, kAtOnceUs,
     [](FaultScene& s) {
         s.world.wire.reply = SendStatus::gone;
         s.world.wire.inject(ReadStatus::gone);
         s.touch_now();
     },
     [](FaultScene& s) { return s.world.guard->is_wire_gone(); }},
    {"C29", "interface down, and up at once", Reaction::stop, kAtOnceUs,
     [](FaultScene& s) {
         s.world.wire.inject(ReadStatus::down);
         s.touch_now();
     },
     [](FaultScene& s) {
         return s.has_stopped_for(GuardFault::input) && s.world.wire.applied == 1;
     }},
    {"C31", "a flood of bus errors", Reaction::borne, 0,
     [](FaultScene& s) {
         s.always([](FaultScene& t, Frames& frames) {
             CanFrame told = t.error_frame(kErrorBus);
             told.time_us = frames[0].time_us;
             t.touch(told.time_us);
             frames.insert(frames.begin(), 60, told);
         });
     },
     [](FaultScene& s) { return s.grown(ReceiverFault::error_frame) > 60; }},
});

inline constexpr std::array kAxisRows = std::to_array<LiveFaultRow>({
    {"A01", "no position", Reaction::stop, kAtOnceUs,
     [](FaultScene& s) {
         s.always([](FaultScene& t, Frames& frames) {
             CanFrame& frame = frames[1];  // the first axes
             const std::size_t width = t.is_fd() ? 4 : 3;
             const std::size_t at = (t.is_fd() ? 4 : 2) + width * t.draw(2);
             std::fill_n(frame.data.begin() + static_cast<std::ptrdiff_t>(at), width - 1, 0);
             frame.data[at + width - 1] = 0x80;
             t.protect(frame);
             t.touch(t.last_axis_frame(frames).time_us);
         });
     },
     [](FaultScene& s) { return s.gave_up_for(ReceiverFault::no_position); }},
    {"A02", "out of travel", Reaction::stop, kAtOnceUs,
     [](FaultScene& s) {
         s.says([axis = s.draw(4)](FaultScene& t, AxisSnapshot& p) {
             p.position[axis] = t.world.machine.axes[axis].max + 0.01;
         });
     },
     [](FaultScene& s) { return s.gave_up_for(ReceiverFault::out_of_travel); }},
    {"A03", "a jump beyond what the axis can do", Reaction::stop, kAtOnceUs,
     [](FaultScene& s) {
         s.says([axis = s.draw(5)](FaultScene&, AxisSnapshot& p) {
             p.position[axis] += axis < 3 ? 2.0 : 0.05;
         });
     },
     [](FaultScene& s) { return s.gave_up_for(ReceiverFault::jump); }},
    {"A04", "positions stand while the board says moving", Reaction::stop, 103'000,
     [](FaultScene& s) {
         s.says([still = AxisSnapshot{}](FaultScene& t, AxisSnapshot& p) mutable {
             still = t.applied == 0 ? p : still;
             p.position = still.position;
         });
     },
     [](FaultScene& s) { return s.gave_up_for(ReceiverFault::frozen); },
     LiveFaultRow::For::every_format, 110},
    {"A05", "the sender's clock stands", Reaction::stop, kByAgeUs,
     [](FaultScene& s) {
         s.always([](FaultScene& t, Frames& frames) {
             CanFrame& frame = frames[1];
             if (t.kept.empty()) {
                 t.kept = {frame};
                 return;
             }
             std::copy_n(t.kept[0].data.begin() + 24, 4, frame.data.begin() + 24);
             t.protect(frame);
             t.touch(frame.time_us);
         });
     },
     [](FaultScene& s) { return s.is_old() && s.grown(ReceiverFault::sender_clock) > 0; },
     LiveFaultRow::For::fd},
    {"A06", "a later frame always of the sample before", Reaction::stop, kByAgeUs,
     [](FaultScene& s) {
         // Not the first one: its sample would be whole when it comes, and be used, a period old.
         s.always([slot = 2 + s.draw(2)](FaultScene& t, Frames& frames) {
             const CanFrame own = frames[slot];
             if (!t.kept.empty()) {
                 frames[slot].data = t.kept[0].data;
                 t.touch(frames[0].time_us);
             }
             t.kept = {own};
         });
     },
     [](FaultScene& s) { return s.is_old(); }, LiveFaultRow::For::classical},
    {"A08", "an axis lost its reference", Reaction::stop, kAtOnceUs,
     [](FaultScene& s) { s.says([](FaultScene&, AxisSnapshot& p) { p.flags |= kFlagNotHomed; }); },
     [](FaultScene& s) { return s.gave_up_for(ReceiverFault::not_homed); }},
    {"A10", "an encoder rolled over", Reaction::stop, kAtOnceUs,
     [](FaultScene& s) {
         s.says([axis = s.draw(3)](FaultScene&, AxisSnapshot& p) {
             p.position[axis] += p.position[axis] > 0 ? -400 : 400;
         });
     },
     [](FaultScene& s) {
         return s.gave_up_for(ReceiverFault::jump) || s.gave_up_for(ReceiverFault::out_of_travel);
     }},
});

}  // namespace axg::test
