// SPDX-License-Identifier: GPL-2.0-or-later
// Options of what people see of the guard in axguard-hal, with the names of axguardd run. This file
// does not use HAL.
#ifndef AXG_AXGUARD_SHOW_H
#define AXG_AXGUARD_SHOW_H

#include <axguard.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define AXG_SHOW_NAME "linuxcnc"
#define AXG_SHOW_DUMPS 8U  // as axguardd, where there is a folder
#define AXG_SHOW_DUMPS_MAX 1000
#define AXG_SHOW_USAGE "[--status-socket PATH] [--metrics FILE] [--state-dir DIR [--black-boxes N]]"

typedef struct axg_show {
    const char *status_socket, *metrics, *state_dir, *black_boxes;  // as given; null: not
} axg_show;

// Takes words[*at] and its value, if it is one of these options.
static inline bool axg_show_take(axg_show* show, int count, char** words, int* at) {
    const struct {
        const char* name;
        const char** value;
    } options[] = {{"--status-socket", &show->status_socket},
                   {"--metrics", &show->metrics},
                   {"--state-dir", &show->state_dir},
                   {"--black-boxes", &show->black_boxes}};
    for (size_t i = 0; i < sizeof options / sizeof options[0]; ++i) {
        if (strcmp(words[*at], options[i].name) == 0 && *at + 1 < count) {
            *options[i].value = words[++*at];
            return true;
        }
    }
    return false;
}

// @return  false: no number of dumps, or none that a folder is for
static inline bool axg_show_dumps(const axg_show* show, uint32_t* dumps) {
    *dumps = show->state_dir != NULL ? AXG_SHOW_DUMPS : 0;
    if (show->black_boxes == NULL) {
        return true;
    }
    char* end = NULL;
    const long number = strtol(show->black_boxes, &end, 10);
    *dumps = (uint32_t)number;
    return end != show->black_boxes && *end == '\0' && number >= 0 &&
           number <= AXG_SHOW_DUMPS_MAX && (number == 0 || show->state_dir != NULL);
}

// Before axg_guard_start. Prints a fault.
// @param is_elsewhere  the guard is axguardd, on another computer
static inline bool axg_show_open(axg_guard* guard, const axg_show* show, bool is_elsewhere) {
    if (show->status_socket == NULL && show->metrics == NULL && show->state_dir == NULL &&
        show->black_boxes == NULL) {
        return true;
    }
    axg_show_options options = {AXG_SHOW_NAME, show->status_socket, show->metrics, show->state_dir,
                                0};
    if (is_elsewhere) {
        fprintf(stderr, "axguard-hal: --bus: the other computer shows its guard. Remove %s.\n",
                AXG_SHOW_USAGE);
        return false;
    }
    if (!axg_show_dumps(show, &options.black_boxes)) {
        fprintf(stderr,
                "axguard-hal: --black-boxes: found '%s', expected 0 to %d, and --state-dir\n",
                show->black_boxes, AXG_SHOW_DUMPS_MAX);
        return false;
    }
    char text[512];
    if (axg_guard_show(guard, &options, text, sizeof text) != AXG_STATUS_OK) {
        fprintf(stderr, "axguard-hal: %s\n", text);
        return false;
    }
    return true;
}

#endif
