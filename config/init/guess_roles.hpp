// SPDX-License-Identifier: Apache-2.0
// Guesses the roles of the parts of a machine from the names of their files, to save typing. Every
// output marks them as guesses.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/vec3.hpp"

namespace axg {

inline constexpr std::uint32_t kNoParent = 0xffffffffU;  // carried by the machine's frame
inline constexpr std::uint32_t kNoFile = 0xffffffffU;    // a body of shapes, or a bare link

struct RoleGuess {
    std::string name;  // of the body: the file's name made a legal and unique one
    std::string axis;  // "X"; empty: does not move by itself
    bool is_tool = false;
    bool is_unnamed = false;           // its name contains no known word
    bool is_table_side = false;        // carries the workpiece: commanded motion runs the other way
    std::uint32_t parent = kNoParent;  // index in the result
    std::uint32_t file = 0;            // index of the file, or kNoFile
    // Stated by another file: name, axis, parent, where the mesh is, a point on its axis and which
    // way it moves.
    bool is_stated = false;
    Vec3d at_mm{}, pivot_mm{};  // if stated
    bool is_reversed = false;   // if stated: moves against its axis when the command is positive
    std::string way_doubt, pivot_doubt;  // if stated: why a person has to confirm the value
    // Of a URDF file.
    Vec3d direction{};      // 0: that of the axis, by its letter
    Vec3d rotate_deg{};     // of the mesh
    std::string shapes;     // items of mesh.shapes, in place of a file
    std::string axis_note;  // where the axis is stated
};

/// One guess a file, parents first. Table side: Y carries X carries A, B, C. Head side: Z carries
/// the tool. If no name contains an axis, the first file moves along X: a machine needs one axis.
[[nodiscard]] std::vector<RoleGuess> guess_roles(const std::vector<std::string>& files);

/// Extents of a mesh, mm.
struct Box {
    Vec3d min_mm{}, max_mm{};
};

/// Lets each body without a known name ride on the smallest named one whose box contains its own: a
/// motor in the headstock moves with it.
/// @param boxes  [files]
void ride_in_boxes(std::vector<RoleGuess>& roles, const std::vector<Box>& boxes);

/// Adds a tool body, as a guess on the last moved body that does not carry the workpiece; nothing
/// if there is one.
void add_tool_body(std::vector<RoleGuess>& roles);

/// The first axis X to C that is a word of a name, in capitals: 'X' for "x_joint"; '\0': none.
[[nodiscard]] char axis_in(std::string_view name);

/// The name of a body: `stem` with what is not legal replaced, and unlike the others.
[[nodiscard]] std::string legal_name(const std::string& stem, const std::vector<RoleGuess>& others);

}  // namespace axg
