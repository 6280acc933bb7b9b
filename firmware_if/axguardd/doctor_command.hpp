// SPDX-License-Identifier: Apache-2.0
// `axguardd doctor`: what of this machine would make the guard late or deaf, and the command that
// mends it.
#pragma once

namespace CLI {
class App;
}

namespace axg {

void add_doctor(CLI::App& app, int& exit_code);

}  // namespace axg
