// SPDX-License-Identifier: Apache-2.0
// Any sequence of frames: the receiver gives no picture while INVALID, and every picture is whole
// and finite. Input: two bytes of time step, two of id, one of length, then the data; repeated.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "firmware_if/axis_receiver.hpp"
#include "tests/support/motion_machine.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const axg::Machine machine = axg::motion_test_machine();
    axg::AxisReceiver receiver{machine};
    receiver.acknowledge();
    std::int64_t now_us = 0;
    std::size_t at = 0;
    while (size - at >= 5) {
        now_us += data[at] | data[at + 1] << 8U;
        axg::CanFrame frame;
        frame.time_us = now_us;
        frame.id = static_cast<std::uint32_t>(data[at + 2] | (data[at + 3] & 7) << 8U);
        frame.fd = (data[at + 4] & 0x80U) != 0;
        const std::size_t most = frame.fd ? 64 : 8;
        const std::size_t length =
            std::min({static_cast<std::size_t>(data[at + 4] & 0x7fU), most, size - at - 5});
        frame.length_bytes = static_cast<std::uint8_t>(length);
        std::copy_n(data + at + 5, length, frame.data.begin());
        at += 5 + length;
        const axg::ReceiverEvent event = receiver.on_frame(frame);
        if (event.kind != axg::ReceiverEvent::Kind::picture) {
            continue;
        }
        if (event.state == axg::ReceiverState::invalid ||
            event.picture.axis_count != machine.axes.size()) {
            std::abort();
        }
        for (std::size_t i = 0; i < machine.axes.size(); ++i) {
            if (!std::isfinite(event.picture.position[i])) {
                std::abort();
            }
        }
    }
    return 0;
}
