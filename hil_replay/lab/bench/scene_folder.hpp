// SPDX-License-Identifier: Apache-2.0
// A scene folder: bare meshes at given poses, no machine. bodies.csv (name,stl,triangles),
// pairs.csv (pair,a,b), poses.csv (pose,body,m00..m33: 4x4 row by row, mm); STL files in mm in
// the same folder.
#pragma once

#include <string>
#include <vector>

#include "core/base/pose.hpp"
#include "core/mesh/mesh.hpp"

namespace axg {

struct SceneFolder {
    struct Pair {
        std::string name;
        std::size_t a = 0, b = 0;  // bodies
    };
    std::vector<Mesh> bodies;
    std::vector<Pair> pairs;
    std::vector<std::string> poses;  // names, in order of first appearance
    std::vector<Pose> placed;        // [pose][body]
    std::vector<std::string> files;  // that the reader opened
    double pose_error_mm = 0;        // bound of a point's error from matrices not exactly rigid

    [[nodiscard]] const Pose& at(std::size_t pose, std::size_t body) const {
        return placed[pose * bodies.size() + body];
    }
};

/// Every body must have a matrix in every pose, rigid to 1e-6 (R^T R against the identity).
/// @return empty, or the first fault as FILE:LINE: message (no LINE for a missing matrix)
[[nodiscard]] std::string read_scene_folder(const std::string& folder, SceneFolder& out);

}  // namespace axg
