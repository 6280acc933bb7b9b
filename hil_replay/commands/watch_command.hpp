// SPDX-License-Identifier: Apache-2.0
// axguard watch: a running guard as a live page, read-only.
#pragma once

namespace axg {

class CommandLine;

void add_watch(CommandLine& line);

}  // namespace axg
