// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/watch/watched_bus.hpp"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <utility>

#include "firmware_if/guard/live_ids.hpp"
#include "firmware_if/protocol/axis_frames.hpp"

namespace axg {
namespace {

// A full bus sends 100 frames in this time, and a queue holds more: one wake-up reads many.
constexpr std::int64_t kNapUs = 5'000;

void sleep_until(std::int64_t until_us) {
    const std::int64_t left_ms = (until_us - monotonic_us()) / 1000;
    poll(nullptr, 0, static_cast<int>(std::max<std::int64_t>(left_ms, 1)));
}

}  // namespace

std::unique_ptr<WatchedBus> WatchedBus::open_interface(const Machine& machine,
                                                       const std::string& interface,
                                                       std::string& fault) {
    std::unique_ptr<WatchedBus> out(new WatchedBus());
    out->name_ = interface;
    out->options_.interface = interface;
    out->options_.ids.count = live_ids(machine, out->options_.ids.id);
    const AxisFrameSet set = make_frame_set(machine);
    out->options_.is_fd =
        std::find(set.is_flexible.begin(), set.is_flexible.end(), true) != set.is_flexible.end();
    return out->open_listener(fault) ? std::move(out) : nullptr;
}

std::unique_ptr<WatchedBus> WatchedBus::open_trace_file(const std::string& path,
                                                        std::string& fault) {
    std::unique_ptr<WatchedBus> out(new WatchedBus());
    out->name_ = path;
    out->trace_ = open_trace(path, {.lenient = true}, fault);
    return out->trace_ ? std::move(out) : nullptr;
}

void WatchedBus::read_until(std::int64_t until_us, const OnFrame& on_frame) {
    if (trace_) {
        read_trace(until_us, on_frame);
        return;
    }
    for (std::uint32_t frames = 0; frames < kFramesATurnMax; ++frames) {
        if (listener_ && read_listener(on_frame)) {
            continue;
        }
        const std::int64_t now_us = monotonic_us();
        if (!listener_ && now_us >= reopen_us_) {
            reopen_us_ = now_us + kReopenUs;
            fault_ = open_listener(fault_) ? std::string() : fault_;
        }
        if (now_us >= until_us) {
            return;
        }
        sleep_until(std::min(until_us, now_us + kNapUs));
    }
}

bool WatchedBus::open_listener(std::string& fault) {
    std::optional<CanListener> opened = CanListener::open(options_, fault);
    if (opened) {
        listener_.emplace(std::move(*opened));
    }
    return listener_.has_value();
}

bool WatchedBus::read_listener(const OnFrame& on_frame) {
    CanArrival arrival;
    switch (listener_->read(arrival)) {
        case ReadStatus::frame:
            on_frame(arrival.frame);
            return true;
        case ReadStatus::none:
            return false;
        case ReadStatus::failed:
        case ReadStatus::down:
        case ReadStatus::gone:
            break;
    }
    fault_ = name_ + ": the interface is down or was removed";
    reopen_us_ = monotonic_us() + kReopenUs;
    listener_.reset();
    return false;
}

void WatchedBus::read_trace(std::int64_t until_us, const OnFrame& on_frame) {
    sleep_until(until_us);
    const std::int64_t now_us = monotonic_us();
    for (std::uint32_t frames = 0; frames < kFramesATurnMax; ++frames) {
        if (!next_) {
            CanFrame frame;
            if (!trace_->next(frame)) {
                fault_ = name_ + (trace_->error().empty() ? ": the trace has ended"
                                                          : ": " + trace_->error());
                return;
            }
            next_ = frame;
        }
        if (!has_begun_) {
            has_begun_ = true;
            shift_us_ = now_us - next_->time_us;
        }
        next_->time_us += shift_us_;
        if (next_->time_us > now_us) {
            next_->time_us -= shift_us_;
            return;
        }
        on_frame(*next_);
        next_.reset();
    }
}

}  // namespace axg
