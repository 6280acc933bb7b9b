// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/place/path_match.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "core/base/sincos.hpp"
#include "hil_replay/motion/motion_limits.hpp"

namespace axg {
namespace {

constexpr std::size_t kChordsInBox = 64;
constexpr std::size_t kPlacesMax = 64;
// A chord further on has to be nearer by this for each mm of the path, so that the first of equally
// near chords counts. At a reversal the way back is 2 mm further for each mm from the path's end.
constexpr double kMmPerMmAhead = 0.3;
constexpr double kLeastMm = 3 * kMatchWithinMm;  // less is a crossing
constexpr double kDecidedMm = 200;  // after this way along the best place, drop the others
constexpr double kLateMm = 5;       // of the motion, in which the distance from a place is averaged
constexpr double kAlikeMm = 0.02;   // places with no more between them fit alike
constexpr double kWorseMm = 0.1;    // drop a place that is so much farther than the best one
constexpr double kPoorMm = 0.1;     // a best place so far away: there may be a nearer one

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

/// Selects the turn in which an endless axis is nearest to a chord.
void PathMatch::find_turns(std::size_t chord, std::span<double> turns) const {
    for (std::size_t i = 0; i < here_.size(); ++i) {
        const double middle =
            0.5 * (double{path_.point(chord)[i]} + double{path_.point(chord + 1)[i]});
        turns[i] =
            turn_mm_[i] > 0 ? std::round((middle - here_[i]) / turn_mm_[i]) * turn_mm_[i] : 0;
    }
}

/// A lower bound of the distance to a box, for any turn of an endless axis.
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

/// False: the positions have left this place, which does not change.
bool PathMatch::follow(Place& place, double step_mm) const {
    const double reach_mm = 2 * step_mm + kMatchWithinMm;
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
    place.away_mm += std::min(1.0, step_mm / kLateMm) * (best.away_mm - place.away_mm);
    return true;
}

void PathMatch::mark(Place& place, std::int64_t time_us) const {
    const std::uint32_t line = place.along_mm > 0 ? path_.lines[place.chord + 1] : 0;
    if (place.marks.empty() || place.marks.back().line != line) {
        place.marks.push_back({time_us, line});
    }
    ++place.samples;
}

/// Returns the nearest point of each stretch of the path that is near. Stretches behind the last
/// place come first: programs run forward.
std::vector<PathMatch::Place> PathMatch::places_here() const {
    std::vector<Place> places, before;
    Nearest best{.away_mm = std::numeric_limits<double>::max()};
    std::size_t best_chord = 0;
    std::vector<double> turns(here_.size()), best_turns = turns;
    double since_mm = 0;
    const auto end_stretch = [&] {
        if (best.away_mm <= kMatchWithinMm) {
            (best.along_mm >= last_mm_ ? places : before)
                .push_back({.chord = best_chord,
                            .along_mm = best.along_mm,
                            .born_mm = best.along_mm,
                            .away_mm = best.away_mm,
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
    places.insert(places.end(), before.begin(), before.end());
    return places;
}

void PathMatch::find_places() {
    tried_ = here_;
    places_ = places_here();
    while (places_.size() > kPlacesMax) {  // the farthest one, of those the last
        const auto farthest =
            std::max_element(places_.rbegin(), places_.rend(),
                             [](const Place& a, const Place& b) { return a.away_mm < b.away_mm; });
        places_.erase(std::prev(farthest.base()));
    }
}

/// While no place fits well: commits the lines so far, and adds nearer places.
void PathMatch::find_nearer() {
    tried_ = here_;
    const double poor_mm = least_away();
    std::vector<Place> nearer = places_here();
    std::erase_if(nearer, [&](const Place& place) {
        return place.away_mm > poor_mm - kPoorMm / 2 ||
               std::any_of(places_.begin(), places_.end(), [&](const Place& known) {
                   return std::abs(known.along_mm - place.along_mm) < kMatchWithinMm / 2;
               });
    });
    if (nearer.empty()) {
        return;
    }
    commit(best());
    for (Place& place : places_) {
        place.marks.clear();
        place.samples = 0;
    }
    nearer.resize(std::min(nearer.size(), kPlacesMax - places_.size()));
    std::move(nearer.begin(), nearer.end(), std::back_inserter(places_));
}

/// How far a place must have been followed to count, mm; 0 if none was followed for kLeastMm, so
/// that each one counts.
double PathMatch::least_way() const noexcept {
    const bool has_known = std::any_of(places_.begin(), places_.end(), [](const Place& place) {
        return place.way_mm() >= kLeastMm;
    });
    return has_known ? kLeastMm : 0;
}

double PathMatch::least_away() const noexcept {
    const double way_mm = least_way();
    double least = std::numeric_limits<double>::max();
    for (const Place& place : places_) {
        least = place.way_mm() >= way_mm ? std::min(least, place.away_mm) : least;
    }
    return least;
}

/// The first of the places that fit alike.
PathMatch::Place& PathMatch::best() noexcept {
    const double way_mm = least_way(), least = least_away();
    return *std::find_if(places_.begin(), places_.end(), [&](const Place& place) {
        return place.way_mm() >= way_mm && place.away_mm <= least + kAlikeMm;
    });
}

/// Merges places that reached the same point; drops all but the best one after kDecidedMm.
void PathMatch::drop_worse() {
    const Place* const kept = &best();
    const double way_mm = least_way(), least = least_away(), at_mm = kept->along_mm;
    const double born_mm = kept->born_mm;
    const bool is_decided = kept->way_mm() >= kDecidedMm;
    std::vector<Place> left;
    for (Place& place : places_) {
        const bool is_known = place.way_mm() >= way_mm;
        const bool is_alike = place.away_mm <= least + kAlikeMm && place.along_mm != at_mm;
        is_repeated_ = is_repeated_ || (is_decided && is_known && is_alike && born_mm != 0);
        const bool is_left =
            &place == kept || (place.along_mm != at_mm &&
                               !(is_known && (is_decided || place.away_mm > least + kWorseMm)));
        if (is_left) {
            left.push_back(std::move(place));
        }
    }
    places_ = std::move(left);
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
        const auto left = std::stable_partition(
            places_.begin(), places_.end(), [&](Place& place) { return follow(place, step_mm); });
        if (left == places_.begin()) {
            commit(best());
            commit_mark(time_us, 0);
        }
        places_.erase(left, places_.end());
    }
    const bool has_moved = tried_.empty() || distance_mm(here_, tried_) >= kMatchWithinMm / 2;
    if (places_.empty() && has_moved) {
        find_places();
    } else if (!places_.empty() && has_moved && least_away() > kPoorMm) {
        find_nearer();
    }
    if (!places_.empty()) {
        drop_worse();
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
    if (place.way_mm() < kLeastMm) {
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
        const Place& last = best();
        const double least = least_away();
        is_repeated_ =
            is_repeated_ || (last.born_mm != 0 &&
                             std::any_of(places_.begin(), places_.end(), [&](const Place& place) {
                                 return &place != &last && place.away_mm <= least + kAlikeMm;
                             }));
        commit(last);
        places_.clear();
    }
    return marks_;
}

}  // namespace axg
