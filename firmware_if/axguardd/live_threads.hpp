// SPDX-License-Identifier: Apache-2.0
// The threads of the deployed guard except the main one, which waits for signals: the bus thread,
// with the deadline; the engine thread; the logger; the status thread. They share queues without
// locks; a descriptor each wakes the first two, so that none can block another. After the start the
// first two allocate nothing; the logger does for a dump.
#pragma once

#include <string>

#include "firmware_if/can/socket_can.hpp"
#include "firmware_if/explain/stop_desk.hpp"
#include "firmware_if/guard/guard_chain.hpp"
#include "firmware_if/guard/guard_node.hpp"
#include "firmware_if/live/black_box_dump.hpp"
#include "firmware_if/live/metrics.hpp"
#include "firmware_if/live/status_line.hpp"
#include "firmware_if/system/latch_file.hpp"
#include "firmware_if/system/status_socket.hpp"

namespace axg {

struct ThreadOptions {
    int bus_priority = 80, engine_priority = 70;  // SCHED_FIFO; 0: as it is
    int bus_cpu = -1, engine_cpu = -1;            // -1: any
    LiveOptions guard;
    BlackBoxHeader black_box;  // header of its dumps
    BlackBoxFolder dumps;
    std::string bus;           // names the guard in its metrics
    std::string metrics_file;  // empty: none are written
    AdmissionGauge admission;  // for them
    bool compares_hashes = true;
    // State for every user; null: no socket.
    const StatusSocket* status_socket = nullptr;
    const StatusLine* status_line = nullptr;
    StopDesk* desk = nullptr;  // explains stops, for the log and the status
};

/// How a run ended.
struct LiveEnd {
    Guard guard;
    StopReason reason = StopReason::none;
    LiveCounters counters;
    ReceiverCounters input;
    std::uint64_t frames_dropped = 0;
    bool is_wire_gone = false;
    std::string dump;   // the newest of the black box; empty: none
    std::string fault;  // a thread or descriptor could not be made
};

/// Bytes that run_live reserves for threads, queues and the black box.
[[nodiscard]] std::size_t live_bytes(const Machine& machine) noexcept;

/// Runs until SIGTERM or SIGINT, or until the interface is removed. SIGUSR1 arms, SIGUSR2 resets.
/// `machine` is that of `chain`.
[[nodiscard]] LiveEnd run_live(const Machine& machine, GuardChain& chain, SocketCan& wire,
                               LatchCell& latch, const ThreadOptions& options);

}  // namespace axg
