// SPDX-License-Identifier: Apache-2.0
#include <set>
#include <tuple>

#include "hil_replay/certcheck/model.hpp"
#include "hil_replay/certcheck/sections.hpp"

namespace axg::certcheck {
namespace {

constexpr double kLengthMax = 1e9;                  // mm
constexpr double kRateMin = 1e-9, kRateMax = 1e18;  // 1e18: no limit of the jerk
constexpr std::uint32_t kTrianglesMax = 1U << 22;

bool read_flag(ByteReader& in) {
    return in.within<std::uint8_t>(0, 1, "expected 0 or 1") == 1;
}

std::uint32_t read_count(ByteReader& in, std::uint32_t low, std::uint32_t high) {
    const auto count = in.number<std::uint32_t>();
    in.require(count >= low && count <= high, "the count is out of range");
    return count;
}

Vector read_vector(ByteReader& in) {
    Vector vector;
    for (Interval& each : vector.at) {
        each = in.within<double>(-kLengthMax, kLengthMax, "a length is out of range");
    }
    return vector;
}

void read_axes(ByteReader in, Model& model) {
    model.axes.resize(read_count(in, 1, kAxesMax));
    for (Axis& axis : model.axes) {
        axis.name = in.text();
        axis.is_rotary = read_flag(in);
        axis.unit = axis.is_rotary ? 0x1p-24 : 0x1p-16;
        for (double* rate : {&axis.speed, &axis.acceleration, &axis.jerk, &axis.stopping}) {
            *rate = in.within<double>(kRateMin, kRateMax, "a limit of the axis is out of range");
        }
        axis.following = in.number<std::int64_t>();
        in.require(axis.following >= 0 && axis.following <= kPositionMax,
                   "the following error is out of range");
        axis.within = in.number<double>();
        in.require(axis.within >= 0, "within is negative");
    }
    in.end();
}

void read_bodies(ByteReader in, Model& model) {
    const int count = static_cast<int>(read_count(in, 1, kBodiesMax));
    for (int i = 0; i < count; ++i) {
        Body body;
        body.name = in.text();
        body.parent = in.number<std::int32_t>();
        in.require(body.parent >= -1 && body.parent < i, "the parent does not precede the body");
        body.axis = in.number<std::int32_t>();
        in.require(body.axis >= -1 && body.axis < static_cast<int>(model.axes.size()),
                   "no such axis");
        const Vector along = read_vector(in);
        body.pivot = read_vector(in);
        if (body.axis >= 0) {
            const Interval off = dot(along, along) - 1;
            in.require(off.low >= -1e-9 && off.high <= 1e-9, "a direction is not of length 1");
            body.direction = (1 / length(along)) * along;
        }
        body.has_surface =
            static_cast<int>(in.within<std::uint8_t>(0, 2, "has surface: expected 0, 1 or 2"));
        model.bodies.push_back(body);
    }
    in.end();
}

Surface surface_of(std::string name, std::vector<Triangle> corners) {
    Surface surface{std::move(name), BoxTree(std::move(corners))};
    if (surface.tree.triangles().empty()) {
        return surface;
    }
    const Vector& box = surface.tree.box(surface.tree.top());
    for (std::size_t i = 0; i < 3; ++i) {  // any point will do, so its rounding does no harm
        surface.middle[i] = (box[i].low + box[i].high) / 2;
    }
    for (const Triangle& triangle : surface.tree.triangles()) {
        for (std::size_t i = 0; i < 9; i += 3) {
            const Vector corner{{triangle[i], triangle[i + 1], triangle[i + 2]}};
            surface.radius = std::max(surface.radius, length(corner - surface.middle).high);
        }
    }
    return surface;
}

void read_surfaces(ByteReader in, Model& model) {
    const auto count = in.number<std::uint32_t>();
    for (std::uint32_t i = 0; i < count; ++i) {
        std::string name = in.text();
        const std::uint32_t triangles = read_count(in, 0, kTrianglesMax);
        in.require(triangles <= in.left() / sizeof(Triangle), "the section ends too early");
        std::vector<Triangle> corners(triangles);
        for (Triangle& triangle : corners) {
            for (float& value : triangle) {
                value = static_cast<float>(
                    in.within<float>(-kLengthMax, kLengthMax, "a corner is out of range"));
            }
        }
        model.surfaces.push_back(surface_of(std::move(name), std::move(corners)));
    }
    in.end();
}

/// A placement keeps lengths, up to 1e-9.
Pose read_pose(ByteReader& in) {
    Pose pose;
    for (Vector& row : pose.row) {
        row = read_vector(in);
    }
    pose.shift = read_vector(in);
    for (std::size_t i = 0; i < 9; ++i) {
        const Interval off = dot(pose.row[i / 3], pose.row[i % 3]) - (i / 3 == i % 3 ? 1 : 0);
        in.require(off.low >= -1e-9 && off.high <= 1e-9, "a placement is no rotation");
    }
    return pose;
}

void read_tasks(ByteReader in, Model& model) {
    const std::uint32_t tools = read_count(in, 0, 64);
    for (std::uint32_t i = 0; i < tools; ++i) {
        const auto number = in.number<std::uint16_t>();
        model.tools.push_back(std::string("T").append(std::to_string(number)) + " " + in.text());
    }
    const auto count = in.number<std::uint32_t>();
    for (std::uint32_t i = 0; i < count; ++i) {
        Task task;
        bool carries_tool = false;
        for (int& body : task.body) {
            body = in.number<std::int32_t>();
            in.require(body >= 0 && body < static_cast<int>(model.bodies.size()), "no such body");
            const int has_surface = model.bodies[static_cast<std::size_t>(body)].has_surface;
            in.require(has_surface != 0, "a body of the task has no surface");
            carries_tool = carries_tool || has_surface == 2;
        }
        in.require(task.body[0] != task.body[1], "a task of one body");
        task.tool = in.number<std::int32_t>();
        in.require(task.tool < static_cast<int>(tools) && task.tool >= -1 &&
                       (task.tool >= 0) == carries_tool,
                   "the task's tool does not fit its bodies");
        for (Pose& at : task.at) {
            at = read_pose(in);
        }
        for (std::uint32_t* surface :
             {&task.surface[0], &task.surface[1], &task.whole[0], &task.whole[1]}) {
            *surface = in.number<std::uint32_t>();
            in.require(*surface < model.surfaces.size(), "no such surface");
        }
        task.margin = in.within<double>(0, kLengthMax, "the margin is out of range");
        task.error = in.within<double>(0, kLengthMax, "the error is out of range");
        model.tasks.push_back(task);
    }
    in.end();
}

void read_exclusions(ByteReader in, Model& model) {
    const auto count = in.number<std::uint32_t>();
    for (std::uint32_t i = 0; i < count; ++i) {
        Exclusion exclusion;
        for (int& body : exclusion.body) {
            body = in.number<std::int32_t>();
            in.require(body >= 0 && body < static_cast<int>(model.bodies.size()), "no such body");
        }
        exclusion.reason = in.text();
        model.exclusions.push_back(std::move(exclusion));
    }
    in.end();
}

/// Every two bodies that have a surface are in a task, once for each tool, or excluded.
void require_all_pairs(const std::string& file, const Model& model) {
    std::set<std::tuple<int, int, int>> covered;
    const int tools = static_cast<int>(model.tools.size());
    for (const Task& task : model.tasks) {
        covered.emplace(task.body[0], task.body[1], task.tool);
        covered.emplace(task.body[1], task.body[0], task.tool);
    }
    for (const Exclusion& pair : model.exclusions) {
        for (int tool = -1; tool < tools; ++tool) {
            covered.emplace(pair.body[0], pair.body[1], tool);
            covered.emplace(pair.body[1], pair.body[0], tool);
        }
    }
    for (int a = 0; a < static_cast<int>(model.bodies.size()); ++a) {
        for (int b = 0; b < a; ++b) {
            const Body& one = model.bodies[static_cast<std::size_t>(a)];
            const Body& other = model.bodies[static_cast<std::size_t>(b)];
            if (one.has_surface == 0 || other.has_surface == 0) {
                continue;
            }
            const bool carries_tool = one.has_surface == 2 || other.has_surface == 2;
            for (int tool = carries_tool ? 0 : -1; tool < (carries_tool ? tools : 0); ++tool) {
                if (!covered.contains({a, b, tool})) {
                    throw Refusal{10, file + ": TASK: no task of " + other.name + " and " +
                                          one.name +
                                          (tool < 0 ? "" : " with " + model.tools[tool]) +
                                          ", and no exclusion of this pair"};
                }
            }
        }
    }
}

}  // namespace

Model read_model(const std::string& file, std::span<const std::uint8_t> bytes) {
    Sections sections(file, bytes);
    Model model;
    ByteReader head = sections.open("MODL");
    head.require(head.number<std::uint32_t>() == 1, "the format is not 1");
    model.is_independent = !read_flag(head);
    model.has_free_jerk = read_flag(head);
    model.turns_round = read_flag(head);
    head.end();
    read_axes(sections.open("AXES"), model);
    read_bodies(sections.open("BODY"), model);
    read_surfaces(sections.open("SURF"), model);
    read_tasks(sections.open("TASK"), model);
    read_exclusions(sections.open("EXCL"), model);
    sections.end();
    require_all_pairs(file, model);
    return model;
}

}  // namespace axg::certcheck
