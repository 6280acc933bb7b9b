// SPDX-License-Identifier: Apache-2.0
// What a guard may conclude from axis frames of each format: one row a format. Other rooms read a
// column; only two programs choose a format by its name (trace_period.cpp, simulate_command.cpp).
// A new format is a row here, at the end since hashes have its number, a codec in
// firmware_if/protocol/axis_frames.cpp, and its name in the schema. Claim: rows stand in the
// order of CanFormat (static_assert), and the columns agree with the frames
// (tests/unit/firmware_if/protocol/wire_format_test.cpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/limits.hpp"

namespace axg {

inline constexpr std::uint8_t kSyncCounterMax = 240;  // CANopen object 0x1019
inline constexpr std::uint32_t kFdAxesMax = 13;       // 12 + 4 * 13 = 64 bytes

// classical and fd are ours; signals are frames of other makers without SYNC (a DBC file, or
// written in the machine file); cia402 are the process data of drives, all latched by one SYNC.
enum class CanFormat : std::uint8_t { classical, fd, signals, cia402 };

/// How a receiver recognises the frames of one sample.
enum class SampleMark : std::uint8_t {
    index,    // each frame states the index of its sample; the SYNC of that index dates it
    sync,     // frames follow the SYNC that dates them
    arrival,  // frames arrive together, and nothing else dates them
};

/// Evidence of rest, in addition to positions that do not change.
enum class RestReport : std::uint8_t {
    mode,      // each sample states a mode
    speeds,    // a signal states motion, or the speeds of all axes do; otherwise no axis rests
    optional,  // the same; without it positions have to stay for longer
};

struct WireFormat {
    CanFormat format = CanFormat::classical;
    const char* name = "";  // as can.format states it; "dbc" files contain signals
    SampleMark mark = SampleMark::index;
    RestReport rest = RestReport::mode;
    std::uint8_t slots_a_frame = 0;         // of own frames: one an axis, then one for the status
    std::uint8_t axes_max = kAxesMax;       // of own frames
    std::uint8_t index_modulus = 1;         // of sample indexes in own frames
    bool has_sender_clock = false;          // frames also state the time of the sender
    bool has_look_ahead = false;            // the board may announce its path
    double counts_per_mm = 1.0e3;           // of own frames
    std::int32_t position_most = 0x7FFFFF;  // counts of own frames, either way
    std::uint16_t tool_most = 255;          // number that own frames carry
    std::uint8_t permit_samples_most = 15;
    std::uint8_t stale_samples_least = 3;  // default of can.stale_after_us
    std::uint8_t latched_age_samples = 0;  // default of can.latched_age_us, largest
};

inline constexpr std::array<WireFormat, 4> kWireFormats{{
    {.format = CanFormat::classical,
     .name = "classical",
     .slots_a_frame = 2,
     .index_modulus = 16,
     // A hole of 9 samples counts as late already, and one of 16 looks like none.
     .permit_samples_most = 12},
    {.format = CanFormat::fd,
     .name = "fd",
     .slots_a_frame = UINT8_MAX,
     .axes_max = kFdAxesMax,
     .index_modulus = kSyncCounterMax,
     .has_sender_clock = true,
     .has_look_ahead = true,
     .counts_per_mm = 1.0e4,
     .position_most = INT32_MAX,
     .tool_most = UINT16_MAX},
    {.format = CanFormat::signals,
     .name = "signals",
     .mark = SampleMark::arrival,
     .rest = RestReport::optional},
    {.format = CanFormat::cia402,
     .name = "cia402",
     .mark = SampleMark::sync,
     .rest = RestReport::speeds,
     // A frame of a drive that is lost costs its sample and the next.
     .stale_samples_least = 4,
     // A drive may answer with the value of the SYNC before.
     .latched_age_samples = 1},
}};

static_assert(
    [] {
        for (std::size_t i = 0; i < kWireFormats.size(); ++i) {
            if (kWireFormats[i].format != static_cast<CanFormat>(i)) {
                return false;
            }
        }
        return true;
    }(),
    "wire_format() finds a row by its number");

[[nodiscard]] constexpr const WireFormat& wire_format(CanFormat format) noexcept {
    const auto row = static_cast<std::size_t>(format);
    return kWireFormats[row < kWireFormats.size() ? row : 0];
}

/// Whether the frames are of our own making: counter, checksum, SYNC, heartbeat.
[[nodiscard]] constexpr bool is_native(const WireFormat& wire) noexcept {
    return wire.mark == SampleMark::index;
}

/// Whether a SYNC dates each sample. Without it only its arrival does.
[[nodiscard]] constexpr bool has_sync(const WireFormat& wire) noexcept {
    return wire.mark != SampleMark::arrival;
}

/// Axis frames a sample of our own formats; 0 for others.
[[nodiscard]] constexpr std::uint32_t own_axis_frames(const WireFormat& wire,
                                                      std::size_t axis_count) noexcept {
    const auto slots = static_cast<std::uint32_t>(axis_count) + 1;
    return wire.slots_a_frame == 0 ? 0 : (slots + wire.slots_a_frame - 1U) / wire.slots_a_frame;
}

}  // namespace axg
