// SPDX-License-Identifier: Apache-2.0
// The files that a page is put together from: our own, which are installed with axguard, and the
// libraries where Debian has them; and the machine as the page's scripts read it.
#pragma once

#include <cstdio>
#include <optional>
#include <string>

#include "firmware_if/setup/loaded_machine.hpp"

namespace axg {

/// A file of hil_replay/page. nullopt: `messages` has the reason and the next step.
[[nodiscard]] std::optional<std::string> own_part(const char* name, std::FILE* messages);
/// A file below /usr/share/javascript.
/// @param what_next  what to install
[[nodiscard]] std::optional<std::string> library_part(const char* name, const char* what_next,
                                                      std::FILE* messages);

/// JSON text: "machine", "body_meshes", "tool_meshes", as in the data of a page.
[[nodiscard]] std::string machine_data(const LoadedMachine& loaded);

}  // namespace axg
