// SPDX-License-Identifier: Apache-2.0
// Any text as a candump log: it ends, every frame is one that a bus can carry, and a frame written
// in the common core reads back as itself.
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "hil_replay/trace/candump_log.hpp"
#include "tests/fuzz/targets.hpp"

namespace {

void check_round_trip(const axg::CanFrame& frame) {
    std::string line;
    append_candump(line, frame, "can0");
    axg::TraceOptions options;
    const auto reader = axg::read_candump("again.log", line, options);
    axg::CanFrame again;
    if (!reader->next(again) || again.id != frame.id || again.extended != frame.extended ||
        again.remote != frame.remote || again.error != frame.error || again.fd != frame.fd ||
        again.length_bytes != frame.length_bytes || again.data != frame.data) {
        std::abort();
    }
}

void read_all(std::string_view text, bool lenient) {
    axg::TraceOptions options;
    options.lenient = lenient;
    const auto reader = axg::read_candump("fuzz.log", text, options);
    axg::CanFrame frame;
    while (reader->next(frame)) {
        if (frame.length_bytes > (frame.fd ? 64 : 8) ||
            (!frame.error && frame.id > (frame.extended ? 0x1fffffffU : 0x7ffU))) {
            std::abort();
        }
        if (frame.time_us >= 0) {
            check_round_trip(frame);
        }
    }
}

}  // namespace

int axg::fuzz::candump(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    read_all(text, false);
    read_all(text, true);
    return 0;
}
