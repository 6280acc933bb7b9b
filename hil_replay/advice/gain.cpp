// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/advice/gain.hpp"

#include <algorithm>

namespace axg {
namespace {

constexpr double kEqualGainMm = 0.01;

/// Whether `less` gains as much as `more` by some of its lines.
bool replaces(const AdvisedSetting& less, const AdvisedSetting& more) {
    const auto is_in_more = [&more](const std::string& line) {
        return std::find(more.lines.begin(), more.lines.end(), line) != more.lines.end();
    };
    const bool gains_as_much =
        less.is_gone || (!more.is_gone && less.gain_mm >= more.gain_mm - kEqualGainMm);
    return less.is_driven == more.is_driven && less.lines.size() < more.lines.size() &&
           gains_as_much && std::all_of(less.lines.begin(), less.lines.end(), is_in_more);
}

}  // namespace

void note_end(const Setting& setting, bool is_driven, const RunEnd& first, const RunEnd& again,
              Advice& out) {
    const double after_s = static_cast<double>(again.ended_us - first.snapshot.arrived_us) * 1e-6;
    ++out.tried;
    const bool is_gone = !again.is_stopped;
    const double gain_mm = is_gone ? 0 : first.left_mm - again.left_mm;
    if (!again.is_complete || (!is_gone && again.pair != first.pair) ||
        (!is_gone && gain_mm < kAdviceGainMm)) {
        return;
    }
    // On a trace the same sample is the same place: only its certified distance differs.
    if (!is_driven && !is_gone && again.snapshot.arrived_us <= first.snapshot.arrived_us) {
        return;
    }
    out.settings.push_back({.lines = setting.lines,
                            .is_gone = is_gone,
                            .after_s = is_gone ? after_s : 0,
                            .left_mm = is_gone ? 0 : again.left_mm,
                            .gain_mm = gain_mm,
                            .is_driven = is_driven});
}

void sort_settings(Advice& advice) {
    const std::vector<AdvisedSetting> all = advice.settings;
    std::erase_if(advice.settings, [&all](const AdvisedSetting& more) {
        return std::any_of(all.begin(), all.end(),
                           [&more](const AdvisedSetting& less) { return replaces(less, more); });
    });
    std::stable_sort(advice.settings.begin(), advice.settings.end(),
                     [](const AdvisedSetting& a, const AdvisedSetting& b) {
                         return a.is_gone != b.is_gone ? a.is_gone : a.gain_mm > b.gain_mm;
                     });
}

}  // namespace axg
