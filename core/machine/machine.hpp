// SPDX-License-Identifier: Apache-2.0
// The machine in plain data: axes, a tree of bodies, checked pairs, tools. Valid by construction:
// config/ built it. Directions and pivots are stated in machine coordinates at the zero pose (all
// axes at 0; docs/reference/machine-file.md), so that a body's placement is the product of its
// chain's motions (kinematics.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/base/limits.hpp"
#include "core/base/pose.hpp"
#include "core/base/vec3.hpp"
#include "core/machine/can_layout.hpp"
#include "core/machine/cycle_work.hpp"
#include "core/mesh/shape.hpp"

namespace axg {

inline constexpr std::uint32_t kNoIndex = 0xffffffffU;

enum class AxisKind : std::uint8_t { linear, rotary };

/// Jerk of an axis without a promised limit: its acceleration may change at once. The closed forms
/// use this value: a change of acceleration then needs no time.
inline constexpr double kNoJerkLimit = 1e18;

/// One controlled axis. Units: mm, mm/s, mm/s2, mm/s3 for linear; rad and rad/s... for rotary axes.
struct Axis {
    std::string name;  // "X", "A": the letter in G-code
    AxisKind kind = AxisKind::linear;
    bool unlimited = false;   // endless rotary: no travel limits, positions compare modulo one turn
    double min = 0, max = 0;  // travel
    double speed_max = 0;
    double acceleration_max = 0;
    double jerk_max = 0;      // kNoJerkLimit: none is promised
    double stopping_min = 0;  // deceleration the board guarantees in a stop
    // The hardest deceleration of its drive; infinite: none is promised.
    double stopping_most = std::numeric_limits<double>::infinity();
    // Errors of a reported position, beyond one count of the wire: from the true position at its
    // instant; and if the board reports commanded positions, from those to the actual ones.
    double position_error = 0, following_error = 0;
    // Whether the machine file states them; `axguard check` lists the defaults used otherwise.
    bool states_position_error = false, states_following_error = false;
    // Two joints move this axis (a gantry), and their positions differ by at most this, mm. The
    // position of the axis is their mean. 0: one joint.
    double skew_mm = 0;
};

[[nodiscard]] constexpr bool has_jerk_limit(const Axis& axis) noexcept {
    return axis.jerk_max < kNoJerkLimit;
}

/// Body to parent. axis == kNoIndex: fixed. Several bodies may follow one axis (gantries).
struct Joint {
    std::uint32_t axis = kNoIndex;
    Vec3d direction{0, 0, 1};  // unit; +q moves or turns (right hand) the body this way
    Vec3d pivot_mm{};          // a point on the rotary axis
    // How far the true axis may be from this: its point, and its direction.
    double pivot_error_mm = 0, direction_error_rad = 0;
};

enum class LengthUnit : std::uint8_t { mm, inch, m, um };

/// Source of a surface. `file` is relative to the mesh root; empty when `shapes` are used.
struct MeshSource {
    std::string file;
    LengthUnit unit = LengthUnit::mm;
    std::vector<Shape> shapes;  // each a closed shell; they may overlap; a tool's sections
    bool allow_open = false;    // no containment claim is made for this body
    bool allow_self_intersection = false;
    bool allow_degenerate = false;  // zero-area facets are dropped and counted
    // The tool turns about +Z of the tool body's frame, the spindle axis: its surface is all that
    // it sweeps. Its shapes are in that frame; `at` moves a file's triangles there.
    bool turns = false;
    Pose at;
    double simplify_mm = 0;  // permitted deviation when simplified; 0: not simplified
    // Computed when it was simplified: every point of the surface is proven to be this near to the
    // surface in the engines.
    double deviation_mm = 0;
    std::string sha256;        // empty: not pinned
    Vec3d expected_size_mm{};  // 0: not stated
    // The machine file confirms a size that config/mesh/size_doubts.hpp would doubt.
    bool size_is_right = false;
    std::string where;  // "machine.yaml:14", for messages about the file
};

struct Body {
    std::string name;
    std::uint32_t parent = kNoIndex;  // index of an earlier body; kNoIndex: the machine's frame
    Joint joint;
    Pose at;                // mesh frame to machine coordinates at the zero pose
    bool is_tool = false;   // its surface is that of the tool in the spindle
    bool is_stock = false;  // the stock: cutting sections of tools may touch it
    bool has_mesh = false;  // a body may be a bare link
    // No point of it, or of what it carries, is farther from where the file puts it.
    double place_error_mm = 0;
    MeshSource mesh;
};

struct Tool {
    std::uint16_t number = 0;
    std::string name;
    double length_mm = 0;               // spindle nose to tip: G43's offset along the tool axis
    std::optional<double> diameter_mm;  // G41's and G42's, of the control's tool table
    Pose at;  // tool mesh frame to the tool body's; identity if it turns (see MeshSource::at)
    double place_error_mm = 0;  // as of a body
    MeshSource mesh;
};

struct Pair {
    std::uint32_t a = 0, b = 0;  // body indices
    double margin_mm = 0;
    // Clearance levels, beyond the margin (core/guard/margin_advisory.hpp); slow_mm <= warn_mm, 0:
    // no such level.
    double slow_mm = 0, warn_mm = 0;
};

/// A surface of a body for one pair only: in every other pair the body's
/// own is used. Computed after load, from the meshes.
struct PairSurface {
    std::uint32_t body = 0, against = 0;  // Machine::bodies
    std::uint32_t tool = kNoIndex;        // with that tool in the pair; kNoIndex: none is in it
    std::uint32_t surface = 0;            // index of a pair-specific surface
    // Containment tests use the whole body, unless this surface is all of the body in this
    // pair.
    bool is_whole = false;
};

/// A proof about a pair (with one tool, if a tool is in it) for all positions within Travel
/// (docs/theory/travel.md).
struct TravelProof {
    // Pruned parts of its surfaces are proven farther apart than this. Negative: none was pruned.
    double distance_mm = -1;
    bool is_apart = false;  // all was pruned, and neither body is inside the other
    // The remaining surfaces, as pair-specific ones; kNoIndex: the body's own, unpruned.
    std::uint32_t surface_a = kNoIndex, surface_b = kNoIndex;
};

/// The positions that travel proofs hold for, and these proofs.
struct Travel {
    std::array<double, kAxesMax> low{}, high{};  // mm or rad; an endless one is free
    std::vector<TravelProof> proofs;  // [pairs, each with each tool (stop_tasks)]; empty: none
};

/// What the stated errors of joints and places may take from the distance of a pair
/// (docs/theory/certificate.md, "Stated errors"). Computed after load, from the meshes.
struct PoseErrors {
    bool are_stated = false;                // the machine file states one above 0
    std::vector<double> mm{};               // [pairs]
    std::array<double, kAxesMax> within{};  // of linear axes: the largest |position| they hold for
};

struct Exclusion {
    std::uint32_t a = 0, b = 0;
    std::string reason;
    // Why it may hide a contact that is not permanent; empty: it hides none, by its author.
    std::string because;
};

/// Capacities of all queries in one launch of a GPU together: they bound the longest launch. Time
/// of the default ones: docs/measurements/gpu-fill.md.
struct BatchCapacities {
    std::uint32_t level_pairs = 1024;      // pairs of nodes opened on one level
    std::uint32_t leaf_pairs = 1024;       // pairs of leaves
    std::uint32_t box_rows = 6144;         // a box against the up to 32 boxes of a node
    std::uint32_t triangle_pairs = 16384;  // left after clipping
    std::uint32_t rechecks = 512;          // double precision
};

/// Capacities of the engine's fixed lists for queries about one pose; an overflow returns
/// not_proven. Queries about boxes use the lists of the cycle's plan.
struct Capacities {
    std::uint32_t node_pairs = 8192;       // a query, all levels together
    std::uint32_t triangle_pairs = 65536;  // a query
    std::uint32_t rechecks = 1024;         // a query, double precision; 0: kPoseRechecks
    BatchCapacities batch{};               // an engine on a GPU
};

inline constexpr std::uint32_t kPoseRechecks = 64;
[[nodiscard]] constexpr std::uint32_t pose_rechecks(const Capacities& capacities) noexcept {
    return capacities.rechecks != 0 ? capacities.rechecks : kPoseRechecks;
}

/// How the axes brake to rest in every stop, whatever its cause (docs/theory/certificate.md).
enum class StopPromise : std::uint8_t {
    independent = 0,  // each axis by itself
    path_keeping,     // along the look-ahead path (CanLayout::look_ahead_samples)
};
[[nodiscard]] constexpr const char* to_text(StopPromise promise) noexcept {
    return promise == StopPromise::path_keeping ? "path_keeping" : "independent";
}

/// The device that ends the motion when permits end (docs/reference/machine-file.md, "Who obeys the
/// permit").
enum class ObeyedBy : std::uint8_t {
    board = 0,  // the motion board, by the age of the sample that a permit names
    line,       // a monoflop behind the output line
    drives,     // their own heartbeat consumers
};
[[nodiscard]] constexpr const char* to_text(ObeyedBy who) noexcept {
    return who == ObeyedBy::line ? "line" : who == ObeyedBy::drives ? "drives" : "board";
}

/// Whether a stop may turn an axis round (docs/theory/certificate.md, "Stops that turn an axis
/// round").
enum class StopReversal : std::uint8_t {
    none = 0,
    jerk_limited,  // only as far as the jerk forces it: the acceleration that it begins with
};
[[nodiscard]] constexpr const char* to_text(StopReversal reversal) noexcept {
    return reversal == StopReversal::jerk_limited ? "jerk_limited" : "none";
}

/// Whether a board limits its axes to the cap of a permit. all_axes: it can only scale its whole
/// motion.
enum class CapPromise : std::uint8_t { none = 0, all_axes, per_axis };
[[nodiscard]] constexpr const char* to_text(CapPromise promise) noexcept {
    return promise == CapPromise::all_axes   ? "all_axes"
           : promise == CapPromise::per_axis ? "per_axis"
                                             : "none";
}

/// single_jog: while the board reports a jog, only one axis is commanded to move, one way, within
/// these, whatever the axis could do.
struct JogRules {
    bool is_promised = false;
    double speed_mm_s = 0, acceleration_mm_s2 = 0;
    double speed_rad_s = 0, acceleration_rad_s2 = 0;
};

/// Promises of the board about motion and stops, and contents of the permit in addition
/// (docs/theory/certificate.md). How long a permit is valid is CanLayout::permit_samples.
struct GuardRules {
    StopPromise promise = StopPromise::independent;
    ObeyedBy obeyed_by = ObeyedBy::board;
    StopReversal stop_reversal = StopReversal::none;
    double board_reaction_s = 2e-3;  // from the end of the permit until every axis brakes
    double latch_jitter_s = 20e-6;   // the time between two samples may be off by this
    bool free_jerk_limited = false;  // jerk_max holds in free motion, not only in stops
    bool reports_limits = false;     // limits_broken: report; the guard does not stop
    bool travel_enforced = false;    // the board never leaves the travel, not in a stop either
    // The never-colliding set is pruned (docs/theory/travel.md), this far beyond the
    // travel.
    bool travel_proofs = false;
    double overrun_mm = 2, overrun_rad = 0.5 * 0x1.1df46a2529d39p-6;  // 0.5 degrees
    bool speed_cap = false;             // the permit carries one (docs/theory/certificate.md)
    CapPromise cap = CapPromise::none;  // the board obeys that of the permit, and proofs use it
    double cap_lead_s = 20e-3;          // from a sample until the board applies its cap
    // A clearance level improves this far beyond it, after this many samples in a row.
    double level_band_mm = 0.5;
    std::uint32_t level_hold_samples = 50;
    JogRules jog;
};

/// Promises that the machine file states, though each has a default. Axis has two more.
struct StatedPromises {
    bool sample_us = false, latched_age_us = false;
    bool board_reaction_ms = false, latch_jitter_us = false, stop_reversal = false;
};

/// Output line of the guard's host for a monoflop, in addition to the bus.
struct OutputLine {
    std::string chip;  // "gpiochip0"; empty: there is none
    std::uint32_t line = 0;
};

/// The engine that processes queries. automatic: the faster one, as measured at start.
enum class EngineChoice : std::uint8_t { automatic, cpu, cuda };

struct Machine {
    std::string name;
    std::vector<Axis> axes;
    std::vector<Body> bodies;  // parents first
    std::vector<Pair> pairs;
    std::vector<PairSurface> pair_surfaces;
    Travel travel;
    PoseErrors pose_errors;
    std::vector<Exclusion> exclusions;
    std::vector<Tool> tools;
    std::uint16_t first_tool = 0;  // in the spindle while the board reports none; 0: none
    CanLayout can;
    GuardRules guard;
    StatedPromises states;
    CycleRules cycle;
    std::optional<CyclePlan> plan;  // chosen at start, or recorded; replaces that of `cycle`
    OutputLine output_line;
    Capacities capacities;
    EngineChoice engine = EngineChoice::automatic;
    std::uint32_t deadline_us = 500;
    double program_speed_mm_s = 10000.0 / 60.0;  // cap of simulated feeds, the paper's 10 m/min
};

/// Largest distance of a point of a body from its surface in an engine, mm.
/// @param tool  the slot in the spindle, for the body that carries it; kNoIndex: none
[[nodiscard]] inline double deviation_of(const Machine& machine, std::uint32_t body,
                                         std::uint32_t tool) noexcept {
    const bool is_tool = machine.bodies[body].is_tool;
    return !is_tool           ? machine.bodies[body].mesh.deviation_mm
           : tool == kNoIndex ? 0
                              : machine.tools[tool].mesh.deviation_mm;
}

/// Infinite where errors are stated and nobody has computed what they are worth.
[[nodiscard]] inline double pose_error_of(const Machine& machine, std::uint32_t pair) noexcept {
    const PoseErrors& errors = machine.pose_errors;
    return !errors.are_stated                         ? 0
           : errors.mm.size() != machine.pairs.size() ? std::numeric_limits<double>::infinity()
                                                      : errors.mm[pair];
}

}  // namespace axg
