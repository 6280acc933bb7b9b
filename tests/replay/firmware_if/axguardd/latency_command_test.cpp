// SPDX-License-Identifier: Apache-2.0
// axguardd latency-test: the verdict from both sides, and that the document says what was done.
#include "firmware_if/axguardd/latency_command.hpp"

#include <gtest/gtest.h>

#include "firmware_if/axguardd/run_command.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

TEST(LatencyTest, AFifthOfThePeriodMayBeLost) {
    EXPECT_EQ(fit_period_us(200'000), 1000);
    EXPECT_EQ(fit_period_us(200'001), 1001);
    EXPECT_EQ(fit_period_us(0), 1);
    EXPECT_EQ(fit_period_us(-5), 1);
}

TEST(LatencyTest, TheDocumentAndTheExitCodeAgree) {
    test::Workshop shop;
    const std::string path = shop.file("latency.json");
    const int code = run_axguardd({"latency-test", "--period-us", "2000", "--seconds", "0.2",
                                   "--priority", "0", "--json=" + path});
    const test::Json report = test::Json::parse_file(path);
    EXPECT_EQ(report["wake_ups"], 100);
    const auto latest_ns = report["late_ns"]["max"].get<std::int64_t>();
    EXPECT_GE(latest_ns, report["late_ns"]["p50"].get<std::int64_t>());
    EXPECT_GT(latest_ns, 0) << "an instant is over when it was waited for";
    EXPECT_EQ(report["fit_period_us"], fit_period_us(latest_ns));
    EXPECT_EQ(code, fit_period_us(latest_ns) <= 2000 ? kExitClean : kExitUnfit);
    EXPECT_DOUBLE_EQ(report["three_over_n"].get<double>(), 0.03);
}

TEST(LatencyTest, RefusesAPeriodOfZero) {
    EXPECT_EQ(run_axguardd({"latency-test", "--period-us", "0"}), kExitUsage);
}

}  // namespace
}  // namespace axg
