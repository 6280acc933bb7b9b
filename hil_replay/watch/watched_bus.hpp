// SPDX-License-Identifier: Apache-2.0
// The bus that a page watches: a CAN interface that is only listened to and opened again when it
// comes back, or recorded traces of one time, merged, at their own speed.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/machine/machine.hpp"
#include "firmware_if/can/can_listener.hpp"
#include "hil_replay/trace/trace_reader.hpp"

namespace axg {

inline constexpr std::int64_t kReopenUs = 1'000'000;
inline constexpr std::uint32_t kFramesATurnMax = 20'000;  // more than 50 ms of a full CAN FD bus

/// Frames in order of arrival, times of the monotonic clock.
class WatchedBus {
  public:
    using OnFrame = std::function<void(const CanFrame&)>;

    /// Null: `fault` has the failure and the next step.
    [[nodiscard]] static std::unique_ptr<WatchedBus> open_interface(const Machine& machine,
                                                                    const std::string& interface,
                                                                    std::string& fault);
    [[nodiscard]] static std::unique_ptr<WatchedBus> open_traces(
        const std::vector<std::string>& paths, std::string& fault);

    /// Passes on the frames that have come, or come until then. At most kFramesATurnMax frames.
    void read_until(std::int64_t until_us, const OnFrame& on_frame);
    /// Why no frames come; empty: no fault.
    [[nodiscard]] const std::string& fault() const noexcept { return fault_; }
    [[nodiscard]] const std::string& name() const noexcept { return name_; }
    /// When the last frame of all traces was played; nullopt: it was not, or the bus is live.
    [[nodiscard]] std::optional<std::int64_t> end_us() const noexcept { return end_us_; }

  private:
    WatchedBus() = default;
    [[nodiscard]] bool open_listener(std::string& fault);
    /// False: no more in this turn.
    [[nodiscard]] bool read_listener(const OnFrame& on_frame);
    void read_traces(std::int64_t until_us, const OnFrame& on_frame);

    std::string name_, fault_;
    SocketOptions options_;
    std::optional<CanListener> listener_;
    std::int64_t reopen_us_ = 0;
    struct Trace {
        std::unique_ptr<TraceReader> reader;
        std::optional<CanFrame> next;  // none: it has ended
    };
    void advance(Trace& trace);

    std::vector<Trace> traces_;
    std::int64_t shift_us_ = 0;  // from the traces' clock to ours
    std::int64_t last_us_ = 0;   // of our clock
    std::optional<std::int64_t> end_us_;
    bool has_begun_ = false;
};

}  // namespace axg
