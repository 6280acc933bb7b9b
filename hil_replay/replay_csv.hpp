// SPDX-License-Identifier: Apache-2.0
// One line a cycle of a replay: sample, axes, permit, and the certified clearance of every pair. No
// times of this machine: two runs give equal bytes.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "core/engine.hpp"
#include "core/machine.hpp"
#include "hil_replay/replay_run.hpp"

namespace axg {

class ReplayCsv {
  public:
    /// Clearances are asked of `engine` beside the cycle, up to `within_mm`.
    ReplayCsv(const Machine& machine, Engine engine, std::string path, double within_mm,
              bool is_stoppable);

    void on_cycle(const ReplayCycle& cycle);
    /// False: `messages` says why; nothing then stands under the name.
    [[nodiscard]] bool finish(std::FILE* messages);

  private:
    const Machine& machine_;
    Engine engine_;
    std::string path_, text_;
    double within_mm_;
    bool is_stoppable_, has_levels_;
    PairPlan plan_;  // stoppable mode: the sampled pose, for its clearances
};

/// "cutter-x": the bodies of a pair.
[[nodiscard]] std::string pair_name(const Machine& machine, std::uint32_t pair);

}  // namespace axg
