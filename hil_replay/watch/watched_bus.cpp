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

std::unique_ptr<WatchedBus> WatchedBus::open_traces(const std::vector<std::string>& paths,
                                                    std::string& fault) {
    std::unique_ptr<WatchedBus> out(new WatchedBus());
    for (const std::string& path : paths) {
        out->name_ += (out->name_.empty() ? "" : ", ") + path;
        Trace trace{open_trace(path, {.lenient = true}, fault), {}};
        if (!trace.reader) {
            return nullptr;
        }
        out->advance(trace);
        out->traces_.push_back(std::move(trace));
    }
    return out;
}

void WatchedBus::read_until(std::int64_t until_us, const OnFrame& on_frame) {
    if (!traces_.empty()) {
        read_traces(until_us, on_frame);
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

void WatchedBus::advance(Trace& trace) {
    CanFrame frame;
    trace.next = trace.reader->next(frame) ? std::optional(frame) : std::nullopt;
    if (!trace.next && !trace.reader->error().empty()) {
        fault_ = trace.reader->error();
    }
}

void WatchedBus::read_traces(std::int64_t until_us, const OnFrame& on_frame) {
    sleep_until(until_us);
    const std::int64_t now_us = monotonic_us();
    for (std::uint32_t frames = 0; frames < kFramesATurnMax; ++frames) {
        const auto first =
            std::min_element(traces_.begin(), traces_.end(), [](const Trace& a, const Trace& b) {
                return a.next && (!b.next || a.next->time_us < b.next->time_us);
            });
        if (!first->next) {
            end_us_ = last_us_;
            fault_ = fault_.empty() ? name_ + ": the trace has ended" : fault_;
            return;
        }
        CanFrame frame = *first->next;
        if (!has_begun_) {
            has_begun_ = true;
            shift_us_ = now_us - frame.time_us;
        }
        frame.time_us += shift_us_;
        if (frame.time_us > now_us) {
            return;
        }
        last_us_ = frame.time_us;
        on_frame(frame);
        advance(*first);
    }
}

}  // namespace axg
