// SPDX-License-Identifier: Apache-2.0
#include "config/mesh/survey_mesh.hpp"

#include <bit>

#include "config/mesh/mesh_faults.hpp"
#include "config/text/fault_text.hpp"
#include "config/text/open_beneath.hpp"
#include "core/mesh/mesh_check.hpp"
#include "core/mesh/stl.hpp"

namespace axg {
namespace {

void set_marks(MeshSource& source, unsigned marks) noexcept {
    source.allow_degenerate = (marks & 1U) != 0;
    source.allow_self_intersection = (marks & 2U) != 0;
    source.allow_open = (marks & 4U) != 0;
}

/// Few marks before many: each one is a promise the guard can no longer make.
void allow_least(const MeshReport& report, SurveyedMesh& out) {
    for (int count = 0; count <= 3; ++count) {
        for (unsigned marks = 0; marks < 8; ++marks) {
            if (std::popcount(marks) != count) {
                continue;
            }
            out.notes.clear();
            set_marks(out.source, marks);
            if (judge(report, out.source, printable(out.source.file), out.notes).empty()) {
                return;
            }
        }
    }
    for (const MeshFault& fault :
         judge(report, out.source, printable(out.source.file), out.notes)) {
        out.faults.push_back(fault_text("invalid mesh", fault.got, fault.wanted));
    }
}

}  // namespace

double length_of(LengthUnit unit) noexcept {
    switch (unit) {
        case LengthUnit::mm:
            return 1.0;
        case LengthUnit::inch:
            return 25.4;
        case LengthUnit::m:
            return 1000.0;
        case LengthUnit::um:
            break;
    }
    return 0.001;
}

const char* name_of(LengthUnit unit) noexcept {
    switch (unit) {
        case LengthUnit::mm:
            return "mm";
        case LengthUnit::inch:
            return "inch";
        case LengthUnit::m:
            return "m";
        case LengthUnit::um:
            break;
    }
    return "um";
}

SurveyedMesh survey_mesh(const std::string& root, const std::string& file, LengthUnit unit) {
    SurveyedMesh out;
    out.source.file = file;
    out.source.unit = unit;
    const FileRead read = read_beneath(root, file, kStlBytesMax);
    if (!read.got.empty()) {
        out.faults.push_back(printable(file) + ": " +
                             fault_text("invalid file", read.got, read.wanted));
        return out;
    }
    const StlResult stl = read_stl(read.bytes, length_of(unit));
    for (const StlFault& fault : stl.faults) {
        const MeshFault words = describe(fault, file);
        out.faults.push_back(fault_text("invalid mesh", words.got, words.wanted));
    }
    if (stl.fault_count > 0) {
        return out;
    }
    const MeshReport report = check_mesh(stl.triangles);
    out.min_mm = widen(report.min_mm);
    out.max_mm = widen(report.max_mm);
    out.source.expected_size_mm = out.max_mm - out.min_mm;
    allow_least(report, out);
    return out;
}

}  // namespace axg
