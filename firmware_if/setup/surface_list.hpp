// SPDX-License-Identifier: Apache-2.0
// Every surface that the engines of a machine are given, and the places it has among them: the one
// list that queries, engines, containment test and pages go by.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/mesh.hpp"
#include "firmware_if/setup/loaded_machine.hpp"

namespace axg {

/// Ranges of `engines`, one behind the other (core/certificate/pair_queries.hpp), and what the
/// processor's engine has behind them: it alone runs containment tests, and those are of whole
/// surfaces.
struct SurfaceList {
    std::vector<const Mesh*> engines;
    std::size_t body_count = 0, tool_count = 0;
    std::vector<const Mesh*> behind;
    // [engines] the whole surface, the place of its tree among all of the processor's engine, and
    // the place of the body that it is a part of.
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
