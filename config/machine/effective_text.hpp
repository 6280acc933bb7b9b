// SPDX-License-Identifier: Apache-2.0
// A machine file with defaults, units and lists resolved, as canonical text and
// as a hash: two files that mean the same have the same hash, and a value that was lost in a copy
// shows.
#pragma once

#include <string>

#include "core/machine/configuration_hashes.hpp"
#include "core/machine/machine.hpp"

namespace axg {

struct MachineMeshes;

/// One `key = value` a line, in a fixed order, numbers in the shortest form that reads back to the
/// same bits. Leaves out file names and line numbers.
[[nodiscard]] std::string effective_text(const Machine& machine);

/// The first four bytes of a SHA-256, most significant first, over each part's lines of
/// effective_text() and its surfaces: what a board is to agree about (docs/reference/protocol.md,
/// "Hashes").
[[nodiscard]] ConfigurationHashes configuration_hashes(const Machine& machine,
                                                       const MachineMeshes& meshes);

/// SHA-256 in hexadecimal over effective_text() and every triangle of every surface, bit by bit.
[[nodiscard]] std::string configuration_hash(const Machine& machine, const MachineMeshes& meshes);

}  // namespace axg
