// SPDX-License-Identifier: Apache-2.0
// One block after the other to canonical moves. Modes and tools: gcode_interpreter.cpp; offsets:
// gcode_offsets.cpp; tool centre point control: gcode_tip.cpp; motion: gcode_motion.cpp; canned
// cycles: gcode_cycle.cpp.
#pragma once

#include <optional>
#include <string>

#include "hil_replay/gcode/gcode_block.hpp"
#include "hil_replay/gcode/gcode_reader.hpp"
#include "hil_replay/gcode/gcode_state.hpp"
#include "hil_replay/gcode/gcode_travel.hpp"

namespace axg {

class GcodeInterpreter {
  public:
    GcodeInterpreter(const Machine& machine, const GcodeOptions& options, GcodeResult& result);

    /// In the order of LinuxCNC's "Order of Execution": F counts in the unit that was on before the
    /// block. Faults and moves go to the result.
    void run(const GcodeBlock& block);
    /// A block that did not run may have set F: a missing feed is then no news.
    void skip_block() { state_.is_feed_unknown = true; }
    [[nodiscard]] bool has_ended() const { return state_.has_ended; }
    /// What the control keeps in a numbered parameter: 5220 the work offset in use, 5400 the tool
    /// in the spindle, 5420 to 5428 where the axes are, in the program's units and offsets.
    [[nodiscard]] std::optional<double> parameter(std::uint32_t index) const;

  private:
    void fault(const std::string& word, std::string message);
    void set_feed_and_tool();
    /// The number a T or H word means on this machine; a fault where it is none.
    std::optional<std::uint16_t> tool_number(char letter);
    [[nodiscard]] const Tool* find_tool(std::uint16_t number) const;
    void change_tool();
    void dwell();
    void set_modes();
    void set_tool_length();
    /// The offset of G43, G43.1 or G43.4; nothing, and a fault, where it has none.
    std::optional<AxisPositions> tool_offset(std::int32_t code);
    /// Takes a new tool offset, and tool centre point control on or off. The axes stay where they
    /// are; what changes is which position that is called.
    void change_coordinates(const AxisPositions& offset, bool is_controlled);
    void move();
    [[nodiscard]] double word_value(char letter, const Axis& axis) const;
    /// kNoIndex, and a fault, where the machine has no such axis.
    std::uint32_t named_axis(char letter);
    /// What is added to a word of this axis: work offset, G52 or G92, tool length.
    [[nodiscard]] double offset_of(std::uint32_t axis) const;
    bool set_target(AxisPositions& target);
    bool set_feed(Move& next);
    /// Of G94 or G95, for a move along the linear axes or of rotary ones alone, per minute; 0, and
    /// a fault, where there is none.
    double feed_per_minute(bool moves_linear);
    bool set_arc(Move& next);
    [[nodiscard]] double arc_center(char center_letter, char axis_letter) const;
    /// By way of the words, if any, then to machine zero: the named axes, or all of them.
    void go_home();
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
    /// Where the axes stand, in the coordinates of `position`.
    [[nodiscard]] AxisPositions standing_at() const;
    [[nodiscard]] Move new_move(MoveKind kind) const;
    void append(const Move& next);
    /// The next move of the program; a fault, and its end, where it has too many.
    void push(const Move& next);
    [[nodiscard]] double scale() const { return state_.is_inch ? 25.4 : 1.0; }  // mm a unit

    const Machine& machine_;
    const GcodeOptions& options_;
    GcodeResult& result_;
    GcodeState state_;
    TravelWatch travel_;
    std::optional<TipControl> tip_control_;  // made when a program first asks for it
    const GcodeBlock* block_ = nullptr;
};

}  // namespace axg
