// SPDX-License-Identifier: GPL-2.0-or-later
// Whether the servo thread's period is the declared one, by the host's clock: windows of 1, 2, 4
// ... 4096 periods, as the receiver of a bus has them. Source: docs/reference/protocol.md, "The
// period".
#ifndef AXG_AXGUARD_PERIOD_H
#define AXG_AXGUARD_PERIOD_H

#include <stdbool.h>
#include <stdint.h>

#define AXG_PERIOD_WINDOWS 13
#define AXG_PERIOD_WORDS                                                                       \
    "axguard-stop: the servo period is %ld ns (expected %u us to 1 %%). Correct SERVO_PERIOD " \
    "and can.sample_us.\n"

typedef struct axg_period {
    uint64_t begin[AXG_PERIOD_WINDOWS];
    int64_t begin_ns[AXG_PERIOD_WINDOWS];
    int64_t measured_ns;  // by the last window that showed something
    bool has_windows;
    bool is_shown;  // a window showed that the period is right, and none since that it is wrong
    bool is_refuted;
} axg_period;

// 1: these periods show that one is right to 1 %, -1: that it is not, 0: neither. The clock is read
// at most half a period late, for a later one is a stop; it runs wrong by at most 200 ppm.
static inline int axg_period_judge(int64_t periods, int64_t elapsed_ns, uint64_t period_us) {
    const int64_t period_ns = (int64_t)period_us * 1000;
    const int64_t wanted_ns = periods * period_ns;
    const int64_t off_ns = elapsed_ns > wanted_ns ? elapsed_ns - wanted_ns : wanted_ns - elapsed_ns;
    const int64_t error_ns = period_ns / 2 + wanted_ns / 5000;
    if (off_ns - error_ns > wanted_ns / 100) {
        return -1;
    }
    return off_ns + error_ns <= wanted_ns / 100 ? 1 : 0;
}

// One period has begun. A wrong window goes before a right one. True: it is shown to be wrong, and
// was not before.
static inline bool axg_period_note(axg_period* watch, uint64_t count, int64_t clock_ns,
                                   uint64_t period_us) {
    int verdict = 0;
    for (int i = 0; i < AXG_PERIOD_WINDOWS; ++i) {
        const int64_t periods = (int64_t)(count - watch->begin[i]);
        const int64_t elapsed_ns = clock_ns - watch->begin_ns[i];
        if (watch->has_windows && periods < (int64_t)1 << i) {
            break;  // a longer one ends where a shorter one does
        }
        watch->begin[i] = count;
        watch->begin_ns[i] = clock_ns;
        const int judged =
            watch->has_windows ? axg_period_judge(periods, elapsed_ns, period_us) : 0;
        if (judged < 0 || (judged > 0 && verdict >= 0)) {
            verdict = judged;
            watch->measured_ns = elapsed_ns / periods;
        }
    }
    const bool is_new = verdict < 0 && !watch->is_refuted;
    watch->has_windows = true;
    watch->is_shown = verdict > 0 || (verdict == 0 && watch->is_shown);
    watch->is_refuted = verdict < 0 || (verdict == 0 && watch->is_refuted);
    return is_new;
}

#endif
