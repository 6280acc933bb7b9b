// SPDX-License-Identifier: Apache-2.0
// The verdict of an admission from its figures: each bound from both sides, and that what is not
// known, or is no number, is never fit.
#include "firmware_if/axguardd/admission.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <regex>
#include <string>
#include <vector>

#include "firmware_if/live/metrics.hpp"

namespace axg {
namespace {

TimeLimits limits(std::uint32_t deadline_us) {
    Machine machine;
    machine.deadline_us = deadline_us;
    return time_limits(machine);
}

/// 1000 Hz with a deadline of 500 us, and room in everything.
AdmissionFigures healthy() {
    AdmissionFigures figures;
    figures.times = limits(500);
    figures.system = {{Fitness::ok, "kernel", "PREEMPT_RT", ""},
                      {Fitness::warn, "throttling", "on", "sysctl"}};
    figures.wake_ups = {2000, 20'000, 50'000};
    figures.cycles = {"cpu, neon lanes", 128, 100, 180, 900, 512, 0};
    figures.passes_known_answer = true;
    figures.memory = {1'000'000, 12'000'000, 4'000'000'000, 90'000'000, ~std::uint64_t{0}, 0};
    return figures;
}

std::vector<std::string> failed(const AdmissionVerdict& verdict) {
    std::vector<std::string> names;
    for (const AdmissionLine& line : verdict.lines) {
        if (!line.is_passed) {
            names.emplace_back(to_text(line.check));
            EXPECT_NE(line.mend, "") << names.back() << ": " << line.found;
        } else {
            EXPECT_EQ(line.mend, "") << to_text(line.check);
        }
        EXPECT_NE(line.found, "") << to_text(line.check);
    }
    EXPECT_EQ(names.empty(), verdict.is_fit());
    return names;
}

using Names = std::vector<std::string>;

Names failed_with(const std::function<void(AdmissionFigures&)>& change) {
    AdmissionFigures figures = healthy();
    change(figures);
    return failed(judge_admission(figures));
}

TEST(Admission, AFitMachineHasTheMarginOfItsTightestCheck) {
    const AdmissionVerdict verdict = judge_admission(healthy());
    EXPECT_EQ(failed(verdict), Names{});
    // latency 1 - 50/200, engine 1 - 180/450, cycle 1 - (2 * 50 + 180)/500
    EXPECT_DOUBLE_EQ(verdict.margin, 1 - 280.0 / 500);
    EXPECT_EQ(to_text(verdict), "fit for 1000 Hz with margin 44 % (cycle)");
    EXPECT_TRUE(verdict.is_waived_by({}));
}

TEST(Admission, WhatWasNotMeasuredHasFailed) {
    AdmissionFigures nothing;
    nothing.times = limits(500);
    EXPECT_EQ(failed(judge_admission(nothing)),
              (Names{"system", "latency", "engine", "cycle", "known_answer", "memory"}));
    EXPECT_EQ(failed_with([](auto& f) { f.system.reset(); }), Names{"system"});
    EXPECT_EQ(failed_with([](auto& f) { f.system->clear(); }), Names{"system"});
    EXPECT_EQ(failed_with([](auto& f) { f.wake_ups.reset(); }), (Names{"latency", "cycle"}));
    EXPECT_EQ(failed_with([](auto& f) { f.wake_ups->count = 0; }), (Names{"latency", "cycle"}));
    EXPECT_EQ(failed_with([](auto& f) { f.cycles.reset(); }), (Names{"engine", "cycle"}));
    EXPECT_EQ(failed_with([](auto& f) { f.cycles->proven_count = 0; }), (Names{"engine", "cycle"}))
        << "a machine that is never proven says nothing about how long a proof takes";
    EXPECT_EQ(failed_with([](auto& f) { f.passes_known_answer.reset(); }), Names{"known_answer"});
    EXPECT_EQ(failed_with([](auto& f) { f.memory.reset(); }), Names{"memory"});
    EXPECT_EQ(failed_with([](auto& f) { f.memory->available_bytes = 0; }), Names{"memory"});
    const double not_a_number = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(failed_with([&](auto& f) { f.cycles->longest_us = not_a_number; }), Names{"engine"});
    EXPECT_EQ(failed_with([&](auto& f) { f.cycles->proven_us = not_a_number; }),
              (Names{"engine", "cycle"}));
}

TEST(Admission, TheLongestCycleIsNamedWithItsPlan) {
    AdmissionFigures figures = healthy();
    figures.cycles->worst_case_us = 440;
    figures.cycles->plan = CyclePlan{};
    const AdmissionVerdict verdict = judge_admission(figures);
    EXPECT_NE(verdict.lines[2].found.find("worst case 440 us (2 stages, 0 queries after the first"),
              std::string::npos)
        << verdict.lines[2].found;
}

TEST(Admission, EachBoundFromBothSides) {
    EXPECT_EQ(failed_with([](auto& f) { f.system->front().fitness = Fitness::bad; }),
              Names{"system"});
    EXPECT_EQ(failed_with([](auto& f) {
                  f.times = limits(900);
                  f.wake_ups->latest_ns = 200'000;
              }),
              Names{});
    EXPECT_EQ(failed_with([](auto& f) {
                  f.times = limits(900);
                  f.wake_ups->latest_ns = 200'001;
              }),
              Names{"latency"});
    const auto engine_us = [](double us) {
        return [us](AdmissionFigures& f) {
            f.wake_ups->latest_ns = 1000;
            f.cycles->proven_us = us;
        };
    };
    EXPECT_EQ(failed_with(engine_us(450)), Names{});
    EXPECT_EQ(failed_with(engine_us(450.5)), Names{"engine"});
    EXPECT_EQ(failed_with([](auto& f) { f.cycles->worst_case_us = 451; }),
              (Names{"engine", "cycle"}))
        << "the constructed longest cycle has the deadline too";
    EXPECT_EQ(failed_with([](auto& f) { f.cycles->proven_us = 400; }), Names{});
    EXPECT_EQ(failed_with([](auto& f) { f.cycles->proven_us = 400.5; }), Names{"cycle"});
    EXPECT_EQ(failed_with([](auto& f) { f.cycles->longest_us = 2999; }), Names{});
    EXPECT_EQ(failed_with([](auto& f) { f.cycles->longest_us = 3000; }), Names{"engine"});
    EXPECT_EQ(failed_with([](auto& f) { f.passes_known_answer = false; }), Names{"known_answer"});
    EXPECT_EQ(failed_with([](auto& f) { f.memory->available_bytes = 12'000'000; }), Names{});
    EXPECT_EQ(failed_with([](auto& f) { f.memory->available_bytes = 11'999'999; }),
              Names{"memory"});
    EXPECT_EQ(failed_with([](auto& f) { f.memory->lock_limit_bytes = 102'000'000; }), Names{});
    EXPECT_EQ(failed_with([](auto& f) { f.memory->lock_limit_bytes = 101'999'999; }),
              Names{"memory"});
    EXPECT_EQ(failed_with([](auto& f) { f.memory->lock_limit_bytes = 8'000'000; }), Names{"memory"})
        << "less than is mapped already";
}

TEST(Admission, TheVerdictSaysWhyAndWhatToChange) {
    AdmissionFigures figures = healthy();
    figures.wake_ups->latest_ns = 706'500;
    figures.system->push_back(
        {Fitness::bad, "priority", "limit 0 (expected at least 80)", "ulimit -r 99"});
    const AdmissionVerdict verdict = judge_admission(figures);
    EXPECT_EQ(to_text(verdict), "not fit for 1000 Hz: system, latency, cycle");
    EXPECT_EQ(verdict.margin, 0);
    EXPECT_EQ(verdict.lines[0].found, "priority: limit 0 (expected at least 80)");
    EXPECT_EQ(verdict.lines[0].mend, "ulimit -r 99");
    EXPECT_EQ(verdict.lines[1].found,
              "worst wake-up latency 706.5 us, limit 200.0 us (2000 samples)");
    EXPECT_NE(verdict.lines[1].mend.find("raise can.sample_us (latency allows 3533 us)"),
              std::string::npos)
        << verdict.lines[1].mend;
    EXPECT_NE(verdict.lines[3].mend.find("raise deadline_us to 1593 or more"), std::string::npos)
        << verdict.lines[3].mend;
}

// What a machine file is told to say has to be something that a machine file may say.
TEST(Admission, EachKeyThatIsNamedIsOne) {
    AdmissionFigures figures = healthy();
    figures.wake_ups->latest_ns = 706'500;
    figures.cycles->proven_us = 800;
    const AdmissionVerdict slow = judge_admission(figures);
    figures.cycles->longest_us = 4000;
    const AdmissionVerdict lasting = judge_admission(figures);
    std::ifstream file(AXG_SOURCE_DIR "/config/schema/machine.schema.json");
    const std::string schema{std::istreambuf_iterator<char>(file), {}};
    const std::regex key("[a-z]+(_[a-z0-9]+)+");
    std::size_t keys = 0;
    for (const AdmissionVerdict* const verdict : {&slow, &lasting}) {
        for (const AdmissionLine& line : verdict->lines) {
            for (std::sregex_iterator at(line.mend.begin(), line.mend.end(), key), end; at != end;
                 ++at, ++keys) {
                EXPECT_NE(schema.find('"' + at->str() + '"'), std::string::npos) << line.mend;
            }
        }
    }
    EXPECT_GT(keys, 4U);
}

TEST(Admission, OnlyNamesOfAllThatFailedWaiveIt) {
    AdmissionFigures figures = healthy();
    figures.wake_ups->latest_ns = 706'500;
    const AdmissionVerdict verdict = judge_admission(figures);
    EXPECT_FALSE(verdict.is_waived_by({}));
    EXPECT_FALSE(verdict.is_waived_by({"latency"}));
    EXPECT_FALSE(verdict.is_waived_by({"system", "engine", "memory", "cycle"}));
    EXPECT_TRUE(verdict.is_waived_by({"cycle", "latency"}));
    EXPECT_FALSE(verdict.is_fit()) << "waived is not fit";
    const AdmissionGauge gauge = gauge_of(verdict);
    EXPECT_FALSE(gauge.is_fit);
    EXPECT_EQ(gauge.failed, 1U << 1 | 1U << 3) << "latency, cycle";
}

}  // namespace
}  // namespace axg
