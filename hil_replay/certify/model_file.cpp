// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/certify/model_file.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "hil_replay/certify/chord_path.hpp"
#include "hil_replay/certify/section_file.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kModelFormat = 1;

std::int32_t index_of(std::uint32_t index) {
    return index == kNoIndex ? -1 : static_cast<std::int32_t>(index);
}

std::string rules_of(const Machine& machine) {
    SectionBytes out;
    out.put(kModelFormat);
    out.put(static_cast<std::uint8_t>(machine.guard.promise));
    out.put(static_cast<std::uint8_t>(machine.guard.free_jerk_limited));
    out.put(static_cast<std::uint8_t>(machine.guard.stop_reversal == StopReversal::jerk_limited));
    return out.bytes;
}

std::string axes_of(const Machine& machine) {
    SectionBytes out;
    out.put(static_cast<std::uint32_t>(machine.axes.size()));
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const Axis& axis = machine.axes[i];
        const bool is_bound = machine.pose_errors.are_stated && axis.kind == AxisKind::linear;
        out.put_text(axis.name);
        out.put(static_cast<std::uint8_t>(axis.kind));
        out.put(axis.speed_max);
        out.put(axis.acceleration_max);
        out.put(axis.jerk_max);
        out.put(axis.stopping_min);
        out.put(units_up(axis.following_error + axis.position_error, axis.kind));
        out.put(is_bound ? machine.pose_errors.within[i] : std::numeric_limits<double>::infinity());
    }
    return out.bytes;
}

std::string bodies_of(const Machine& machine) {
    SectionBytes out;
    out.put(static_cast<std::uint32_t>(machine.bodies.size()));
    for (const Body& body : machine.bodies) {
        out.put_text(body.name);
        out.put(index_of(body.parent));
        out.put(index_of(body.joint.axis));
        out.put_vector(body.joint.direction);
        out.put_vector(body.joint.pivot_mm);
        out.put(static_cast<std::uint8_t>(body.is_tool ? 2 : body.has_mesh ? 1 : 0));
    }
    return out.bytes;
}

/// Each surface once, in the order of its first use.
class SurfaceNumbers {
  public:
    std::uint32_t of(const Mesh* mesh) {
        const auto found = std::find(meshes_.begin(), meshes_.end(), mesh);
        const auto place = static_cast<std::uint32_t>(found - meshes_.begin());
        if (found == meshes_.end()) {
            meshes_.push_back(mesh);
        }
        return place;
    }

    [[nodiscard]] std::string bytes() const {
        SectionBytes out;
        out.put(static_cast<std::uint32_t>(meshes_.size()));
        for (const Mesh* mesh : meshes_) {
            out.put_text(mesh->name);
            out.put(static_cast<std::uint32_t>(mesh->triangles.size()));
            for (const Triangle& t : mesh->triangles) {
                for (const Vec3f& corner : {t.a, t.b, t.c}) {
                    out.put(corner.x);
                    out.put(corner.y);
                    out.put(corner.z);
                }
            }
        }
        return out.bytes;
    }

  private:
    std::vector<const Mesh*> meshes_;
};

std::string tasks_of_model(const Machine& machine, const CertifyTasks& tasks,
                           SurfaceNumbers& surfaces) {
    SectionBytes out;
    out.put(static_cast<std::uint32_t>(machine.tools.size()));
    for (const Tool& tool : machine.tools) {
        out.put(tool.number);
        out.put_text(tool.name);
    }
    out.put(static_cast<std::uint32_t>(tasks.tasks.size()));
    for (const CertifyTask& of : tasks.tasks) {
        out.put(index_of(of.task.body_a));
        out.put(index_of(of.task.body_b));
        out.put(index_of(of.tool));
        out.put_pose(of.task.at_a);
        out.put_pose(of.task.at_b);
        out.put(surfaces.of(of.surface_a));
        out.put(surfaces.of(of.surface_b));
        out.put(surfaces.of(of.whole_a));
        out.put(surfaces.of(of.whole_b));
        out.put(of.task.margin_mm);
        out.put(of.task.pose_error_mm);
    }
    return out.bytes;
}

std::string exclusions_of(const Machine& machine) {
    SectionBytes out;
    out.put(static_cast<std::uint32_t>(machine.exclusions.size()));
    for (const Exclusion& exclusion : machine.exclusions) {
        out.put(index_of(exclusion.a));
        out.put(index_of(exclusion.b));
        out.put_text(exclusion.reason.substr(0, UINT16_MAX));
    }
    return out.bytes;
}

}  // namespace

std::string model_file(const LoadedMachine& loaded, const CertifyTasks& tasks) {
    const Machine& machine = loaded.machine;
    SurfaceNumbers surfaces;
    const std::string of_tasks = tasks_of_model(machine, tasks, surfaces);
    SectionFile file;
    file.add("MODL", rules_of(machine));
    file.add("AXES", axes_of(machine));
    file.add("BODY", bodies_of(machine));
    file.add("SURF", surfaces.bytes());
    file.add("TASK", of_tasks);
    file.add("EXCL", exclusions_of(machine));
    return file.finish();
}

}  // namespace axg
