// SPDX-License-Identifier: Apache-2.0
// What an enforced cap would buy the two near programs, positions alone: at each place the
// certificate is asked with the speed of the axes bounded, and with the program slowed to that
// bound. AXG_COUNT: places of each program.
// Figures: docs/measurements/cap.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "tests/support/count.hpp"
#include "tests/support/example_programs.hpp"
#include "tests/support/program_places.hpp"

namespace axg::test {
namespace {

constexpr std::uint64_t kUsualPlaces = 500;
constexpr double kRapid = 250;  // a cap is in 1/250 of rapid
constexpr std::array kCaps{1, 2, 3, 5, 8, 12, 25, 50, 125, 250};
constexpr std::array<std::uint8_t, 2> kPermitSamples{3, 10};
constexpr double kStepS = 1e-4;
constexpr double kRoomS = 0.1, kRaiseS = 0.01;  // of the control law

struct Place {
    std::size_t at = 0;                    // in the path
    std::array<double, kAxesMax> share{};  // of its largest speed that each axis has, 0 to 1
    double highest = 0;                    // of them
    // The fastest rate of the program that a cap proves, 0: none; all axes bound, and those whose
    // bound costs least.
    double whole = 0, single = 0;
};

/// The rate of the program, 0 to 1, at which the axes of a mask are within a cap.
double rate_within(const Place& place, std::uint32_t mask, double cap) {
    double rate = 1;
    for (std::size_t i = 0; i < place.share.size(); ++i) {
        if ((mask >> i & 1U) != 0 && place.share[i] > 0) {
            rate = std::min(rate, cap / kRapid / place.share[i]);
        }
    }
    return rate;
}

/// A machine whose axes may be bounded, and what its certificate says.
class CappedPlaces {
  public:
    CappedPlaces(LoadedMachine& loaded, const std::vector<MotionSample>& path,
                 std::uint8_t permit_samples)
        : axes_(loaded.machine.axes), path_(path), places_(loaded) {
        loaded.machine.can.permit_samples = {permit_samples, permit_samples};
        for (const Axis& axis : axes_) {
            rapid_.push_back(axis.speed_max);
        }
    }

    [[nodiscard]] Place look(std::size_t at) const {
        Place place;
        place.at = at;
        const AxisPositions& from = path_[at].position;
        const AxisPositions& to = path_[std::min(at + 1, path_.size() - 1)].position;
        for (std::uint32_t i = 0; i < axes_.size(); ++i) {
            place.share[i] = std::abs(to[i] - from[i]) / kStepS / rapid_[i];
            place.highest = std::max(place.highest, place.share[i]);
        }
        return place;
    }

    [[nodiscard]] bool is_proven(const Place& place, std::uint32_t mask, double cap) {
        for (std::uint32_t i = 0; i < axes_.size(); ++i) {
            axes_[i].speed_max = rapid_[i] * ((mask >> i & 1U) != 0 ? cap / kRapid : 1);
        }
        const bool is_proven = places_.is_stoppable(path_, place.at, rate_within(place, mask, cap));
        for (std::uint32_t i = 0; i < axes_.size(); ++i) {
            axes_[i].speed_max = rapid_[i];
        }
        return is_proven;
    }
    [[nodiscard]] std::uint32_t all_axes() const { return (1U << axes_.size()) - 1; }

  private:
    std::vector<Axis>& axes_;
    std::vector<double> rapid_;
    const std::vector<MotionSample>& path_;
    Places places_;
};

/// How long the program takes where the cap falls in time and rises by the control law: to the
/// rates given at a deceleration of the softest axis, and up by 1/32 every 10 ms after 100 ms.
double seconds_by_law(const Machine& machine, const std::vector<Place>& places, double place_s,
                      double Place::*rate) {
    double braking = HUGE_VAL;  // of the share of rapid, 1/s
    for (const Axis& axis : machine.axes) {
        braking = std::min(braking, axis.acceleration_max / axis.speed_max);
    }
    std::vector<double> most(places.size(), 1);  // share of rapid
    double ahead = 1;
    for (std::size_t i = places.size(); i-- > 0;) {
        const Place& place = places[i];
        const double allowed =
            place.*rate < 1 ? std::max(1 / kRapid, place.*rate * place.highest) : 1;
        // Back along the path by so much of the way at full speed, and by the lead.
        const double square = ahead * ahead + 2 * braking * place.highest * place_s;
        ahead = std::min(allowed, std::sqrt(square));
        most[i] = ahead;
    }
    double cap = 1, taken_s = 0, room_s = 0, raised_s = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
        const double share = places[i].highest;
        double left = 1;  // of this place
        while (left > 1e-12) {
            if (cap > most[i]) {
                cap = most[i];
                room_s = 0;
            }
            const double speed = share > cap ? cap / share : 1;
            const double step_s = std::min(1e-3, left * place_s / speed);
            left -= step_s * speed / place_s;
            taken_s += step_s;
            room_s = most[i] >= cap * 9 / 8 || most[i] >= 1 ? room_s + step_s : 0;
            raised_s += step_s;
            if (room_s >= kRoomS && raised_s >= kRaiseS) {
                cap = std::min(1.0, cap + std::max(1 / kRapid, cap / 32));
                raised_s = 0;
            }
        }
    }
    return taken_s;
}

struct Totals {
    std::array<std::uint64_t, kCaps.size()> open{};  // all axes bound
    std::uint64_t never = 0;
    double whole_s = 0, single_s = 0;  // lost where each place is passed as fast as is proven
};

/// What a slower cap proves is not asked again of a place that a faster one proves.
void look_at(CappedPlaces& machine, Place& place, Totals& totals) {
    const std::uint32_t all = machine.all_axes();
    for (std::size_t c = kCaps.size(); c-- > 0 && place.whole == 0;) {
        if (machine.is_proven(place, all, kCaps[c])) {
            place.whole = rate_within(place, all, kCaps[c]);
        } else {
            ++totals.open[c];
        }
    }
    place.single = place.whole;
    for (std::size_t c = 0; c < kCaps.size() && place.single < 1; ++c) {
        for (std::uint32_t mask = 1; mask < all; ++mask) {
            const double rate = rate_within(place, mask, kCaps[c]);
            if (rate > place.single && machine.is_proven(place, mask, kCaps[c])) {
                place.single = rate;
            }
        }
    }
    totals.never += place.whole == 0 ? 1 : 0;
}

class CapPlaces : public testing::TestWithParam<Example> {};

TEST_P(CapPlaces, ACrawlIsProvenWhereTheProgramsSpeedIsNot) {
    const std::uint64_t looks = count_from_environment(kUsualPlaces);
    for (const std::uint8_t permit_samples : kPermitSamples) {
        LoadedMachine loaded;
        ASSERT_TRUE(load_example(GetParam().machine, loaded));
        const std::vector<MotionSample> path =
            path_of(read_example(GetParam().program, loaded.machine), loaded.machine);
        CappedPlaces machine(loaded, path, permit_samples);
        const double whole_s = static_cast<double>(path.size()) * kStepS;
        const double place_s = whole_s / static_cast<double>(looks);
        Totals totals;
        std::vector<Place> places;
        for (std::uint64_t i = 0; i < looks; ++i) {
            places.push_back(machine.look(i * path.size() / looks));
            Place& place = places.back();
            look_at(machine, place, totals);
            totals.whole_s += place_s * (place.whole > 0 ? 1 / place.whole - 1 : 0);
            totals.single_s += place_s * (place.single > 0 ? 1 / place.single - 1 : 0);
        }
        std::printf("%s, n = %u, %llu places, %.2f s:\n", GetParam().program, permit_samples,
                    static_cast<unsigned long long>(looks), whole_s);
        for (std::size_t c = 0; c < kCaps.size(); ++c) {
            double slowed_s = 0;
            for (const Place& place : places) {
                slowed_s += place_s * (1 / rate_within(place, machine.all_axes(), kCaps[c]) - 1);
            }
            std::printf("  cap %3d: %6llu not proven; the whole program so slow loses %.1f s\n",
                        kCaps[c], static_cast<unsigned long long>(totals.open[c]), slowed_s);
        }
        std::printf(
            "  each place as fast as proven loses %.2f s with one factor, %.2f s with the "
            "best axes; never proven %llu; by the law %.2f s, %.2f s\n",
            totals.whole_s, totals.single_s, static_cast<unsigned long long>(totals.never),
            seconds_by_law(loaded.machine, places, place_s, &Place::whole) - whole_s,
            seconds_by_law(loaded.machine, places, place_s, &Place::single) - whole_s);
        EXPECT_GT(totals.open.back(), 0U) << "nothing is near: nothing would be shown";
        EXPECT_LT(totals.open.front(), totals.open.back());
    }
}

INSTANTIATE_TEST_SUITE_P(Near, CapPlaces, testing::Values(kExamples[1], kExamples[4]),
                         [](const auto& example) { return name_of(example.param); });

}  // namespace
}  // namespace axg::test
