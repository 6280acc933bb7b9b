// SPDX-License-Identifier: Apache-2.0
// Files of cases for `axguard-lab accuracy`: pairs of triangles ('TTP1': float or double, with a
// pose or without) and meshes at poses ('TTM1'). Little-endian, mm. Source of the format: README of
// the folder tritri next to the project's data; docs/reference/commands.md repeats it.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/mesh/mesh.hpp"
#include "hil_replay/lab/cases/pair_set.hpp"

namespace axg::lab {

/// Two meshes at a pose: a vertex q of b is at R q + t in the frame of a.
struct MeshCase {
    std::uint32_t a = 0, b = 0;
    Pose pose;
};

/// Either pairs or meshes; ids[i] names pair or mesh case i.
struct TritriFile {
    std::vector<std::uint32_t> ids;
    PairSet pairs;
    std::vector<Mesh> meshes;
    std::vector<MeshCase> mesh_cases;

    [[nodiscard]] bool holds_meshes() const noexcept { return !meshes.empty(); }
};

/// Parses the bytes of a file. Checks every length and count against the bytes that are left before
/// it reserves memory. Returns an empty text, or the fault as OFFSET: WHAT (found ..., ...); `out`
/// is unusable then.
[[nodiscard]] std::string parse_tritri(std::string_view bytes, TritriFile& out);

/// Reads and parses a file; a fault begins with its name.
[[nodiscard]] std::string read_tritri(const std::string& path, TritriFile& out);

}  // namespace axg::lab
