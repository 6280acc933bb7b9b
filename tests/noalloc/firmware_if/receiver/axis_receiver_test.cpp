// SPDX-License-Identifier: Apache-2.0
// Encoding, receiving and encoding answers never touches the heap after construction: every call of
// malloc counts.
#include "firmware_if/receiver/axis_receiver.hpp"

#include <gtest/gtest.h>

#include <cstdint>

#include "firmware_if/protocol/guard_frames.hpp"
#include "tests/support/can_board.hpp"
#include "tests/support/malloc_count.hpp"

namespace axg {
namespace {

using test::allocations;

TEST(AxisReceiver, NeverAllocatesAfterConstruction) {
    for (const CanFormat format :
         {CanFormat::classical, CanFormat::fd, CanFormat::signals, CanFormat::cia402}) {
        const Machine machine = test::five_axis_machine(format);
        AxisEncoder encoder(machine);
        AxisReceiver receiver(machine);
        std::array<CanFrame, kFramesPerSnapshotMax> frames;
        std::uint64_t snapshots = 0;
        const std::uint64_t before = allocations;
        for (std::uint64_t k = 0; k < 2000; ++k) {
            const EncodeResult result = encoder.encode(test::snapshot_at(machine, k), frames);
            for (std::uint32_t i = 0; i < result.frame_count; ++i) {
                if (k % 100 == 50 && i == 1) {
                    frames[i].data[3] ^= 1;  // faults must not allocate either
                }
                const ReceiverEvent event = receiver.on_frame(frames[i]);
                snapshots += event.kind == ReceiverEvent::Kind::snapshot ? 1 : 0;
            }
            (void)receiver.on_time(test::snapshot_at(machine, k).latched_us + 600);
        }
        receiver.acknowledge();
        EXPECT_EQ(allocations, before);
        const bool has_checksum = format == CanFormat::classical || format == CanFormat::fd;
        EXPECT_GT(snapshots, has_checksum ? 1900U : 0U);
    }
}

}  // namespace
}  // namespace axg
