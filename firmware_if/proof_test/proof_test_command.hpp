// SPDX-License-Identifier: Apache-2.0
// axguardd proof-test: a person proves each month that the guard still stops the machine.
#pragma once

namespace axg {

class CommandLine;

void add_proof_test(CommandLine& line);

}  // namespace axg
