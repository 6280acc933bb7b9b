// SPDX-License-Identifier: Apache-2.0
// The ring of the black box, what fills it, and the files that come of it: the oldest go first, ten
// seconds of a healthy bus fit, what was lost is told, and the disk holds no more than was asked
// for.
#include "firmware_if/guard/black_box.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "firmware_if/live/black_box_dump.hpp"
#include "hil_replay/replay/black_box_file.hpp"
#include "tests/support/live_world.hpp"

namespace axg {
namespace {

BlackBoxEntry lost(std::int64_t time_us, std::uint32_t count) {
    return {time_us, LostRecords{count}};
}

std::vector<BlackBoxRecord> records_of(const BlackBox& black_box) {
    std::vector<std::uint8_t> bytes(kBlackBoxHeaderBytes);
    encode_black_box_header(
        {}, std::span<std::uint8_t, kBlackBoxHeaderBytes>(bytes.data(), kBlackBoxHeaderBytes));
    for (const auto& part : black_box.records()) {
        bytes.insert(bytes.end(), part.begin(), part.end());
    }
    std::array<std::uint8_t, kBlackBoxRecordBytesMax> end;
    const std::size_t size = encode_black_box_record({0, BlackBoxEnd{}}, black_box.sequence(), end);
    bytes.insert(bytes.end(), end.begin(), end.begin() + static_cast<long>(size));
    BlackBoxFile file("ring", bytes);
    std::vector<BlackBoxRecord> out;
    BlackBoxRecord record;
    while (file.next(record)) {
        out.push_back(record);
    }
    EXPECT_EQ(file.error(), "");
    return out;
}

TEST(BlackBoxRing, TheOldestMakeRoomForTheNewest) {
    BlackBox black_box(1000);
    for (std::uint32_t i = 0; i < 500; ++i) {
        black_box.add(lost(i, i));
        const std::vector<BlackBoxRecord> kept = records_of(black_box);
        ASSERT_FALSE(kept.empty());
        EXPECT_EQ(kept.back().sequence, i);
        EXPECT_EQ(std::get<LostRecords>(kept.back().entry.content).count, i);
    }
    EXPECT_EQ(records_of(black_box).size(), 1000U / (kBlackBoxRecordBytesMin + 4));
}

class BlackBoxWorld : public testing::TestWithParam<CanFormat> {
  protected:
    void start() {
        world.options.black_box = &records;
        world.start();
        world.each_step = [this] {
            BlackBoxEntry record;
            while (drains && records.pop(record)) {
                black_box.add(record);
            }
        };
    }
    LatchCell latch{kLatchClear, ~kLatchClear};
    BlackBoxQueue records;
    test::LiveWorld world{GetParam(), latch};
    BlackBox black_box{black_box_bytes(world.machine)};
    bool drains = true;
};

TEST_P(BlackBoxWorld, TenSecondsOfAHealthyBusFit) {
    start();
    world.run_to_armed();
    world.run_periods(3 * kBlackBoxUs / world.machine.can.sample_us);
    ASSERT_EQ(world.guard->guard().phase, GuardPhase::armed);
    const std::vector<BlackBoxRecord> kept = records_of(black_box);
    ASSERT_GT(kept.front().sequence, 0U) << "the ring was never full: nothing is shown";
    EXPECT_GE(kept.back().entry.time_us - kept.front().entry.time_us, kBlackBoxUs);
    EXPECT_EQ(world.guard->counters().records_lost, 0U);
}

// What the wire and the guard did is what is in it: every frame, snapshot, result and word.
TEST_P(BlackBoxWorld, EverythingIsRecordedOnceAndInOrder) {
    start();
    world.run_to_armed();
    world.run_periods(200);
    std::uint64_t read = 0, sent = 0, echoes = 0, snapshots = 0, results = 0, phases = 0;
    std::int64_t last_us = 0;
    for (const BlackBoxRecord& record : records_of(black_box)) {
        EXPECT_GE(record.entry.time_us, last_us);
        last_us = record.entry.time_us;
        const BlackBoxContent& content = record.entry.content;
        if (const auto* arrival = std::get_if<CanArrival>(&content)) {
            ++(arrival->is_own ? echoes : read);
        } else if (const auto* query = std::get_if<LiveQuery>(&content)) {
            snapshots += query->kind == LiveQuery::Kind::snapshot ? 1U : 0U;
        } else if (const auto* note = std::get_if<LiveNote>(&content)) {
            phases += note->kind == LiveNote::Kind::phase ? 1U : 0U;
        }
        sent += std::holds_alternative<SentFrame>(content) ? 1U : 0U;
        results += std::holds_alternative<LiveResult>(content) ? 1U : 0U;
    }
    EXPECT_EQ(read, world.guard->receiver().counters().frames);
    EXPECT_EQ(sent, world.wire.sent.size());
    EXPECT_EQ(echoes, world.guard->counters().echoes);
    EXPECT_EQ(snapshots, world.guard->counters().snapshots);
    EXPECT_GE(results, snapshots) << "the self-test is one more, the last may be on its way";
    EXPECT_EQ(phases, 3U) << "selftest, ready, armed";
}

// A logger that stands still: what is lost is counted, told by the next record that finds room,
// and periods in which it happens are bad ones, so that it stops in the end.
TEST_P(BlackBoxWorld, ALoggerThatIsSlowIsToldAndInTheEndStops) {
    start();
    world.run_to_armed();
    world.run_periods(50);
    ASSERT_EQ(world.guard->guard().phase, GuardPhase::armed);
    drains = false;
    world.run_periods(2000);
    EXPECT_EQ(world.guard->guard().phase, GuardPhase::stopped);
    EXPECT_EQ(world.guard->guard().cause, GuardFault::flapping);
    const std::uint64_t count = world.guard->counters().records_lost;
    EXPECT_GT(count, 0U);
    drains = true;
    world.run_periods(2);
    std::uint64_t told = 0;
    for (const BlackBoxRecord& record : records_of(black_box)) {
        const auto* gap = std::get_if<LostRecords>(&record.entry.content);
        told += gap != nullptr ? gap->count : 0;
    }
    EXPECT_EQ(told, world.guard->counters().records_lost);
    EXPECT_GE(told, count);
}

INSTANTIATE_TEST_SUITE_P(Formats, BlackBoxWorld,
                         testing::Values(CanFormat::classical, CanFormat::fd));

class BlackBoxDumpTest : public testing::Test {
  protected:
    BlackBoxDumpTest() : folder_(testing::TempDir() + "/axg_dumps") {
        std::filesystem::remove_all(folder_);
        std::filesystem::create_directory(folder_);
        black_box.add(lost(1, 2));
    }
    ~BlackBoxDumpTest() override { std::filesystem::remove_all(folder_); }
    BlackBoxFolder folder(std::uint32_t dumps_max) const {
        return {.folder = folder_, .bus = "can0", .dumps_max = dumps_max};
    }
    std::size_t files() const {
        const auto all = std::filesystem::directory_iterator(folder_);
        return static_cast<std::size_t>(std::distance(begin(all), end(all)));
    }
    LiveNote stop(GuardFault cause) const {
        LiveNote note;
        note.phase = GuardPhase::stopped;
        note.cause = cause;
        note.time_us = 1'000'000;
        return note;
    }
    std::string folder_, fault;
    BlackBox black_box{1000};
};

TEST_F(BlackBoxDumpTest, NoMoreAreKeptThanWereAskedForAndTheNewestAre) {
    std::ofstream(folder_ + "/can0.latch") << "latch";
    std::ofstream(folder_ + "/can1-20200101T000000Z.axgbox") << "another bus";
    std::string newest;
    for (std::int64_t day = 0; day < 5; ++day) {
        BlackBoxHeader header;
        header.unix_us = 1'700'000'000'000'000 + day * 86'400'000'000;
        newest = write_black_box(black_box, header, folder(2), fault);
        ASSERT_NE(newest, "") << fault;
    }
    EXPECT_EQ(files(), 4U) << "two, and what is not ours to remove";
    EXPECT_TRUE(std::filesystem::exists(newest));
    EXPECT_EQ(newest, folder_ + "/can0-20231118T221320Z.axgbox");
    BlackBoxFile file = BlackBoxFile::open(newest);
    BlackBoxRecord record;
    EXPECT_TRUE(file.next(record));
    EXPECT_FALSE(file.next(record));
    EXPECT_EQ(file.error(), "");
}

TEST_F(BlackBoxDumpTest, OneOfAnotherVersionNamesBoth) {
    const std::string path = write_black_box(black_box, {}, folder(2), fault);
    std::fstream dump(path, std::ios::binary | std::ios::in | std::ios::out);
    dump.seekp(8).put(4);
    dump.close();
    EXPECT_EQ(BlackBoxFile::open(path).error(),
              path +
                  ":0: invalid file (found a black box of version 4, expected version 8). Use the "
                  "axguard version of the axguardd that wrote it.");
}

std::array<std::uint8_t, kBlackBoxHeaderBytes> bytes_of(const BlackBoxHeader& header) {
    std::array<std::uint8_t, kBlackBoxHeaderBytes> bytes;
    encode_black_box_header(header, bytes);
    return bytes;
}

TEST(BlackBoxHeader, HoldsThePlan) {
    BlackBoxHeader header, read;
    header.is_stoppable = true;
    header.configuration.fill('a');
    header.plan = plan_of(3, 8, 512, {1, 22, 333, 4444, 55555});
    header.plan.depth_max = 9;
    header.plan.form = TreeForm::whole;
    ASSERT_EQ(decode_black_box_header(bytes_of(header), read), BlackBoxStatus::ok);
    EXPECT_EQ(read.plan, header.plan);
}

TEST(BlackBoxHeader, APlanThatNobodyHasIsRefused) {
    BlackBoxHeader good, read;
    good.plan = plan_of(2, 8, 510, {512, 512, 2048, 4096, 0});
    for (int fault = 0; fault < 4; ++fault) {
        BlackBoxHeader bad = good;
        bad.plan.stages = fault == 0 ? 0 : fault == 1 ? kStagesMax + 1 : 2;
        bad.plan.depth_max = fault == 2 ? kStageDepthMax + 1 : kStageDepthMax;
        bad.plan.queries[1] = fault == 3 ? UINT32_MAX : 510;
        EXPECT_EQ(decode_black_box_header(bytes_of(bad), read), BlackBoxStatus::bad_content)
            << fault;
    }
    EXPECT_EQ(decode_black_box_header(bytes_of(good), read), BlackBoxStatus::ok);
}

TEST_F(BlackBoxDumpTest, AFolderThatIsNotThereIsSaid) {
    EXPECT_EQ(write_black_box(black_box, {}, {.folder = folder_ + "/none", .bus = "can0"}, fault),
              "");
    EXPECT_NE(fault.find("cannot write the black box: No such file"), std::string::npos) << fault;
}

TEST_F(BlackBoxDumpTest, OneStopIsOneDumpHalfASecondLater) {
    BlackBoxDump dump(black_box, {}, folder(8));
    dump.on_note(stop(GuardFault::verdict));
    dump.serve(1'499'999);
    EXPECT_EQ(files(), 0U);
    dump.serve(1'500'000);
    EXPECT_EQ(files(), 1U);
    EXPECT_TRUE(std::filesystem::exists(dump.path()));
    dump.serve(9'000'000);
    dump.finish(9'000'000);
    EXPECT_EQ(files(), 1U);
}

TEST_F(BlackBoxDumpTest, TheEndOfTheProcessDoesNotWait) {
    BlackBoxDump dump(black_box, {}, folder(8));
    dump.on_note(stop(GuardFault::gap));
    dump.finish(1'000'001);
    EXPECT_EQ(files(), 1U);
}

TEST_F(BlackBoxDumpTest, NothingIsWrittenForAStopOfAnEarlierRunOrWhereNoneIsWanted) {
    BlackBoxDump dump(black_box, {}, folder(8));
    dump.on_note(stop(GuardFault::latched));
    dump.finish(9'000'000);
    BlackBoxDump none(black_box, {}, folder(0));
    none.on_note(stop(GuardFault::verdict));
    none.finish(9'000'000);
    EXPECT_EQ(files(), 0U);
    EXPECT_EQ(none.path(), "");
}

}  // namespace
}  // namespace axg
