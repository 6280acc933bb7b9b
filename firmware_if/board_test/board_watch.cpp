// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/board_test/board_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/reach/stop_limits.hpp"

namespace axg {

namespace {

constexpr std::int64_t kSessionLateUs = 150'000;  // 100 ms, and half of that for a full bus
constexpr std::size_t kSpeedSamples = 20;
constexpr double kSpeedSlack = 1.02;

std::uint8_t cap_of(const Permit& permit, std::size_t axis) noexcept {
    const bool is_bound = ((permit.mask >> std::min<std::size_t>(axis, 7)) & 1U) != 0;
    return is_bound ? permit.cap : kPermitCapNone;
}

/// This computer was too slow to read.
bool is_of_the_host(ReceiverFault fault) noexcept {
    return fault == ReceiverFault::rx_overflow;
}

}  // namespace

void BoardWatch::fail(Watched watched, std::int64_t at_us, std::string found) {
    WatchedState& rule = state(watched);
    rule.is_judged = true;
    if (rule.faults++ == 0) {
        rule.found = std::move(found);
        rule.at_us = at_us;
    }
}

void BoardWatch::on_fault(const ReceiverEvent& event, std::int64_t measured_period_ns) {
    if (event.fault == ReceiverFault::sync_period) {
        has_wrong_period_ = true;
        fail(Watched::samples, event.time_us,
             fmt::format("a period of {:.1f} us (expected can.sample_us {} to 1 %)",
                         static_cast<double>(measured_period_ns) / 1000, machine_.can.sample_us));
        return;
    }
    const FaultRow& row = fault_row(event.fault);
    const bool is_ignored =
        row.severity == Severity::ignore && event.fault != ReceiverFault::repeated;
    if (is_ignored || is_of_the_host(event.fault)) {
        return;
    }
    const Watched watched = event.fault == ReceiverFault::held_up     ? Watched::session
                            : event.fault == ReceiverFault::not_homed ? Watched::mode
                                                                      : Watched::samples;
    fail(watched, event.time_us,
         fmt::format("{}: {} (frame 0x{:03X})", row.name, row.meaning, event.frame_id));
}

void BoardWatch::on_session(const Session& session, std::int64_t time_us) {
    note(Watched::session);
    if (session_us_ != 0 && time_us - session_us_ > kSessionLateUs) {
        fail(Watched::session, time_us,
             fmt::format("{} ms without one", (time_us - session_us_) / 1000));
    }
    session_us_ = time_us;
    nonces_.insert(session.nonce);
}

void BoardWatch::on_new_nonce(std::uint32_t nonce, std::int64_t time_us) {
    note(Watched::new_nonce);
    if (nonces_.count(nonce) != 0) {
        fail(Watched::new_nonce, time_us,
             fmt::format("nonce 0x{:06X} repeated (expected an unused one)", nonce));
    }
}

void BoardWatch::on_permit(const Permit& permit) noexcept {
    ++sent_count_;
    sent_[sent_count_ % sent_.size()] = permit;
}

void BoardWatch::judge_sync(const ReceiverEvent& event) {
    note(Watched::samples);
    const AxisSnapshot& snapshot = event.snapshot;
    const auto period_us = static_cast<double>(machine_.can.sample_us);
    if (samples_ == 0 || snapshot.sample <= last_sample_) {
        first_sample_ = snapshot.sample;
        first_us_ = snapshot.latched_us;
        samples_ = 0;
    } else if (snapshot.sample == last_sample_ + 1) {
        jitter_us_ = std::max(
            jitter_us_, std::abs(static_cast<double>(snapshot.latched_us - last_us_) - period_us));
    } else {
        fail(Watched::samples, event.time_us,
             fmt::format("{} samples are missing", snapshot.sample - last_sample_ - 1));
    }
    last_sample_ = snapshot.sample;
    last_us_ = snapshot.latched_us;
    ++samples_;
}

void BoardWatch::judge_tool(const AxisSnapshot& snapshot, bool is_braking) {
    const bool is_announced = snapshot.mode == kModeToolChange;
    if (is_announced && !announced_us_) {
        announced_us_ = snapshot.latched_us;
    }
    if (has_tool_ && snapshot.tool != tool_) {
        const double horizon_us = 1e6 * free_seconds(machine_, machine_.can.permit_samples.most);
        note(Watched::tool_change);
        const double ahead_us =
            announced_us_ ? static_cast<double>(snapshot.latched_us - *announced_us_) : 0;
        if (ahead_us < horizon_us) {
            fail(Watched::tool_change, snapshot.latched_us,
                 fmt::format("tool {} became {} {:.1f} ms after mode 2 began (expected {:.1f} ms)",
                             tool_, snapshot.tool, ahead_us * 1e-3, horizon_us * 1e-3));
        } else if (is_braking) {
            fail(Watched::tool_change, snapshot.latched_us,
                 fmt::format("tool {} became {} in a stop", tool_, snapshot.tool));
        }
    }
    if (!is_announced) {
        announced_us_.reset();
    }
    tool_ = snapshot.tool;
    has_tool_ = true;
}

void BoardWatch::judge_ack(const AxisSnapshot& snapshot) {
    const std::optional<std::uint8_t> ack = acked_permit(snapshot);
    Bounds bounds;
    bounds.fill(kPermitCapNone);
    if (cap_ == CapPromise::none) {
        if (ack) {
            fail(Watched::ack, snapshot.latched_us,
                 "bit 2 of the flags is set, but the machine file has no cap");
        }
    } else if (ack) {
        note(Watched::ack);
        // Every permit that the nibble may mean, from the oldest that the last ack may have meant.
        const std::uint64_t oldest =
            std::max(acked_, sent_count_ - std::min<std::uint64_t>(sent_count_, 255));
        std::uint64_t first = 0;
        Bounds most{};
        for (std::uint64_t i = std::max<std::uint64_t>(oldest, 1); i <= sent_count_; ++i) {
            const Permit& permit = sent_[i % sent_.size()];
            if ((permit.live_counter & 15U) != *ack) {
                continue;
            }
            first = first == 0 ? i : first;
            for (std::size_t axis = 0; axis < machine_.axes.size(); ++axis) {
                most[axis] = std::max(most[axis], cap_of(permit, axis));
            }
        }
        if (first == 0) {
            fail(Watched::ack, snapshot.latched_us,
                 fmt::format("ack {} names a permit older than the one before, or none", *ack));
        } else {
            acked_ = first;
            bounds = most;
        }
    }
    bounds_.push_back(bounds);
    if (bounds_.size() > kSpeedSamples + 1) {
        bounds_.pop_front();
    }
}

void BoardWatch::judge_speeds(const AxisSnapshot& snapshot, const MotionRecord& record) {
    if (cap_ == CapPromise::none || bounds_.size() <= kSpeedSamples ||
        record.newest().number < kSpeedSamples) {
        return;
    }
    const std::uint64_t now = record.newest().number;
    for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
        std::uint8_t bound = 0;
        for (const Bounds& one : bounds_) {
            bound = std::max(bound, one[i]);
        }
        const double seconds = kSpeedSamples * machine_.can.sample_us * 1e-6;
        const double most = machine_.axes[i].speed_max * bound / kPermitCapNone * kSpeedSlack +
                            2 * record.resolution(i) / seconds;
        const double speed = std::abs(record.speed(i, now - kSpeedSamples, now));
        if (speed > most) {
            fail(Watched::ack, snapshot.latched_us,
                 fmt::format("{} is faster than {}/250 of rapid, which its samples acknowledge",
                             machine_.axes[i].name, bound));
        }
    }
}

void BoardWatch::on_sample(const ReceiverEvent& event, const MotionRecord& record,
                           bool is_braking) {
    judge_sync(event);
    judge_tool(event.snapshot, is_braking);
    judge_ack(event.snapshot);
    judge_speeds(event.snapshot, record);
}

SyncFigures BoardWatch::sync() const noexcept {
    const auto periods = static_cast<double>(last_sample_ - first_sample_);
    return {.samples = samples_,
            .mean_us = periods > 0 ? static_cast<double>(last_us_ - first_us_) / periods : 0,
            .jitter_us_max = jitter_us_};
}

}  // namespace axg
