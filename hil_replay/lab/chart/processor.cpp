// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/chart/processor.hpp"

#include <fstream>

#include "core/collision/cpu_engine.hpp"

namespace axg::chart {

std::string format_processor() {
    std::string out = "one core";
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);) {
        const std::size_t colon = line.find(": ");
        if (line.starts_with("model name") && colon != std::string::npos) {
            out += " of an " + line.substr(colon + 2);
            break;
        }
    }
    if (const LaneKernels* const lanes = lane_kernels(LaneSet::widest); lanes != nullptr) {
        out += ", ";
        out += lanes->name;
        out += " with " + std::to_string(lanes->width) + " lanes";
    }
    return out;
}

}  // namespace axg::chart
