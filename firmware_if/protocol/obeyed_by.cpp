// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/protocol/obeyed_by.hpp"

#include "firmware_if/protocol/axis_frames.hpp"

namespace axg {
namespace {

std::string without_counter(const CanLayout& can) {
    if (!has_sync(wire_of(can))) {
        return "no board can obey these permits: axguard reads these frames without SYNC, so a "
               "permit names no sample and has no end (expected a SYNC counter 1 to 240). Use "
               "can.format: classical or fd, or cia402 with sync_counter: 240.";
    }
    return "no board can obey these permits: a permit does not name its sample (found "
           "can.sync_counter: " +
           std::to_string(can.sync_counter_max) +
           ", expected 240). Let the SYNC producer count to 240 (object 0x1019), and state "
           "sync_counter: 240; or make the guard the producer: can.sync: guard.";
}

}  // namespace

std::string obeyed_by_refusal(const Machine& machine) {
    switch (machine.guard.obeyed_by) {
        case ObeyedBy::board:
            return has_sample_counter(machine.can) ? "" : without_counter(machine.can);
        case ObeyedBy::line:
            return "no line can obey these permits: not built. Missing: the date limit of an edge "
                   "(line_lambda_ms), the time between clock and edge (line_edge_us), and the "
                   "times of monoflop, relay and drives in the certificate. Use guard.obeyed_by: "
                   "board.";
        case ObeyedBy::drives:
            return "no drive can obey these permits: not built. Missing: a heartbeat that is sent "
                   "only after a proven sample of its period, an enforced limit of its age on the "
                   "bus, and the consumer time (object 0x1016) in the certificate. Use "
                   "guard.obeyed_by: board.";
    }
    return "guard.obeyed_by has no such value";
}

}  // namespace axg
