// SPDX-License-Identifier: Apache-2.0
// From frames to complete samples: three assemblers with their own state, one for each SampleMark.
// Set-up makes the one of the format; none knows events, counters or severities. Rules:
// docs/reference/protocol.md. Claim: never two instants in one sample, never an unknown age
// (tests/property/firmware_if/protocol/axis_frames_test.cpp).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <variant>

#include "core/machine/machine.hpp"
#include "firmware_if/protocol/axis_frames.hpp"
#include "firmware_if/receiver/arrival_anchor.hpp"
#include "firmware_if/receiver/frame_gate.hpp"
#include "firmware_if/receiver/received_samples.hpp"

namespace axg {

/// The result of one frame: nothing yet, a fault, or a complete sample.
struct Assembly {
    ReceiverFault fault = ReceiverFault::none;
    bool begins_period = false;    // this SYNC begins a period
    bool is_estimated = false;     // the SYNC was lost: the instant is extrapolated
    std::uint32_t steps = 1;       // periods since the last snapshot
    std::optional<Latch> latch{};  // of the complete sample in ReceivedSamples::set
};

/// One axis frame that passed all checks of its own.
struct AxisFrame {
    const CanFrame& frame;
    const AxisFrameContent& content;
    std::uint32_t slot;
    LastFrame& last;  // of this slot
};

/// The last good SYNC, and what the next one is against it.
struct SyncWatch {
    std::uint8_t counter_max = kSyncCounterMax;  // 0: SYNC is empty
    SequenceCheck sequence;
    bool is_known = false;  // there is a last one
    std::uint8_t counter = 0;
    std::int64_t time_us = 0;

    struct Step {
        ReceiverFault fault = ReceiverFault::none;
        std::int64_t periods = 1;
        bool is_in_time = true;
        // Our clock was set back: it measures nothing across that, and this stamp may be the only
        // one.
        bool is_set_back = false;
    };
    [[nodiscard]] Step judge(const CanFrame& frame, std::int64_t period_us) noexcept;
    /// A good SYNC becomes the last one; its stamp may prove or refute the period.
    [[nodiscard]] Assembly take(const CanFrame& frame, const Step& step, bool is_torn,
                                ReceivedSamples& samples) noexcept;
    void forget() noexcept {
        sequence.reset();
        is_known = false;
    }
};

/// A sender whose clock stops while its counter runs repeats old values in fresh frames. If its
/// clock shows that the frames were delayed together with their SYNC, it determines the age of the
/// sample. Its periods count from the sample that it dated last, delivered or not.
struct SenderClock {
    bool is_known = false;
    std::uint8_t index = 0;  // of the sample that it dated last
    std::uint32_t last_us = 0;
    std::int64_t offset_us = 0;   // smallest (our clock - sender's clock) seen, leaking
    std::int64_t elapsed_us = 0;  // sender's clock, unwrapped

    /// sender_clock or sync_period; none: the sample may be used.
    [[nodiscard]] ReceiverFault judge(std::uint32_t sender_us, std::uint32_t modulus,
                                      ReceivedSamples& samples, Latch& latch) noexcept;
};

/// Frames of our own formats: each states the index of its sample.
class NativeAssembler {
  public:
    NativeAssembler(const CanLayout& can, const AxisFrameSet& set) noexcept;
    [[nodiscard]] Assembly on_sync(const CanFrame& frame, ReceivedSamples& samples) noexcept;
    [[nodiscard]] Assembly on_axis(const AxisFrame& axis, ReceivedSamples& samples) noexcept;
    void forget() noexcept;

  private:
    struct SyncStamp {
        std::uint8_t counter = 0;  // 0: none
        std::int64_t time_us = 0;
    };
    [[nodiscard]] Assembly finish(std::uint32_t sender_us, ReceivedSamples& samples) noexcept;
    void date(const ReceivedSamples& samples, Assembly& out) noexcept;

    std::uint32_t modulus_;
    SyncWatch sync_;
    std::array<SyncStamp, 16> sync_stamps_{};
    std::uint8_t estimates_ = 0;  // in a row
    std::optional<SenderClock> sender_clock_;
};

/// Process data of drives. These latch their positions as SYNC ends and number nothing: only time
/// shows which frames belong together. After any event that may have mixed two instants, a whole
/// group is discarded.
class DriveAssembler {
  public:
    DriveAssembler(const CanLayout& can, const AxisFrameSet& set) noexcept;
    [[nodiscard]] Assembly on_sync(const CanFrame& frame, ReceivedSamples& samples) noexcept;
    [[nodiscard]] Assembly on_axis(const AxisFrame& axis, ReceivedSamples& samples) noexcept;
    void forget() noexcept;

  private:
    std::int64_t window_us_;
    SyncWatch sync_;
    bool is_open_ = false;     // process data of the last SYNC may come
    bool is_suspect_ = false;  // a frame of an earlier SYNC may still be on its way
};

/// Frames of other makers carry neither counter nor index: a set is what arrives within one period,
/// each id once. Its number follows from its arrival.
class SignalAssembler {
  public:
    explicit SignalAssembler(const CanLayout& can) noexcept;
    [[nodiscard]] static Assembly on_sync(const CanFrame& /*frame*/,
                                          ReceivedSamples& /*samples*/) noexcept {
        return {};  // the format has no SYNC
    }
    [[nodiscard]] Assembly on_axis(const AxisFrame& axis, ReceivedSamples& samples) noexcept;
    void forget() noexcept { arrivals_.has_sample = false; }

  private:
    ArrivalAnchor arrivals_;
};

using Assembler = std::variant<NativeAssembler, DriveAssembler, SignalAssembler>;
[[nodiscard]] Assembler make_assembler(const CanLayout& can, const AxisFrameSet& set) noexcept;

/// @param modulus  of the counter; 0: the frame has none
[[nodiscard]] SequenceCheck sequence_of(const CanLayout& can, std::uint16_t modulus) noexcept;

}  // namespace axg
