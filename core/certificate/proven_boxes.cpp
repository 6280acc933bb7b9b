// SPDX-License-Identifier: Apache-2.0
#include "core/certificate/proven_boxes.hpp"

#include "core/machine/kinematics.hpp"

namespace axg {

std::size_t ProvenBoxes::size_bytes(const Machine& machine) noexcept {
    return Arena::size_bytes<Kept>(stop_tasks(machine)) +
           Arena::size_bytes<std::uint32_t>(stop_tasks(machine));
}

ProvenBoxes::ProvenBoxes(const Machine& machine, Arena& arena) noexcept
    : machine_(&machine),
      kept_(arena.take<Kept>(stop_tasks(machine))),
      untested_(arena.take<std::uint32_t>(kept_.size())) {}

/// With a path, successive stretches meet at the present commands; each is one chain of boxes.
bool ProvenBoxes::holds(const Kept& kept, const JointPath& path, const Reach& reach,
                        const AxisSnapshot& snapshot) const noexcept {
    if (reach.is_known_path() || kept.by_path) {
        return kept.has_box && kept.by_path && reach.is_known_path() &&
               snapshot.sample <= kept.until;
    }
    return kept.has_box && is_in_box_any_turn(*machine_, path, kept.box, snapshot.position);
}

void ProvenBoxes::judge(const ContainmentTest& containment_test, PairTasks& tasks,
                        const Reach& reach, const AxisSnapshot& snapshot,
                        const std::array<double, kAxesMax>& position) noexcept {
    for (std::uint32_t i = 0; i < tasks.count(); ++i) {
        PairProof& proof = tasks.proofs()[i];
        if (proof.surfaces.proof != JointBoxProof::proven) {
            continue;
        }
        const std::uint32_t slot = tasks.slot_of(i);
        if (holds(kept_[slot], tasks.slots()[slot].task.path, reach, snapshot)) {
            // The boxes meet, and no surface crosses another in them.
            proof.containment_result = {.status = QueryStatus::ok,
                                        .containment = Containment::none};
        } else {
            untested_[tests_++] = i;
        }
    }
    if (tests_ == 0) {
        return;
    }
    std::array<Pose, kBodiesMax> moved;
    move_bodies(*machine_, position, moved);
    for (std::uint32_t i = 0; i < tests_; ++i) {
        PairProof& proof = tasks.proofs()[untested_[i]];
        proof.containment_result = containment_test.test(
            apart_pose_in(*machine_, tasks.tasks()[untested_[i]], proof.surfaces, position, moved));
    }
}

void ProvenBoxes::keep(const PairTasks& tasks, const Reach& reach, JogFloors& floors) noexcept {
    for (Kept& kept : kept_) {
        kept.has_box = false;
    }
    for (std::uint32_t i = 0; i < tasks.count(); ++i) {
        const PairProof& proof = tasks.proofs()[i];
        if (proof.surfaces.proof != JointBoxProof::proven ||
            proof.containment_result.containment != Containment::none) {
            continue;
        }
        const JointBox& box = tasks.tasks()[i].box;
        kept_[tasks.slot_of(i)] = {true, box, reach.is_known_path(), reach.until};
        floors.keep(tasks.slot_of(i), box);
    }
}

}  // namespace axg
