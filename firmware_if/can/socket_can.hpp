// SPDX-License-Identifier: Apache-2.0
// A CAN interface of Linux: one raw socket, classical and FD, that never waits. Kernel filters let
// through the ids of the machine file alone, and only data frames; error frames say what the
// controller sees; drops of the queue become error frames of the same kind. Times are of
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
    bool is_fd = false;                     // take flexible frames too
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
    /// By the queue of this socket being full, since it was opened.
    /// What came since the socket was opened, while memory was reserved: old, and with holes where
    /// the queue was too small for it. A guard that began with it would begin with faults.
    void forget() noexcept;
    [[nodiscard]] std::uint64_t frames_dropped() const noexcept { return dropped_total_; }

  private:
    explicit SocketCan(int socket) noexcept : socket_(socket) {}
    [[nodiscard]] ReadStatus report_drops(CanArrival& out) noexcept;

    int socket_ = -1;
    // The queue was empty at the one instant, and a frame was in it at the other; between bursts
    // the first is taken as early as the last look at the clock.
    std::int64_t empty_us_ = 0, clock_us_ = 0;
    std::int64_t wall_ahead_us_ = 0;  // CLOCK_REALTIME less CLOCK_MONOTONIC, at the last burst
    bool is_drained_ = true;
    std::uint32_t dropped_ = 0;     // SO_RXQ_OVFL as last reported, modulo 2^32
    std::uint32_t unreported_ = 0;  // drops that `read` has not told yet
    bool forgets_drops_ = false;    // those that the next frame tells of were before it
    std::uint64_t dropped_total_ = 0;
};

/// CLOCK_MONOTONIC, us.
[[nodiscard]] std::int64_t monotonic_us() noexcept;

}  // namespace axg
