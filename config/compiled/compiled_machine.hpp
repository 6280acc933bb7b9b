// SPDX-License-Identifier: Apache-2.0
// A machine in one file, with everything about it that is slow to compute: surfaces checked and
// simplified, the grouping of their trees, their connected parts, the hashes
// (docs/reference/compiled.md). mm.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "config/compiled/compiled_sections.hpp"
#include "config/mesh/load_meshes.hpp"
#include "config/text/config_fault.hpp"
#include "config/text/machine_text.hpp"
#include "core/machine/machine.hpp"

namespace axg {

struct CompiledMachine {
    MachineText source;
    Machine machine;
    MachineMeshes meshes;
    // Lines to review, in addition to those of `source` (config/mesh/drawing_doubts.hpp). Of a
    // machine file only; not compiled.
    std::vector<std::string> doubts{};
};

/// Whether a file is read as a compiled machine: its name ends in .axg.
[[nodiscard]] bool is_compiled_name(std::string_view path) noexcept;

/// The bytes of the file. The same machine gives the same bytes. Slow: it groups the triangles.
[[nodiscard]] std::string compile_machine(const CompiledMachine& compiled);

/// Reads such bytes; `file` is the name in messages. Either no faults, or one and `out` is
/// untouched. Refuses hostile bytes: checks every length before it reserves memory, and every index
/// that engines use unchecked. The sums detect accidental changes of the contents, not forgery.
[[nodiscard]] std::vector<ConfigFault> parse_compiled(std::string_view bytes,
                                                      const std::string& file, CompiledMachine& out,
                                                      Sums sums = Sums::checked);

/// parse_compiled() of a file.
[[nodiscard]] std::vector<ConfigFault> load_compiled(const std::string& path, CompiledMachine& out);

/// The machine of a machine file or of a compiled one, without its meshes.
/// @param source  out, if not null: the text of the machine file
[[nodiscard]] std::vector<ConfigFault> load_machine(const std::string& path, Machine& out,
                                                    MachineText* source = nullptr);

}  // namespace axg
