// SPDX-License-Identifier: Apache-2.0
// Two queries with fixed results in every batch, which detect an engine that always returns the
// same result.
#pragma once

#include <cstdint>

#include "core/collision/engine.hpp"
#include "core/mesh/mesh.hpp"

namespace axg {

inline constexpr std::uint16_t kKnownAnswerSignature = 0xC5A3;  // both results right

/// A tetrahedron of 1 mm.
[[nodiscard]] Mesh known_answer_mesh();

/// The tetrahedron against itself: 10 mm away, or overlapping.
/// @param mesh  the tetrahedron's place among the engine's surfaces
[[nodiscard]] Query known_answer_query(std::uint32_t mesh, bool is_near) noexcept;

/// kKnownAnswerSignature if both results are right, else 0. The near result is right if it is not
/// far, even if a list was full: its pairs touch, so a list may have no place for them.
[[nodiscard]] std::uint16_t known_answer_signature(const QueryResult& far,
                                                   const QueryResult& near) noexcept;

/// Whether a list that all queries of a batch share was full: then the far query is not proven
/// either, and no result of the batch counts. The engine is not broken.
[[nodiscard]] bool is_batch_lost(const QueryResult& far, const QueryResult& near) noexcept;

}  // namespace axg
