// SPDX-License-Identifier: Apache-2.0
// How the programs end; other programs rely on the numbers. docs/reference/commands.md.
#pragma once

namespace axg {

enum ExitCode : int {
    kExitClean = 0,
    kExitInternal = 1,
    kExitUsage = 2,
    kExitInput = 3,
    kExitCollision = 10,
    kExitDeadline = 11,
    kExitCan = 12,
    kExitGpu = 13,
    kExitUnfit = 14,
};

}  // namespace axg
