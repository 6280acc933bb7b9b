// SPDX-License-Identifier: Apache-2.0
#include "core/certificate/stop_certificate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/assert.hpp"
#include "core/base/sincos.hpp"
#include "core/certificate/steered_samples.hpp"
#include "core/certificate/travel.hpp"
#include "core/machine/kinematics.hpp"

namespace axg {

std::uint32_t stop_tasks(const Machine& machine) noexcept {
    std::uint32_t count = 0;
    for (const Pair& pair : machine.pairs) {
        count += tasks_of(machine, pair);
    }
    return count;
}

JointBoxTask pair_task(const Machine& machine, std::uint32_t pair, std::uint32_t tool,
                       std::span<const BodyExtent> extents) noexcept {
    const Pair& p = machine.pairs[pair];
    JointBoxTask task;
    // Uses the extent of the queried surface for levers: no other surface has to stay away.
    const auto place = [&](std::uint32_t body, std::uint32_t against, std::uint32_t& mesh, Pose& at,
                           const BodyExtent*& extent) {
        const bool is_tool = machine.bodies[body].is_tool;
        mesh = mesh_in_pair(machine, body, against, tool);
        AXG_ASSERT(mesh < extents.size());
        at = machine.bodies[body].at;
        at = is_tool ? compose(at, machine.tools[tool].at) : at;
        extent = &extents[mesh];
        task.pose_error_mm += deviation_of(machine, body, tool);
    };
    task.pose_error_mm = kPlacementErrorMm;
    task.body_a = p.a;
    task.body_b = p.b;
    place(p.a, p.b, task.mesh_a, task.at_a, task.extent_a);
    place(p.b, p.a, task.mesh_b, task.at_b, task.extent_b);
    task.path = path_between(machine, p.a, p.b);
    task.margin_mm = p.margin_mm;
    return task;
}

StopCertificate::StopCertificate(const Machine& machine, const StopOptions& options,
                                 StagedProver prover, std::optional<LookAheadPath> path,
                                 Arena arena) noexcept
    : machine_(&machine),
      options_(options),
      prover_(std::move(prover)),
      path_(std::move(path)),
      arena_(std::move(arena)) {
    stride_ = history_stride(machine.can.sample_us * 1e-6);
    samples_ = machine.can.permit_samples.least;
    ladder_.samples =
        keeps_cap() ? samples_work(machine.can.permit_samples) : machine.can.permit_samples.most;
    ladder_next_ = ladder_;
    limit_rules_ = limit_rules(machine, options_.count);
    speed_bound_.fill(std::numeric_limits<double>::infinity());
}

std::optional<StopCertificate> StopCertificate::create(const Machine& machine,
                                                       std::span<const Mesh* const> surfaces,
                                                       const StopOptions& options) {
    const std::uint32_t slots = stop_tasks(machine);
    const PermitSamples samples = machine.can.permit_samples;
    const std::uint32_t tasks = tries_longer(samples) ? 2 * slots : slots;
    auto prover =
        StagedProver::create(machine, tasks, options.plan, known_answer_mesh_index(machine));
    const bool has_path = machine.can.look_ahead_samples != 0;
    auto path = has_path ? LookAheadPath::create(machine, {.count = options.count}) : std::nullopt;
    const std::uint32_t pieces = has_path ? kPathPieces : 0;
    const bool has_jogs = machine.guard.jog.is_promised;
    const std::uint32_t rungs =
        has_jogs ? std::max(slots, std::min(slots, jog_ladders(options.plan)) * kJogRungs) : 0;
    const std::uint32_t ladders = has_jogs ? slots : 0;
    Arena arena(Arena::size_bytes<JointBox>(pieces) +
                Arena::size_bytes<BodyExtent>(surfaces.size()) + Arena::size_bytes<Slot>(slots) +
                Arena::size_bytes<std::uint32_t>(slots) + Arena::size_bytes<JointBoxTask>(tasks) +
                Arena::size_bytes<JointBoxResult>(tasks) + Arena::size_bytes<PairProof>(slots) +
                Arena::size_bytes<std::uint32_t>(slots) + Arena::size_bytes<Query>(rungs) +
                Arena::size_bytes<QueryResult>(rungs) + Arena::size_bytes<GroupWork>(ladders) +
                Arena::size_bytes<std::uint32_t>(ladders));
    if (!prover || !arena.ok() || (has_path && !path)) {
        return std::nullopt;
    }
    StopCertificate certificate(machine, options, std::move(*prover), std::move(path),
                                std::move(arena));
    certificate.extents_ = certificate.arena_.take<BodyExtent>(surfaces.size());
    certificate.slots_ = certificate.arena_.take<Slot>(slots);
    certificate.queried_ = certificate.arena_.take<std::uint32_t>(slots);
    certificate.tasks_ = certificate.arena_.take<JointBoxTask>(tasks);
    certificate.results_ = certificate.arena_.take<JointBoxResult>(tasks);
    certificate.proofs_ = certificate.arena_.take<PairProof>(slots);
    certificate.untested_ = certificate.arena_.take<std::uint32_t>(slots);
    certificate.rung_queries_ = certificate.arena_.take<Query>(rungs);
    certificate.rung_results_ = certificate.arena_.take<QueryResult>(rungs);
    certificate.rung_groups_ = certificate.arena_.take<GroupWork>(ladders);
    certificate.below_ = certificate.arena_.take<std::uint32_t>(ladders);
    certificate.pieces_ = certificate.arena_.take<JointBox>(pieces);
    certificate.arena_.seal();
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        certificate.extents_[i] = extent_of(*surfaces[i]);
    }
    for (std::uint32_t i = 0; i < machine.pairs.size(); ++i) {
        const Pair& pair = machine.pairs[i];
        for (std::uint32_t k = 0; k < tasks_of(machine, pair); ++k) {
            certificate.add_slot(i, has_tool(machine, pair) ? k : kNoIndex);
        }
    }
    return certificate;
}

void StopCertificate::add_slot(std::uint32_t pair, std::uint32_t tool) noexcept {
    Slot& slot = slots_[slot_count_];
    slot.pair = pair;
    slot.tool = tool;
    slot.has_box = slot.by_path = false;
    slot.floor_mm = 0;
    slot.floor_kept_mm = kNoJogFloor;
    slot.task = pair_task(*machine_, pair, tool, extents_);
    const TravelProof known = travel_proof(*machine_, slot_count_++);
    slot.task.pruned = {.up_to_mm = known.distance_mm,
                        .is_apart = known.is_apart,
                        .mesh_a = pruned_mesh_index(*machine_, known.surface_a, slot.task.mesh_a),
                        .mesh_b = pruned_mesh_index(*machine_, known.surface_b, slot.task.mesh_b)};
}

void StopCertificate::note(const AxisSnapshot& snapshot, bool is_first) noexcept {
    const AxisSnapshot before = snapshot_;
    snapshot_ = snapshot;
    history_.count = is_first ? 0 : history_.count;
    note_snapshot(history_, snapshot, stride_);
    watch_limits(is_first);
    note_jog(is_first);
    note_tool(before, is_first);
    if (!path_) {
        return;
    }
    if (is_first || jog_.is_on()) {  // a jog is not part of a path
        path_->clear();
        took_back_ = took_back_ && !jog_.is_on();
    }
    has_left_path_ = took_back_ || !path_->keeps_to(snapshot);
    took_back_ = false;
    if (has_left_path_) {
        path_->clear();
    }
}

void StopCertificate::watch_limits(bool is_first) noexcept {
    if (is_first) {
        forget_limits(limit_watch_);
        broken_limit_ = own_stop_ = {};
    }
    const LimitFact fact = note_limits(limit_watch_, limit_rules_, snapshot_, history_);
    const bool is_stopping = limit_watch_.machine_stop.is_on;
    if (is_stopping) {
        own_stop_ = limit_watch_.machine_stop.cause;
        is_limit_judged_ = false;
    }
    if (fact.kind != LimitKind::none) {
        broken_limit_ = fact;
        is_limit_judged_ = false;
    } else if (is_limit_judged_ && snapshot_.sample % limit_rules_.stride == 0) {
        broken_limit_ = own_stop_ = {};
    }
}

void StopCertificate::note_jog(bool is_first) noexcept {
    std::array<SampleErrors, kAxesMax> errors;
    for (std::uint32_t i = 0; i < machine_->axes.size(); ++i) {
        errors[i] = errors_of(i);
    }
    const JogMove before = jog_.move();
    has_left_jog_ = !jog_.note(*machine_, snapshot_, errors, is_first);
    has_floors_ = has_floors_ && !is_first && jog_.is_on() && jog_.move() == before;
    for (std::uint32_t i = 0; is_first && i < slot_count_; ++i) {
        slots_[i].floor_kept_mm = kNoJogFloor;
    }
}

/// A board may report the number of the next tool while the last one is still in the spindle. Both
/// count until no earlier permit is in force; if the number changes again, all of them count. An
/// older permit may end after a newer one, so this assumes the longest permit, whatever was sent.
void StopCertificate::note_tool(const AxisSnapshot& before, bool is_first) noexcept {
    if (is_first) {
        tool_until_ = {};
        return;
    }
    std::uint32_t was = kNoIndex, is = kNoIndex;
    const bool are_known = judge_snapshot(*machine_, before, was) == SnapshotStatus::ok &&
                           judge_snapshot(*machine_, snapshot_, is) == SnapshotStatus::ok;
    if (are_known && was != is && was != kNoIndex) {
        const double longest_s = free_seconds(*machine_, machine_->can.permit_samples.most);
        const double samples = std::ceil(longest_s * 1e6 / machine_->can.sample_us);
        tool_until_[was] = snapshot_.sample + static_cast<std::uint64_t>(samples) + 1;
    }
}

void StopCertificate::bound_speeds(std::span<const double> speeds) noexcept {
    AXG_ASSERT(speeds.size() == machine_->axes.size());
    std::copy(speeds.begin(), speeds.end(), speed_bound_.begin());
}

void StopCertificate::ask_raise(std::span<const double> speeds) noexcept {
    AXG_ASSERT(keeps_cap() && speeds.size() == machine_->axes.size());
    std::copy(speeds.begin(), speeds.end(), raised_bound_.begin());
    asks_raise_ = true;
}

void StopCertificate::note_path(const PathPoints& points) noexcept {
    if (path_ && !path_->note_path(points)) {
        took_back_ = true;
    }
}

AxisRange StopCertificate::now(std::uint32_t axis) const noexcept {
    const Axis& promised = machine_->axes[axis];
    AxisRange range = limit_watch_.ranges[axis].range;
    if (!ranges_hold(limit_watch_, limit_rules_, history_, axis)) {
        range.speed_low = -promised.speed_max;
        range.speed_high = promised.speed_max;
        range.acceleration_low = -promised.acceleration_max;
        range.acceleration_high = promised.acceleration_max;
    }
    return range;
}

AxisLimits StopCertificate::bounded_limits(std::uint32_t axis) const noexcept {
    AxisLimits limits = stop_limits(*machine_, axis);
    limits.speed_max = std::min(limits.speed_max, speed_bound_[axis]);
    return limits;
}

JointBox StopCertificate::reach(std::uint32_t samples) const noexcept {
    return reach_within(samples, speed_bound_);
}

JointBox StopCertificate::reach_within(std::uint32_t samples,
                                       const std::array<double, kAxesMax>& bounds) const noexcept {
    const double free_s = free_seconds(*machine_, samples);
    JointBox box;
    for (std::uint32_t i = 0; i < machine_->axes.size(); ++i) {
        AxisLimits limits = stop_limits(*machine_, i);
        limits.speed_max = std::min(limits.speed_max, bounds[i]);
        put_reach(axis_reach(*machine_, i, limits, now(i), free_s, errors_of(i).position), i, box);
    }
    return box;
}

/// Box of all axes at their present positions, and of the jog's axis over its whole reach.
JointBox StopCertificate::jog_box(std::uint32_t samples) const noexcept {
    JointBox box;
    for (std::uint32_t i = 0; i < machine_->axes.size(); ++i) {
        const double at = snapshot_.position[i], error = held_error(i);
        ReachRange range{at - error, at + error};
        if (i == jog_.move().axis) {
            const AxisLimits limits = jog_limits(machine_->guard.jog, machine_->axes[i]);
            const double reach = jog_reach(limits, free_seconds(*machine_, samples));
            const bool turns_round = machine_->guard.stop_reversal == StopReversal::jerk_limited;
            const double back = turns_round ? jog_turn_reach(limits) : 0;
            range.low -= jog_.move().is_negative ? reach : back;
            range.high += jog_.move().is_negative ? back : reach;
        }
        put_reach(range, i, box);
    }
    return box;
}

/// Determines each pair's floor at the start of a jog; it applies to the jog's end.
void StopCertificate::find_floors(const Engine& engine) noexcept {
    std::array<Pose, kBodiesMax> moved;
    move_bodies(*machine_, snapshot_.position, moved);
    JointBox errors{.centre = snapshot_.position, .half = {}};
    for (std::uint32_t i = 0; i < machine_->axes.size(); ++i) {
        errors.half[i] = held_error(i);
    }
    has_floors_ = true;
    floors_at_ = snapshot_.sample;
    for (std::uint32_t i = 0; i < proof_count_; ++i) {
        pose_rungs(i, moved, errors, 0, rung_queries_.subspan(i, 1));
    }
    ask_rungs(engine, proof_count_, 1, jog_lists(options_.plan).margins);
    std::uint32_t open = 0;
    for (std::uint32_t i = 0; i < proof_count_; ++i) {
        const bool is_kept =
            rung_results_[i].status == QueryStatus::ok && rung_results_[i].proof == Proof::far;
        slots_[queried_[i]].floor_mm = tasks_[i].margin_mm;
        if (!is_kept) {
            below_[open++] = i;
        }
    }
    if (open > jog_ladders(options_.plan)) {  // too many pairs nearer than their margins
        has_floors_ = false;
    } else if (open != 0) {
        find_lower_floors(engine, moved, errors, open);
    }
}

/// Queries all rungs below the margin at once, for the pairs nearer than their margin.
void StopCertificate::find_lower_floors(const Engine& engine, std::span<const Pose> moved,
                                        const JointBox& errors, std::uint32_t open) noexcept {
    constexpr std::uint32_t kBelow = kJogRungs - 1;
    for (std::uint32_t i = 0; i < open; ++i) {
        pose_rungs(below_[i], moved, errors, 1, rung_queries_.subspan(i * kBelow, kBelow));
    }
    ask_rungs(engine, open, kBelow, jog_lists(options_.plan).rungs);
    for (std::uint32_t i = 0; i < open; ++i) {
        take_floor(below_[i], rung_results_.subspan(i * kBelow, kBelow));
    }
}

/// Makes one query for each rung from `first` down, at the present positions.
void StopCertificate::pose_rungs(std::uint32_t place, std::span<const Pose> moved,
                                 const JointBox& errors, std::uint32_t first,
                                 std::span<Query> out) const noexcept {
    const JointBoxTask& task = tasks_[place];
    const PlacedPair pair = placed_pair(task, moved);
    const double errors_mm =
        motion_along(*machine_, task.path, moved, pair.a, pair.b, errors).total_mm;
    const auto rungs = jog_ladder(task.margin_mm, floor_before(slots_[queried_[place]]));
    for (std::uint32_t i = 0; i < out.size(); ++i) {
        out[i] = query_of(task, pair, jog_rung_query_mm(rungs[first + i], errors_mm));
        out[i].is_float_only = lists_of(options_.plan).rechecks == 0;
    }
}

/// Runs `rungs` queries of each pair, stored in order; each pair is a group.
void StopCertificate::ask_rungs(const Engine& engine, std::uint32_t pairs, std::uint32_t rungs,
                                const WorkLists& lists) noexcept {
    if (pairs == 0) {
        return;
    }
    const std::span<Query> queries = rung_queries_.first(pairs * rungs);
    const std::span<QueryResult> results = rung_results_.first(pairs * rungs);
    for (std::uint32_t i = 0; i < queries.size(); ++i) {
        queries[i].group = static_cast<std::uint16_t>(i / rungs);
    }
    std::fill_n(rung_groups_.begin(), pairs, GroupWork{.share = share_of(lists, pairs)});
    std::fill(results.begin(), results.end(), QueryResult{});
    engine(queries, results, rung_groups_.first(pairs));
}

/// Sets the floor to the highest proven rung below the margin. If no query ran to its end, the pair
/// has no floor.
void StopCertificate::take_floor(std::uint32_t place, std::span<const QueryResult> rungs) noexcept {
    Slot& slot = slots_[queried_[place]];
    const double before_mm = floor_before(slot), margin_mm = tasks_[place].margin_mm;
    slot.floor_mm = std::max(0.0, std::min(before_mm, margin_mm));
    bool is_known = false;
    for (std::size_t i = rungs.size(); i-- > 0;) {
        const bool is_tested = rungs[i].status == QueryStatus::ok;
        is_known = is_known || is_tested;
        if (is_tested && rungs[i].proof == Proof::far) {
            slot.floor_mm = jog_ladder(margin_mm, before_mm)[i + 1];
        }
    }
    has_floors_ = has_floors_ && is_known;
}

/// The last jog's floor if the axes are still in the box of its certificate. No permit can have led
/// them out of it: a person moved a machine that is outside.
double StopCertificate::floor_before(const Slot& slot) const noexcept {
    const bool holds = slot.floor_kept_mm != kNoJogFloor && is_in(slot.floor_box, slot.task.path);
    return holds ? slot.floor_kept_mm : kNoJogFloor;
}

/// Replaces the margins by the floors of a jog. False: there are none, or this call has just
/// determined them: that needs as much time as a proof, and a cycle has time for only one.
bool StopCertificate::keep_floors(const Engine& engine) noexcept {
    if (!has_floors_ || floors_at_ == snapshot_.sample) {
        find_floors(engine);
        begins_jog_ = has_floors_;
        return false;
    }
    for (std::uint32_t i = 0; i < proof_count_; ++i) {
        tasks_[i].margin_mm = slots_[queried_[i]].floor_mm;
    }
    return has_floors_;
}

/// Sets the box and its pieces from the board's look-ahead path. False: the path is too short.
bool StopCertificate::bound_path(double free_s) noexcept {
    double periods = free_s * 1e6 / machine_->can.sample_us;
    if (keeps_path()) {
        const PathStretch stretch = path_->stretch(snapshot_.sample, free_s);
        if (!stretch.is_known) {
            return false;
        }
        path_->cut(snapshot_.sample, stretch.end, pieces_.first<kPathPieces>());
        queried_pieces_ = pieces_;
        periods = stretch.end;
    } else {
        if (!path_->reach(snapshot_.sample, free_s, pieces_.first<kReachPieces>())) {
            return false;
        }
        queried_pieces_ = pieces_.first<kReachPieces>();
    }
    box_ = queried_pieces_[0];
    path_until_ = snapshot_.sample + static_cast<std::uint64_t>(periods);
    return true;
}

/// Sets the box to query for a permit valid for so many samples. False: not enough data.
bool StopCertificate::bound_box(std::uint32_t samples,
                                const std::array<double, kAxesMax>& bounds) noexcept {
    queried_pieces_ = {};
    if (jog_.is_on()) {
        is_path_known_ = false;
        box_ = jog_box(samples);
        return true;
    }
    is_path_known_ = path_ && bound_path(free_seconds(*machine_, samples));
    if (is_path_known_) {
        return true;
    }
    if (keeps_path()) {
        box_ = {.centre = snapshot_.position, .half = {}};
        return false;
    }
    box_ = reach_within(samples, bounds);
    return history_.count > 1;  // one snapshot gives no speed
}

/// During a tool change any tool may be in the spindle before the permit ends.
bool StopCertificate::is_queried(const Slot& slot) const noexcept {
    return slot.tool == kNoIndex || slot.tool == tool_ ||
           snapshot_.sample < tool_until_[slot.tool] || snapshot_.mode == kModeToolChange;
}

void StopCertificate::list_tasks() noexcept {
    for (std::uint32_t i = 0; i < slot_count_; ++i) {
        if (is_queried(slots_[i])) {
            queried_[proof_count_] = i;
            tasks_[proof_count_] = slots_[i].task;
            tasks_[proof_count_].box = box_;
            tasks_[proof_count_].pieces = queried_pieces_;
            ++proof_count_;
        }
    }
}

/// Sets n: the permit is as long as the shortest one proven for a pair.
void StopCertificate::take_wider() noexcept {
    bool are_all_proven = true;
    for (std::uint32_t i = 0; i < proof_count_; ++i) {
        const bool is_proven = results_[proof_count_ + i].proof == JointBoxProof::proven;
        are_all_proven = are_all_proven && is_proven;
        if (is_proven) {
            tasks_[i].box = wider_box_;
            tasks_[i].pieces = {};
        }
    }
    const PermitSamples range = machine_->can.permit_samples;
    is_longer_proven_ = are_all_proven;
    samples_ = are_all_proven ? ladder_.samples : range.least;
    if (!keeps_cap()) {
        ladder_next_ = ladder_.next(range, are_all_proven);
    } else {
        ladder_next_ = ladder_.next({range.least, samples_work(range)}, are_all_proven);
        ladder_next_.samples = std::max(ladder_next_.samples, samples_steered(range));
    }
}

void StopCertificate::prove(const Engine& engine,
                            const ContainmentTest& containment_test) noexcept {
    proof_count_ = containment_tests_ = 0;
    work_ = {};
    is_path_known_ = is_longer_proven_ = begins_jog_ = false;
    const PermitSamples range = machine_->can.permit_samples;
    samples_ = range.least;
    ladder_next_ = ladder_;
    status_ = judge_snapshot(*machine_, snapshot_, tool_);
    if (status_ == SnapshotStatus::ok && (has_left_path_ || has_left_jog_)) {
        status_ = has_left_jog_ ? SnapshotStatus::left_jog : SnapshotStatus::left_path;
    }
    if (status_ == SnapshotStatus::ok && !machine_->guard.reports_limits) {
        status_ = broken_limit_.kind != LimitKind::none ? SnapshotStatus::left_limits
                  : own_stop_.kind != LimitKind::none   ? SnapshotStatus::own_stop
                                                        : SnapshotStatus::ok;
    }
    if (status_ != SnapshotStatus::ok) {
        return;
    }
    has_wider_ = tries_longer(range) &&
                 bound_box(ladder_.samples, asks_raise_ ? raised_bound_ : speed_bound_);
    const bool is_wider_path = is_path_known_;
    wider_box_ = box_;
    bool is_known = bound_box(range.least, speed_bound_);
    has_wider_ = has_wider_ && is_wider_path == is_path_known_;
    list_tasks();
    if (jog_.is_on()) {
        is_known = keep_floors(engine);
    }
    // Without enough data no permit can follow this snapshot: the prover runs only the known-answer
    // test.
    const std::uint32_t proven = is_known ? proof_count_ : 0;
    has_wider_ = has_wider_ && is_known;
    for (std::uint32_t i = 0; has_wider_ && i < proof_count_; ++i) {  // in one box each
        JointBoxTask& task = tasks_[proof_count_ + i] = tasks_[i];
        task.box = wider_box_;
        task.pieces = {};
    }
    const std::uint32_t asked = has_wider_ ? 2 * proven : proven;
    work_ =
        prover_.prove(engine, tasks_.first(asked), results_.first(asked), has_wider_, keeps_cap());
    if (has_wider_) {
        take_wider();
    }
    for (std::uint32_t i = proven; i < proof_count_; ++i) {
        results_[i] = {.proof = JointBoxProof::budget_spent, .open = box_};
    }
    for (std::uint32_t i = 0; i < proof_count_; ++i) {
        const Slot& slot = slots_[queried_[i]];
        proofs_[i] = {slot.pair, slot.tool, results_[i], {}};
        if (results_[i].proof != JointBoxProof::proven) {
            continue;
        }
        if (is_inside_proven(slot)) {  // the boxes meet, and no surface crosses another in them
            proofs_[i].containment_result = {.status = QueryStatus::ok,
                                             .containment = Containment::none};
        } else {
            untested_[containment_tests_++] = i;
        }
    }
    if (containment_tests_ != 0) {
        test_containment(containment_test);
    }
}

/// With a path, successive stretches meet at the present commands; each is one chain of boxes.
bool StopCertificate::is_inside_proven(const Slot& slot) const noexcept {
    if (is_path_known_ || slot.by_path) {
        return slot.has_box && slot.by_path && is_path_known_ &&
               snapshot_.sample <= slot.proven_until;
    }
    return slot.has_box && is_in(slot.box, slot.task.path);
}

/// Whether the box contains the newest position, on the axes of the pair's path.
bool StopCertificate::is_in(const JointBox& box, const JointPath& path) const noexcept {
    bool inside = true;
    for (std::uint32_t k = 0; inside && k < path.count; ++k) {
        const std::uint32_t axis = machine_->bodies[path.body[k]].joint.axis;
        double off = snapshot_.position[axis] - box.centre[axis];
        if (machine_->axes[axis].unlimited) {
            off -= 2 * kPi * std::round(off / (2 * kPi));
        }
        inside = std::fabs(off) <= box.half[axis];
    }
    return inside;
}

/// Tests at the sampled pose or, with a path, at the pose commanded for it. The box proven just now
/// contains that pose, so its surfaces need no query.
void StopCertificate::test_containment(const ContainmentTest& containment_test) noexcept {
    const std::array<double, kAxesMax>& position =
        is_path_known_ ? path_->at(snapshot_.sample) : snapshot_.position;
    std::array<Pose, kBodiesMax> moved;
    move_bodies(*machine_, position, moved);
    for (std::uint32_t i = 0; i < containment_tests_; ++i) {
        PairProof& proof = proofs_[untested_[i]];
        proof.containment_result = containment_test.test(
            apart_pose_in(*machine_, tasks_[untested_[i]], proof.surfaces, position, moved));
    }
}

void StopCertificate::keep() noexcept {
    is_limit_judged_ = true;
    asks_raise_ = false;
    ladder_ = ladder_next_;
    if (begins_jog_) {
        return;  // earlier boxes remain valid: no surface crosses another in them
    }
    std::uint32_t next = 0;
    for (std::uint32_t i = 0; i < slot_count_; ++i) {
        const bool is_queried = next < proof_count_ && queried_[next] == i;
        const PairProof* proof = is_queried ? &proofs_[next] : nullptr;
        slots_[i].has_box = is_queried && proof->surfaces.proof == JointBoxProof::proven &&
                            proof->containment_result.containment == Containment::none;
        if (slots_[i].has_box) {
            slots_[i].box = tasks_[next].box;
            slots_[i].by_path = is_path_known_;
            slots_[i].proven_until = path_until_;
            slots_[i].floor_kept_mm = jog_.is_on() ? slots_[i].floor_mm : kNoJogFloor;
            slots_[i].floor_box = slots_[i].box;
        }
        next += is_queried ? 1 : 0;
    }
}

}  // namespace axg
