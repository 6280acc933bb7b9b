// SPDX-License-Identifier: Apache-2.0
// Notifications for systemd: datagrams to the socket named in NOTIFY_SOCKET, sd_notify(3). The
// watchdog is fed only while the guard's periods go on. Without that variable nothing is sent.
#pragma once

#include <cstdint>
#include <string_view>

namespace axg {

class ServiceNotify {
  public:
    /// Reads NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID.
    ServiceNotify() noexcept;
    ~ServiceNotify();
    ServiceNotify(const ServiceNotify&) = delete;
    ServiceNotify& operator=(const ServiceNotify&) = delete;

    /// Reports the service as ready after the first period, and feeds the watchdog four times as
    /// often as required, each time only if periods have ended since.
    void work(std::uint32_t period, std::int64_t now_us) noexcept;
    /// One line for `systemctl status`, without a line break.
    void status(std::string_view words) noexcept;
    void stopping() noexcept { send("STOPPING=1"); }

  private:
    void send(std::string_view words) noexcept;

    int socket_ = -1;
    std::int64_t watchdog_us_ = 0, fed_us_ = 0;
    std::uint32_t period_ = 0;
    bool is_ready_ = false;
};

}  // namespace axg
