// SPDX-License-Identifier: Apache-2.0
#include "core/certificate/stop_certificate.hpp"

#include <algorithm>
#include <utility>

#include "core/base/assert.hpp"

namespace axg {

StopCertificate::StopCertificate(const Machine& machine, std::span<const Mesh* const> surfaces,
                                 const StopOptions& options, StagedProver prover,
                                 std::optional<PathReach> path, Arena arena) noexcept
    : machine_(&machine),
      options_(options),
      prover_(std::move(prover)),
      arena_(std::move(arena)),
      motion_(machine, options.count),
      path_(std::move(path)),
      tasks_(machine, surfaces, arena_),
      jog_(machine, options.plan, arena_),
      boxes_(machine, arena_),
      permits_(machine.can.permit_samples, keeps_cap()) {
    arena_.seal();
    bounds_.now.fill(std::numeric_limits<double>::infinity());
}

std::optional<StopCertificate> StopCertificate::create(const Machine& machine,
                                                       std::span<const Mesh* const> surfaces,
                                                       const StopOptions& options) {
    const std::uint32_t slots = stop_tasks(machine);
    auto prover =
        StagedProver::create(machine, tries_longer(machine.can.permit_samples) ? 2 * slots : slots,
                             options.plan, known_answer_mesh_index(machine));
    const bool has_path = machine.can.look_ahead_samples != 0;
    auto path = has_path ? PathReach::create(machine, {.count = options.count}) : std::nullopt;
    Arena arena(PairTasks::size_bytes(machine, surfaces.size()) +
                JogFloors::size_bytes(machine, options.plan) + ProvenBoxes::size_bytes(machine));
    if (!prover || !arena.ok() || (has_path && !path)) {
        return std::nullopt;
    }
    return StopCertificate(machine, surfaces, options, std::move(*prover), std::move(path),
                           std::move(arena));
}

void StopCertificate::note(const AxisSnapshot& snapshot, bool is_first) noexcept {
    const AxisSnapshot before = motion_.snapshot();
    motion_.note(snapshot, is_first);
    jog_.note(motion_, is_first);
    tools_.note(*machine_, before, snapshot, is_first);
    if (path_) {
        path_->note(snapshot, is_first, jog_.is_on());
    }
}

void StopCertificate::note_path(const PathPoints& points) noexcept {
    if (path_) {
        path_->note_path(points);
    }
}

void StopCertificate::bound_speeds(std::span<const double> speeds) noexcept {
    AXG_ASSERT(speeds.size() == machine_->axes.size());
    std::copy(speeds.begin(), speeds.end(), bounds_.now.begin());
}

void StopCertificate::ask_raise(std::span<const double> speeds) noexcept {
    AXG_ASSERT(keeps_cap() && speeds.size() == machine_->axes.size());
    std::copy(speeds.begin(), speeds.end(), bounds_.raised.begin());
    bounds_.asks_raise = true;
}

AxisLimits StopCertificate::bounded_limits(std::uint32_t axis) const noexcept {
    AxisLimits limits = stop_limits(*machine_, axis);
    limits.speed_max = std::min(limits.speed_max, bounds_.now[axis]);
    return limits;
}

JointBox StopCertificate::reach(std::uint32_t samples) const noexcept {
    return independent_reach(*machine_, motion_, samples, bounds_.now).box;
}

/// Whether the newest snapshot can be queried, and the axes keep to what is known of them.
SnapshotStatus StopCertificate::judge_status() noexcept {
    const SnapshotStatus status = tools_.judge(*machine_, snapshot());
    return status != SnapshotStatus::ok ? status
           : jog_.has_left()            ? SnapshotStatus::left_jog
           : path_ && path_->has_left() ? SnapshotStatus::left_path
                                        : motion_.status();
}

/// A jog has a reach of its own, and a path that is long enough goes before the axes' limits.
Reach StopCertificate::reach_for(std::uint32_t samples,
                                 const std::array<double, kAxesMax>& speeds) noexcept {
    if (jog_.is_on()) {
        return reach_in_jog(*machine_, motion_, jog_.move(), samples);
    }
    const Reach along = path_ ? path_->reach(snapshot().sample, samples) : Reach{};
    if (along.is_known) {
        return along;
    }
    if (keeps_path()) {  // such a stop is bounded by its path alone
        return {.kind = ReachKind::path, .box = {.centre = snapshot().position, .half = {}}};
    }
    return independent_reach(*machine_, motion_, samples, speeds);
}

void StopCertificate::prove(const Engine& engine,
                            const ContainmentTest& containment_test) noexcept {
    tasks_.clear();
    boxes_.begin_cycle();
    jog_.begin_cycle();
    permits_.begin();
    work_ = {};
    reach_ = {};
    status_ = judge_status();
    if (status_ != SnapshotStatus::ok) {
        return;
    }
    const Reach wider =
        permits_.tries_longer()
            ? reach_for(permits_.longer(), bounds_.asks_raise ? bounds_.raised : bounds_.now)
            : Reach{};
    reach_ = reach_for(permits_.least(), bounds_.now);
    proven_reach_ = reach_.box;
    tasks_.list(tools_, snapshot(), reach_);
    const bool is_known = jog_.is_on() ? jog_.apply(engine, motion_, tasks_) : reach_.is_known;
    prove_tasks(engine, is_known, wider);
    boxes_.judge(
        containment_test, tasks_, reach_, snapshot(),
        reach_.is_known_path() ? path_->path().at(snapshot().sample) : snapshot().position);
}

/// Without enough data no permit can follow this snapshot: the prover runs only the known-answer
/// test.
void StopCertificate::prove_tasks(const Engine& engine, bool is_known,
                                  const Reach& wider) noexcept {
    const std::uint32_t proven = is_known ? tasks_.count() : 0;
    const bool has_wider = is_known && wider.is_known && wider.kind == reach_.kind;
    if (has_wider) {
        tasks_.add_wider(wider.box);
    }
    const std::uint32_t asked = has_wider ? 2 * proven : proven;
    const std::span<JointBoxResult> results = tasks_.results();
    work_ = prover_.prove(engine, tasks_.tasks().first(asked), results.first(asked), has_wider,
                          keeps_cap());
    if (has_wider) {
        take_wider(wider.box);
    }
    for (std::uint32_t i = proven; i < tasks_.count(); ++i) {
        results[i] = {.proof = JointBoxProof::budget_spent, .open = reach_.box};
    }
    for (std::uint32_t i = 0; i < tasks_.count(); ++i) {
        const PairSlot& slot = tasks_.slots()[tasks_.slot_of(i)];
        tasks_.proofs()[i] = {slot.pair, slot.tool, results[i], {}};
    }
}

/// Where the longer permit is proven for a pair, its box is the proven one.
void StopCertificate::take_wider(const JointBox& box) noexcept {
    bool are_all_proven = true;
    for (std::uint32_t i = 0; i < tasks_.count(); ++i) {
        const bool is_proven = tasks_.results()[tasks_.count() + i].proof == JointBoxProof::proven;
        are_all_proven = are_all_proven && is_proven;
        if (is_proven) {
            tasks_.tasks()[i].box = box;
            tasks_.tasks()[i].pieces = {};
        }
    }
    permits_.take(are_all_proven);
    proven_reach_ = are_all_proven ? box : reach_.box;
}

void StopCertificate::keep() noexcept {
    motion_.keep();
    bounds_.asks_raise = false;
    permits_.keep();
    if (!jog_.begins()) {  // else earlier boxes remain valid: no surface crosses another in them
        boxes_.keep(tasks_, reach_, jog_);
    }
}

}  // namespace axg
