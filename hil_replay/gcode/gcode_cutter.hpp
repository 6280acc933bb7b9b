// SPDX-License-Identifier: Apache-2.0
// Cutter compensation: the path of the tool's centre beside a contour of lines and arcs. Around an
// outer corner runs an arc about it; at an inner one both moves end where their parallels meet.
// Source of the rules: LinuxCNC, "Cutter Compensation" and the answers of its interpreter (2.9);
// tests/oracle/cutter_test.py compares them.
#pragma once

#include <string>
#include <vector>

#include "hil_replay/gcode/plane_point.hpp"
#include "hil_replay/motion/program.hpp"

namespace axg {

class CutterPath {
  public:
    struct Settings {
        bool is_left = true;
        double radius_mm = 0;     // 0: the contour is the path
        double unit_mm = 1;       // of the program: LinuxCNC's tolerances are in it
        std::uint32_t first = 0;  // axes of the plane
        std::uint32_t second = 0;
        std::uint32_t third = kNoIndex;  // the linear axis across it
    };

    void start(const Settings& settings);
    [[nodiscard]] const Settings& settings() const { return settings_; }
    /// Between G41 or G42 and G40.
    [[nodiscard]] bool is_on() const { return is_on_; }
    /// The programmed position is another than that of the tool's centre.
    [[nodiscard]] bool is_beside() const { return is_on_ && !is_first_; }

    /// Adds a programmed move. Its end is known only with the next one, so it comes out later.
    /// @param from   the programmed position before it
    /// @param turns  of an arc, clockwise below 0
    /// @param out    moves that are complete, in order; only the ends of their arcs and the centres
    /// are meant: see finish_arc
    /// @return a fault; empty: added
    [[nodiscard]] std::string add(const Move& next, const AxisPositions& from, int turns,
                                  std::vector<Move>& out);
    /// A pause runs after the moves that wait.
    void add_pause(const Move& pause, std::vector<Move>& out);
    /// All moves that wait: for M0, M2 and G40.
    [[nodiscard]] std::string flush(std::vector<Move>& out);
    void stop() { is_on_ = false; }
    /// Angles and radii of an arc that begins here and has its end, its centre, and in sweep_rad
    /// the turns. Returns a fault, or nothing.
    [[nodiscard]] static std::string finish_arc(const AxisPositions& from, Move& arc);

  private:
    struct Waiting {
        Move move;
        PlanePoint way;        // of a line: LinuxCNC refuses to turn it round
        double sweep_rad = 0;  // of an arc, as programmed
    };

    [[nodiscard]] PlanePoint at(const AxisPositions& position) const;
    void set(AxisPositions& position, PlanePoint point) const;
    [[nodiscard]] bool is_inside(double turns) const { return settings_.is_left == (turns > 0); }
    /// Across a way, to the tool's side.
    [[nodiscard]] PlanePoint to_side(PlanePoint way) const;
    [[nodiscard]] std::string add_first_line(const Move& next, PlanePoint to);
    [[nodiscard]] std::string add_first_arc(const Move& next, PlanePoint to);
    [[nodiscard]] std::string add_line(const Move& next, const AxisPositions& from,
                                       std::vector<Move>& out);
    [[nodiscard]] std::string add_arc(const Move& next, const AxisPositions& from,
                                      std::vector<Move>& out);
    /// From the last direction to the next: below 0 an inner corner, pi a turn back.
    [[nodiscard]] double corner_rad(PlanePoint corner, PlanePoint way) const;
    /// The end of the waiting arc at an inner corner with a line.
    [[nodiscard]] std::string meet_line(PlanePoint corner, PlanePoint way, PlanePoint& meet) const;
    [[nodiscard]] std::string meet_arc(const Move& next, PlanePoint corner, double radius,
                                       PlanePoint& meet) const;
    void round_corner(const Move& next, const AxisPositions& from, PlanePoint to, bool is_rapid,
                      std::vector<Move>& out);
    /// Ends every waiting move at this point and lets it go.
    [[nodiscard]] std::string end_waiting(PlanePoint end, std::vector<Move>& out);
    void let_go(std::vector<Move>& out);
    void wait(const Move& move, PlanePoint end, PlanePoint way, double sweep_rad);

    Settings settings_;
    bool is_on_ = false, is_first_ = true;
    PlanePoint centre_;  // of the tool, at the end of the last move
    PlanePoint start_;   // of the first waiting move
    bool has_start_ = false;
    std::vector<Waiting> waiting_;
};

}  // namespace axg
