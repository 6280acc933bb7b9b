// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/place/path_match.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/sincos.hpp"
#include "hil_replay/motion/motion_limits.hpp"

namespace axg {
namespace {

constexpr std::size_t kChordsInBox = 64;
constexpr std::size_t kPlacesMax = 64;
// Of equally near chords the first one: so much nearer a mm further on has to be.
constexpr double kMmPerMmAhead = 0.05;
constexpr double kLeastMm = 3 * kMatchWithinMm;  // less is a crossing
constexpr double kDecidedMm = 200;  // so far along the first place, and the others are given up

double distance_mm(std::span<const double> a, std::span<const double> b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        sum += (a[i] - b[i]) * (a[i] - b[i]);
    }
    return std::sqrt(sum);
}

}  // namespace

PathMatch::PathMatch(ProgramPath path, const Machine& machine)
    : path_(std::move(path)), here_(machine.axes.size()) {
    const MotionLimits limits = make_motion_limits(machine);
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        metric_.push_back(limits.metric[i]);
        turn_mm_.push_back(machine.axes[i].unlimited ? 2 * kPi * limits.metric[i] : 0);
    }
    for (std::size_t first = 0; first + 1 < path_.size(); first += kChordsInBox) {
        Box box{std::vector(metric_.size(), std::numeric_limits<float>::max()),
                std::vector(metric_.size(), std::numeric_limits<float>::lowest())};
        const std::size_t end = std::min(path_.size(), first + kChordsInBox + 1);
        for (std::size_t k = first; k < end; ++k) {
            for (std::size_t i = 0; i < metric_.size(); ++i) {
                box.low[i] = std::min(box.low[i], path_.point(k)[i]);
                box.high[i] = std::max(box.high[i], path_.point(k)[i]);
            }
        }
        boxes_.push_back(std::move(box));
    }
}

/// The nearest point of a chord, not before `from_mm` of the path.
PathMatch::Nearest PathMatch::nearest(std::size_t chord, double from_mm,
                                      std::span<const double> turns) const {
    const std::span<const float> a = path_.point(chord), b = path_.point(chord + 1);
    double dot = 0, square = 0;
    for (std::size_t i = 0; i < here_.size(); ++i) {
        const double way = double{b[i]} - double{a[i]};
        dot += way * (here_[i] + turns[i] - double{a[i]});
        square += way * way;
    }
    const double length_mm = path_.along_mm[chord + 1] - path_.along_mm[chord];
    const double least = std::clamp((from_mm - path_.along_mm[chord]) / length_mm, 0.0, 1.0);
    const double share = std::clamp(dot / square, least, 1.0);
    double sum = 0;
    for (std::size_t i = 0; i < here_.size(); ++i) {
        const double off =
            double{a[i]} + share * (double{b[i]} - double{a[i]}) - (here_[i] + turns[i]);
        sum += off * off;
    }
    return {std::sqrt(sum), path_.along_mm[chord] + share * length_mm};
}

/// To the turn in which an endless axis is nearest to a chord.
void PathMatch::find_turns(std::size_t chord, std::span<double> turns) const {
    for (std::size_t i = 0; i < here_.size(); ++i) {
        const double middle =
            0.5 * (double{path_.point(chord)[i]} + double{path_.point(chord + 1)[i]});
        turns[i] =
            turn_mm_[i] > 0 ? std::round((middle - here_[i]) / turn_mm_[i]) * turn_mm_[i] : 0;
    }
}

/// Whatever the turn of an endless axis.
double PathMatch::away_from(const Box& box) const {
    double sum = 0;
    for (std::size_t i = 0; i < here_.size(); ++i) {
        if (turn_mm_[i] > 0) {
            continue;
        }
        const double off =
            std::max({double{box.low[i]} - here_[i], here_[i] - double{box.high[i]}, 0.0});
        sum += off * off;
    }
    return std::sqrt(sum);
}

/// False: the positions have left this place, which is as it was.
bool PathMatch::follow(Place& place, double reach_mm) const {
    Nearest best{.away_mm = std::numeric_limits<double>::max()};
    double least = best.away_mm;
    std::size_t chord = place.chord;
    for (std::size_t k = place.chord;
         k + 1 < path_.size() && path_.along_mm[k] <= place.along_mm + reach_mm; ++k) {
        const Nearest found = nearest(k, place.along_mm, place.turns);
        const double cost = found.away_mm + kMmPerMmAhead * (found.along_mm - place.along_mm);
        if (cost < least) {
            least = cost;
            best = found;
            chord = k;
        }
    }
    if (best.away_mm > kMatchWithinMm) {
        return false;
    }
    place.chord = chord;
    place.along_mm = best.along_mm;
    return true;
}

void PathMatch::mark(Place& place, std::int64_t time_us) const {
    const std::uint32_t line = place.along_mm > 0 ? path_.lines[place.chord + 1] : 0;
    if (place.marks.empty() || place.marks.back().line != line) {
        place.marks.push_back({time_us, line});
    }
    ++place.samples;
}

/// Wherever the path is near: the nearest point of each stretch of it. Behind the last place first,
/// for programs run forward.
void PathMatch::find_places() {
    std::vector<Place> before;
    Nearest best{.away_mm = std::numeric_limits<double>::max()};
    std::size_t best_chord = 0;
    std::vector<double> turns(here_.size()), best_turns = turns;
    double since_mm = 0;
    const auto end_stretch = [&] {
        if (best.away_mm <= kMatchWithinMm) {
            (best.along_mm >= last_mm_ ? places_ : before)
                .push_back({.chord = best_chord,
                            .along_mm = best.along_mm,
                            .born_mm = best.along_mm,
                            .turns = best_turns});
        }
        best.away_mm = std::numeric_limits<double>::max();
    };
    for (std::size_t k = 0; k + 1 < path_.size(); ++k) {
        if (k % kChordsInBox == 0 && away_from(boxes_[k / kChordsInBox]) > kMatchWithinMm) {
            end_stretch();
            k += kChordsInBox - 1;
            continue;
        }
        find_turns(k, turns);
        const Nearest found = nearest(k, 0, turns);
        const bool is_near = found.away_mm <= kMatchWithinMm;
        if (!is_near ||
            (best.away_mm <= kMatchWithinMm && path_.along_mm[k] > since_mm + 4 * kMatchWithinMm)) {
            end_stretch();
        }
        if (is_near && best.away_mm > kMatchWithinMm) {
            since_mm = path_.along_mm[k];
        }
        if (is_near && found.away_mm < best.away_mm) {
            best = found;
            best_chord = k;
            best_turns = turns;
        }
    }
    end_stretch();
    places_.insert(places_.end(), before.begin(), before.end());
    places_.resize(std::min(places_.size(), kPlacesMax));
}

/// Two that have come to the same point are one.
void PathMatch::drop_repeated() {
    const double first_mm = places_.front().along_mm;
    const bool is_decided = first_mm - places_.front().born_mm >= kDecidedMm;
    places_.erase(std::remove_if(
                      places_.begin() + 1, places_.end(),
                      [&](const Place& place) { return is_decided || place.along_mm == first_mm; }),
                  places_.end());
}

void PathMatch::add(std::int64_t time_us, std::span<const double> position) {
    for (std::size_t i = 0; i < here_.size(); ++i) {
        const double now = position[i] * metric_[i];
        const bool is_endless = turn_mm_[i] > 0 && !before_.empty();
        here_[i] = is_endless ? before_[i] + std::remainder(now - before_[i], turn_mm_[i]) : now;
    }
    ++samples_;
    if (before_.empty()) {
        before_ = here_;
    }
    const double step_mm = distance_mm(here_, before_);
    before_ = here_;
    if (step_mm == 0 && !places_.empty()) {
        for (Place& place : places_) {
            ++place.samples;
        }
        return;
    }
    if (!places_.empty()) {
        const auto left = std::stable_partition(places_.begin(), places_.end(), [&](Place& place) {
            return follow(place, 2 * step_mm + kMatchWithinMm);
        });
        if (left == places_.begin()) {
            commit(places_.front());
            commit_mark(time_us, 0);
        }
        places_.erase(left, places_.end());
    } else if (tried_.empty() || distance_mm(here_, tried_) >= kMatchWithinMm / 2) {
        tried_ = here_;
        find_places();
    }
    if (!places_.empty()) {
        drop_repeated();
        for (Place& place : places_) {
            mark(place, time_us);
        }
    }
}

void PathMatch::commit_mark(std::int64_t time_us, std::uint32_t line) {
    if (marks_.empty() ? line != 0 : marks_.back().line != line) {
        marks_.push_back({time_us, line});
    }
}

void PathMatch::commit(const Place& place) {
    if (place.along_mm - place.born_mm < kLeastMm) {
        return;
    }
    for (const Mark& one : place.marks) {
        commit_mark(one.time_us, one.line);
    }
    matched_ += place.samples;
    last_mm_ = place.along_mm;
}

const std::vector<PathMatch::Mark>& PathMatch::finish() {
    if (!places_.empty()) {
        commit(places_.front());
        places_.clear();
    }
    return marks_;
}

}  // namespace axg
