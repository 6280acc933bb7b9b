// SPDX-License-Identifier: GPL-2.0-or-later
// The length of the tool in the spindle, as LinuxCNC and the machine file have it. A difference
// withholds the permit: the guard would prove another tool. This file does not use HAL.
#ifndef AXG_AXGUARD_LENGTH_H
#define AXG_AXGUARD_LENGTH_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#define AXG_LENGTH_TOLERANCE_MM 0.1  // unless the pin states another one

#define AXG_LENGTH_WORDS                                                                        \
    "axguard: tool %u: LinuxCNC's length is %.3f mm, length_mm of the machine file %.3f mm "    \
    "(tolerance %.3f mm): no permit. Correct the tool table or the machine file; G49 ends the " \
    "comparison.\n"

typedef struct axg_length {
    double file_mm;      // length_mm of tool `file_tool`
    uint32_t file_tool;  // the tool that `file_mm` is of
    bool is_known;       // `file_mm` was received
    uint16_t tool;       // in the spindle
    double offset_mm;    // of LinuxCNC when that tool came in: it may still be the old tool's
    bool is_offset_set;  // another offset since: of this tool
    bool differs;        // the permit is withheld
} axg_length;

// The tool at the start: LinuxCNC's offset is its own, for no other tool was in the spindle.
static inline void axg_length_begin(axg_length* length, uint16_t tool) {
    length->tool = tool;
    length->is_offset_set = true;
    length->is_known = false;
    length->differs = false;
}

// Of the tool in the spindle, by the guard; negative: the machine file states none.
static inline void axg_length_take(axg_length* length, uint32_t file_tool, double file_mm) {
    length->file_tool = file_tool;
    length->file_mm = file_mm;
    length->is_known = file_mm >= 0;
}

// Once a servo period. Without an offset (G49) nothing is compared; an offset or a tolerance that
// is no number differs.
// @return  true: the permit is withheld
static inline bool axg_length_compare(axg_length* length, uint16_t tool, double offset_mm,
                                      double tolerance_mm) {
    if (tool != length->tool) {
        length->tool = tool;
        length->offset_mm = offset_mm;
        length->is_offset_set = false;
    }
    if (offset_mm != length->offset_mm) {
        length->is_offset_set = true;
    }
    const bool is_comparable =
        length->is_known && length->file_tool == tool && length->is_offset_set && offset_mm != 0;
    length->differs = is_comparable && !(fabs(offset_mm - length->file_mm) <= tolerance_mm);
    return length->differs;
}

#endif
