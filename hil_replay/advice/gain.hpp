// SPDX-License-Identifier: Apache-2.0
// Compares the end of a motion with the end of the same one under another setting.
#pragma once

#include "hil_replay/advice/settings.hpp"
#include "hil_replay/advice/trace_run.hpp"
#include "hil_replay/replay/why_stop.hpp"

namespace axg {

/// Counts the setting, and adds it if its run has no stop, or stops for the same pair at least
/// kAdviceGainMm nearer; on a trace also at a later sample, since one sample is one place.
void note_end(const Setting& setting, bool is_driven, const RunEnd& first, const RunEnd& again,
              Advice& out);
/// The best first: gone, then by gain; equal ones in the order of the trial. Drops a setting if
/// fewer of its lines gain as much.
void sort_settings(Advice& advice);

}  // namespace axg
