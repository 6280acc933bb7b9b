// SPDX-License-Identifier: Apache-2.0
// From frames to permits while tools are changed: all of them were given to the engine at the
// start, so nothing is allocated; and a number that no tool has gets no permit, then or later.
#include <gtest/gtest.h>

#include <array>
#include <optional>
#include <vector>

#include "config/compiled/compiled_machine.hpp"
#include "config/mesh/cutting_parts.hpp"
#include "firmware_if/guard/guard_chain.hpp"
#include "firmware_if/protocol/axis_frames.hpp"
#include "firmware_if/protocol/guard_frames.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "tests/support/malloc_count.hpp"

namespace axg {
namespace {

using test::allocations;
using test::NoAllocation;

constexpr std::uint16_t kNobody = 9;  // no tool of the machine has this number

class ToolChange : public NoAllocation {
  protected:
    void SetUp() override {
        NoAllocation::SetUp();
        const std::string folder = AXG_SOURCE_DIR "/config/machines";
        ASSERT_TRUE(load_machine(folder + "/vice-mill.yaml", loaded.machine).empty());
        ASSERT_TRUE(load_meshes(loaded.machine, folder, loaded.meshes).empty());
        part_cutters(loaded.machine, loaded.meshes);
        engine.emplace(std::move(*make_engine(loaded)));
        containment_test.emplace(std::move(*make_containment_test(loaded, *engine)));
        certificate.emplace(std::move(*make_stop_certificate(loaded)));
    }

    /// A still machine: 40 samples with each of these tools, the change between them announced.
    std::vector<CanFrame> frames_with(const std::vector<std::uint16_t>& tools) {
        AxisEncoder encoder(loaded.machine);
        std::vector<CanFrame> out;
        AxisSnapshot snapshot;
        snapshot.axis_count = 3;
        snapshot.latched_us = 1'000'000;
        for (const std::uint16_t tool : tools) {
            for (int k = 0; k < 40; ++k) {
                snapshot.tool = tool;
                snapshot.mode = k < 10 ? kModeToolChange : kModeStandstill;
                std::array<CanFrame, kFramesPerSnapshotMax> set;
                const EncodeResult encoded = encoder.encode(snapshot, set);
                EXPECT_EQ(encoded.status, EncodeStatus::ok);
                out.insert(out.end(), set.begin(), set.begin() + encoded.frame_count);
                snapshot.latched_us += loaded.machine.can.sample_us;
                ++snapshot.sample;
            }
        }
        return out;
    }

    /// Permits on the wire by the tool number of their snapshot; the others are counted as stops.
    struct Sent {
        std::array<int, 10> permits{}, stops{};
        int capped = 0;
    };
    Sent run(const std::vector<CanFrame>& frames, StopCertificate* stop_certificate,
             SpeedAdvisory* advisory = nullptr) {
        GuardChain chain(loaded.machine, engine->engine(), *containment_test,
                         {stop_certificate, advisory});
        AckLedger ledger;
        std::uint8_t live = 0;
        AxisReceiver receiver(loaded.machine);
        Sent sent;
        const std::uint64_t before = allocations;
        for (const CanFrame& frame : frames) {
            const ReceiverEvent event = receiver.on_frame(frame);
            chain.take(event,
                       ledger.note_sample(live == 0 ? std::nullopt
                                                    : std::optional<std::uint8_t>(live & 15U)));
            if (event.kind != ReceiverEvent::Kind::snapshot) {
                continue;
            }
            chain.evaluate();
            const CycleResult result = chain.decide(event.state == ReceiverState::valid, true);
            chain.update_advisories();
            ledger.note_sent(++live, caps_of_permit(result.cap_order.cap, result.cap_order.mask));
            sent.capped += result.has_cap ? 1 : 0;
            const bool is_run = permit_of(result, 0, event.sync_counter).word == PermitWord::run;
            ++(is_run ? sent.permits : sent.stops)[event.snapshot.tool];
        }
        EXPECT_EQ(allocations - before, 0U);
        return sent;
    }

    LoadedMachine loaded;
    std::optional<CpuEngine> engine;
    std::optional<ContainmentTest> containment_test;
    std::optional<StopCertificate> certificate;
};

TEST_F(ToolChange, AllocatesNothingInEitherMode) {
    const auto frames = frames_with({1, 2, 1, 2});
    for (StopCertificate* const stop_certificate :
         {&*certificate, static_cast<StopCertificate*>(nullptr)}) {
        const Sent sent = run(frames, stop_certificate);
        EXPECT_GT(sent.permits[1], 40) << "all but the first samples, which know no speed";
        EXPECT_EQ(sent.permits[2], 80);
        EXPECT_EQ(sent.stops[2], 0);
    }
}

TEST_F(ToolChange, AllocatesNothingWithAnEnforcedCap) {
    loaded.machine.can.permit_samples = {3, 12};
    const auto frames = frames_with({1, 2, 1, 2});
    for (const CapPromise promise : {CapPromise::all_axes, CapPromise::per_axis}) {
        loaded.machine.guard.cap = promise;
        std::optional<StopCertificate> capped = make_stop_certificate(loaded);
        std::optional<SpeedAdvisory> advisory = SpeedAdvisory::create(loaded.machine);
        ASSERT_TRUE(capped && advisory);
        const Sent sent = run(frames, &*capped, &*advisory);
        EXPECT_EQ(sent.capped, 160);
        EXPECT_GT(sent.permits[2], 70);
    }
}

TEST_F(ToolChange, ToANumberThatNoToolHasEndsThePermits) {
    const auto frames = frames_with({1, kNobody, 1});
    for (StopCertificate* const stop_certificate :
         {&*certificate, static_cast<StopCertificate*>(nullptr)}) {
        const Sent sent = run(frames, stop_certificate);
        EXPECT_EQ(sent.permits[kNobody], 0);
        EXPECT_EQ(sent.stops[kNobody], 40);
        EXPECT_GT(sent.permits[1], 5);
    }
}

}  // namespace
}  // namespace axg
