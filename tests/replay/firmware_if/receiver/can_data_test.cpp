// SPDX-License-Identifier: Apache-2.0
// ctest-labels: data
// Logs recorded on real buses and the samples of another reader: counts are those of the data's own
// description.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "firmware_if/receiver/axis_receiver.hpp"
#include "hil_replay/trace/candump_log.hpp"
#include "hil_replay/trace/trace_survey.hpp"
#include "tests/support/can_board.hpp"

namespace axg {
namespace {

std::string data(const char* name) {
    return std::string(AXG_SHARED_DATA) + "/can/" + name;
}

class CanData : public testing::Test {
  protected:
    void SetUp() override {
        if (!std::filesystem::exists(data("sample-can.log"))) {
            GTEST_SKIP() << "no data under " << AXG_SHARED_DATA;
        }
    }
    static std::vector<CanFrame> read(const char* name, std::string& error,
                                      const TraceOptions& options = {}) {
        const auto reader = open_trace(data(name), options, error);
        std::vector<CanFrame> frames;
        CanFrame frame;
        while (reader != nullptr && reader->next(frame)) {
            frames.push_back(frame);
        }
        error += reader != nullptr ? reader->error() : "";
        return frames;
    }
};

// Counts, rates and jitter as the data's description has them.
TEST_F(CanData, ASurveyFindsWhatTheLogsAreKnownToHold) {
    const auto survey_of = [](const char* name) {
        std::string error;
        TraceSurvey survey(nullptr);
        for (const CanFrame& frame : read(name, error)) {
            survey.add(frame);
        }
        EXPECT_EQ(error, "");
        return survey;
    };
    const TraceSurvey motor = survey_of("candump-2019-01-09_224207.log");
    EXPECT_EQ(motor.frame_count(), 1588U);
    EXPECT_NEAR(static_cast<double>(motor.last_us() - motor.first_us()) * 1e-6, 38.2, 0.05);
    int fast = 0, slow = 0;
    for (const auto& [key, survey] : motor.ids()) {
        fast += std::abs(survey.period_us_median - 200'000) < 1000 ? 1 : 0;
        slow += std::abs(survey.period_us_median - 1'000'000) < 5000 ? 1 : 0;
        EXPECT_EQ(survey.bytes_min, 8) << key.id;
    }
    EXPECT_EQ(fast, 7);
    EXPECT_GE(slow, 5);
    EXPECT_NEAR(static_cast<double>(motor.ids().at({.id = 0x081}).period_us_p1), 169'000, 1000);
    const TraceSurvey car = survey_of("sample-can.log");
    EXPECT_EQ(car.frame_count(), 6158U);
    EXPECT_EQ(car.ids().size(), 34U);
    EXPECT_NEAR(6158e6 / static_cast<double>(car.last_us() - car.first_us()), 1890, 1);
}

TEST_F(CanData, RecordedLogsAreReadWholeAndWrittenBackByteForByte) {
    struct Log {
        const char *name, *device;
        std::size_t count;
    };
    for (const Log& log : {Log{"candump-2019-01-09_224207.log", "slcan0", 1588},
                           Log{"sample-can.log", "can0", 6158}}) {
        std::string error;
        const auto frames = read(log.name, error);
        EXPECT_EQ(error, "");
        EXPECT_EQ(frames.size(), log.count);
        std::string again;
        for (const CanFrame& frame : frames) {
            append_candump(again, frame, log.device);
        }
        std::ostringstream original;
        original << std::ifstream(data(log.name)).rdbuf();
        EXPECT_TRUE(again == original.str()) << log.name;
    }
}

TEST_F(CanData, AForeignBusNeverGivesASnapshot) {
    std::string error;
    const auto frames = read("sample-can.log", error);
    AxisReceiver receiver(test::five_axis_machine(CanFormat::classical));
    for (const CanFrame& frame : frames) {
        EXPECT_NE(receiver.on_frame(frame).kind, ReceiverEvent::Kind::snapshot);
    }
    EXPECT_EQ(receiver.counters().frames, 6158U);
}

TEST_F(CanData, VectorSamplesAreReadByChannel) {
    std::string error;
    const auto flexible = read("test_CanFdMessage64.asc", error);
    EXPECT_EQ(error, "");
    ASSERT_EQ(flexible.size(), 2U);
    EXPECT_EQ(flexible[0].id, 0x4EEU);
    EXPECT_TRUE(flexible[0].fd && flexible[0].error_state && !flexible[0].bit_rate_switch);
    EXPECT_EQ(flexible[0].length_bytes, 64);
    EXPECT_EQ(flexible[0].data[63], 0x64);
    EXPECT_EQ(flexible[1].id, 0x1C4D80A7U);
    EXPECT_TRUE(flexible[1].extended && flexible[1].bit_rate_switch);
    EXPECT_EQ(flexible[1].time_us - flexible[0].time_us, 1'000'000);

    EXPECT_EQ(read("test_CanErrorFrames.asc", error).size(), 2U);
    EXPECT_NE(error.find("interface: invalid value (found \"2\""), std::string::npos) << error;
    for (const auto& [channel, count] :
         {std::pair<const char*, std::size_t>{"1", 2}, {"2", 1}, {"5", 1}}) {
        TraceOptions options;
        options.device = channel;
        const auto errors = read("test_CanErrorFrames.asc", error, options);
        EXPECT_EQ(error, "");
        ASSERT_EQ(errors.size(), count);
        EXPECT_TRUE(errors[0].error);
    }
}

TEST_F(CanData, AFormatWeDoNotReadIsRefusedWithTheWayOut) {
    std::string error;
    EXPECT_EQ(open_trace(data("test_CanMessage_V2_1.trc"), {}, error), nullptr);
    EXPECT_NE(error.find("can_logconvert"), std::string::npos) << error;
}

}  // namespace
}  // namespace axg
