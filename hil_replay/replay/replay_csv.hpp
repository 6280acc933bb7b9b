// SPDX-License-Identifier: Apache-2.0
// Writes one line a cycle of a replay: sample, axes, permit, and the certified clearance of every
// pair. The file contains no times of this computer: two runs give equal bytes.
#pragma once

#include <cstdio>
#include <span>
#include <string>

#include "core/machine/machine.hpp"
#include "hil_replay/replay/replay_run.hpp"

namespace axg {

class ReplayCsv {
  public:
    ReplayCsv(const Machine& machine, std::string path, bool is_stoppable);

    /// @param clearances_mm  [pairs], kNotNear if there is no clearance (PairClearances)
    void on_cycle(const ReplayCycle& cycle, std::span<const double> clearances_mm);
    /// False: the reason is in `messages`; no file of that name was written.
    [[nodiscard]] bool finish(std::FILE* messages);

  private:
    const Machine& machine_;
    std::string path_, text_;
    bool is_stoppable_, has_clearance_levels_;
};

/// "cutter-x": the bodies of a pair.
[[nodiscard]] std::string pair_name(const Machine& machine, std::uint32_t pair);

}  // namespace axg
