// SPDX-License-Identifier: Apache-2.0
// Whether a machine touches itself at given axis positions, judged by CGAL on triangles placed by
// kinematics of its own: nothing of the engine, the kinematics or the proofs is in it. mm, rad.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "config/mesh/load_meshes.hpp"
#include "core/machine/machine.hpp"

namespace axg::test {

struct Judgement {
    bool touches = false;   // two triangles of a checked pair share a point
    bool too_near = false;  // a checked pair is nearer than its margin, by more than 1e-6 mm
    double clear_mm = 0;    // no checked pair is nearer; 0 where one touches
    std::uint32_t pair = kNoIndex;  // the one that touches or is too near
};

class CgalJudge {
  public:
    /// Both must outlive it. The tool is first_tool.
    CgalJudge(const Machine& machine, const MachineMeshes& meshes);
    ~CgalJudge();

    /// @param within_mm  clear_mm is no more than this, and is found the sooner
    [[nodiscard]] Judgement judge(std::span<const double> position, double within_mm);

    /// No point of any body moves farther than this times the change of a rotary axis, mm a rad.
    [[nodiscard]] double reach_mm() const noexcept;

  private:
    struct Work;
    std::unique_ptr<Work> work_;
};

}  // namespace axg::test
