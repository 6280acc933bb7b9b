// SPDX-License-Identifier: Apache-2.0
// Shows a guard in another program's process as axguardd shows its own: status socket, metrics, and
// dumps of the black box, by two threads of this service. The guard's thread never waits for them.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>

#include "firmware_if/explain/stop_desk.hpp"
#include "firmware_if/live/black_box_dump.hpp"
#include "firmware_if/live/live_view.hpp"
#include "firmware_if/live/metrics.hpp"
#include "firmware_if/live/status_line.hpp"
#include "firmware_if/live/status_server.hpp"
#include "firmware_if/system/status_socket.hpp"

namespace axg {

struct LiveServiceOptions {
    std::string name;                         // in the place of the bus
    std::string status_socket, metrics_file;  // empty: none
    BlackBoxHeader black_box;
    BlackBoxFolder dumps;
};

class LiveService {
  public:
    /// Reserves all memory and opens the socket; `line` and `desk` must outlive it.
    /// @param fault  reason of a socket that could not be opened; else empty
    LiveService(const Machine& machine, const StatusLine& line, StopDesk& desk,
                const LiveServiceOptions& options, std::string& fault);
    /// Ends the threads, and writes a dump that is due.
    ~LiveService();
    LiveService(const LiveService&) = delete;
    LiveService& operator=(const LiveService&) = delete;

    /// Starts the threads, in which all signals are blocked.
    void start();

    /// For LiveOptions::black_box.
    [[nodiscard]] BlackBoxQueue& records() noexcept { return *records_; }
    /// Passes on a note that the guard's thread has read. A stop has a dump if the guard was armed:
    /// a control that starts before its axes are homed stops each time. No allocation.
    void note(const LiveNote& note) noexcept;
    /// Called by the guard's thread after each turn. No allocation.
    /// @param now_us  by the guard's clock
    template <class MakeView>
    void show(std::int64_t now_us, const MakeView& view) noexcept {
        now_us_.store(now_us, std::memory_order_relaxed);
        answer(status_, view);
        answer(metrics_, view);
    }

  private:
    void run_logger();
    void take_records();

    const StatusLine& line_;
    StopDesk& desk_;
    StatusSocket socket_;
    MetricsWriter writer_;
    std::unique_ptr<BlackBoxQueue> records_;
    BlackBox black_box_;
    BlackBoxDump dump_;
    SpscQueue<LiveNote, 64> notes_{};
    ViewExchange status_{}, metrics_{};
    std::atomic<std::int64_t> now_us_{0};
    bool was_armed_ = false;  // the guard's thread: before this stop
    std::atomic<bool> is_ending_{false};
    std::thread logger_, server_;
};

}  // namespace axg
