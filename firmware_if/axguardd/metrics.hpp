// SPDX-License-Identifier: Apache-2.0
// The guard's counters as a text file for the Prometheus node exporter (its textfile collector):
// units in the names, no time stamps, the file replaced as a whole. No allocation after
// construction.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

#include "core/guard/guard_state.hpp"
#include "firmware_if/axguardd/admission.hpp"
#include "firmware_if/guard/guard_node.hpp"
#include "firmware_if/receiver/axis_receiver.hpp"

namespace axg {

inline constexpr std::int64_t kMetricsPeriodUs = 1'000'000;

/// Verdict of the admission at the start, one bit a check in the order of kAdmissionChecks.
struct AdmissionGauge {
    bool is_fit = false;
    double margin = 0;
    std::uint32_t failed = 0;  // those that a person waived: there is no guard otherwise
};
[[nodiscard]] AdmissionGauge gauge_of(const AdmissionVerdict& verdict) noexcept;

/// The bus thread's copy of its state for other threads.
struct LiveView {
    GuardPhase phase = GuardPhase::stopped;
    GuardFault cause = GuardFault::none;
    LiveCounters counters;
    ReceiverCounters input;
    std::uint64_t frames_dropped = 0;
    std::int64_t time_us = 0, phase_us = 0;  // of this view; when the phase began
    StopReason reason = StopReason::none;    // of the newest stop, and its pair
    std::uint32_t pair = kNoIndex;
    std::uint32_t stop_query = 0;  // GuardNode::stop_query
    WithheldPermit withheld;
    bool stands = false, is_confirmed = false, has_session = false;
    AdmissionGauge admission;  // at the start
    bool compares_hashes = true;
};
static_assert(std::is_trivially_copyable_v<LiveView>);

/// @param bus  names the guard in every line
/// @return     how much was written; 0: `out` was too small
[[nodiscard]] std::size_t write_metrics(const LiveView& view, std::string_view bus,
                                        std::span<char> out) noexcept;

/// A file that appears under its name when it is complete, readable for everyone.
class ReplacedFile {
  public:
    /// @param path  empty: nothing is ever written
    explicit ReplacedFile(const std::string& path) : path_(path), part_(path + ".part") {}
    [[nodiscard]] bool is_wanted() const noexcept { return !path_.empty(); }
    /// False: the reason is in errno.
    [[nodiscard]] bool replace(std::span<const char> text) const noexcept;
    void remove() const noexcept;
    [[nodiscard]] const std::string& path() const noexcept { return path_; }

  private:
    std::string path_, part_;
};

}  // namespace axg
