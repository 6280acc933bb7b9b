// SPDX-License-Identifier: Apache-2.0
// A healthy board's frames, damaged as the input says and then sealed again with valid checksums,
// so that the fuzzer reaches what lies behind them: no snapshot while INVALID, none older than the
// age limit, none outside the travel, sample numbers that only grow; a look-ahead path is one of
// numbers, ahead of the last snapshot. Both native formats, the flexible one with a look-ahead
// path, and drives.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "firmware_if/protocol/e2e.hpp"
#include "tests/fuzz/targets.hpp"
#include "tests/support/can_board.hpp"

namespace {

constexpr std::uint32_t kLookAhead = 20;

void seal(const axg::AxisFrameSet& set, axg::CanFrame& frame) {
    if (set.wire->format == axg::CanFormat::cia402) {
        return;  // drives send no checksum
    }
    if (set.look_ahead_samples != 0 && frame.id == set.look_ahead_id &&
        frame.length_bytes == set.look_ahead_bytes) {
        axg::p05_protect({frame.data.data(), frame.length_bytes}, set.look_ahead_data_id,
                         frame.data[2]);
        return;
    }
    for (std::uint32_t slot = 0; slot < set.frame_count; ++slot) {
        if (frame.id != set.ids[slot] || frame.length_bytes != set.frame_bytes[slot]) {
            continue;
        }
        if (set.wire->format == axg::CanFormat::fd) {
            axg::p05_protect({frame.data.data(), frame.length_bytes}, set.data_ids[slot],
                             frame.data[2]);
        } else {
            frame.data[0] = axg::classical_crc(
                std::span<const std::uint8_t, 8>(frame.data.data(), 8), set.data_ids[slot]);
        }
    }
}

/// Four bytes of input a frame: what to change, where, with what, and how late it comes.
void damage(axg::CanFrame& frame, const std::uint8_t* input) {
    switch (input[0] % 8U) {
        case 1:
            frame.data[input[1] % 64U] ^= input[2];
            break;
        case 2:
            frame.data[1] = input[2];
            break;
        case 3:
            frame.length_bytes = static_cast<std::uint8_t>(input[2] % 65U);
            break;
        case 4:
            frame.id = input[1] * 8U + input[2] % 8U;
            break;
        case 5:
            frame.error = true;
            frame.data[1] = input[2];
            break;
        default:
            break;
    }
    frame.time_us += input[0] < 128 ? 0 : input[3] * 16 - 1024;
}

axg::Machine machine_of(std::uint8_t choice) {
    constexpr std::array kFormats{axg::CanFormat::classical, axg::CanFormat::fd, axg::CanFormat::fd,
                                  axg::CanFormat::cia402};
    axg::Machine machine = axg::test::five_axis_machine(kFormats[choice % kFormats.size()]);
    machine.can.look_ahead_samples = choice % kFormats.size() == 2 ? kLookAhead : 0;
    return machine;
}

std::vector<axg::CanFrame> frames_of(const axg::Machine& machine, axg::AxisEncoder& encoder,
                                     std::uint64_t k) {
    const axg::AxisSnapshot snapshot = axg::test::snapshot_at(machine, k);
    if (machine.can.look_ahead_samples == 0) {
        return axg::test::frames_of(encoder, snapshot);
    }
    axg::PathPoints look_ahead;
    look_ahead.sample = k + kLookAhead;
    look_ahead.position = axg::test::snapshot_at(machine, k + kLookAhead).position;
    look_ahead.before = axg::test::snapshot_at(machine, k + kLookAhead - 1).position;
    std::vector<axg::CanFrame> frames(axg::kFramesPerSnapshotMax);
    frames.resize(encoder.encode(snapshot, frames, &look_ahead).frame_count);
    return frames;
}

bool is_path(const axg::PathPoints& look_ahead, std::uint64_t next_sample) {
    bool is_good = look_ahead.sample + axg::kLookAheadSamplesMax >= next_sample;
    for (std::size_t i = 0; i < 5; ++i) {
        for (const double position : {look_ahead.position[i], look_ahead.before[i]}) {
            is_good = is_good && std::isfinite(position);
            is_good = is_good && (i != 4 || (position >= 0 && position < 2 * axg::kPi));
        }
    }
    return is_good;
}

}  // namespace

int axg::fuzz::frame(const std::uint8_t* data, std::size_t size) {
    if (size == 0) {
        return 0;
    }
    const axg::Machine machine = machine_of(data[0]);
    axg::AxisEncoder encoder(machine);
    axg::AxisReceiver receiver(machine);
    std::uint64_t next_sample = 0;
    std::size_t at = 1;
    for (std::uint64_t k = 0; at + 4 <= size && k < 500; ++k) {
        for (axg::CanFrame& frame : frames_of(machine, encoder, k)) {
            if (at + 4 <= size) {
                damage(frame, data + at);
                at += 4;
                seal(encoder.frame_set(), frame);
            }
            const bool was_invalid = receiver.state() == axg::ReceiverState::invalid;
            const axg::ReceiverEvent event = receiver.on_frame(frame);
            if (event.kind == axg::ReceiverEvent::Kind::look_ahead &&
                (was_invalid || !is_path(event.look_ahead, next_sample))) {
                std::abort();
            }
            if (event.kind != axg::ReceiverEvent::Kind::snapshot) {
                continue;
            }
            const axg::AxisSnapshot& snapshot = event.snapshot;
            bool is_good = !was_invalid && snapshot.sample >= next_sample &&
                           snapshot.arrived_us - snapshot.latched_us <= machine.can.stale_after_us;
            for (std::size_t i = 0; i < 4; ++i) {
                is_good = is_good && snapshot.position[i] >= machine.axes[i].min &&
                          snapshot.position[i] <= machine.axes[i].max;
            }
            if (!is_good) {
                std::abort();
            }
            next_sample = snapshot.sample + 1;
        }
    }
    return 0;
}
