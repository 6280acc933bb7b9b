// SPDX-License-Identifier: GPL-2.0-or-later
// Records samples as the frames of a board, in the text of candump -L, for axguard inspect and
// axguard replay. This file does not use HAL.
#ifndef AXG_AXGUARD_RECORD_H
#define AXG_AXGUARD_RECORD_H

#include <axguard.h>
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#define AXG_NOT_HOMED 1U  // of axg_sample.flags

// Frames of samples before homing are left out: nobody knows where the joints are.
static inline void axg_record_frame(FILE* out, const axg_sample* sample, const axg_frame* frame) {
    if (out == NULL || (sample->flags & AXG_NOT_HOMED) != 0) {
        return;
    }
    const char* const id = frame->id > 0x7FFU ? "%08" PRIX32 "#" : "%03" PRIX32 "#";
    fprintf(out, "(%" PRId64 ".%06" PRId64 ") hal ", frame->time_us / 1000000,
            frame->time_us % 1000000);
    fprintf(out, id, frame->id);
    if ((frame->flags & AXG_FRAME_FD) != 0) {
        fprintf(out, "#%d", (frame->flags & AXG_FRAME_BIT_RATE_SWITCH) != 0 ? 1 : 0);
    }
    for (unsigned i = 0; i < frame->length_bytes; ++i) {
        fprintf(out, "%02X", frame->data[i]);
    }
    fputc('\n', out);
}

// @return  null after a message: the guard runs without a record
static inline FILE* axg_record_open(const char* path) {
    FILE* const out = fopen(path, "w");
    if (out == NULL) {
        fprintf(stderr, "axguard-hal: --record: %s: %s\n", path, strerror(errno));
    }
    return out;
}

static inline void axg_record_close(FILE* out) {
    if (out != NULL && (ferror(out) != 0 || fclose(out) != 0)) {
        fprintf(stderr, "axguard-hal: --record: the record is not whole\n");
    }
}

#endif
