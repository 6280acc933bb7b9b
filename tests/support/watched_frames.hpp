// SPDX-License-Identifier: Apache-2.0
// A bus to watch: a board on its path and a guard that permits every sample, as frames in order of
// time, and the machine that both are of.
#pragma once

#include <vector>

#include "firmware_if/protocol/guard_frames.hpp"
#include "firmware_if/protocol/hints_frame.hpp"
#include "firmware_if/protocol/permit_frames.hpp"
#include "tests/support/can_board.hpp"
#include "tests/support/session_frame.hpp"

namespace axg::test {

/// Three bodies, two pairs, permit version 2, hashes.
inline Machine watched_machine() {
    Machine machine = five_axis_machine(CanFormat::classical);
    machine.name = "watched";
    machine.bodies.resize(3);
    machine.bodies[0].name = "plate";
    machine.bodies[1].name = "cutter";
    machine.bodies[2].name = "head";
    machine.pairs = {{.a = 1, .b = 0}, {.a = 2, .b = 0}};
    machine.can.hashes_in_id = 0x582;
    machine.can.hashes_out_id = 0x602;
    machine.can.permit_samples = {3, 12};
    return machine;
}

inline constexpr std::uint32_t kWatchedNonce = 0xC0FFEE;
inline constexpr std::int64_t kWatchedAnswerUs = 400;  // from the latch to the permit

/// Of sample k, with the answer of this nonce.
inline std::array<CanFrame, 2> permit_of_sample(const Machine& machine, std::uint64_t k,
                                                std::uint32_t nonce = kWatchedNonce) {
    return encode_permit(machine.can,
                         {.word = PermitWord::slow,
                          .sync_counter = sync_counter_of(k),
                          .live_counter = static_cast<std::uint8_t>(k + 1),
                          .known_answer_signature = kKnownAnswerSignature,
                          .cap = 125,
                          .mask = 0xFF,
                          .samples = 3,
                          .level = 2,
                          .nonce = nonce,
                          .lap = static_cast<std::uint16_t>(k / kSyncCounterMax)},
                         snapshot_at(machine, k).latched_us + kWatchedAnswerUs);
}

/// Samples 0 to count - 1; every tenth one with session, heartbeats and hints.
inline std::vector<CanFrame> watched_frames(const Machine& machine, std::uint64_t count) {
    std::vector<CanFrame> out;
    std::uint8_t session_counter = 0;
    AxisEncoder encoder(machine, {.says_session = false});
    for (std::uint64_t k = 0; k < count; ++k) {
        const AxisSnapshot snapshot = snapshot_at(machine, k);
        const std::vector<CanFrame> sample = frames_of(encoder, snapshot);
        out.insert(out.end(), sample.begin(), sample.end());
        const std::int64_t now_us = snapshot.latched_us + kWatchedAnswerUs;
        if (k % 10 == 0) {
            CanFrame beat;
            beat.id = machine.can.heartbeat_in_id;
            beat.length_bytes = 1;
            beat.data[0] = 5;
            beat.time_us = now_us;
            out.push_back(beat);
            out.push_back(session_frame(
                {.number = k, .nonce = kWatchedNonce, .counter = session_counter++}, now_us));
        }
        for (const CanFrame& frame : permit_of_sample(machine, k)) {
            out.push_back(frame);
        }
        if (k % 10 == 0) {
            out.push_back(encode_guard_heartbeat(machine.can, GuardHeartbeat::running, now_us));
            out.push_back(encode_hints(
                machine.can, {.sync_counter = sync_counter_of(k), .pair = 1, .distance_10um = 131},
                now_us));
        }
    }
    return out;
}

}  // namespace axg::test
