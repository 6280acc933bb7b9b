// SPDX-License-Identifier: Apache-2.0
// Converts block after block to canonical moves. Modes and tools: gcode_interpreter.cpp; offsets:
// gcode_offsets.cpp; tool centre point control: gcode_tip.cpp; motion: gcode_motion.cpp; canned
// cycles: gcode_cycle.cpp; threads and probing: gcode_thread.cpp; splines: gcode_spline.cpp; cutter
// compensation: gcode_contour.cpp; saved modes: gcode_modes.cpp.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hil_replay/gcode/gcode_block.hpp"
#include "hil_replay/gcode/gcode_cutter.hpp"
#include "hil_replay/gcode/gcode_reader.hpp"
#include "hil_replay/gcode/gcode_state.hpp"
#include "hil_replay/gcode/gcode_travel.hpp"

namespace axg {

class GcodeInterpreter {
  public:
    GcodeInterpreter(const Machine& machine, const GcodeOptions& options, GcodeResult& result);

    /// Runs a block in LinuxCNC's "Order of Execution": F uses the unit active before the block.
    /// Appends faults and moves to the result.
    void run(const GcodeBlock& block);
    /// The number of calls under way: M73 restores the modes when it falls.
    /// @param line  of the return
    void set_call_depth(std::size_t depth, std::uint32_t line);
    /// A skipped block may have set F: later blocks then report no missing feed.
    void skip_block() { state_.is_feed_unknown = true; }
    [[nodiscard]] bool has_ended() const { return state_.has_ended; }
    /// Moves of cutter compensation wait for a next one, and LinuxCNC would not run them.
    [[nodiscard]] bool is_contour_open() const { return cutter_.is_beside(); }
    /// G5.3 has not ended the points of G5.2, and LinuxCNC would not move along them.
    [[nodiscard]] bool is_nurbs_open() const {
        return state_.spline.is_open && !state_.spline.is_refused;
    }
    /// Value of a numbered parameter of the control: 5220 the active work offset, 5400 the tool in
    /// the spindle, 5420 to 5428 the axis positions in the program's units and offsets.
    [[nodiscard]] std::optional<double> parameter(std::uint32_t index) const;

  private:
    void fault(const std::string& word, std::string message);
    /// Adds a setting of the control that decides what this program means.
    void assume(const std::string& setting);
    /// A length counts in the unit of the start: a fault, once, if that is unknown.
    void use_start_unit(char letter);
    void use_lengths();
    /// Where an absolute word takes an endless axis, from its target turn by turn.
    /// @param word_deg  as written: its sign may be a direction
    double by_rotary_rule(char letter, std::uint32_t axis, double target, double word_deg);
    /// A block that changes an offset computes the position in all of them anew, as sums.
    void forget_words();
    /// Notes that an absolute word, and no sum, leaves the axis at this target.
    void keep_word(std::uint32_t axis, double target);
    double wrapped_target(char letter, std::uint32_t axis, double target, double word_deg);
    void set_feed_and_tool();
    /// The machine's tool number for a T or H word; nothing, and a fault, if there is none.
    std::optional<std::uint16_t> tool_number(char letter);
    [[nodiscard]] const Tool* find_tool(std::uint16_t number) const;
    void change_tool();
    void dwell();
    /// G40 to G42.1.
    void set_cutter();
    void begin_contour(const std::string& word);
    /// Nothing, and a fault, if the diameter that G41 or G42 takes is unknown.
    std::optional<double> cutter_diameter(const std::string& word);
    /// False, and a fault, if the block has a word that cutter compensation does not go with.
    bool is_contour_block();
    /// Adds a programmed move; what comes out are moves of the tool's centre.
    void follow_contour(Move next);
    /// The moves that wait, before a stop or the end of compensation.
    void flush_contour();
    void release(std::vector<Move>& moves);
    void save_modes();
    void restore_modes(const GcodeState& saved);
    void wait_for_input();
    void set_modes();
    void set_tool_length();
    /// The tool offset after the word `code` (-1: unchanged); if it has none, nothing and a fault.
    std::optional<AxisPositions> tool_offset(std::int32_t code);
    /// Sets a new tool offset, and tool centre point control on or off. The axes do not move; only
    /// the coordinates of their position change.
    void change_coordinates(const AxisPositions& offset, bool is_controlled);
    void move();
    void move_to_target(bool is_arc_mode);
    [[nodiscard]] double word_value(char letter, const Axis& axis) const;
    /// The index of the axis; kNoIndex, and a fault, if the machine has no such axis.
    std::uint32_t named_axis(char letter);
    /// Sum of the offsets of this axis: work offset, G52 or G92, tool offset.
    [[nodiscard]] double offset_of(std::uint32_t axis) const;
    [[nodiscard]] double rotation_rad() const { return state_.rotations_rad[state_.work_offset]; }
    [[nodiscard]] bool is_rotated() const { return rotation_rad() != 0; }
    /// Turns X and Y of a vector by the active work offset's angle, or back.
    void rotate(AxisPositions& vector, bool is_back = false) const;
    /// The position in the program's coordinates: without offsets and rotation.
    [[nodiscard]] AxisPositions programmed_position() const { return to_program(state_.position); }
    [[nodiscard]] AxisPositions to_program(const AxisPositions& position) const;
    [[nodiscard]] AxisPositions from_program(const AxisPositions& programmed) const;
    /// Takes X and Y of the block into a rotated target.
    void set_rotated_target(AxisPositions& target);
    /// What LinuxCNC does where the angle changes under G92 is a fault.
    void check_rotation(double rad_before);
    /// A fault, for what LinuxCNC does in a rotated work offset is not read.
    void refuse_rotated(const std::string& word);
    bool set_target(AxisPositions& target);
    bool set_feed(Move& next);
    /// The feed of G94 or G95 per minute: mm, or degrees if only rotary axes move. 0 if there is
    /// none, with a fault unless a skipped block may have set it.
    double feed_per_minute(bool moves_linear);
    /// The speed of the spindle for `word`; 0, and a fault, where none is known.
    double spindle_speed(const char* word);
    bool set_arc(Move& next);
    /// True: this block belongs to a spline, and is done.
    bool run_spline();
    /// False, and a fault, where the block has what LinuxCNC refuses with splines or does
    /// otherwise than its words say.
    bool is_spline_block(const std::string& word);
    void run_single_spline();
    void add_nurbs_point();
    /// False for wrong words; the fault is reported unless a skipped block may have set the feed.
    bool read_nurbs_words(bool is_first);
    void end_nurbs();
    /// Moves along the curve through the control points, whose last is `last.target`.
    void follow_spline(const std::string& word, const std::vector<SplinePoint>& points,
                       std::uint32_t order, const Move& last);
    void append_bend(const SplinePiece& piece, Move next);
    /// A line, or the lines of a circle so large that its angles would lose digits.
    void append_flat_bend(bool is_arc, Move next);
    /// A position in the plane XY as a control point.
    [[nodiscard]] SplinePoint spline_point(const AxisPositions& position, double weight) const;
    void run_thread();
    void probe();
    /// True, and a fault, if a sum with the position of this axis depends on what was probed.
    bool is_unknown_after_probe(char letter, std::uint32_t axis);
    /// The same for the start of an arc or of a compensated contour, in the plane.
    bool is_unknown_arc();
    [[nodiscard]] double arc_center(char center_letter, char axis_letter) const;
    /// G28, G30: moves to the words, if any, then the named axes, or all, to the stored position.
    void go_home();
    /// go_home where nothing in the block forbids it. `word`: G28 or G30.
    void move_home(const char* word);
    /// Whether this block has a use for its L, P and Q: without a motion word in it,
    /// make_gcode_block does not have the mode to check these. Reports the first that has none.
    [[nodiscard]] bool are_letters_taken(bool is_arc_mode);
    void write_offsets();
    void write_work_offset();
    struct Hole;
    void run_cycle(std::int32_t last_motion, bool has_axis);
    bool read_hole(Hole& hole);
    bool read_letters(Hole& hole, bool is_same);
    void drill(const Hole& read);
    void peck(const Hole& hole);
    void go_to(const Hole& hole, double height_mm, bool is_feed);
    void wait(double seconds);
    void stop();
    /// The present axis positions in the coordinates of `position`.
    [[nodiscard]] AxisPositions standing_at() const;
    /// The same, under cutter compensation the programmed position.
    [[nodiscard]] AxisPositions programmed_at() const;
    [[nodiscard]] Move new_move(MoveKind kind) const;
    void append(Move next);
    /// Gives axes that would move by rounding only the position that they have.
    void settle(AxisPositions& target, const AxisPositions& from) const;
    /// Adds a move to the program; with too many moves adds a fault and ends the program instead.
    void push(const Move& next);
    [[nodiscard]] double scale() const { return state_.is_inch ? 25.4 : 1.0; }  // mm per unit

    const Machine& machine_;
    const GcodeOptions& options_;
    GcodeResult& result_;
    GcodeState state_;
    struct SavedModes {
        GcodeState state;
        bool is_for_return = false;
    };
    std::vector<std::optional<SavedModes>> saved_modes_{1};  // by depth of call
    TravelWatch travel_;
    CutterPath cutter_;
    // Under cutter compensation the programmed position in the plane, as LinuxCNC adds the words of
    // the program; NaN: its start is not known to the last digit.
    std::array<double, 2> contour_words_{};
    std::optional<TipControl> tip_control_;  // made when a program first switches it on
    std::vector<std::uint32_t> unruled_;     // axes whose missing rule was reported
    const GcodeBlock* block_ = nullptr;
};

}  // namespace axg
