// SPDX-License-Identifier: Apache-2.0
// The files of the live page, by the path that a browser requests.
#pragma once

#include <cstdio>
#include <optional>

#include "firmware_if/setup/loaded_machine.hpp"
#include "hil_replay/watch/http_server.hpp"

namespace axg {

/// nullopt: `messages` has the missing file, and what to install.
[[nodiscard]] std::optional<HttpParts> watch_parts(const LoadedMachine& loaded,
                                                   std::FILE* messages);

}  // namespace axg
