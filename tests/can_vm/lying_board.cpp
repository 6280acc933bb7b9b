// SPDX-License-Identifier: Apache-2.0
// A board whose X moves while its frames say that the machine stands, as a candump log on stdout.
//   lying_board MACHINE MESH_ROOT creep|swing REST_S
// Rest, three seconds of X at 20 mm/s or at up to 125 mm/s to and fro, and rest.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "firmware_if/protocol/axis_frames.hpp"
#include "firmware_if/setup/loaded_machine.hpp"
#include "hil_replay/trace/candump_log.hpp"
#include "tests/support/can_board.hpp"

namespace axg::test {
namespace {

constexpr double kMovesS = 3, kRestsS = 8;
constexpr double kCreepMmS = 20, kSwingMm = 5, kSwingRadS = 25;

int write(const std::string& file, const std::string& root, bool swings, double rest_s) {
    LoadedMachine loaded;
    if (!load(file, root, loaded, stderr)) {
        return 3;
    }
    const Machine& machine = loaded.machine;
    AxisEncoder encoder(machine);
    AxisSnapshot snapshot;
    snapshot.axis_count = static_cast<std::uint32_t>(machine.axes.size());
    snapshot.tool = machine.first_tool;
    snapshot.mode = kModeStandstill;
    const double period_s = machine.can.sample_us * 1e-6;
    std::string text;
    for (; static_cast<double>(snapshot.sample) * period_s < rest_s + kMovesS + kRestsS;
         ++snapshot.sample) {
        const double t_s = static_cast<double>(snapshot.sample) * period_s;
        const double moves_s = std::clamp(t_s - rest_s, 0.0, kMovesS);
        snapshot.position[0] =
            swings ? kSwingMm * std::sin(kSwingRadS * moves_s) : kCreepMmS * moves_s;
        snapshot.latched_us = static_cast<std::int64_t>(snapshot.sample) * machine.can.sample_us;
        for (const CanFrame& frame : frames_of(encoder, snapshot)) {
            append_candump(text, frame, "can0");
        }
    }
    return std::fputs(text.c_str(), stdout) < 0 ? 1 : 0;
}

}  // namespace
}  // namespace axg::test

int main(int count, char** words) {
    if (count != 5) {
        std::fprintf(stderr, "usage: lying_board MACHINE MESH_ROOT creep|swing REST_S\n");
        return 2;
    }
    return axg::test::write(words[1], words[2], std::string(words[3]) == "swing",
                            std::strtod(words[4], nullptr));
}
