// SPDX-License-Identifier: Apache-2.0
// A motion board for tests: a five-axis machine on a smooth path, its frames in order of time.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "core/base/sincos.hpp"
#include "core/machine/machine.hpp"
#include "firmware_if/protocol/axis_frames.hpp"
#include "firmware_if/receiver/axis_receiver.hpp"

namespace axg::test {

/// Drives 3 to 7: status word and position in one PDO, that of X with its velocity in a second one.
inline void add_drives(Machine& machine) {
    for (std::uint32_t i = 0; i < 5; ++i) {
        CanSignal status;
        status.id = 0x183 + i;
        status.axis = i;
        status.length_bits = 16;
        status.is_signed = false;
        status.role = SignalRole::drive_status;
        status.mark = i == 0 ? 0x0100 : 0;  // the others keep their place
        status.frame_bytes = 6;
        CanSignal position = status;
        position.role = SignalRole::position;
        position.start_bit = 16;
        position.length_bits = 32;
        position.is_signed = true;
        position.factor = i < 3 ? 5.0 / 65536 : 360.0 / (1 << 20);
        machine.can.signals.push_back(status);
        machine.can.signals.push_back(position);
    }
    CanSignal velocity = machine.can.signals[1];
    velocity.id = 0x283;
    velocity.role = SignalRole::velocity;
    velocity.start_bit = 0;
    velocity.frame_bytes = 4;
    velocity.factor = 0.001;
    machine.can.signals.push_back(velocity);
    machine.can.sync_counter_max = 0;
    machine.can.stale_after_us = 4 * machine.can.sample_us;
}

inline Machine five_axis_machine(CanFormat format) {
    Machine machine;
    const auto add = [&](const char* name, bool rotary, double limit, double speed) {
        Axis axis;
        axis.name = name;
        axis.kind = rotary ? AxisKind::rotary : AxisKind::linear;
        axis.min = -limit;
        axis.max = limit;
        axis.speed_max = speed;
        axis.acceleration_max = rotary ? 20 : 5000;
        machine.axes.push_back(axis);
    };
    add("X", false, 300, 500);
    add("Y", false, 300, 500);
    add("Z", false, 250, 500);
    add("A", true, 2.0, 3.0);
    add("C", true, 0, 6.0);
    machine.axes.back().unlimited = true;
    machine.can.format = format;
    if (format == CanFormat::cia402) {
        add_drives(machine);
    }
    if (format == CanFormat::signals) {
        for (std::uint32_t i = 0; i < 5; ++i) {
            CanSignal signal;
            signal.id = 0x300 + i / 2;
            signal.axis = i;
            signal.length_bits = 32;
            signal.start_bit = static_cast<std::uint16_t>(i % 2 == 0 ? 0 : 39);
            signal.order = i % 2 == 0 ? ByteOrder::little : ByteOrder::big;
            signal.factor = 1.0e-4;
            machine.can.signals.push_back(signal);
        }
    }
    return machine;
}

/// Sample k of a path that turns C through many turns and stays within every limit.
inline AxisSnapshot snapshot_at(const Machine& machine, std::uint64_t k) {
    const double t = static_cast<double>(k) * machine.can.sample_us * 1.0e-6;
    AxisSnapshot snapshot;
    snapshot.latched_us = 1'000'000 + static_cast<std::int64_t>(k) * machine.can.sample_us;
    snapshot.sample = k;
    snapshot.axis_count = 5;
    snapshot.tool = 7;
    snapshot.mode = kModeMoving;
    snapshot.position = {100 * std::sin(2 * t), -50 * std::cos(t), -20 + 10 * std::sin(3 * t),
                         0.5 * std::sin(t), 5.0 * t};
    return snapshot;
}

inline std::vector<CanFrame> frames_of(AxisEncoder& encoder, const AxisSnapshot& snapshot) {
    std::vector<CanFrame> frames(kFramesPerSnapshotMax);
    const EncodeResult result = encoder.encode(snapshot, frames);
    frames.resize(result.frame_count);
    return frames;
}

/// Samples 0..count-1, grouped by sample.
inline std::vector<std::vector<CanFrame>> board_frames(const Machine& machine,
                                                       std::uint64_t count) {
    AxisEncoder encoder(machine);
    std::vector<std::vector<CanFrame>> all;
    for (std::uint64_t k = 0; k < count; ++k) {
        all.push_back(frames_of(encoder, snapshot_at(machine, k)));
    }
    return all;
}

/// Everything a receiver said to a stream of frames.
struct Heard {
    std::vector<AxisSnapshot> snapshots;
    std::vector<ReceiverEvent> faults;
};

inline void listen(AxisReceiver& receiver, const std::vector<CanFrame>& frames, Heard& heard) {
    for (const CanFrame& frame : frames) {
        const ReceiverEvent event = receiver.on_frame(frame);
        if (event.kind == ReceiverEvent::Kind::snapshot) {
            heard.snapshots.push_back(event.snapshot);
        } else if (event.kind == ReceiverEvent::Kind::fault) {
            heard.faults.push_back(event);
        }
    }
}

inline std::uint64_t environment_number(const char* name, std::uint64_t otherwise) {
    const char* text = std::getenv(name);
    return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

}  // namespace axg::test
