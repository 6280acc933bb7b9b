// SPDX-License-Identifier: Apache-2.0
// Any text as a Vector ASC trace: it ends, and every frame is one that a bus can carry.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "hil_replay/trace/vector_asc.hpp"
#include "tests/fuzz/targets.hpp"

int axg::fuzz::vector_asc(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    for (const bool lenient : {false, true}) {
        axg::TraceOptions options;
        options.lenient = lenient;
        const auto reader = axg::read_asc("fuzz.asc", text, options);
        axg::CanFrame frame;
        while (reader->next(frame)) {
            if (frame.length_bytes > (frame.fd ? 64 : 8) ||
                (!frame.error && frame.id > (frame.extended ? 0x1fffffffU : 0x7ffU))) {
                std::abort();
            }
        }
    }
    return 0;
}
