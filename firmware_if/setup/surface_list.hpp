// SPDX-License-Identifier: Apache-2.0
// Every surface of the engines of a machine, and its index among them: queries, engines,
// containment test and pages all use this list.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/mesh.hpp"
#include "firmware_if/setup/loaded_machine.hpp"

namespace axg {

/// Surfaces of every engine, in ranges one after the other (core/certificate/pair_queries.hpp),
/// then those that only the CPU engine has: it runs the containment tests, which need whole
/// surfaces.
struct SurfaceList {
    std::vector<const Mesh*> engines;
    std::size_t body_count = 0, tool_count = 0;
    std::vector<const Mesh*> behind;
    // [engines] the whole surface, the index of its tree in the CPU engine, and the index of the
    // body that it is a part of.
    std::vector<const Mesh*> whole;
    std::vector<std::uint32_t> whole_tree, same_as;

    [[nodiscard]] std::span<const Mesh* const> bodies() const noexcept {
        return std::span(engines).first(body_count);
    }
    [[nodiscard]] std::span<const Mesh* const> tools() const noexcept {
        return std::span(engines).subspan(body_count, tool_count);
    }
};

/// `loaded` must outlive it.
[[nodiscard]] SurfaceList surface_list(const LoadedMachine& loaded);

}  // namespace axg
