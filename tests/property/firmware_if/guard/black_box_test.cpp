// SPDX-License-Identifier: Apache-2.0
// A dump that was torn, flipped or put together wrongly: the reader hands out what is before the
// damage, exactly as it was written, says where the damage is, and hands out nothing behind it.
#include <gtest/gtest.h>

#include <random>

#include "firmware_if/guard/black_box.hpp"
#include "hil_replay/replay/black_box_file.hpp"
#include "tests/support/count.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

class Dump {
  public:
    explicit Dump(std::mt19937_64& random) : random_(random) {
        bytes.resize(kBlackBoxHeaderBytes);
        BlackBoxHeader header;
        header.configuration.fill('a');
        header.time_us = 77;
        encode_black_box_header(header, std::span<std::uint8_t, kBlackBoxHeaderBytes>(
                                            bytes.data(), kBlackBoxHeaderBytes));
        const std::uint32_t first = draw(5) == 0 ? 0xFFFFFFF0U : draw(1000);
        const std::uint32_t count = 1 + draw(40);
        for (std::uint32_t i = 0; i < count; ++i) {
            add({static_cast<std::int64_t>(i) * 50, content()}, first + i);
        }
        add({99, BlackBoxEnd{}}, first + count);
    }

    std::vector<std::uint8_t> bytes;
    std::vector<std::size_t> begins;  // of each record, the end's too

  private:
    std::uint32_t draw(std::uint32_t count) {
        return static_cast<std::uint32_t>(random_() % count);
    }
    CanFrame frame() {
        CanFrame out;
        out.time_us = static_cast<std::int64_t>(random_() >> 1U);
        out.id = draw(0x20000000);
        out.fd = draw(2) == 0;
        out.error = draw(9) == 0;
        out.sent_by_host = draw(2) == 0;
        out.length_bytes = static_cast<std::uint8_t>(draw(out.fd ? 65 : 9));
        for (std::size_t i = 0; i < out.length_bytes; ++i) {
            out.data[i] = static_cast<std::uint8_t>(draw(256));
        }
        return out;
    }
    LiveQuery query() {
        LiveQuery out;
        out.kind = static_cast<LiveQuery::Kind>(draw(3));
        out.number = draw(~0U);
        if (out.kind == LiveQuery::Kind::snapshot) {
            out.event.kind = ReceiverEvent::Kind::snapshot;
            out.event.state = ReceiverState::valid;
            out.event.snapshot.axis_count = 1 + draw(kAxesMax);
            for (std::uint32_t i = 0; i < out.event.snapshot.axis_count; ++i) {
                out.event.snapshot.position[i] = static_cast<double>(random_()) * 1e-9;
                out.caps.acked[i] = static_cast<std::uint8_t>(draw(251));
                out.caps.since[i] = static_cast<std::uint8_t>(draw(251));
            }
            out.caps.status = static_cast<AckStatus>(draw(3));
        }
        return out;
    }
    BlackBoxContent content() {
        LiveResult live_result;
        LiveNote note;
        switch (draw(9)) {
            case 0:
                return CanArrival{.frame = frame(), .is_own = draw(2) == 0};
            case 1:
                return SentFrame{frame(), SendStatus::busy};
            case 7:
                return EmptyTurn{};
            case 8:
                return LiveCall{static_cast<LiveCall::Kind>(draw(3)), GuardFault::input_noise};
            case 2:
                return ReadStatus::gone;
            case 3:
                return query();
            case 4:
                live_result.kind = LiveQuery::Kind::snapshot;
                live_result.number = draw(~0U);
                live_result.result.pair = draw(100);
                live_result.result.reason = StopReason::left_cap;
                live_result.result.has_cap = draw(2) == 0;
                live_result.result.is_held = draw(2) == 0;
                live_result.result.cap_order = {static_cast<std::uint8_t>(draw(251)),
                                                static_cast<std::uint8_t>(draw(256))};
                live_result.result.cap_fact = {static_cast<CapBreak>(draw(4)), draw(16)};
                live_result.done_us = static_cast<std::int64_t>(random_());
                return live_result;
            case 5:
                note.words = "a guard frame was rejected";
                note.fault = ReceiverFault::torn;
                note.count = draw(9);
                return note;
            default:
                return LostRecords{draw(100)};
        }
    }
    void add(const BlackBoxEntry& entry, std::uint32_t sequence) {
        std::array<std::uint8_t, kBlackBoxRecordBytesMax> record;
        const std::size_t size = encode_black_box_record(entry, sequence, record);
        begins.push_back(bytes.size());
        bytes.insert(bytes.end(), record.begin(), record.begin() + static_cast<long>(size));
    }

    std::mt19937_64& random_;
};

/// The bytes of every record that was handed out, encoded anew; what was said at the end.
struct Read {
    std::vector<std::uint8_t> bytes;
    std::size_t records = 0;
    std::string error;
};
Read read_all(const std::vector<std::uint8_t>& dump) {
    BlackBoxFile file("dump", dump);
    Read out;
    BlackBoxRecord record;
    while (file.next(record)) {
        std::array<std::uint8_t, kBlackBoxRecordBytesMax> again;
        const std::size_t size = encode_black_box_record(record.entry, record.sequence, again);
        out.bytes.insert(out.bytes.end(), again.begin(), again.begin() + static_cast<long>(size));
        ++out.records;
    }
    out.error = file.error();
    return out;
}

/// The records up to byte `end` of the dump, and a complaint about that place.
void expect_up_to(const Dump& dump, const Read& read, std::size_t record) {
    EXPECT_EQ(read.records, record);
    const std::size_t begin = dump.begins.front(), end = dump.begins[record];
    EXPECT_TRUE(std::equal(read.bytes.begin(), read.bytes.end(),
                           dump.bytes.begin() + static_cast<long>(begin),
                           dump.bytes.begin() + static_cast<long>(end)));
    EXPECT_EQ(read.error.find("dump:" + std::to_string(end) + ": "), 0U) << read.error;
    EXPECT_NE(read.error.find("Earlier records are used"), std::string::npos) << read.error;
}

/// The record that holds the byte.
std::size_t record_at(const Dump& dump, std::size_t at) {
    return static_cast<std::size_t>(std::upper_bound(dump.begins.begin(), dump.begins.end(), at) -
                                    dump.begins.begin() - 1);
}

TEST(BlackBoxFileTest, AWholeDumpReadsBackAsItWasWritten) {
    std::mt19937_64 random(test::printed_seed(20261121));
    for (std::uint64_t i = 0; i < test::count_from_environment(2000); ++i) {
        const Dump dump(random);
        const Read read = read_all(dump.bytes);
        ASSERT_EQ(read.error, "");
        ASSERT_EQ(read.records, dump.begins.size() - 1);
        ASSERT_TRUE(std::equal(read.bytes.begin(), read.bytes.end(),
                               dump.bytes.begin() + static_cast<long>(kBlackBoxHeaderBytes)));
    }
}

TEST(BlackBoxFileTest, AFlippedBitEndsItBeforeItsRecord) {
    std::mt19937_64 random(test::printed_seed(20261122));
    for (std::uint64_t i = 0; i < test::count_from_environment(2000) && !HasFailure(); ++i) {
        Dump dump(random);
        for (int flips = 0; flips < 20; ++flips) {
            std::vector<std::uint8_t> bytes = dump.bytes;
            const std::size_t bit = random() % (bytes.size() * 8);
            bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ (1U << (bit % 8)));
            const Read read = read_all(bytes);
            if (bit / 8 < kBlackBoxHeaderBytes) {
                EXPECT_EQ(read.records, 0U);
                EXPECT_EQ(read.error.find("dump:0: "), 0U) << read.error;
            } else {
                expect_up_to(dump, read, record_at(dump, bit / 8));
            }
        }
    }
}

TEST(BlackBoxFileTest, CutAtAnyByteItIsUsedUpToThere) {
    std::mt19937_64 random(test::printed_seed(20261123));
    for (std::uint64_t i = 0; i < test::count_from_environment(100) && !HasFailure(); ++i) {
        const Dump dump(random);
        for (std::size_t size = 0; size < dump.bytes.size(); ++size) {
            const Read read =
                read_all({dump.bytes.begin(), dump.bytes.begin() + static_cast<long>(size)});
            if (size < kBlackBoxHeaderBytes) {
                EXPECT_EQ(read.records, 0U);
                EXPECT_NE(read.error, "") << "a header that was cut short";
            } else {
                expect_up_to(dump, read, record_at(dump, size));
            }
        }
    }
}

TEST(BlackBoxFileTest, ARecordThatIsMissingOrBehindTheEndIsSeen) {
    std::mt19937_64 random(test::printed_seed(20261124));
    for (std::uint64_t i = 0; i < test::count_from_environment(2000) && !HasFailure(); ++i) {
        Dump dump(random);
        std::vector<std::uint8_t> bytes = dump.bytes;
        bytes.push_back(0);
        EXPECT_NE(read_all(bytes).error.find("something behind the end"), std::string::npos);
        if (dump.begins.size() < 3) {
            continue;
        }
        const std::size_t record = 1 + random() % (dump.begins.size() - 2);
        bytes = dump.bytes;
        bytes.erase(bytes.begin() + static_cast<long>(dump.begins[record]),
                    bytes.begin() + static_cast<long>(dump.begins[record + 1]));
        const Read read = read_all(bytes);
        expect_up_to(dump, read, record);
        EXPECT_NE(read.error.find("a record is missing"), std::string::npos) << read.error;
    }
}

}  // namespace
}  // namespace axg
