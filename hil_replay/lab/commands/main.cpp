// SPDX-License-Identifier: Apache-2.0
// axguard-lab: research on a PC. Measures methods, engines and devices; decides nothing.
#include "firmware_if/cli/report_exceptions.hpp"
#include "hil_replay/lab/commands/axguard_lab.hpp"

int main(int argc, char** argv) {
    return axg::report_exceptions("axguard-lab", [&] {
        return axg::run_axguard_lab({argv + (argc > 0 ? 1 : 0), argv + argc});
    });
}
