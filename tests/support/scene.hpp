// SPDX-License-Identifier: Apache-2.0
// A scene folder: bare meshes at given poses, as `axguard-lab query` takes them. Read and written
// here by code of its own, so that the tests do not lean on the reader they test.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/pose.hpp"
#include "core/mesh/mesh.hpp"

namespace axg::test {

struct ScenePair {
    std::string name;
    std::uint32_t a = 0, b = 0;  // indices into Scene::bodies
};

struct Scene {
    std::vector<Mesh> bodies;
    std::vector<ScenePair> pairs;
    std::uint32_t pose_count = 0;
    std::vector<Pose> placed;  // [pose][body]: mesh frame to machine coordinates, mm

    [[nodiscard]] const Pose& at(std::uint32_t pose, std::uint32_t body) const {
        return placed[pose * bodies.size() + body];
    }
};

/// Writes bodies.csv, pairs.csv, poses.csv (17 significant digits: exact) and one binary STL a
/// body. Throws std::runtime_error naming the file that could not be written.
void write_scene(const Scene& scene, const std::string& folder);

/// Reads such a folder. Throws std::runtime_error naming file and line of the first fault.
[[nodiscard]] Scene read_scene(const std::string& folder);

/// One line of ANSWERS.csv; -1 for an empty column.
struct QueryAnswer {
    std::uint32_t pose = 0;
    std::string pair;
    int hit = -1;
    long count = -1;
    double clearance_mm = -1;
};
[[nodiscard]] std::vector<QueryAnswer> read_answers(const std::string& file);

}  // namespace axg::test
