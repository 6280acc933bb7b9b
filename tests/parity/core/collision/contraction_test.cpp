// SPDX-License-Identifier: Apache-2.0
// No compiler fuses a product with a sum of its own accord, in any of the ways that this build
// compiles: equal bits rest on it. The unit that may fuse shows that the probe would notice.
#include <gtest/gtest.h>

#include "core/collision/cpu_engine.hpp"
#include "tests/parity/contraction_probe.hpp"

namespace axg::test {
namespace {

void expect_unfused(const Probe& probe, const char* unit) {
    EXPECT_EQ(probe.plain, 0) << unit;
    EXPECT_EQ(probe.plain_double, 0) << unit;
    EXPECT_EQ(probe.of_vectors, 0) << unit;
    EXPECT_EQ(probe.of_rotation, 0) << unit;
    EXPECT_EQ(probe.of_lanes, 0) << unit;
    EXPECT_EQ(probe.fused, 0x1p-24F) << unit << ": what is written as fused is fused";
}

TEST(Contraction, IsOffInEveryUnit) {
    expect_unfused(probe_baseline({}), "baseline");
#if defined(__x86_64__)
    if (has_lane_set(LaneSet::avx2)) {
        expect_unfused(probe_avx2({}), "avx2");
    }
    if (has_lane_set(LaneSet::avx512)) {
        expect_unfused(probe_avx512({}), "avx512");
    }
#endif
}

TEST(Contraction, WouldBeNoticed) {
    if (!has_lane_set(LaneSet::widest)) {
        GTEST_SKIP() << kNoLaneSet;
    }
    const Probe probe = probe_on({});
    EXPECT_EQ(probe.of_lanes, 0x1p-24F);
#if !defined(__clang__) || defined(NDEBUG)  // clang's sanitizers put checks between the two
    EXPECT_EQ(probe.of_vectors, 0x1p-24F);
    EXPECT_EQ(probe.plain, 0x1p-24F);
    EXPECT_EQ(probe.plain_double, 0x1p-54);
    EXPECT_EQ(probe.of_rotation, 0x1p-54);
#endif
}

}  // namespace
}  // namespace axg::test
