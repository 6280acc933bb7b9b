// SPDX-License-Identifier: Apache-2.0
// The places that a program goes through, and what a certificate from positions alone says of a
// machine that comes there at a share of the program's speed.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "firmware_if/setup/guard_engine.hpp"
#include "hil_replay/motion/motion_sampler.hpp"

namespace axg::test {

/// What a certificate from positions alone would say of a machine at some place of a path.
class Places {
  public:
    explicit Places(LoadedMachine& loaded)
        : machine_(loaded.machine),
          engine_(make_engine(loaded)),
          containment_test_(make_containment_test(loaded, *engine_)),
          certificate_(make_stop_certificate(loaded)) {}

    /// Whether it holds, if the machine came there along the path at `share` of the path's speed.
    /// @param path  every 0.1 ms
    bool is_stoppable(const std::vector<MotionSample>& path, std::size_t at, double share) {
        std::vector<AxisPositions> seen;
        for (std::uint32_t back = kSamplesKept; back-- > 0;) {
            const double when = std::max(0.0, static_cast<double>(at) - 10.0 * share * back);
            const auto i = static_cast<std::size_t>(when);
            const AxisPositions& from = path[i].position;
            const AxisPositions& to = path[std::min(i + 1, path.size() - 1)].position;
            seen.push_back(from);
            for (std::size_t k = 0; k < machine_.axes.size(); ++k) {
                seen.back()[k] += (when - static_cast<double>(i)) * (to[k] - from[k]);
            }
        }
        return is_stoppable(seen, path[at].tool);
    }

  private:
    bool is_stoppable(const std::vector<AxisPositions>& seen, std::uint16_t tool) {
        AxisSnapshot snapshot;
        snapshot.axis_count = static_cast<std::uint32_t>(machine_.axes.size());
        snapshot.tool = tool;
        snapshot.mode = kModeMoving;
        for (const AxisPositions& position : seen) {
            ++snapshot.sample;
            snapshot.position = position;
            certificate_->note(snapshot, snapshot.sample == 1);
        }
        certificate_->prove(engine_->engine(), *containment_test_);
        const auto proofs = certificate_->cycle().proofs;
        return std::all_of(proofs.begin(), proofs.end(), [](const PairProof& proof) {
            return proof.surfaces.proof == JointBoxProof::proven;
        });
    }

    Machine& machine_;
    std::optional<CpuEngine> engine_;
    std::optional<ContainmentTest> containment_test_;
    std::optional<StopCertificate> certificate_;
};

/// Every 0.1 ms of a program at its own speed.
inline std::vector<MotionSample> path_of(const Program& program, const Machine& machine) {
    const MotionLimits limits = make_motion_limits(machine);
    const MotionOptions motion;
    MotionSampler sampler(program, limits, motion);
    std::vector<MotionSample> path;
    MotionSample sample;
    while (sampler.next(sample)) {
        path.push_back(sample);
    }
    return path;
}

}  // namespace axg::test
