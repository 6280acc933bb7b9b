// SPDX-License-Identifier: Apache-2.0
// The guard inside another process, for C: frames in, frames out, time in. It has no thread, no
// clock and no socket; the process that calls it has. Lengths in mm, times in us of one monotonic
// clock. No exception leaves it. After axg_guard_start nothing is allocated but by
// axg_guard_destroy. An example: c_interface/example/guard_a_trace.c; the rest:
// docs/reference/c-interface.md.
#ifndef AXG_AXGUARD_H
#define AXG_AXGUARD_H

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define AXG_API __attribute__((visibility("default")))
#else
#define AXG_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

// Raised when a struct or the meaning of a call changes; axg_guard_create compares it.
#define AXG_INTERFACE_VERSION 2U
#define AXG_NO_PAIR UINT32_MAX

typedef enum axg_status {
    AXG_STATUS_OK = 0,
    AXG_STATUS_EMPTY,        // axg_guard_next_tx_frame: no frame waits
    AXG_STATUS_BAD_CALL,     // a null pointer, a value out of range, before start or after it
    AXG_STATUS_BAD_VERSION,  // another AXG_INTERFACE_VERSION: compile with this library's header
    AXG_STATUS_BAD_INPUT,    // machine file or meshes: every fault is in the text
    AXG_STATUS_NO_GPU,       // one was asked for and is not there
    AXG_STATUS_UNFIT,        // this processor or GPU is too slow or lacks what the engine needs
    AXG_STATUS_NO_MEMORY,
    AXG_STATUS_QUEUE_FULL,  // a frame was not taken; the guard stops when it is processed next
    AXG_STATUS_INTERNAL     // a bug in the library
} axg_status;

typedef enum axg_engine {
    AXG_ENGINE_OF_MACHINE_FILE = 0,
    AXG_ENGINE_CPU,
    AXG_ENGINE_CUDA,
    AXG_ENGINE_AUTO
} axg_engine;
typedef enum axg_mode { AXG_MODE_STOPPABLE = 0, AXG_MODE_CONTACT } axg_mode;

// docs/reference/states.md. Zeroed memory is stopped.
typedef enum axg_phase {
    AXG_PHASE_STOPPED = 0,
    AXG_PHASE_INIT,
    AXG_PHASE_SELFTEST,
    AXG_PHASE_READY,
    AXG_PHASE_ARMED
} axg_phase;

// What the calling process has seen or wants, and where that has an effect.
typedef enum axg_event {
    AXG_EVENT_ARM = 0,      // a person wants to go on; in AXG_PHASE_READY, while the axes stand
    AXG_EVENT_RESET,        // a person has looked; in AXG_PHASE_STOPPED, when the cause is gone and
                            // the axes stand
    AXG_EVENT_BUS_DOWN,     // the interface is down: stops
    AXG_EVENT_FRAMES_LOST,  // the process or its socket has dropped frames
    AXG_EVENT_SUSPENDED     // the computer was suspended, and the clock of now_us has not counted
                            // that: stops
} axg_event;

// Bits of axg_frame.flags.
enum {
    AXG_FRAME_EXTENDED = 1,  // 29-bit id
    AXG_FRAME_REMOTE = 2,    // remote frame
    AXG_FRAME_ERROR = 4,     // error frame: id holds the class bits of linux/can/error.h
    AXG_FRAME_FD = 8,        // flexible data rate
    AXG_FRAME_BIT_RATE_SWITCH = 16,
    AXG_FRAME_ERROR_STATE = 32,  // FD: the sender is error-passive
    AXG_FRAME_LOCAL = 64,        // sent by this host, and not by the guard
    AXG_FRAME_OWN = 128  // a frame of the guard, seen on the bus: what CAN_RAW_RECV_OWN_MSGS
                         // and MSG_CONFIRM tell, or the controller's transmit interrupt
};

typedef struct axg_frame {
    int64_t time_us;  // received: the receive stamp; to send: when it was made
    uint32_t id;      // 11 or 29 bits, without flags
    uint8_t flags;
    uint8_t raw_dlc;  // 9..15 where a classical frame said so, else 0
    uint8_t length_bytes;
    uint8_t reserved;  // 0
    uint8_t data[64];
} axg_frame;

// The stop that outlives the process. A guard that was armed and not destroyed is stopped when it
// comes back. Anything but what axg_latch_clear writes is a stop, zeros too. Two words, so that a
// torn write is one as well.
typedef struct axg_latch {
    uint64_t word, inverse;
} axg_latch;

typedef struct axg_options {
    uint32_t version;          // AXG_INTERFACE_VERSION
    const char* machine_file;  // docs/reference/machine-file.md
    const char* mesh_root;     // null: the machine file's folder
    int32_t engine;            // axg_engine
    int32_t mode;              // axg_mode
    axg_latch* latch;  // must outlive the guard, such as a mapped file; null: a stop is forgotten
                       // when the guard is destroyed
    uint8_t takes_local;  // 1: frames with AXG_FRAME_LOCAL are the board's; 0: they stop the guard
} axg_options;

// Texts are static; the words are those of docs/reference/states.md, docs/reference/commands.md and
// docs/reference/protocol.md.
typedef struct axg_state {
    axg_phase phase;
    const char* cause;        // of the stop: none, verdict, input, output, silence ...
    const char* reason;       // verdict: contact, predicted, contained ...
    uint32_t pair;            // verdict: for axg_guard_pair_name; or AXG_NO_PAIR
    const char* input_fault;  // the last one that stops: stale, spoofed, jump ...; or ""
    uint32_t input_frame;     // the id that showed it; 0: the clock did
    const char* refused;      // why the last arm, reset or operator's message had no effect; or ""
    const char* bus_fault;    // the last fault of the bus in words; or ""
    int64_t next_due_us;      // call axg_guard_process again at this time, or when a frame is there
    uint8_t has_query;        // 1: call axg_guard_evaluate
    uint64_t snapshots;       // complete samples
    uint64_t permits, stops;  // sent
    uint64_t late;            // results that came after the machine file's deadline
    uint64_t samples_lost;
} axg_state;

typedef struct axg_guard axg_guard;

// Reads the machine file and the meshes, makes the engine, reserves everything. Seconds where there
// is a GPU. `text` gets what is wrong and what to do next, cut to `text_bytes` with its end; it may
// be null. On AXG_STATUS_OK *out is to be given back with axg_guard_destroy, else it is null.
AXG_API axg_status axg_guard_create(const axg_options* options, axg_guard** out, char* text,
                                    size_t text_bytes);

// Once. From here on nothing is allocated.
AXG_API axg_status axg_guard_start(axg_guard* guard, int64_t now_us);

// A frame from the bus, in order of arrival, the guard's own with AXG_FRAME_OWN included. Kept for
// the next axg_guard_process; 256 fit.
AXG_API axg_status axg_guard_receive(axg_guard* guard, const axg_frame* frame);

// Everything that is due now, short of the geometry; microseconds. now_us never runs backwards. A
// result of axg_guard_evaluate counts as given when the first axg_guard_process after it begins.
AXG_API axg_status axg_guard_process(axg_guard* guard, int64_t now_us, axg_state* out);

// The geometry of the newest sample: as long as a cycle of the engine takes. May be called by a
// thread of its own, one, beside all other calls but start and destroy. Of a machine with clearance
// levels it queries those when the result can be had: axg_guard_process in another thread does not
// wait for them.
AXG_API axg_status axg_guard_evaluate(axg_guard* guard);

// The next frame to send, after axg_guard_process, until AXG_STATUS_EMPTY. Send it at once; one
// that is not seen on the bus (AXG_FRAME_OWN) within two periods stops the guard.
AXG_API axg_status axg_guard_next_tx_frame(axg_guard* guard, axg_frame* out);

// Reports what the calling process has seen, or what a person wants.
// @param event  axg_event
AXG_API axg_status axg_guard_notify(axg_guard* guard, int32_t event, int64_t now_us);

// "cutter - c"; lives as long as the guard. "" for AXG_NO_PAIR and what is no pair.
AXG_API const char* axg_guard_pair_name(const axg_guard* guard, uint32_t pair);

AXG_API void axg_guard_destroy(axg_guard* guard);  // null is allowed

// A latch that says that nothing has stopped: for memory that is used for the first time.
AXG_API void axg_latch_clear(axg_latch* latch);

// What a status means, in words.
AXG_API const char* axg_status_text(axg_status status);
// The version of the library, such as 0.1.0.
AXG_API const char* axg_library_version(void);

#ifdef __cplusplus
}
#endif

#endif
