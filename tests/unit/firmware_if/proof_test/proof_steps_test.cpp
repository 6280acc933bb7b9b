// SPDX-License-Identifier: Apache-2.0
// What each step of a proof test accepts of a guard's state, and what looks like it and is not.
#include "firmware_if/proof_test/proof_steps.hpp"

#include <gtest/gtest.h>

namespace axg {
namespace {

GuardSight sight(const std::string& phase, const std::string& cause = "none") {
    GuardSight out;
    out.phase = phase;
    out.cause = cause;
    out.has_view = true;
    out.age_ms = 3;
    return out;
}

StepEnd judged(std::string_view name, const GuardSight& now, bool was_gone = false,
               std::string_view pair = "") {
    const GuardSight before = sight("ready");
    for (const ProofStep& step : proof_steps()) {
        if (step.name == name) {
            return step.judge({.now = now, .before = before, .was_gone = was_gone, .pair = pair});
        }
    }
    ADD_FAILURE() << name;
    return StepEnd::failed;
}

TEST(ProofSteps, ArmedMeansPermitsSinceTheStepBegan) {
    GuardSight now = sight("armed");
    EXPECT_EQ(judged("armed", now), StepEnd::waiting);
    now.permits = 1;
    EXPECT_EQ(judged("armed", now), StepEnd::passed);
    now.age_ms = 1000;
    EXPECT_EQ(judged("armed", now), StepEnd::passed);
    now.age_ms = 1001;  // the guard that shows this stands still
    EXPECT_EQ(judged("armed", now), StepEnd::waiting);
    now = sight("ready");
    now.permits = 1;
    EXPECT_EQ(judged("armed", now), StepEnd::waiting);
}

TEST(ProofSteps, OnlyAVerdictAboutTheExpectedPairProvesThePlace) {
    GuardSight now = sight("stopped", "verdict");
    EXPECT_EQ(judged("place", now), StepEnd::failed);  // left_limits: no pair
    now.pair = "cutter - block";
    EXPECT_EQ(judged("place", now), StepEnd::passed);
    EXPECT_EQ(judged("place", now, false, "cutter - block"), StepEnd::passed);
    EXPECT_EQ(judged("place", now, false, "cutter - plate"), StepEnd::failed);
    now.cause = "silence";
    EXPECT_EQ(judged("place", now), StepEnd::failed);
    EXPECT_EQ(judged("place", sight("armed")), StepEnd::waiting);
}

TEST(ProofSteps, RestIsStandingConfirmedAndStillStopped) {
    GuardSight now = sight("stopped", "verdict");
    now.stands = true;
    EXPECT_EQ(judged("rest", now), StepEnd::waiting);
    now.is_confirmed = true;
    EXPECT_EQ(judged("rest", now), StepEnd::passed);
    now.stands = false;
    EXPECT_EQ(judged("rest", now), StepEnd::waiting);
    EXPECT_EQ(judged("rest", sight("selftest")), StepEnd::failed);
}

TEST(ProofSteps, AVerdictIsNoBrokenBus) {
    for (const char* cause : {"input", "silence", "output"}) {
        EXPECT_EQ(judged("plug", sight("stopped", cause)), StepEnd::passed) << cause;
    }
    for (const char* cause : {"verdict", "engine", "gap", "latched", "foreign_stop"}) {
        EXPECT_EQ(judged("plug", sight("stopped", cause)), StepEnd::failed) << cause;
    }
    EXPECT_EQ(judged("plug", sight("armed")), StepEnd::waiting);
}

TEST(ProofSteps, AGuardThatComesBackUnlatchedFails) {
    EXPECT_EQ(judged("killed", sight("stopped", "latched"), false), StepEnd::waiting);
    EXPECT_EQ(judged("killed", sight("stopped", "latched"), true), StepEnd::passed);
    EXPECT_EQ(judged("killed", sight("selftest"), true), StepEnd::failed);
    EXPECT_EQ(judged("killed", sight("stopped", "input"), true), StepEnd::failed);
    GuardSight unshown = sight("init");
    unshown.has_view = false;
    EXPECT_EQ(judged("killed", unshown, true), StepEnd::waiting);
}

TEST(ProofSteps, ALineWithoutAKeyIsNotRead) {
    const std::string line =
        R"({"bus":"can0","machine":"m","configuration_sha256":"a","phase":"stopped","age_ms":3,)"
        R"("permits":5,"cause":"verdict","reason":"predicted","pair":["a","b\u001b"],)"
        R"("withheld":"nothing","withheld_pair":null,"stands":true,"confirmed":true})";
    const std::optional<GuardSight> read = sight_of(line);
    ASSERT_TRUE(read);
    EXPECT_EQ(summary_of(*read), "stopped: verdict: predicted: a - b\\x1b");
    for (const char* key : {"bus", "phase", "permits", "pair", "stands", "confirmed", "cause"}) {
        std::string other = line;
        other.replace(other.find("\"" + std::string(key) + "\"") + 1, 1, "_");
        EXPECT_FALSE(sight_of(other)) << key;
    }
    EXPECT_FALSE(sight_of("{"));
}

TEST(ProofSteps, SummaryNamesWhyThereIsNoPermit) {
    GuardSight now = sight("selftest");
    now.withheld = "not proven";
    now.withheld_pair = "a - b";
    EXPECT_EQ(summary_of(now), "selftest, no permit: not proven: a - b");
    now.withheld = "nothing";
    EXPECT_EQ(summary_of(now), "selftest");
}

}  // namespace
}  // namespace axg
