// SPDX-License-Identifier: Apache-2.0
// Any bytes: the STL reader ends with triangles within the limits or with faults; what it accepts
// survives writing and reading, and can be judged as a surface.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "core/mesh/mesh_check.hpp"
#include "core/mesh/stl.hpp"
#include "tests/fuzz/targets.hpp"

int axg::fuzz::stl(const std::uint8_t* data, std::size_t size) {
    const auto bytes = std::as_bytes(std::span{data, size});
    const axg::StlResult result = axg::read_stl(bytes, 1.0);
    if (result.faults.empty() == result.triangles.empty()) {
        std::abort();
    }
    for (const axg::Triangle& t : result.triangles) {
        for (const axg::Vec3f& v : {t.a, t.b, t.c}) {
            for (const float x : {v.x, v.y, v.z}) {
                if (!(std::abs(x) <= axg::kCoordinateMmMax)) {
                    std::abort();
                }
            }
        }
    }
    if (!result.triangles.empty()) {
        const axg::StlResult again = axg::read_stl(axg::write_stl(result.triangles), 1.0);
        if (again.triangles != result.triangles) {
            std::abort();
        }
        if (axg::check_mesh(result.triangles).facet_count != result.triangles.size()) {
            std::abort();
        }
    }
    return 0;
}
