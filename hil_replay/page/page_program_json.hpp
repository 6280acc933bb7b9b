// SPDX-License-Identifier: Apache-2.0
// The program of a run as its page has it: lines over time, and the block of each line once.
#pragma once

#include <string>

#include "hil_replay/page/run_page.hpp"

namespace axg {

/// Steps and blocks are written whole where they fit into this; it is a fifth of what a page may
/// have (20 MB).
inline constexpr std::size_t kProgramBytesMax = 4U << 20U;
inline constexpr std::size_t kBlockCharactersMax = 200;  // of a block, and about that much of it

/// {"file","count","steps":{"time_s":[..],"line":[..]},"blocks":{"12":"G1 X1"}} as JSON text. Empty
/// where the run has no lines. `count` is the program's number of steps. If they do not all fit, it
/// contains only the steps of the page's rows and stops: everything that the page draws has its
/// true line, and lines that it does not draw are missing.
[[nodiscard]] std::string program_data(const RunPage& page);

}  // namespace axg
