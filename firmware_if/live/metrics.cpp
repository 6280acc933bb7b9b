// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/live/metrics.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>

namespace axg {
namespace {

/// Writes on while there is room.
class Page {
  public:
    explicit Page(std::span<char> out) noexcept : out_(out) {}

    template <class... Values>
    void put(fmt::format_string<Values...> text, Values&&... values) {
        const auto end = fmt::format_to_n(out_.data() + size_, out_.size() - size_, text,
                                          std::forward<Values>(values)...);
        is_full_ = is_full_ || end.size > out_.size() - size_;
        size_ += is_full_ ? 0 : end.size;
    }
    void head(const char* name, const char* kind, const char* help) {
        put("# HELP axguard_{0} {1}\n# TYPE axguard_{0} {2}\n", name, help, kind);
    }
    [[nodiscard]] std::size_t size() const noexcept { return is_full_ ? 0 : size_; }

  private:
    std::span<char> out_;
    std::size_t size_ = 0;
    bool is_full_ = false;
};

struct Counter {
    const char* name;
    const char* help;
    std::uint64_t value;
};

void put_counters(Page& page, const LiveView& view, std::string_view bus) {
    const LiveCounters& counters = view.counters;
    for (const Counter& counter : std::initializer_list<Counter>{
             {"snapshots_total", "Complete samples of all axes.", counters.snapshots},
             {"permits_total", "Permits sent.", counters.permits},
             {"stop_frames_total", "Stop frames sent.", counters.stops},
             {"answers_late_total", "Verdicts after their deadline.", counters.late},
             {"permits_refused_total", "Proven samples without a permit (late or too old).",
              counters.refused},
             {"echoes_total", "Frames of the guard seen on the bus.", counters.echoes},
             {"send_faults_total", "Frames of the guard that were rejected or not seen on the bus.",
              counters.send_faults},
             {"turns_cut_short_total",
              "Turns of the bus thread that left frames for the next turn.", counters.frames_left},
             {"operator_acts_total", "Resets and armings by operator frames.",
              counters.operator_acts},
             {"operator_refused_total", "Operator messages that were rejected.",
              counters.operator_refused},
             {"operator_ignored_total", "Invalid or out-of-order frames with an operator id.",
              counters.operator_ignored},
             {"samples_lost_total", "Samples that remained incomplete.", view.input.samples_lost},
             {"frames_received_total", "Frames that the receiver saw.", view.input.frames},
             {"frames_dropped_total", "Frames that the kernel dropped at the socket.",
              view.frames_dropped},
         }) {
        page.head(counter.name, "counter", counter.help);
        page.put("axguard_{}{{bus=\"{}\"}} {}\n", counter.name, bus, counter.value);
    }
}

void put_admission(Page& page, const AdmissionGauge& admission, std::string_view bus) {
    page.head("admission_fit", "gauge", "1 if every admission check passed.");
    page.put("axguard_admission_fit{{bus=\"{}\"}} {}\n", bus, admission.is_fit ? 1 : 0);
    page.head("admission_margin_ratio", "gauge",
              "Smallest unused share of all time limits of the admission.");
    page.put("axguard_admission_margin_ratio{{bus=\"{}\"}} {:.3f}\n", bus, admission.margin);
    page.head("admission_waived", "gauge", "1 for a check that failed and was waived by name.");
    for (std::size_t i = 0; i < kAdmissionNames.size(); ++i) {
        page.put("axguard_admission_waived{{bus=\"{}\",check=\"{}\"}} {}\n", bus,
                 kAdmissionNames[i], admission.failed >> i & 1U);
    }
}

}  // namespace

std::size_t write_metrics(const LiveView& view, std::string_view bus,
                          std::span<char> out) noexcept {
    Page page(out);
    page.head("phase_info", "gauge", "1 for the phase that the guard is in.");
    for (std::uint32_t i = 0; i < kGuardPhases; ++i) {
        const auto phase = static_cast<GuardPhase>(i);
        page.put("axguard_phase_info{{bus=\"{}\",phase=\"{}\"}} {}\n", bus, to_text(phase),
                 phase == view.phase ? 1 : 0);
    }
    page.head("stop_cause_info", "gauge", "1 for the cause of the stop; absent without a stop.");
    page.put("axguard_stop_cause_info{{bus=\"{}\",cause=\"{}\"}} 1\n", bus, to_text(view.cause));
    if (view.admission) {
        put_admission(page, *view.admission, bus);
    }
    page.head("hashes_compared", "gauge", "1 if the board has to send the hashes of the machine.");
    page.put("axguard_hashes_compared{{bus=\"{}\"}} {}\n", bus, view.compares_hashes ? 1 : 0);
    put_counters(page, view, bus);
    page.head("receiver_faults_total", "counter", "Faults of received frames, by name.");
    for (std::uint32_t i = 1; i < kReceiverFaults; ++i) {
        const auto fault = static_cast<ReceiverFault>(i);
        page.put("axguard_receiver_faults_total{{bus=\"{}\",fault=\"{}\"}} {}\n", bus,
                 fault_row(fault).name, view.input.of(fault));
    }
    return page.size();
}

namespace {

/// A device, a pipe or a link: neither replaced nor removed.
bool is_something_else(const std::string& path) noexcept {
    struct stat status {};
    return lstat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode);
}

}  // namespace

bool ReplacedFile::replace(std::span<const char> text) const noexcept {
    if (is_something_else(path_)) {
        return false;  // it has the name meanwhile
    }
    const int file =
        open(part_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0644);
    if (file < 0) {
        return false;
    }
    const bool is_written =
        fchmod(file, 0644) == 0 &&  // whatever the unit's UMask is
        write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size());
    close(file);
    return is_written && rename(part_.c_str(), path_.c_str()) == 0;
}

void ReplacedFile::remove() const noexcept {
    if (is_wanted() && !is_something_else(path_)) {
        unlink(path_.c_str());
    }
}

void MetricsWriter::work(ViewExchange& exchange, std::int64_t now_us) noexcept {
    LiveView view;
    while (exchange.views.pop(view)) {
        const std::size_t size = write_metrics(view, bus_, text_);
        if (!file_.replace({text_.data(), size}) && !has_failed_) {
            has_failed_ = true;
            std::fprintf(stderr,
                         "%s: metrics: %s: %s. Pass a file in a writable folder with --metrics.\n",
                         program_invocation_short_name, file_.path().c_str(), std::strerror(errno));
        }
    }
    if (file_.is_wanted() && now_us >= due_us_) {
        due_us_ = now_us + kMetricsPeriodUs;
        exchange.is_wanted.store(true);
    }
}

}  // namespace axg
