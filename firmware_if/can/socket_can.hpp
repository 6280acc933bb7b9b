// SPDX-License-Identifier: Apache-2.0
// A CAN interface of Linux: one raw socket, classical and FD, that never waits. Kernel filters let
// through only the ids of the machine file, and only data frames; error frames report what the
// controller detects; drops of the queue become error frames of the same kind. Times are of
// CLOCK_MONOTONIC, us. Source: linux/Documentation/networking/can.rst, socket(7).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "firmware_if/can/can_transport.hpp"

namespace axg {

inline constexpr std::uint32_t kCanFiltersMax = 72;  // 16 drives, three frames each, and ours

/// The ids a live guard has to see: the board's frames, and its own, for their echo and for a
/// second guard.
struct CanIds {
    std::array<std::uint32_t, kCanFiltersMax> id{};  // as core/machine/can_id.hpp marks them
    std::uint32_t count = 0;
};

struct SocketOptions {
    std::string interface;  // "can0"
    CanIds ids;
    bool is_fd = false;                     // receive flexible frames too
    std::int32_t receive_buffer_bytes = 0;  // SO_RCVBUF; 0: the system's
};

class SocketCan final : public CanTransport {
  public:
    /// Empty: `fault` has the failure and the next step.
    [[nodiscard]] static std::optional<SocketCan> open(const SocketOptions& options,
                                                       std::string& fault);
    ~SocketCan() override;
    SocketCan(SocketCan&& other) noexcept;
    SocketCan(const SocketCan&) = delete;
    SocketCan& operator=(SocketCan&&) = delete;

    [[nodiscard]] SendStatus send(const CanFrame& frame) noexcept override;
    [[nodiscard]] ReadStatus read(CanArrival& out) noexcept override;

    /// For poll(); readable when `read` has a result.
    [[nodiscard]] int descriptor() const noexcept { return socket_; }
    /// Discards the frames that arrived since the socket was opened, while memory was reserved:
    /// they are old, with gaps where the queue was full, and a guard would begin with faults.
    void forget() noexcept;
    /// Frames dropped because the queue of this socket was full, since it was opened.
    [[nodiscard]] std::uint64_t frames_dropped() const noexcept { return dropped_total_; }

  private:
    explicit SocketCan(int socket) noexcept : socket_(socket) {}
    [[nodiscard]] ReadStatus report_drops(CanArrival& out) noexcept;

    int socket_ = -1;
    // Instants at which the queue was last empty and had a frame in it; between bursts the first is
    // as early as the last reading of the clock.
    std::int64_t empty_us_ = 0, clock_us_ = 0;
    std::int64_t wall_ahead_us_ = 0;  // CLOCK_REALTIME less CLOCK_MONOTONIC, at the last burst
    bool is_drained_ = true;
    std::uint32_t dropped_ = 0;     // SO_RXQ_OVFL as last reported, modulo 2^32
    std::uint32_t unreported_ = 0;  // drops that `read` has not reported yet
    bool forgets_drops_ = false;    // drops reported with the next frame were before it
    std::uint64_t dropped_total_ = 0;
};

/// CLOCK_MONOTONIC, us.
[[nodiscard]] std::int64_t monotonic_us() noexcept;

}  // namespace axg
