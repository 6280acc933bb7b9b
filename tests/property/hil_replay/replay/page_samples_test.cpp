// SPDX-License-Identifier: Apache-2.0
// Rows of a page against the samples that they stand for: the least and the most of every column,
// and of the sample of least clearance what is shown; for runs of any length.
#include "hil_replay/replay/page_samples.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "hil_replay/page/run_page.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/seed.hpp"

namespace axg::test {
namespace {

Machine small_machine() {
    Machine machine;
    machine.axes = {{.name = "X", .speed_max = 100},
                    {.name = "C", .kind = AxisKind::rotary, .unlimited = true, .speed_max = 10}};
    for (const char* name : {"a", "b</script>", "c"}) {
        machine.bodies.emplace_back().name = name;
    }
    machine.pairs = {{.a = 0, .b = 1, .margin_mm = 1}, {.a = 1, .b = 2, .margin_mm = 2}};
    return machine;
}

struct Sample {
    AxisSnapshot snapshot;
    PageCycle cycle;
    std::vector<double> clearances_mm;
};

Sample random_sample(std::mt19937_64& random, std::uint64_t index) {
    std::uniform_real_distribution<double> number(-3, 3);
    Sample out;
    out.snapshot.axis_count = 2;
    out.snapshot.latched_us = static_cast<std::int64_t>(index) * 1000;
    out.snapshot.arrived_us = out.snapshot.latched_us + 100;
    out.snapshot.position[0] = number(random);
    out.snapshot.position[1] = number(random);
    out.cycle.has_permit = random() % 4 != 0;
    out.cycle.valid_periods = static_cast<std::uint8_t>(3 + random() % 10);
    out.cycle.cap = static_cast<std::uint8_t>(random() % 251);
    out.cycle.spent_ns = 1000 + static_cast<std::int64_t>(random() % 100'000);
    for (int i = 0; i < 2; ++i) {
        const double mm = 20 * std::abs(number(random));
        out.clearances_mm.push_back(mm < 50 ? mm : kNotNear);
    }
    return out;
}

double least_clearance(const Sample& sample) {
    return std::min(sample.clearances_mm[0], sample.clearances_mm[1]);
}

std::size_t column_of(const PageSamples& page, const char* name) {
    std::size_t i = 0;
    while (i < page.columns().size() && page.columns()[i].name != name) {
        ++i;
    }
    return i;
}

void expect_row(const PageSamples& page, std::size_t row, std::span<const Sample> samples) {
    const auto at = [&](const char* name) { return page.row(row)[column_of(page, name)]; };
    const auto least = [&](auto value) {
        double out = kNotNear;
        for (const Sample& sample : samples) {
            out = std::min(out, value(sample));
        }
        return out;
    };
    const auto nearest = std::min_element(
        samples.begin(), samples.end(),
        [](const Sample& a, const Sample& b) { return least_clearance(a) < least_clearance(b); });
    EXPECT_EQ(at("clearance_mm"), least_clearance(*nearest));
    EXPECT_EQ(at("time_s"), static_cast<double>(nearest->snapshot.arrived_us) * 1e-6);
    EXPECT_EQ(at("X_mm"), nearest->snapshot.position[0]);
    const auto x = [](const Sample& s) { return s.snapshot.position[0]; };
    EXPECT_EQ(at("X_least_mm"), least(x));
    EXPECT_EQ(at("X_most_mm"), -least([&](const Sample& s) { return -x(s); }));
    EXPECT_EQ(at("permit"), least([](const Sample& s) { return s.cycle.has_permit ? 1.0 : 0.0; }));
    EXPECT_EQ(at("valid_periods"),
              least([](const Sample& s) { return static_cast<double>(*s.cycle.valid_periods); }));
    EXPECT_EQ(at("cap_percent"), least([](const Sample& s) { return 100.0 * *s.cycle.cap / 250; }));
    EXPECT_EQ(at("cycle_us"), -least([](const Sample& s) {
                  return -static_cast<double>(s.cycle.spent_ns) * 1e-3;
              }));
    EXPECT_EQ(at("pair_1_mm"), least([](const Sample& s) { return s.clearances_mm[1]; }));
}

TEST(PageSamples, ARowKeepsTheLeastAndTheMostOfItsSamples) {
    std::mt19937_64 random(printed_seed(20261121));
    const Machine machine = small_machine();
    constexpr std::size_t kRows = 16;
    for (std::size_t count = 1; count <= 20 * kRows; count += 1 + count / 7) {
        SCOPED_TRACE(count);
        PageSamples page(machine, kRows);
        std::vector<Sample> samples;
        for (std::size_t i = 0; i < count; ++i) {
            samples.push_back(random_sample(random, i));
            page.add(samples.back().snapshot, samples.back().cycle,
                     {.mm = samples.back().clearances_mm});
        }
        ASSERT_EQ(page.samples(), count);
        ASSERT_LE(page.rows(), kRows);
        ASSERT_EQ(page.rows(), (count + page.stride() - 1) / page.stride());
        ASSERT_TRUE(count < kRows || page.rows() >= kRows / 2) << "rows were wasted";
        for (std::size_t row = 0; row < page.rows(); ++row) {
            const std::size_t first = row * page.stride();
            const std::size_t size = std::min<std::size_t>(page.stride(), count - first);
            expect_row(page, row, std::span(samples).subspan(first, size));
        }
    }
}

TEST(PageSamples, EachSampleAboutALossOfThePermitHasARowAndNoExtremeIsLost) {
    std::mt19937_64 random(printed_seed(20261123));
    const Machine machine = small_machine();
    for (const std::size_t lost : {std::size_t{10}, std::size_t{3000}, std::size_t{4999}}) {
        SCOPED_TRACE(lost);
        PageSamples page(machine, 64);
        std::vector<Sample> samples;
        for (std::size_t i = 0; i < 5000; ++i) {
            samples.push_back(random_sample(random, i));
            samples.back().cycle.has_permit = i < lost;
            page.add(samples.back().snapshot, samples.back().cycle,
                     {.mm = samples.back().clearances_mm});
        }
        page.finish();
        std::vector<double> times;
        for (std::size_t row = 0; row < page.rows(); ++row) {
            times.push_back(page.row(row)[0]);
        }
        EXPECT_TRUE(std::is_sorted(times.begin(), times.end()));
        const auto expect_own_row = [&](std::size_t i) {
            const double time_s = static_cast<double>(samples[i].snapshot.arrived_us) * 1e-6;
            for (std::size_t row = 0; row < page.rows(); ++row) {
                if (page.row(row)[0] == time_s && page.row(row)[column_of(page, "X_least_mm")] ==
                                                      page.row(row)[column_of(page, "X_most_mm")]) {
                    return;
                }
            }
            ADD_FAILURE() << "sample " << i << " shares its row";
        };
        for (std::size_t i = lost - std::min(lost, kDetailBefore - 1);
             i < std::min(samples.size(), lost + kDetailAfter + 1); ++i) {
            expect_own_row(i);
        }
        for (std::size_t i = samples.size() - kDetailBefore; i < samples.size(); ++i) {
            expect_own_row(i);
        }
        for (const char* name : {"clearance_mm", "X_least_mm", "C_least_deg", "pair_0_mm",
                                 "pair_1_mm", "X_least_mm_s"}) {
            double kept = kNotNear, given = kNotNear;
            for (std::size_t row = 0; row < page.rows(); ++row) {
                kept = std::fmin(kept, page.row(row)[column_of(page, name)]);
            }
            PageSamples whole(machine, 8192);
            for (const Sample& sample : samples) {
                whole.add(sample.snapshot, sample.cycle, {.mm = sample.clearances_mm});
            }
            for (std::size_t row = 0; row < whole.rows(); ++row) {
                given = std::fmin(given, whole.row(row)[column_of(whole, name)]);
            }
            EXPECT_EQ(kept, given) << name;
        }
        EXPECT_LE(page.rows(), 64 + kDetailsMax * (kDetailBefore + kDetailAfter));
    }
}

TEST(PageSamples, AnEndlessAxisGoesTheShortWayRound) {
    const Machine machine = small_machine();
    PageSamples page(machine, 4);
    AxisSnapshot snapshot{.axis_count = 2};
    snapshot.position[1] = 6.2;
    page.add(snapshot, {}, {});
    snapshot.latched_us = 1000;
    snapshot.position[1] = 0.1;
    page.add(snapshot, {}, {});
    const double turned_deg = (0.1 - 6.2 + 2 * 3.141592653589793) * 180 / 3.141592653589793;
    EXPECT_NEAR(page.row(1)[column_of(page, "C_most_deg_s")], turned_deg / 1e-3, 1e-6);
    EXPECT_TRUE(std::isnan(page.row(0)[column_of(page, "C_most_deg_s")])) << "there is none before";
}

TEST(RunPage, NoNameClosesTheScriptThatHoldsTheData) {
    LoadedMachine loaded;
    loaded.machine = small_machine();
    loaded.meshes.bodies.resize(3);
    loaded.meshes.bodies[0].triangles = {{{0, 0, 0}, {0.1F, 0, 0}, {0, 1, 0}},
                                         {{0.1F, 0, 0}, {0, 0, 0}, {0, 0, 1}}};
    const PageSamples samples(loaded.machine, 4);
    const RunPage page{loaded, samples, nullptr, 500, "</script><b>", "\xff words", "[]"};
    const std::string text = page_data(page);
    EXPECT_EQ(text.find('<'), std::string::npos);
    const auto data = Json::parse(text);
    EXPECT_EQ(data["title"], "</script><b>");
    EXPECT_EQ(data["machine"]["bodies"][1]["name"], "b</script>");
    EXPECT_EQ(data["samples"]["rows"], 0);
    // Each corner once; the float as it is.
    EXPECT_EQ(data["body_meshes"][0]["corners"], Json::array({0, 1, 2, 1, 0, 3}));
    EXPECT_EQ(data["body_meshes"][0]["points"][3].get<float>(), 0.1F);
}

}  // namespace
}  // namespace axg::test
