// SPDX-License-Identifier: Apache-2.0
// Proves a program's path clear, stretch by stretch, for each pair with each tool: the stretches
// with their witnesses, and what stayed open. The result depends on machine and path only, not on
// the number of threads. Source: docs/theory/program.md.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/collision/containment.hpp"
#include "core/collision/cpu_engine.hpp"
#include "hil_replay/certify/certify_tasks.hpp"
#include "hil_replay/certify/chord_path.hpp"
#include "hil_replay/certify/tube.hpp"

namespace axg {

// Tags of a tree (docs/reference/certificate-file.md, "Stretches"). Below: a number of directions.
inline constexpr std::uint8_t kCutTag = 128, kHoleTag = 255;

struct ProvenStretch {
    PathInterval at;
    bool is_hole = false;
    std::string tree{};
};

enum class OpenReason : std::uint8_t {
    position,  // the positions of the path themselves are too near
    tube,      // they are clear, but not with the errors, and the way of a stop
    inside,    // a part of one body is inside the other, or that could not be excluded
    beyond,    // of what kinematics or the stated errors hold for
};
[[nodiscard]] const char* to_text(OpenReason reason) noexcept;

/// Neighbouring segments of one line and pair that are not proven.
struct OpenStretch {
    std::uint32_t task = 0;
    std::uint64_t first = 0, end = 0;  // segments
    OpenReason reason = OpenReason::position;
    UnitBox box;              // the worst segment's
    double clearance_mm = 0;  // certified in the box's middle; at most kClearanceMmMax
    double needed_mm = 0;     // there
};
inline constexpr double kClearanceMmMax = 100;

struct ProgramProof {
    std::vector<std::vector<ProvenStretch>> tasks;  // [tasks] in the order of the path
    std::vector<OpenStretch> open;
    std::uint64_t boxes = 0, questions = 0;
};

/// A row of neighbouring segments in which a task counts.
struct SegmentRange {
    std::uint64_t first = 0, end = 0;
};
/// @param tool  kNoIndex: a pair without a tool
[[nodiscard]] std::vector<SegmentRange> pieces_of(const ChordPath& path, std::uint32_t tool);

struct ProveOptions {
    std::uint32_t threads = 1;
    std::function<void(double share)> progress{};  // on the caller's thread; may be empty
};
/// @param engine  of make_engine: its trees are used by all threads
/// Empty tasks: this processor has no engine, or memory ran out.
[[nodiscard]] ProgramProof prove_program(const LoadedMachine& loaded, const CertifyTasks& tasks,
                                         const ChordPath& path, CpuEngine& engine,
                                         const ContainmentTest& containment,
                                         const ProveOptions& options);

}  // namespace axg
