// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/cli/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>

namespace axg {

std::string duration_text(double seconds) {
    const auto whole = static_cast<long long>(std::ceil(seconds));
    if (whole < 60) {
        return fmt::format("{} s", whole);
    }
    return whole < 3600 ? fmt::format("{} min {} s", whole / 60, whole % 60)
                        : fmt::format("{} h {} min", whole / 3600, whole / 60 % 60);
}

Progress::Progress() : is_terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
    if (was_shown_) {
        fmt::print(stderr, "\r{:79}\r", "");
    }
}

bool Progress::is_due() const {
    return is_terminal_ && Clock::now() - shown_ >= std::chrono::milliseconds(200);
}

void Progress::show(double machine_s, double share, const std::string& what) {
    const double spent_s = std::chrono::duration<double>(Clock::now() - start_).count();
    put(fmt::format("{:.1f} s of machine time, {:.0f} x real time", machine_s, machine_s / spent_s),
        share, what);
}

void Progress::show(double share, const std::string& what) {
    put(what, share, "");
}

void Progress::put(const std::string& begin, double share, const std::string& end) {
    shown_ = Clock::now();
    was_shown_ = true;
    const double spent_s = std::chrono::duration<double>(shown_ - start_).count();
    std::string line = begin;
    if (share > 0 && share <= 1) {
        line += fmt::format(", {:.0f} %, {} left", 100 * share,
                            duration_text(spent_s * (1 - share) / share));
    }
    line += end.empty() ? "" : ", " + end;
    fmt::print(stderr, "\r{:<79.79}", line);
    std::fflush(stderr);
}

}  // namespace axg
