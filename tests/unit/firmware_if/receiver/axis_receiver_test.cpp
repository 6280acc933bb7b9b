// SPDX-License-Identifier: Apache-2.0
// Every fault of docs/reference/protocol.md's table, put into the frames of a healthy board: the
// receiver must name it and react as the table says. Numbers in names (C01, A03) are the rows of
// the fault list.
#include "firmware_if/receiver/axis_receiver.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/receiver_fixture.hpp"

namespace axg {
namespace {

using namespace test;
TEST(AxisReceiver, AHealthyBoardGivesEverySnapshotWithItsInstant) {
    for (const CanFormat format : {CanFormat::classical, CanFormat::fd, CanFormat::signals}) {
        Fixture fixture(format, 600);  // past every wrap: 16, 240, 256
        fixture.hear();
        EXPECT_TRUE(fixture.heard.faults.empty())
            << fault_row(fixture.heard.faults.front().fault).name;
        ASSERT_EQ(fixture.heard.snapshots.size(), 600U);
        EXPECT_EQ(fixture.receiver.state(), ReceiverState::valid);
        for (std::size_t k = 0; k < 600; ++k) {
            const AxisSnapshot& got = fixture.heard.snapshots[k];
            const AxisSnapshot sent = snapshot_at(fixture.machine, k);
            EXPECT_EQ(got.sample, k);
            if (format != CanFormat::signals) {
                EXPECT_EQ(got.latched_us, sent.latched_us);
                EXPECT_EQ(got.mode, sent.mode);
                EXPECT_EQ(got.tool, sent.tool);
            }
            for (std::size_t i = 0; i < 3; ++i) {
                EXPECT_NEAR(got.position[i], sent.position[i], 0.51e-3);
            }
        }
    }
}

TEST(AxisReceiver, BecomesValidOnlyWithTwoSnapshotsInARowAndAHeartbeat) {
    Fixture fixture;
    listen(fixture.receiver, fixture.samples[0], fixture.heard);
    EXPECT_EQ(fixture.receiver.state(), ReceiverState::init);
    EXPECT_EQ(fixture.heard.snapshots.size(), 1U);
    listen(fixture.receiver, fixture.samples[1], fixture.heard);
    EXPECT_EQ(fixture.receiver.state(), ReceiverState::valid);

    Fixture silent;
    for (auto& sample : silent.samples) {
        std::erase_if(sample, [](const CanFrame& frame) { return frame.id == 0x701; });
    }
    silent.hear();
    EXPECT_EQ(silent.receiver.state(), ReceiverState::init);
    EXPECT_EQ(silent.heard.snapshots.size(), 40U);
}

TEST(AxisReceiver, C01_OneFrameLostLosesOneSampleAndNoMore) {
    Fixture fixture;
    fixture.samples[20].erase(fixture.samples[20].begin() + kSecond);
    fixture.hear();
    fixture.expect_running_without(1);
    EXPECT_EQ(fixture.count(ReceiverFault::torn), 1U);
    EXPECT_EQ(fixture.receiver.counters().samples_lost, 1U);
}

TEST(AxisReceiver, C02_OneCycleLostAtFullSpeedIsNoJump) {
    Fixture fixture;
    fixture.samples[20].clear();
    fixture.hear();
    EXPECT_EQ(fixture.receiver.state(), ReceiverState::valid);
    EXPECT_EQ(fixture.heard.snapshots.size(), 39U);
    EXPECT_EQ(fixture.heard.snapshots[20].sample, 21U);
    EXPECT_EQ(fixture.receiver.counters().samples_lost, 1U);
}

TEST(AxisReceiver, C03_AFrameThatNeverComesAgainStopsByTheAgeOfTheSnapshot) {
    Fixture fixture;
    for (std::size_t k = 20; k < fixture.samples.size(); ++k) {
        fixture.samples[k].erase(fixture.samples[k].begin() + kThird);
    }
    fixture.hear();
    fixture.expect_stop(ReceiverFault::stale);
    EXPECT_EQ(fixture.heard.snapshots.size(), 20U);
    // the last snapshot is of sample 19; more than 3 ms later is the first frame after SYNC 22
    EXPECT_EQ(fixture.heard.faults.back().time_us, fixture.samples[22][kFirst].time_us);
}

TEST(AxisReceiver, C04_SilenceIsFoundByTheClockOnBothSidesOfTheBound) {
    Fixture fixture;
    fixture.hear();
    const std::int64_t latched_us = fixture.heard.snapshots.back().latched_us;
    EXPECT_EQ(fixture.receiver.on_time(latched_us + 3000).kind, ReceiverEvent::Kind::none);
    const ReceiverEvent event = fixture.receiver.on_time(latched_us + 3001);
    EXPECT_EQ(event.fault, ReceiverFault::stale);
    EXPECT_EQ(event.severity, Severity::stop);
    EXPECT_EQ(event.state, ReceiverState::invalid);
}

TEST(AxisReceiver, C05_ALateSnapshotIsCountedAndOneTooOldStops) {
    Fixture late;
    for (auto& sample : late.samples) {
        sample[kThird].time_us += 700;
        sample.resize(4);
    }
    late.samples[0].push_back(encode_heartbeat(0x701, 5, late.samples[0].back().time_us));
    late.samples.resize(25);
    std::vector<CanFrame> in_order;
    for (const auto& sample : late.samples) {
        in_order.insert(in_order.end(), sample.begin(), sample.end());
    }
    std::stable_sort(in_order.begin(), in_order.end(),
                     [](const CanFrame& a, const CanFrame& b) { return a.time_us < b.time_us; });
    listen(late.receiver, in_order, late.heard);
    late.expect_running_without(0);
    EXPECT_EQ(late.receiver.counters().late, 25U);

    for (const std::int64_t age_us : {3000, 3001}) {
        Fixture at_bound(CanFormat::classical, 1);
        at_bound.samples[0][kThird].time_us = at_bound.samples[0][kSync].time_us + age_us;
        listen(at_bound.receiver, at_bound.samples[0], at_bound.heard);
        EXPECT_EQ(at_bound.heard.snapshots.size(), age_us == 3000 ? 1U : 0U);
        EXPECT_EQ(at_bound.count(ReceiverFault::too_old), age_us == 3000 ? 0U : 1U);
    }
}

TEST(AxisReceiver, C06_AHeldUpQueueStopsAndTheBurstDoesNotRelease) {
    Fixture fixture;
    const std::int64_t release_us = fixture.samples[39].back().time_us;
    for (std::size_t k = 15; k < 40; ++k) {
        for (CanFrame& frame : fixture.samples[k]) {
            frame.time_us = release_us;
        }
    }
    fixture.hear();
    fixture.expect_stop(ReceiverFault::stale);
    EXPECT_EQ(fixture.heard.snapshots.size(), 15U);
    EXPECT_EQ(fixture.heard.faults.size(), 1U);
}

TEST(AxisReceiver, C06_FramesHeldUpTogetherWithTheirSyncAreAsOldAsTheSendersClockSays) {
    Fixture held(CanFormat::fd);
    for (std::size_t k = 20; k < 22; ++k) {  // two samples come 1.5 ms late, SYNC and all
        for (CanFrame& frame : held.samples[k]) {
            frame.time_us = held.samples[21].back().time_us + 500;
        }
    }
    held.hear();
    ASSERT_EQ(held.heard.snapshots.size(), 40U);
    EXPECT_LE(held.heard.snapshots[20].latched_us, snapshot_at(held.machine, 20).latched_us + 1);
}

TEST(AxisReceiver, C07_ADuplicateIsDropped) {
    Fixture fixture;
    for (auto& sample : fixture.samples) {
        sample.insert(sample.begin() + kSecond, sample[kFirst]);
    }
    fixture.hear();
    fixture.expect_running_without(0);
    EXPECT_EQ(fixture.count(ReceiverFault::repeated), 40U);
}

TEST(AxisReceiver, C08_ASenderThatRepeatsItselfIsSilence) {
    for (const CanFormat format : {CanFormat::classical, CanFormat::fd}) {
        Fixture fixture(format);
        for (std::size_t k = 20; k < 40; ++k) {
            for (std::size_t i = 0; i < fixture.samples[k].size(); ++i) {
                const std::int64_t time_us = fixture.samples[k][i].time_us;
                if (fixture.samples[k][i].id != 0x701 && i > kSync) {
                    fixture.samples[k][i] = fixture.samples[19][i];
                    fixture.samples[k][i].time_us = time_us;
                }
            }
        }
        fixture.hear();
        fixture.expect_stop(ReceiverFault::stale);
        EXPECT_EQ(fixture.heard.snapshots.size(), 20U);
        EXPECT_GT(fixture.count(ReceiverFault::repeated), 0U);
    }
}

TEST(AxisReceiver, C08_AStuckSampleIndexUnderARunningCounterIsDropped) {
    Fixture fixture;
    AxisEncoder encoder(fixture.machine);
    for (std::size_t k = 0; k < 40; ++k) {
        AxisSnapshot snapshot = snapshot_at(fixture.machine, k);
        snapshot.sample = std::min<std::uint64_t>(k, 20);
        const std::uint8_t sync = fixture.samples[k][kSync].data[0];
        fixture.samples[k] = frames_of(encoder, snapshot);
        fixture.samples[k][kSync].data[0] = sync;
    }
    fixture.hear();
    fixture.expect_stop(ReceiverFault::stale);
    EXPECT_GT(fixture.count(ReceiverFault::sample_repeated), 0U);
    EXPECT_EQ(fixture.heard.snapshots.size(), 21U);
}

TEST(AxisReceiver, C09_OrderInsideASampleDoesNotMatter) {
    Fixture fixture;
    for (auto& sample : fixture.samples) {
        std::swap(sample[kFirst].data, sample[kThird].data);
        std::swap(sample[kFirst].id, sample[kThird].id);
    }
    fixture.hear();
    fixture.expect_running_without(0);
    EXPECT_TRUE(fixture.heard.faults.empty());
}

TEST(AxisReceiver, C09_AFrameOfAnOlderSampleIsNeverUsed) {
    Fixture fixture;
    CanFrame old = fixture.samples[18][kSecond];
    old.time_us = fixture.samples[20][kFirst].time_us;
    fixture.samples[20].insert(fixture.samples[20].begin() + kSecond, old);
    fixture.hear();
    fixture.expect_running_without(0);
    EXPECT_EQ(fixture.count(ReceiverFault::wrong_sequence), 1U);
}

TEST(AxisReceiver, C09_AnOlderSampleIndexUnderAGoodCounterIsDropped) {
    for (const std::size_t behind : {2U, 5U}) {
        Fixture fixture(CanFormat::fd);
        CanFrame& frame = fixture.samples[20][kFirst];
        frame.data[31] = static_cast<std::uint8_t>(frame.data[31] - behind);
        p05_protect({frame.data.data(), frame.length_bytes}, 0x0181, frame.data[2]);
        fixture.hear();
        EXPECT_EQ(fixture.count(ReceiverFault::late_sample), 1U);
        fixture.expect_running_without(1);
    }
}

TEST(AxisReceiver, C10_EverySingleBitErrorIsDropped) {
    for (std::size_t bit = 0; bit < 64; ++bit) {
        Fixture fixture(CanFormat::classical, 30);
        fixture.samples[20][kSecond].data[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
        fixture.hear();
        EXPECT_EQ(fixture.count(ReceiverFault::bad_crc), 1U) << bit;
        fixture.expect_running_without(1);
    }
}

TEST(AxisReceiver, C12_ASecondSenderWithAValidChecksumStops) {
    for (const CanFormat format : {CanFormat::classical, CanFormat::fd}) {
        Fixture fixture(format);
        CanFrame fake = fixture.samples[20][kFirst];
        fake.time_us += 50;
        fake.data[4] ^= 1;
        if (format == CanFormat::fd) {
            p05_protect({fake.data.data(), fake.length_bytes}, 0x0181, fake.data[2]);
        } else {
            seal(fake, 0x0181);
        }
        fixture.samples[20].insert(fixture.samples[20].begin() + kSecond, fake);
        fixture.hear();
        fixture.expect_stop(ReceiverFault::spoofed);
    }
}

TEST(AxisReceiver, C13_TheRightPayloadUnderAnotherIdIsDropped) {
    Fixture fixture;
    std::swap(fixture.samples[20][kFirst].data, fixture.samples[20][kSecond].data);
    fixture.hear();
    EXPECT_EQ(fixture.count(ReceiverFault::bad_crc), 2U);
    fixture.expect_running_without(1);
}

TEST(AxisReceiver, C14_C15_ExtendedAndRemoteFramesAreNoData) {
    Fixture fixture;
    for (auto& sample : fixture.samples) {
        CanFrame extended = sample[kFirst];
        extended.extended = true;
        extended.id |= 0x1ABCD800;
        CanFrame remote = sample[kFirst];
        remote.remote = true;
        sample.insert(sample.begin() + kFirst, {extended, remote});
    }
    fixture.hear();
    fixture.expect_running_without(0);
    EXPECT_EQ(fixture.count(ReceiverFault::extended_id), 40U);
    EXPECT_EQ(fixture.count(ReceiverFault::remote_frame), 40U);

    Fixture only;  // nor are they a sign of life
    for (std::size_t k = 20; k < 40; ++k) {
        for (CanFrame& frame : only.samples[k]) {
            frame.extended = true;
        }
    }
    only.hear();
    only.expect_stop(ReceiverFault::stale);
}

TEST(AxisReceiver, C16_AFrameOfThisHostStopsWhereThatIsRefused) {
    Fixture fixture;
    fixture.samples[20][kFirst].sent_by_host = true;
    fixture.hear();
    fixture.expect_running_without(0);
    Fixture live;
    AxisReceiver strict(live.machine, {.refuse_local = true});
    live.samples[20][kFirst].sent_by_host = true;
    for (const auto& sample : live.samples) {
        listen(strict, sample, live.heard);
    }
    EXPECT_EQ(strict.stop_cause(), ReceiverFault::local_sender);
}

TEST(AxisReceiver, C17_OnlyTheExactLengthIsUsed) {
    for (const CanFormat format : {CanFormat::classical, CanFormat::fd}) {
        for (const int length : {0, 7, 12, 31, 48}) {
            Fixture fixture(format);
            fixture.samples[20][kFirst].length_bytes = static_cast<std::uint8_t>(length);
            fixture.hear();
            EXPECT_EQ(fixture.count(ReceiverFault::bad_length), 1U);
            EXPECT_EQ(fixture.heard.snapshots.size(), 39U);
        }
    }
    Fixture lasting;
    for (std::size_t k = 20; k < 40; ++k) {
        lasting.samples[k][kFirst].length_bytes = 7;
    }
    lasting.hear();
    lasting.expect_stop(ReceiverFault::stale);
}

TEST(AxisReceiver, C18_C19_OnlyTheExactFormatIsUsed) {
    Fixture flexible;
    flexible.samples[20][kFirst].fd = true;
    flexible.hear();
    EXPECT_EQ(flexible.count(ReceiverFault::bad_format), 1U);
    flexible.expect_running_without(1);
    Fixture classical(CanFormat::fd);
    classical.samples[20][kFirst].fd = false;
    classical.hear();
    EXPECT_EQ(classical.count(ReceiverFault::bad_format), 1U);
    classical.expect_running_without(1);
    Fixture raw;
    raw.samples[20][kFirst].raw_dlc = 9;
    raw.hear();
    EXPECT_EQ(raw.count(ReceiverFault::raw_dlc), 1U);
    raw.expect_running_without(1);
}

TEST(AxisReceiver, C21_MoreThanTwiceOurFramesInAPeriodIsAFlood) {
    for (const std::size_t copies :
         {3U, 4U}) {  // with the three of the board: twice a set, and one more
        Fixture fixture;
        CanFrame copy = fixture.samples[20][kFirst];
        auto at = fixture.samples[20].begin() + kSecond;
        fixture.samples[20].insert(at, copies, copy);
        fixture.hear();
        if (copies == 3) {
            fixture.expect_running_without(0);
        } else {
            fixture.expect_stop(ReceiverFault::flood);
        }
    }
}

CanFrame error_frame(std::uint32_t error_class, std::uint8_t detail, std::int64_t time_us) {
    CanFrame frame;
    frame.error = true;
    frame.id = error_class;
    frame.length_bytes = 8;
    frame.data[1] = detail;
    frame.time_us = time_us;
    return frame;
}

TEST(AxisReceiver, C23_to_C27_ErrorFramesReachTheStateMachine) {
    struct Case {
        std::uint32_t error_class;
        std::uint8_t detail;
        ReceiverFault fault;
    };
    for (const Case& c :
         {Case{0x004, 0x01, ReceiverFault::rx_overflow},
          Case{0x004, 0x04, ReceiverFault::error_frame},
          Case{0x004, 0x10, ReceiverFault::rx_passive},
          Case{0x004, 0x20, ReceiverFault::tx_passive},
          Case{0x004, 0x30, ReceiverFault::tx_passive},
          Case{0x008, 0x00, ReceiverFault::error_frame}, Case{0x040, 0x00, ReceiverFault::bus_off},
          Case{0x044, 0x01, ReceiverFault::bus_off},
          Case{0x100, 0x00, ReceiverFault::bus_restarted}}) {
        Fixture fixture;
        auto& sample = fixture.samples[20];
        sample.push_back(error_frame(c.error_class, c.detail, sample.back().time_us));
        fixture.hear();
        EXPECT_EQ(fixture.count(c.fault), 1U) << fault_row(c.fault).name;
        if (fault_row(c.fault).severity == Severity::stop) {
            fixture.expect_stop(c.fault);
        } else {
            fixture.expect_running_without(0);
        }
    }
}

TEST(AxisReceiver, C33_AClockThatStepsBackDoesNotMakeDataYounger) {
    for (const std::int64_t step_us : {5'000, 100'000}) {
        Fixture fixture;
        for (CanFrame& frame : fixture.samples[20]) {
            frame.time_us -= step_us;
        }
        fixture.hear();
        EXPECT_EQ(fixture.receiver.counters().clock_steps, fixture.samples[20].size());
        if (step_us == 5'000) {  // a SYNC that old makes its snapshot too old
            EXPECT_EQ(fixture.count(ReceiverFault::too_old), 1U);
            fixture.expect_running_without(1);
        } else {  // one beyond the stamps kept is as good as lost
            EXPECT_EQ(fixture.receiver.counters().estimated, 1U);
            fixture.expect_running_without(0);
        }
        for (const AxisSnapshot& snapshot : fixture.heard.snapshots) {
            EXPECT_LE(snapshot.latched_us,
                      snapshot_at(fixture.machine, snapshot.sample).latched_us);
        }
    }
}

TEST(AxisReceiver, C34_ACounterThatRunsBackwardsStops) {
    Fixture fixture;
    for (std::size_t k = 20; k < 40; ++k) {
        for (std::size_t i = kFirst; i <= kThird; ++i) {
            CanFrame& frame = fixture.samples[k][i];
            frame.data[1] = static_cast<std::uint8_t>((frame.data[1] & 0xF0U) | ((40 - k) & 15U));
            seal(frame, static_cast<std::uint16_t>(0x81U + 0x100U * i));
        }
    }
    fixture.hear();
    fixture.expect_stop(ReceiverFault::stale);
    EXPECT_GT(fixture.count(ReceiverFault::wrong_sequence), 0U);
}

TEST(AxisReceiver, C35_LossWithinTheAgeLimitStopsAboveTheLeakyLimitOnly) {
    Fixture seldom(CanFormat::classical, 1000);
    for (std::size_t k = 10; k < 1000; k += 4) {
        seldom.samples[k].clear();
    }
    seldom.hear();
    EXPECT_EQ(seldom.receiver.state(), ReceiverState::valid);
    Fixture often(CanFormat::classical, 1000);
    for (std::size_t k = 10; k < 1000; k += 3) {
        often.samples[k].clear();
    }
    often.hear();
    often.expect_stop(ReceiverFault::loss_limit);
}

TEST(AxisReceiver, HeartbeatMustStayOperationalAndFresh) {
    Fixture stopped;
    stopped.samples[25].push_back(encode_heartbeat(0x701, 4, stopped.samples[25].back().time_us));
    stopped.hear();
    stopped.expect_stop(ReceiverFault::heartbeat_state);
    Fixture lost(CanFormat::classical, 100);
    for (std::size_t k = 1; k < 100; ++k) {
        std::erase_if(lost.samples[k], [](const CanFrame& frame) { return frame.id == 0x701; });
    }
    lost.hear();
    lost.expect_stop(ReceiverFault::heartbeat_lost);
    EXPECT_GT(lost.heard.faults.back().time_us, lost.samples[0].back().time_us + 65'000);
    EXPECT_EQ(lost.heard.snapshots.size(), 66U);  // those complete by then
}

// A board whose period is longer than the usual 10 ms of a heartbeat sends it with its samples.
TEST(AxisReceiver, TheHeartbeatMayComeAsSlowlyAsTheSamples) {
    for (const std::uint32_t timeout_us : {150'000U, 49'999U}) {
        Machine machine = five_axis_machine(CanFormat::classical);
        machine.can.sample_us = 50'000;
        machine.can.stale_after_us = 150'000;
        machine.can.heartbeat_timeout_us = timeout_us;
        AxisReceiver receiver(machine);
        Heard heard;
        for (const std::vector<CanFrame>& frames : board_frames(machine, 20)) {
            listen(receiver, frames, heard);
        }
        EXPECT_EQ(receiver.state() == ReceiverState::valid, timeout_us == 150'000) << timeout_us;
        EXPECT_EQ(receiver.counters().of(ReceiverFault::heartbeat_lost),
                  timeout_us == 150'000 ? 0U : 1U);
        EXPECT_EQ(heard.snapshots.size() == 20, timeout_us == 150'000);
    }
}

TEST(AxisReceiver, SyncIsCheckedForShapeStepAndPeriod) {
    Fixture fixture;
    fixture.samples[10][kSync].length_bytes = 2;
    fixture.samples[14][kSync].data[0] = 241;
    fixture.samples[18][kSync].data[0] = 0;
    fixture.samples[22][kSync].data[0] = 200;
    fixture.samples[26][kSync].time_us += 201;
    fixture.samples[27][kSync].time_us += 1;
    fixture.hear();
    EXPECT_EQ(fixture.count(ReceiverFault::bad_length), 1U);
    EXPECT_EQ(fixture.count(ReceiverFault::bad_format), 2U);
    EXPECT_EQ(fixture.count(ReceiverFault::wrong_sequence), 1U);
    EXPECT_EQ(fixture.count(ReceiverFault::sync_early_or_late), 1U);
    EXPECT_EQ(fixture.receiver.counters().estimated, 4U);
    EXPECT_EQ(fixture.receiver.state(), ReceiverState::valid);
    EXPECT_EQ(fixture.heard.snapshots.size(), 40U);
    EXPECT_EQ(fixture.heard.snapshots[10].latched_us, snapshot_at(fixture.machine, 10).latched_us);
}

TEST(AxisReceiver, ALateSyncDoesNotMakeItsSampleYounger) {
    Fixture fixture;
    for (std::size_t k = 20; k < 24; ++k) {  // each SYNC is held up until the last axis frame
        std::swap(fixture.samples[k][kSync].data, fixture.samples[k][kThird].data);
        std::swap(fixture.samples[k][kSync].id, fixture.samples[k][kThird].id);
        std::swap(fixture.samples[k][kSync].length_bytes, fixture.samples[k][kThird].length_bytes);
        for (CanFrame& frame : fixture.samples[k]) {
            frame.time_us = fixture.samples[k].back().time_us;
        }
    }
    fixture.hear();
    for (const AxisSnapshot& snapshot : fixture.heard.snapshots) {
        const std::int64_t true_us = snapshot_at(fixture.machine, snapshot.sample).latched_us;
        EXPECT_LE(snapshot.latched_us, true_us + 240);  // a fifth of a period, 10 us more each
        EXPECT_GE(snapshot.latched_us, true_us - 1);
    }
    EXPECT_GE(fixture.heard.snapshots.size(), 36U);
}

TEST(AxisReceiver, WithoutSyncTheSnapshotsEndAfterAFewEstimates) {
    Fixture fixture;
    for (std::size_t k = 20; k < 40; ++k) {
        fixture.samples[k].erase(fixture.samples[k].begin());
    }
    fixture.hear();
    fixture.expect_stop(ReceiverFault::stale);
    EXPECT_EQ(fixture.receiver.counters().estimated, 3U);
    EXPECT_EQ(fixture.heard.snapshots.size(), 23U);
}

TEST(AxisReceiver, InvalidIsLeftOnlyByAcknowledge) {
    Fixture fixture;
    replace_sample_20(fixture, [](AxisSnapshot& snapshot) { snapshot.flags = kFlagNotHomed; });
    fixture.hear();
    fixture.expect_stop(ReceiverFault::not_homed);
    const std::uint64_t ignored = fixture.receiver.counters().ignored_invalid;
    EXPECT_GT(ignored, 50U);
    EXPECT_EQ(fixture.heard.snapshots.size(), 20U);
    fixture.receiver.acknowledge();
    EXPECT_EQ(fixture.receiver.state(), ReceiverState::init);
    AxisEncoder encoder(fixture.machine);
    for (std::uint64_t k = 100; k < 110; ++k) {
        listen(fixture.receiver, frames_of(encoder, snapshot_at(fixture.machine, k)),
               fixture.heard);
    }
    EXPECT_EQ(fixture.receiver.state(), ReceiverState::valid);
    ASSERT_EQ(fixture.heard.snapshots.size(), 30U);
    EXPECT_EQ(fixture.heard.snapshots[20].sample, 100U);  // the gap is counted by the clock
}

TEST(AxisReceiver, ABoardThatStartsAgainIsLearntAnewWhileNothingIsPermitted) {
    Fixture fixture;
    listen(fixture.receiver, fixture.samples[0], fixture.heard);
    AxisEncoder restarted(fixture.machine);
    for (std::uint64_t k = 57; k < 60; ++k) {
        listen(fixture.receiver, frames_of(restarted, snapshot_at(fixture.machine, k)),
               fixture.heard);
    }
    EXPECT_TRUE(fixture.heard.faults.empty());
    EXPECT_EQ(fixture.receiver.state(), ReceiverState::valid);
}

TEST(AxisReceiver, ALayoutThatDoesNotFitNeverGivesASnapshot) {
    Machine machine = five_axis_machine(CanFormat::classical);
    const auto samples = board_frames(machine, 5);
    machine.can.axis_ids.resize(2);
    AxisReceiver receiver(machine);
    Heard heard;
    for (const auto& sample : samples) {
        listen(receiver, sample, heard);
    }
    receiver.acknowledge();
    EXPECT_EQ(receiver.state(), ReceiverState::invalid);
    EXPECT_EQ(receiver.stop_cause(), ReceiverFault::bad_layout);
    EXPECT_TRUE(heard.snapshots.empty());
}

TEST(AxisReceiver, ForeignFramesAreCountedAndChangeNothing) {
    Fixture fixture;
    for (auto& sample : fixture.samples) {
        CanFrame frame = sample[kFirst];
        frame.id = 0x123;
        sample.push_back(frame);
        sample.back().time_us = sample[sample.size() - 2].time_us;
    }
    fixture.hear();
    fixture.expect_running_without(0);
    EXPECT_EQ(fixture.receiver.counters().foreign, 40U);
}

}  // namespace
}  // namespace axg
