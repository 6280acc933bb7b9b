// SPDX-License-Identifier: Apache-2.0
// Two queries with known results in every batch, so that an engine that always returns
// the same is found out.
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

/// kKnownAnswerSignature, or 0 unless both are right. Of the near one it is enough that it is not
/// called far: it touches, so it is among the queries that a list may have no place for.
[[nodiscard]] std::uint16_t known_answer_signature(const QueryResult& far,
                                                   const QueryResult& near) noexcept;

/// Whether a list that all queries of a batch share was full: then the known-far one is not
/// proven either, and no result of the batch counts. That is no broken engine.
[[nodiscard]] bool is_batch_lost(const QueryResult& far, const QueryResult& near) noexcept;

}  // namespace axg
