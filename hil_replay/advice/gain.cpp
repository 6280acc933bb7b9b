// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/advice/gain.hpp"

#include <algorithm>

namespace axg {

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
    out.settings.push_back({.lines = setting.lines,
                            .is_gone = is_gone,
                            .after_s = is_gone ? after_s : 0,
                            .left_mm = is_gone ? 0 : again.left_mm,
                            .gain_mm = gain_mm,
                            .is_driven = is_driven});
}

void sort_settings(Advice& advice) {
    std::stable_sort(advice.settings.begin(), advice.settings.end(),
                     [](const AdvisedSetting& a, const AdvisedSetting& b) {
                         return a.is_gone != b.is_gone ? a.is_gone : a.gain_mm > b.gain_mm;
                     });
}

}  // namespace axg
