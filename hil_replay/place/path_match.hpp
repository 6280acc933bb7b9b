// SPDX-License-Identifier: Apache-2.0
// Finds the place of recorded positions on a program's path. It follows several places at once,
// because a path may cross itself or repeat: it drops a place that the positions leave, until one
// remains. Limits: docs/guide/report.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "hil_replay/place/program_path.hpp"

namespace axg {

inline constexpr double kMatchWithinMm = 1.0;

class PathMatch {
  public:
    struct Mark {
        std::int64_t time_us = 0;
        std::uint32_t line = 0;  // 0: not on the path, or before its first move
    };

    /// @param path  with one point at least
    PathMatch(ProgramPath path, const Machine& machine);

    /// In order of time.
    /// @param position  mm or rad, an axis each; of an endless axis any turn
    void add(std::int64_t time_us, std::span<const double> position);
    /// After the last sample, once: from when each line runs, up to the next one's time.
    [[nodiscard]] const std::vector<Mark>& finish();

    [[nodiscard]] std::uint64_t samples() const noexcept { return samples_; }
    /// The samples on the path.
    [[nodiscard]] std::uint64_t matched() const noexcept { return matched_; }
    /// Another pass fitted as well as the first one somewhere; the lines are those of the first.
    [[nodiscard]] bool is_repeated() const noexcept { return is_repeated_; }

  private:
    struct Place {
        std::size_t chord = 0;  // from this point to the next
        double along_mm = 0, born_mm = 0;
        double away_mm = 0;           // of late
        std::vector<double> turns{};  // [axes] path mm from the positions to the program's
        std::uint64_t samples = 0;
        std::vector<Mark> marks{};

        [[nodiscard]] double way_mm() const noexcept { return along_mm - born_mm; }
    };
    struct Box {
        std::vector<float> low{}, high{};
    };
    struct Nearest {
        double away_mm = 0, along_mm = 0;
    };

    [[nodiscard]] Nearest nearest(std::size_t chord, double from_mm,
                                  std::span<const double> turns) const;
    void find_turns(std::size_t chord, std::span<double> turns) const;
    [[nodiscard]] double away_from(const Box& box) const;
    [[nodiscard]] bool follow(Place& place, double step_mm) const;
    void mark(Place& place, std::int64_t time_us) const;
    [[nodiscard]] std::vector<Place> places_here() const;
    void find_places();
    void find_nearer();
    [[nodiscard]] double least_way() const noexcept;
    [[nodiscard]] double least_away() const noexcept;
    [[nodiscard]] Place& best() noexcept;
    void drop_worse();
    void commit(const Place& place);
    void commit_mark(std::int64_t time_us, std::uint32_t line);

    ProgramPath path_;
    std::vector<double> metric_, turn_mm_;       // [axes]; a turn of an endless axis, 0 of others
    std::vector<Box> boxes_;                     // of kChordsInBox chords each
    std::vector<double> here_, before_, tried_;  // [axes] path mm, an endless axis without jumps
    std::vector<Place> places_;                  // in order of preference
    std::vector<Mark> marks_;
    double last_mm_ = 0;  // where the last place was left
    std::uint64_t samples_ = 0, matched_ = 0;
    bool is_repeated_ = false;
};

}  // namespace axg
