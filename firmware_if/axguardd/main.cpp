// SPDX-License-Identifier: Apache-2.0
// axguardd: the guard beside a motion board, on a CAN interface of Linux.
#include "firmware_if/axguardd/run_command.hpp"
#include "firmware_if/cli/report_exceptions.hpp"

int main(int argc, char** argv) {
    return axg::report_exceptions("axguardd", [&] {
        return axg::run_axguardd({argv + (argc > 0 ? 1 : 0), argv + argc});
    });
}
