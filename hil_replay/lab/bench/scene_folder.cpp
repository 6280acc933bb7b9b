// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/bench/scene_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <string_view>

#include "config/text/fault_text.hpp"
#include "config/text/open_beneath.hpp"
#include "config/text/quote_text.hpp"
#include "core/base/limits.hpp"
#include "core/mesh/stl.hpp"
#include "hil_replay/lab/bench/csv_table.hpp"

namespace axg {
namespace {

constexpr double kDefectMax = 1.0e-6;     // beyond it a matrix is not meant to be rigid
constexpr double kDefectExact = 1.0e-12;  // below it the matrix is as good as double allows

using Names = std::map<std::string_view, std::size_t>;

std::string read_bodies(const std::string& folder, const CsvTable& table, SceneFolder& out,
                        Names& names) {
    for (std::size_t row = 0; row < table.row_count(); ++row) {
        const std::string file(table.cell(row, 1));
        const FileRead read = read_beneath(folder, file, kStlBytesMax);
        out.files.push_back(folder + "/" + file);
        if (!read.got.empty()) {
            return fmt::format("{}: {}: {}", table.where(row), escaped(file),
                               fault_text("invalid file", read.got, read.wanted));
        }
        StlResult stl = read_stl(read.bytes, 1.0);
        if (!stl.faults.empty()) {
            return fmt::format(
                "{}: {}: invalid STL file ({} faults, the first at byte {}). For a body of a "
                "machine, axguard check lists them.",
                table.where(row), escaped(file), stl.fault_count, stl.faults[0].byte);
        }
        double stated = static_cast<double>(stl.triangles.size());
        if (!table.cell(row, 2).empty() && (!read_number(table.cell(row, 2), stated) ||
                                            stated != static_cast<double>(stl.triangles.size()))) {
            return fmt::format("{}: triangles: wrong number (found {}, expected {} as in {})",
                               table.where(row), escaped(table.cell(row, 2)), stl.triangles.size(),
                               escaped(file));
        }
        if (!names.emplace(table.cell(row, 0), out.bodies.size()).second) {
            return fmt::format("{}: duplicate body '{}'", table.where(row),
                               escaped(table.cell(row, 0)));
        }
        out.bodies.push_back({std::string(table.cell(row, 0)), std::move(stl.triangles)});
    }
    return {};
}

std::string read_pairs(const CsvTable& table, const Names& bodies, SceneFolder& out) {
    std::set<std::string_view> seen;
    for (std::size_t row = 0; row < table.row_count(); ++row) {
        if (!seen.insert(table.cell(row, 0)).second) {
            return fmt::format("{}: duplicate pair '{}' (expected a unique name)", table.where(row),
                               escaped(table.cell(row, 0)));
        }
        SceneFolder::Pair pair{std::string(table.cell(row, 0)), 0, 0};
        for (const auto& [column, index] : {std::pair{1, &pair.a}, std::pair{2, &pair.b}}) {
            const auto found = bodies.find(table.cell(row, static_cast<std::size_t>(column)));
            if (found == bodies.end()) {
                return fmt::format("{}: unknown body '{}' (expected one of bodies.csv)",
                                   table.where(row),
                                   escaped(table.cell(row, static_cast<std::size_t>(column))));
            }
            *index = found->second;
        }
        out.pairs.push_back(std::move(pair));
    }
    return {};
}

/// Largest entry of |R^T R - I|.
double defect_of(const Pose& p) {
    double defect = 0;
    for (int i = 0; i < 3; ++i) {
        for (int j = i; j < 3; ++j) {
            const double d = p.r[0][i] * p.r[0][j] + p.r[1][i] * p.r[1][j] + p.r[2][i] * p.r[2][j];
            defect = std::max(defect, std::fabs(d - (i == j ? 1.0 : 0.0)));
        }
    }
    return defect;
}

std::string read_matrix(const CsvTable& table, std::size_t row, Pose& out) {
    std::array<double, 16> m{};
    for (std::size_t k = 0; k < 16; ++k) {
        if (!read_number(table.cell(row, 2 + k), m[k])) {
            return fmt::format("{}: m{}{}: invalid value (found '{}', expected a number)",
                               table.where(row), k / 4, k % 4, escaped(table.cell(row, 2 + k)));
        }
    }
    if (m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] != 1) {
        return fmt::format("{}: invalid last row (expected 0 0 0 1)", table.where(row));
    }
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            out.r[i][j] = m[4 * i + j];
        }
        out.t[i] = m[4 * i + 3];
        if (std::fabs(out.t[i]) > kCoordinateMmMax) {
            return fmt::format("{}: translation too large (found {} mm, expected at most {})",
                               table.where(row), out.t[i], kCoordinateMmMax);
        }
    }
    const double defect = defect_of(out);
    const double volume = dot(Vec3d{out.r[0][0], out.r[1][0], out.r[2][0]},
                              cross(Vec3d{out.r[0][1], out.r[1][1], out.r[2][1]},
                                    Vec3d{out.r[0][2], out.r[1][2], out.r[2][2]}));
    if (!(defect <= kDefectMax) || volume < 0) {
        return fmt::format(
            "{}: matrix is not a rotation (found R^T R off by {:.1e}, determinant {:.3g}, expected "
            "at most {:.0e}). Write 17 digits.",
            table.where(row), defect, volume, kDefectMax);
    }
    return {};
}

/// Changes to a near rotation (Gram-Schmidt); moves no unit vector by more than the defect.
void make_rigid(Pose& p) {
    Vec3d column[3];
    for (int k = 0; k < 3; ++k) {
        column[k] = {p.r[0][k], p.r[1][k], p.r[2][k]};
    }
    const auto unit = [](const Vec3d& v) { return (1.0 / std::sqrt(dot(v, v))) * v; };
    column[0] = unit(column[0]);
    column[1] = unit(column[1] - dot(column[0], column[1]) * column[0]);
    column[2] = cross(column[0], column[1]);
    for (int k = 0; k < 3; ++k) {
        p.r[0][k] = column[k].x;
        p.r[1][k] = column[k].y;
        p.r[2][k] = column[k].z;
    }
}

/// Farthest any point of the scene can be from any body's origin, mm.
double reach_of(const SceneFolder& scene) {
    double reach = 0;
    for (const Pose& pose : scene.placed) {
        reach = std::max(reach, 2.0 * std::sqrt(pose.t[0] * pose.t[0] + pose.t[1] * pose.t[1] +
                                                pose.t[2] * pose.t[2]));
    }
    const double apart = reach;
    for (const Mesh& mesh : scene.bodies) {
        for (const Triangle& t : mesh.triangles) {
            for (const Vec3f& v : {t.a, t.b, t.c}) {
                reach = std::max(reach, apart + std::sqrt(dot(widen(v), widen(v))));
            }
        }
    }
    return reach;
}

std::string read_poses(const CsvTable& table, const Names& bodies, SceneFolder& out) {
    Names poses;
    std::vector<bool> given;
    double defect = 0;
    for (std::size_t row = 0; row < table.row_count(); ++row) {
        const auto body = bodies.find(table.cell(row, 1));
        if (body == bodies.end()) {
            return fmt::format("{}: unknown body '{}' (expected one of bodies.csv)",
                               table.where(row), escaped(table.cell(row, 1)));
        }
        const auto [pose, is_new] = poses.emplace(table.cell(row, 0), out.poses.size());
        if (is_new) {
            out.poses.emplace_back(table.cell(row, 0));
            out.placed.resize(out.placed.size() + out.bodies.size());
            given.resize(out.placed.size());
        }
        const std::size_t at = pose->second * out.bodies.size() + body->second;
        if (given[at]) {
            return fmt::format("{}: pose '{}' has body '{}' twice", table.where(row),
                               escaped(table.cell(row, 0)), escaped(table.cell(row, 1)));
        }
        given[at] = true;
        if (std::string fault = read_matrix(table, row, out.placed[at]); !fault.empty()) {
            return fault;
        }
        defect = std::max(defect, defect_of(out.placed[at]));
    }
    const auto missing = std::find(given.begin(), given.end(), false);
    if (missing != given.end()) {
        const auto at = static_cast<std::size_t>(missing - given.begin());
        return fmt::format("poses.csv: pose '{}' has no body '{}'",
                           escaped(out.poses[at / out.bodies.size()]),
                           escaped(out.bodies[at % out.bodies.size()].name));
    }
    if (defect > kDefectExact) {  // few digits: use near rotations, bound the error
        std::for_each(out.placed.begin(), out.placed.end(), make_rigid);
        out.pose_error_mm = 4.0 * defect * (reach_of(out) + 1.0);
    }
    return {};
}

}  // namespace

std::string read_scene_folder(const std::string& folder, SceneFolder& out) {
    constexpr std::array<std::string_view, 3> kBodies{"name", "stl", "triangles"};
    constexpr std::array<std::string_view, 3> kPairs{"pair", "a", "b"};
    constexpr std::array<std::string_view, 18> kPoses{"pose", "body", "m00", "m01", "m02", "m03",
                                                      "m10",  "m11",  "m12", "m13", "m20", "m21",
                                                      "m22",  "m23",  "m30", "m31", "m32", "m33"};
    CsvTable bodies, pairs, poses;
    for (const char* const file : {"/bodies.csv", "/pairs.csv", "/poses.csv"}) {
        out.files.push_back(folder + file);
    }
    if (!bodies.read(folder + "/bodies.csv", kBodies)) {
        return bodies.error();
    }
    if (!pairs.read(folder + "/pairs.csv", kPairs)) {
        return pairs.error();
    }
    if (!poses.read(folder + "/poses.csv", kPoses)) {
        return poses.error();
    }
    Names names;
    if (std::string fault = read_bodies(folder, bodies, out, names); !fault.empty()) {
        return fault;
    }
    if (std::string fault = read_pairs(pairs, names, out); !fault.empty()) {
        return fault;
    }
    return read_poses(poses, names, out);
}

}  // namespace axg
