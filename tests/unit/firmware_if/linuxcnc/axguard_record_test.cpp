// SPDX-License-Identifier: Apache-2.0
// A record of axguard-hal is a candump log: identifiers, flags and bytes come back from it.
#include "firmware_if/linuxcnc/axguard_record.h"

#include <gtest/gtest.h>

#include <array>
#include <string>

namespace axg {
namespace {

std::string recorded(const axg_frame& frame, const axg_sample& sample = {}) {
    std::array<char, 256> text{};
    std::FILE* const out = fmemopen(text.data(), text.size(), "w");
    axg_record_frame(out, &sample, &frame);
    std::fclose(out);
    return text.data();
}

TEST(LinuxCncRecord, IsTheTextOfCandump) {
    axg_frame frame{};
    frame.time_us = 1234000056;
    frame.id = 0x80;
    frame.length_bytes = 1;
    frame.data[0] = 0x0F;
    EXPECT_EQ(recorded(frame), "(1234.000056) hal 080#0F\n");
    frame.id = 0x18FF0181;
    frame.length_bytes = 2;
    EXPECT_EQ(recorded(frame), "(1234.000056) hal 18FF0181#0F00\n");
    frame.id = 0x181;
    frame.flags = AXG_FRAME_FD;
    EXPECT_EQ(recorded(frame), "(1234.000056) hal 181##00F00\n");
    frame.flags = AXG_FRAME_FD | AXG_FRAME_BIT_RATE_SWITCH;
    EXPECT_EQ(recorded(frame), "(1234.000056) hal 181##10F00\n");
}

TEST(LinuxCncRecord, OnlyHomedSamplesAreRecorded) {
    axg_sample sample{};
    sample.flags = AXG_NOT_HOMED;
    EXPECT_EQ(recorded({}, sample), "");
}

TEST(LinuxCncRecord, WithoutAFileNothingIsRecorded) {
    axg_record_frame(nullptr, nullptr, nullptr);
    axg_record_close(nullptr);
    EXPECT_EQ(axg_record_open("/no/such/folder/run.log"), nullptr);
}

}  // namespace
}  // namespace axg
