// SPDX-License-Identifier: Apache-2.0
// Writes the meshes of the example machines: axg_make_machines FOLDER. Equal bytes on every run and
// machine.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "config/machines/generator/parts.hpp"
#include "core/mesh/mesh_check.hpp"
#include "core/mesh/stl.hpp"

namespace {

namespace fs = std::filesystem;

/// A part is written only if it is a sound solid.
bool is_sound(const axg::generator::Part& part) {
    const axg::MeshReport report = axg::check_mesh(part.triangles);
    const bool sound = report.facet_count != 0 && report.is_closed() && report.shells == 1 &&
                       report.volume_mm3 > 0 && report.degenerate_facets == 0 &&
                       report.self_intersections == 0 && report.self_complete;
    if (!sound) {
        std::fprintf(
            stderr,
            "%s: %u facets, %u open, %u flipped, %u other bad edges, %u shells, %u without "
            "area, %u crossings, %g mm3: correct the part\n",
            part.file.c_str(), report.facet_count, report.open_edges, report.flipped_edges,
            report.non_manifold_edges, report.shells, report.degenerate_facets,
            report.self_intersections, report.volume_mm3);
    }
    return sound;
}

/// To a temporary name first: a reader never sees half a file.
bool write(const fs::path& path, const std::vector<std::byte>& bytes) {
    std::error_code error;
    fs::create_directories(path.parent_path(), error);
    const fs::path temporary = path.string() + ".new";
    std::ofstream out(temporary, std::ios::binary);
    out.write(reinterpret_cast<const char*>(bytes.data()),
              static_cast<std::streamsize>(bytes.size()));
    out.close();
    if (out) {
        fs::rename(temporary, path, error);
    }
    if (!out || error) {
        std::fprintf(stderr, "%s: cannot be written\n", path.c_str());
        return false;
    }
    return true;
}

}  // namespace

int main(int count, char** arguments) {
    if (count != 2) {
        std::fprintf(stderr, "usage: axg_make_machines FOLDER\n");
        return 2;
    }
    bool is_good = true;
    for (const auto& machine : {axg::generator::paper_trunnion(), axg::generator::spindle_tilting(),
                                axg::generator::table_spindle_tilting()}) {
        for (const axg::generator::Part& part : machine) {
            is_good = is_sound(part) &&
                      write(fs::path(arguments[1]) / part.file, axg::write_stl(part.triangles)) &&
                      is_good;
            std::printf("%-40s %5zu triangles\n", part.file.c_str(), part.triangles.size());
        }
    }
    return is_good ? 0 : 1;
}
