// SPDX-License-Identifier: Apache-2.0
// The guard's counters as a text file for the Prometheus node exporter (its textfile collector):
// units in the names, no time stamps, the file replaced as a whole. No allocation after
// construction.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "firmware_if/live/live_view.hpp"

namespace axg {

inline constexpr std::int64_t kMetricsPeriodUs = 1'000'000;

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

/// Replaces the metrics file by the metrics of about now.
class MetricsWriter {
  public:
    /// @param file  empty: none is written
    MetricsWriter(std::string bus, const std::string& file) : bus_(std::move(bus)), file_(file) {}
    ~MetricsWriter() { file_.remove(); }  // those of a guard that has ended would mislead
    MetricsWriter(const MetricsWriter&) = delete;
    MetricsWriter& operator=(const MetricsWriter&) = delete;

    /// Some times a second. No allocation.
    void work(ViewExchange& exchange, std::int64_t now_us) noexcept;

  private:
    std::string bus_;
    ReplacedFile file_;
    std::int64_t due_us_ = 0;
    bool has_failed_ = false;
    std::array<char, 16384> text_{};
};

}  // namespace axg
