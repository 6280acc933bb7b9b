// SPDX-License-Identifier: Apache-2.0
// The record of a board test: what is written is read, anything else is no record; and it names
// the hashes that a machine file has once the measured keys are in it.
#include "firmware_if/axguardd/board_test_record.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <regex>
#include <string>
#include <vector>

#include "config/machine/effective_text.hpp"
#include "config/machine/load_machine.hpp"
#include "config/mesh/load_meshes.hpp"
#include "hil_replay/board/axis_motion.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

constexpr ConfigurationHashes kHashes{{0x11223344, 0x00000055, 0x66778899, 0xFFEEDDCC}};

BoardTestRecord a_record() {
    return {.machine = "paper-trunnion",
            .bus = "can0",
            .serial = "MB-7 #0012",
            .date = "2026-11-30T01:02:03Z",
            .hashes = kHashes,
            .counts = {.passed = 38, .failed = 1, .unclear = 2, .not_tested = 3},
            .abandoned = "interrupted"};
}

class BoardTestRecordFile : public testing::Test {
  protected:
    [[nodiscard]] FoundRecord found(const ConfigurationHashes& hashes = kHashes) const {
        return find_record(path, hashes);
    }
    FoundRecord found_in(const std::string& text) {
        (void)shop.write("can0.board-test.json", text);
        return found();
    }

    test::Workshop shop;
    std::string path = board_test_path(shop.file(""), "can0");
};

TEST_F(BoardTestRecordFile, WhatIsWrittenIsRead) {
    const FoundRecord read = found_in(describe_record(a_record()));
    EXPECT_EQ(read.state, RecordState::this_configuration) << read.fault;
    const BoardTestRecord wanted = a_record();
    EXPECT_EQ(read.record.machine, wanted.machine);
    EXPECT_EQ(read.record.bus, wanted.bus);
    EXPECT_EQ(read.record.serial, wanted.serial);
    EXPECT_EQ(read.record.date, wanted.date);
    EXPECT_EQ(read.record.hashes, wanted.hashes);
    EXPECT_EQ(read.record.counts.passed, 38U);
    EXPECT_EQ(read.record.counts.failed, 1U);
    EXPECT_EQ(read.record.counts.unclear, 2U);
    EXPECT_EQ(read.record.counts.not_tested, 3U);
    EXPECT_EQ(read.record.abandoned, wanted.abandoned);
    const std::string words = words_of(read, path);
    EXPECT_NE(words.find("record for this configuration: serial MB-7 #0012, 2026-11-30T01:02:03Z; "
                         "38 passed, 1 FAILED, 2 unclear, 3 not tested; ended early"),
              std::string::npos)
        << words;
}

TEST_F(BoardTestRecordFile, WithoutAFileThereIsNone) {
    EXPECT_EQ(found().state, RecordState::none);
    EXPECT_NE(words_of(found(), path).find("no record (" + path + ")"), std::string::npos);
    EXPECT_NE(words_of(found(), path).find("axguardd board-test --write"), std::string::npos);
}

TEST_F(BoardTestRecordFile, EachHashThatDiffersIsNamed) {
    (void)found_in(describe_record(a_record()));
    for (std::uint32_t i = 0; i < kHashParts; ++i) {
        ConfigurationHashes other = kHashes;
        other.of[i] ^= 1U;
        const FoundRecord read = found(other);
        EXPECT_EQ(read.state, RecordState::another);
        EXPECT_EQ(read.differs, (std::vector<std::string>{kHashPartNames[i]}));
        EXPECT_NE(words_of(read, path)
                      .find(std::string("another configuration (") + kHashPartNames[i] +
                            " differs): serial MB-7 #0012"),
                  std::string::npos)
            << words_of(read, path);
    }
}

TEST_F(BoardTestRecordFile, AHalfWrittenOneIsNoRecord) {
    const std::string whole = describe_record(a_record());
    for (std::size_t size = 0; size + 2 < whole.size(); ++size) {
        const FoundRecord read = found_in(whole.substr(0, size));
        ASSERT_EQ(read.state, RecordState::unreadable) << size;
        EXPECT_NE(words_of(read, path).find(path + ": is no record of a board test"),
                  std::string::npos);
    }
}

TEST_F(BoardTestRecordFile, AValueOfAnotherKindIsRefused) {
    const std::string whole = describe_record(a_record());
    const std::pair<const char*, const char*> changes[] = {
        {"\"MB-7 #0012\"", "\"\""},
        {"\"MB-7 #0012\"", "\"a\\u001b[2Jb\""},
        {"\"MB-7 #0012\"", "12"},
        {"\"2026-11-30T01:02:03Z\"", "\"now\\n\""},
        {"\"11223344\"", "\"1122334\""},
        {"\"11223344\"", "\"1122334g\""},
        {"\"11223344\"", "287454020"},
        {": 38", ": -38"},
        {": 38", ": \"38\""},
        {"\"kinematics\"", "\"kinematic\""},
        {"\"interrupted\"", "null"},
        {"\"can0\"", "0"},
        {"\"paper-trunnion\"", "[]"}};
    for (const auto& [from, to] : changes) {
        std::string text = whole;
        const std::size_t at = text.find(from);
        ASSERT_NE(at, std::string::npos) << from;
        text.replace(at, std::string(from).size(), to);
        EXPECT_EQ(found_in(text).state, RecordState::unreadable) << text;
    }
    EXPECT_EQ(found_in(whole + std::string(20'000, ' ')).fault, "is too long");
}

TEST_F(BoardTestRecordFile, OnlyARegularFileIsReadOrReplaced) {
    EXPECT_EQ(record_place_fault(path), "");
    (void)shop.write("other.json", describe_record(a_record()));
    ASSERT_EQ(symlink(shop.file("other.json").c_str(), path.c_str()), 0);
    EXPECT_EQ(found().fault, "is not a regular file");
    EXPECT_NE(record_place_fault(path).find("is not a regular file"), std::string::npos);
    ASSERT_EQ(unlink(path.c_str()), 0);
    ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
    EXPECT_EQ(found().fault, "is not a regular file");
    EXPECT_NE(record_place_fault(path).find("is not a regular file"), std::string::npos);
}

TEST(BoardTestSerial, IsPrintableAndNotTooLong) {
    for (const std::string good : {"1", "MB-7 #0012", "a\"\\b"}) {
        EXPECT_EQ(serial_fault(good), "") << good;
    }
    EXPECT_EQ(serial_fault(std::string(64, 'x')), "");
    EXPECT_NE(serial_fault(std::string(65, 'x')), "");
    for (const std::string bad : {"", "   ", "a\tb", "a\nb", "\x7F", "\xC3\xA4"}) {
        EXPECT_NE(serial_fault(bad), "") << bad;
    }
}

// --- The hashes -------------------------------------------------------------------------------

AxisStop stop_of(std::uint32_t number, double speed, const StopFigures& figures) {
    AxisStop stop{.axis = number, .speed = speed, .tolerance = 1e-9, .points = {}};
    for (int i = 0; i < 400; ++i) {
        const double seconds = i * 1e-3, free_s = std::min(seconds, figures.reaction_s);
        AxisMotion axis = moved_on({.speed = speed}, free_s);
        brake(axis, {.deceleration = figures.deceleration, .jerk = figures.jerk}, seconds - free_s);
        stop.points.push_back({seconds, axis.position});
    }
    return stop;
}

Machine machine_of(const test::Workshop& shop, const std::string& text) {
    Machine machine;
    for (const ConfigFault& fault : load_machine(shop.write("machine.yaml", text), machine)) {
        ADD_FAILURE() << to_string(fault);
    }
    return machine;
}

/// The keys as a person puts them into the machine file.
std::string with_keys(std::string machine, const std::string& keys) {
    const std::regex axis(R"(\n  ([A-Z]): \{([^}]*)\})"), key(R"((\w+): ([^,}]+))");
    const std::string guard = "guard:\n";
    const std::size_t from = keys.find(guard) + guard.size();
    machine.insert(machine.find(guard) + guard.size(),
                   keys.substr(from, keys.find("axes:\n") - from));
    for (std::sregex_iterator i(keys.begin(), keys.end(), axis), end; i != end; ++i) {
        const std::string pairs = (*i)[2];
        for (std::sregex_iterator k(pairs.begin(), pairs.end(), key); k != end; ++k) {
            const std::regex old("(\n  " + (*i)[1].str() + ": [^\n]*" + (*k)[1].str() +
                                 ": )[0-9.]+");
            EXPECT_TRUE(std::regex_search(machine, old)) << k->str();
            machine = std::regex_replace(machine, old, "$01" + (*k)[2].str());
        }
    }
    return machine;
}

TEST(BoardTestHashes, AreThoseOfTheMachineFileWithTheMeasuredKeys) {
    const test::Workshop shop;
    const std::string paper = test::content_of(test::kPaperMachine);
    const Machine machine = machine_of(shop, paper);
    BoardTestResult result;
    result.reaction_s = 2.4321e-3;
    result.sync.jitter_us_max = 17.2;
    for (const double share : {0.7, 0.9}) {
        for (const std::uint32_t number : {0U, 3U}) {
            const Axis& axis = machine.axes[number];
            result.stops.push_back(
                stop_of(number, share * axis.speed_max,
                        {2.4321e-3, 0.8 * axis.stopping_min, 0.9 * axis.jerk_max}));
        }
    }
    const std::string keys = machine_keys(machine, result);
    ASSERT_NE(keys.find("  X: {stopping_mm_s2: "), std::string::npos) << keys;
    ASSERT_NE(keys.find("  A: {stopping_deg_s2: "), std::string::npos) << keys;
    const Machine measured = with_measured_keys(machine, result);
    const Machine merged = machine_of(shop, with_keys(paper, keys));
    EXPECT_EQ(effective_text(measured), effective_text(merged));
    EXPECT_EQ(configuration_hashes(measured, {}), configuration_hashes(merged, {}));
    EXPECT_NE(configuration_hashes(measured, {}), configuration_hashes(machine, {}));
    EXPECT_EQ(effective_text(with_measured_keys(machine, {})), effective_text(machine))
        << "no stop was judged";
}

}  // namespace
}  // namespace axg
