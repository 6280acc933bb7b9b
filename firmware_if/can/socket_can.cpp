// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/can/socket_can.hpp"

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/net_tstamp.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>

#include "core/machine/can_id.hpp"

namespace axg {
namespace {

// Reports of the controller that the socket receives. Single bus errors are left out: a bad cable
// causes thousands a second, and error-passive and bus-off report it too.
constexpr can_err_mask_t kErrorClasses =
    CAN_ERR_CRTL | CAN_ERR_TRX | CAN_ERR_ACK | CAN_ERR_BUSOFF | CAN_ERR_RESTARTED;

std::int64_t clock_us(clockid_t clock) noexcept {
    timespec time{};
    clock_gettime(clock, &time);
    return time.tv_sec * std::int64_t{1'000'000} + time.tv_nsec / 1000;
}

template <class Value>
bool set_option(int socket, int level, int name, const Value& value) noexcept {
    return setsockopt(socket, level, name, &value, sizeof value) == 0;
}

/// Only data frames with these ids: a mask without the flags would let extended frames with the
/// same low bits through.
bool set_filters(int socket, const CanIds& ids) noexcept {
    std::array<can_filter, kCanFiltersMax> filters{};
    for (std::uint32_t i = 0; i < ids.count; ++i) {
        // The mark of 29 bits is CAN_EFF_FLAG itself.
        const bool is_extended = is_extended_id(ids.id[i]);
        filters[i] = {
            .can_id = ids.id[i],
            .can_mask = CAN_EFF_FLAG | CAN_RTR_FLAG | (is_extended ? CAN_EFF_MASK : CAN_SFF_MASK)};
    }
    return setsockopt(socket, SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(),
                      static_cast<socklen_t>(ids.count * sizeof(can_filter))) == 0;
}

/// The option that failed, or null.
const char* set_options(int socket, const SocketOptions& options) noexcept {
    const int on = 1;
    if (!set_filters(socket, options.ids)) {
        return "CAN_RAW_FILTER";
    }
    if (!set_option(socket, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, kErrorClasses)) {
        return "CAN_RAW_ERR_FILTER";
    }
    if (!set_option(socket, SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, on)) {
        return "CAN_RAW_RECV_OWN_MSGS";
    }
    if (options.is_fd && !set_option(socket, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, on)) {
        return "CAN_RAW_FD_FRAMES";
    }
    if (!set_option(socket, SOL_SOCKET, SO_RXQ_OVFL, on)) {
        return "SO_RXQ_OVFL";
    }
    const int stamps = SOF_TIMESTAMPING_RX_SOFTWARE | SOF_TIMESTAMPING_SOFTWARE |
                       SOF_TIMESTAMPING_RX_HARDWARE | SOF_TIMESTAMPING_RAW_HARDWARE;
    if (!set_option(socket, SOL_SOCKET, SO_TIMESTAMPING, stamps)) {
        return "SO_TIMESTAMPING";
    }
    if (options.receive_buffer_bytes > 0 &&
        !set_option(socket, SOL_SOCKET, SO_RCVBUF, options.receive_buffer_bytes)) {
        return "SO_RCVBUF";
    }
    return nullptr;
}

std::string words(const std::string& interface, const char* what, int error) {
    return interface + ": " + what + ": " + std::strerror(error);
}

/// Index of an interface that is up and carries the requested frames; 0 and `fault` otherwise.
int find_interface(int socket, const SocketOptions& options, std::string& fault) {
    ifreq request{};
    if (options.interface.empty() || options.interface.size() >= sizeof request.ifr_name) {
        fault =
            '"' + options.interface + "\": not the name of an interface. List them with ip link.";
        return 0;
    }
    std::copy(options.interface.begin(), options.interface.end(), request.ifr_name);
    if (ioctl(socket, SIOCGIFINDEX, &request) != 0) {
        fault = words(options.interface, "no such interface", errno) + ". List them with ip link.";
        return 0;
    }
    const int index = request.ifr_ifindex;
    if (ioctl(socket, SIOCGIFFLAGS, &request) != 0 || (request.ifr_flags & IFF_UP) == 0) {
        fault = options.interface + ": interface is down. Set it up: ip link set " +
                options.interface + " up (a real bus: ip link set " + options.interface +
                " up type can bitrate 1000000 restart-ms 0)";
        return 0;
    }
    if (ioctl(socket, SIOCGIFMTU, &request) != 0 ||
        (options.is_fd && request.ifr_mtu < static_cast<int>(CANFD_MTU))) {
        fault = options.interface + ": no CAN FD, but the machine file has format fd. " +
                "With the interface down: ip link set " + options.interface +
                " mtu 72 (vcan), or type can ... fd on dbitrate 5000000 (a real bus)";
        return 0;
    }
    return index;
}

CanFrame frame_of(const canfd_frame& raw, bool is_fd, int flags) noexcept {
    CanFrame frame;
    frame.extended = (raw.can_id & CAN_EFF_FLAG) != 0;
    frame.error = (raw.can_id & CAN_ERR_FLAG) != 0;
    frame.remote = (raw.can_id & CAN_RTR_FLAG) != 0;
    frame.id = raw.can_id & (frame.extended || frame.error ? CAN_EFF_MASK : CAN_SFF_MASK);
    frame.fd = is_fd;
    frame.bit_rate_switch = is_fd && (raw.flags & CANFD_BRS) != 0;
    frame.error_state = is_fd && (raw.flags & CANFD_ESI) != 0;
    frame.sent_by_host = (flags & MSG_DONTROUTE) != 0;
    frame.length_bytes = std::min<std::uint8_t>(raw.len, is_fd ? CANFD_MAX_DLEN : CAN_MAX_DLEN);
    if (!is_fd) {
        can_frame classical{};
        std::memcpy(&classical, &raw, sizeof classical);
        frame.raw_dlc = classical.len8_dlc;
    }
    std::copy_n(raw.data, frame.length_bytes, frame.data.begin());
    return frame;
}

struct Stamps {
    std::int64_t software_us = 0;  // CLOCK_REALTIME; 0: none
    std::int64_t hardware_ns = 0;
    std::uint32_t dropped = 0;
    bool has_dropped = false;
};

Stamps stamps_of(msghdr& message) noexcept {
    Stamps stamps;
    for (cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr; c = CMSG_NXTHDR(&message, c)) {
        if (c->cmsg_level != SOL_SOCKET) {
            continue;
        }
        if (c->cmsg_type == SO_TIMESTAMPING) {
            std::array<timespec, 3> times{};  // software, unused, raw hardware
            std::memcpy(times.data(), CMSG_DATA(c), sizeof times);
            stamps.software_us =
                times[0].tv_sec * std::int64_t{1'000'000} + times[0].tv_nsec / 1000;
            stamps.hardware_ns = times[2].tv_sec * std::int64_t{1'000'000'000} + times[2].tv_nsec;
        } else if (c->cmsg_type == SO_RXQ_OVFL) {
            std::memcpy(&stamps.dropped, CMSG_DATA(c), sizeof stamps.dropped);
            stamps.has_dropped = true;
        }
    }
    return stamps;
}

}  // namespace

std::int64_t monotonic_us() noexcept {
    return clock_us(CLOCK_MONOTONIC);
}

const char* to_text(SendStatus status) noexcept {
    switch (status) {
        case SendStatus::failed:
            return "failed";
        case SendStatus::ok:
            return "ok";
        case SendStatus::busy:
            return "busy";
        case SendStatus::down:
            return "down";
        case SendStatus::gone:
            return "gone";
    }
    return "unknown";
}

const char* to_text(ReadStatus status) noexcept {
    switch (status) {
        case ReadStatus::failed:
            return "failed";
        case ReadStatus::none:
            return "none";
        case ReadStatus::frame:
            return "frame";
        case ReadStatus::down:
            return "down";
        case ReadStatus::gone:
            return "gone";
    }
    return "unknown";
}

std::optional<SocketCan> SocketCan::open(const SocketOptions& options, std::string& fault) {
    const int socket = ::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
    if (socket < 0) {
        fault = words(options.interface, "no CAN socket", errno) +
                ". Load the CAN modules: modprobe can-raw.";
        return std::nullopt;
    }
    const int index = find_interface(socket, options, fault);
    if (index == 0) {
        close(socket);
        return std::nullopt;
    }
    SocketCan made(socket);
    if (const char* const option = set_options(socket, options)) {
        fault = words(options.interface, option, errno) + ". Use Linux 5.4 or later.";
        return std::nullopt;
    }
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = index;
    if (bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
        fault = words(options.interface, "bind", errno) + ". Check with ip link that it is up.";
        return std::nullopt;
    }
    made.empty_us_ = made.clock_us_ = monotonic_us();
    return made;
}

SocketCan::SocketCan(SocketCan&& other) noexcept
    : socket_(other.socket_),
      empty_us_(other.empty_us_),
      clock_us_(other.clock_us_),

      dropped_(other.dropped_),
      unreported_(other.unreported_),
      dropped_total_(other.dropped_total_) {
    other.socket_ = -1;
}

SocketCan::~SocketCan() {
    if (socket_ >= 0) {
        close(socket_);
    }
}

SendStatus SocketCan::send(const CanFrame& frame) noexcept {
    canfd_frame raw{};
    raw.can_id = wire_id(frame.id, frame.extended);
    raw.len = frame.length_bytes;
    raw.flags = frame.fd && frame.bit_rate_switch ? CANFD_BRS : 0;
    std::copy_n(frame.data.begin(), std::min<std::size_t>(frame.length_bytes, sizeof raw.data),
                raw.data);
    const std::size_t size = frame.fd ? CANFD_MTU : CAN_MTU;
    const ssize_t written = ::send(socket_, &raw, size, MSG_DONTWAIT | MSG_NOSIGNAL);
    if (written == static_cast<ssize_t>(size)) {
        return SendStatus::ok;
    }
    switch (written < 0 ? errno : EIO) {
        case ENOBUFS:
        case EAGAIN:
        case EINTR:
            return SendStatus::busy;
        case ENETDOWN:
            return SendStatus::down;
        case ENXIO:
        case ENODEV:
            return SendStatus::gone;
        default:
            return SendStatus::failed;
    }
}

/// Drops look like the controller's own overflow: to the receiver both are samples lost.
ReadStatus SocketCan::report_drops(CanArrival& out) noexcept {
    --unreported_;
    out = {};
    out.frame.time_us = monotonic_us();
    out.frame.error = true;
    out.frame.id = CAN_ERR_CRTL;
    out.frame.length_bytes = CAN_ERR_DLC;
    out.frame.data[1] = CAN_ERR_CRTL_RX_OVERFLOW;
    return ReadStatus::frame;
}

void SocketCan::forget() noexcept {
    constexpr std::uint32_t kBacklogMax = 100'000;  // frames: more than a queue holds
    CanArrival old;
    for (std::uint32_t i = 0; i < kBacklogMax && read(old) == ReadStatus::frame; ++i) {
    }
    forgets_drops_ = true;
}

ReadStatus SocketCan::read(CanArrival& out) noexcept {
    if (unreported_ != 0) {
        return report_drops(out);
    }
    canfd_frame raw{};
    iovec part{.iov_base = &raw, .iov_len = sizeof raw};
    alignas(cmsghdr) std::array<char, 256> control{};
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    const ssize_t size = recvmsg(socket_, &message, MSG_DONTWAIT);
    if (size < 0) {
        switch (errno) {
            case EAGAIN:
                empty_us_ = clock_us_;
                is_drained_ = true;
                return ReadStatus::none;
            case EINTR:
                return ReadStatus::none;
            case ENETDOWN:
                return ReadStatus::down;
            case ENODEV:
            case ENXIO:
                return ReadStatus::gone;
            default:
                return ReadStatus::failed;
        }
    }
    if (size != static_cast<ssize_t>(CAN_MTU) && size != static_cast<ssize_t>(CANFD_MTU)) {
        return ReadStatus::failed;
    }
    const Stamps stamps = stamps_of(message);
    out = {};
    out.frame = frame_of(raw, size == static_cast<ssize_t>(CANFD_MTU), message.msg_flags);
    out.is_own = (message.msg_flags & MSG_CONFIRM) != 0;
    out.hardware_ns = stamps.hardware_ns;
    if (is_drained_) {
        is_drained_ = false;
        clock_us_ = monotonic_us();
        wall_ahead_us_ = clock_us(CLOCK_REALTIME) - clock_us_;
    }
    // The kernel stamps by the wall clock, which may be set at any moment. The stamp is clamped to
    // two instants of the monotonic clock: the last at which the queue was empty, and the one at
    // which the burst's first frame was read. A frame of a burst may so look older than it is.
    const std::int64_t stamp_us =
        stamps.software_us == 0 ? empty_us_ : stamps.software_us - wall_ahead_us_;
    out.frame.time_us = std::clamp(stamp_us, empty_us_, clock_us_);
    if (stamps.has_dropped && stamps.dropped != dropped_) {
        unreported_ = stamps.dropped - dropped_;
        dropped_ = stamps.dropped;
        dropped_total_ += unreported_;
        unreported_ = std::min(unreported_, 64U);  // far more than the loss that stops
        unreported_ = forgets_drops_ ? 0 : unreported_;
    }
    forgets_drops_ = false;
    return ReadStatus::frame;
}

}  // namespace axg
