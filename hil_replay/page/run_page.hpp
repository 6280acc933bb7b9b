// SPDX-License-Identifier: Apache-2.0
// One self-contained HTML file of a run: the machine in three dimensions, its clearances, axes and
// cycles over time, the stops. It opens from disk, without a network. Docs: docs/guide/report.md.
#pragma once

#include <cstdio>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/base/time_histogram.hpp"
#include "firmware_if/setup/loaded_machine.hpp"
#include "hil_replay/page/clearance_tracker.hpp"
#include "hil_replay/replay/page_samples.hpp"
#include "hil_replay/trace/program_lines.hpp"

namespace axg {

inline constexpr std::size_t kPageRowsMax = 8192;
inline constexpr double kPageWithinMm = 50.0;  // clearances are queried up to this

/// Records the data of a page of a run, sample by sample.
class PageRecorder {
  public:
    /// `loaded` and what `engine` points to must outlive it.
    PageRecorder(const LoadedMachine& loaded, Engine engine)
        : samples_(loaded.machine, kPageRowsMax), clearances_(loaded, engine, kPageWithinMm) {}

    void note(const AxisSnapshot& snapshot, const PageCycle& cycle) {
        samples_.add(snapshot, cycle, {.mm = clearances_.at(snapshot)});
    }
    /// After the last sample, once: the nearest pair of every row.
    [[nodiscard]] const PageSamples& finish() {
        samples_.finish();
        samples_.settle([this](const AxisSnapshot& snapshot, std::span<const double> bounds_mm) {
            return clearances_.nearest(snapshot, bounds_mm);
        });
        return samples_;
    }

  private:
    PageSamples samples_;
    ClearanceTracker clearances_;
};

struct RunPage {
    const LoadedMachine& loaded;
    const PageSamples& samples;
    const TimeHistogram* cycles;  // null: not measured
    std::int64_t deadline_us;
    std::string title, words;  // the command's own summary
    // [{"time_us", "reason", may be: "axes": {"X_mm": ..}, "pairs": [{"pair", "triangles"}]}]
    std::string stops;
    const ProgramLines* program = nullptr;  // null or empty: no lines
    // [bodies] whether the line of a rotary axis is a guess; empty: the page draws no axes.
    std::vector<bool> guessed_axes{};
};

/// Writes the page whole or not at all. False: `messages` has the reason, and what to install.
[[nodiscard]] bool write_run_page(const std::string& path, const RunPage& page,
                                  std::FILE* messages);

/// Returns the text that `print` prints.
[[nodiscard]] std::string printed_text(const std::function<void(std::FILE*)>& print);

/// The data of the page alone, as JSON text without '<'.
[[nodiscard]] std::string page_data(const RunPage& page);

}  // namespace axg
