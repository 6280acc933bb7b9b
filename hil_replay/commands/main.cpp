// SPDX-License-Identifier: Apache-2.0
// axguard: the workbench on a PC. No GPU and no CAN needed.
#include "firmware_if/cli/report_exceptions.hpp"
#include "hil_replay/commands/axguard.hpp"

int main(int argc, char** argv) {
    return axg::report_exceptions("axguard", [&] {
        return axg::run_axguard({argv + (argc > 0 ? 1 : 0), argv + argc});
    });
}
