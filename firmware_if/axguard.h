// SPDX-License-Identifier: Apache-2.0
// C interface of the guard, for use in another process: frames in, frames out, time in. The calling
// process provides threads, clock and socket. Lengths in mm, times in us of one monotonic clock. No
// exception crosses this interface. Only axg_guard_destroy, axg_guard_explain, and the threads of
// axg_guard_show touch the heap after axg_guard_start. Example:
// c_interface/example/guard_a_trace.c. Reference: docs/reference/c-interface.md.
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

// Incremented when a struct or the meaning of a call changes; checked by axg_guard_create. A
// program compiled with version 2 works on: for it axg_guard_process writes axg_state up to
// `samples_lost`.
#define AXG_INTERFACE_VERSION 3U
#define AXG_AXES_MAX 16U
#define AXG_HASH_PARTS 4U
#define AXG_SAMPLE_FRAMES_MAX 40U  // of axg_guard_encode_sample
#define AXG_NO_PAIR UINT32_MAX
#define AXG_STOP_TEXT_BYTES 1024U

typedef enum axg_status {
    AXG_STATUS_OK = 0,
    AXG_STATUS_EMPTY,        // axg_guard_next_tx_frame: no frame available
    AXG_STATUS_BAD_CALL,     // null pointer, value out of range, or wrong order of calls
    AXG_STATUS_BAD_VERSION,  // wrong AXG_INTERFACE_VERSION: compile with this library's header
    AXG_STATUS_BAD_INPUT,    // invalid machine file or meshes: the text lists every fault
    AXG_STATUS_NO_GPU,       // a GPU was requested, but none is usable
    AXG_STATUS_UNFIT,        // this processor or GPU is too slow or lacks what the engine needs
    AXG_STATUS_NO_MEMORY,
    AXG_STATUS_QUEUE_FULL,  // the frame was dropped; the next axg_guard_process stops
    AXG_STATUS_INTERNAL     // internal error of the library
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

// Event of the calling process, and when it has an effect.
typedef enum axg_event {
    AXG_EVENT_ARM = 0,      // a person arms: in AXG_PHASE_READY, while the axes are at rest
    AXG_EVENT_RESET,        // a person acknowledges a stop: in AXG_PHASE_STOPPED, after the cause
                            // was removed and while the axes are at rest
    AXG_EVENT_BUS_DOWN,     // the interface is down: stops
    AXG_EVENT_FRAMES_LOST,  // the process or its socket has dropped frames
    AXG_EVENT_SUSPENDED     // the host was suspended, and the clock of now_us did not advance
                            // meanwhile: stops
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
    AXG_FRAME_OWN = 128          // a frame of the guard that was sent on the bus, as reported by
                                 // CAN_RAW_RECV_OWN_MSGS and MSG_CONFIRM or a transmit interrupt
};

typedef struct axg_frame {
    int64_t time_us;  // receive time stamp; of a frame to send: time of its creation
    uint32_t id;      // 11 or 29 bits, without flags
    uint8_t flags;
    uint8_t raw_dlc;  // 9 to 15 if a classical frame has that DLC, else 0
    uint8_t length_bytes;
    uint8_t reserved;  // 0
    uint8_t data[64];
} axg_frame;

// The stop that survives the process. A guard that was armed and not destroyed restarts in phase
// stopped. Any value other than that of axg_latch_clear is a stop, zeros included. Two words: a
// torn write is a stop too.
typedef struct axg_latch {
    uint64_t word, inverse;
} axg_latch;

typedef struct axg_options {
    uint32_t version;          // AXG_INTERFACE_VERSION
    const char* machine_file;  // docs/reference/machine-file.md
    const char* mesh_root;     // null: folder of the machine file
    int32_t engine;            // axg_engine
    int32_t mode;              // axg_mode
    axg_latch* latch;     // must outlive the guard, such as a mapped file; null: a stop is lost
                          // when the guard is destroyed
    uint8_t takes_local;  // 1: accept AXG_FRAME_LOCAL as the board's frames; 0: they stop the guard
} axg_options;

// One sample of all axes, in place of its frames: with can.format classical or fd alone.
typedef struct axg_sample {
    int64_t latched_us;  // instant of the positions, on the clock of now_us
    uint64_t number;     // +1 a period, also for samples that were lost; SYNC counter: number % 240
                         // + 1, lap: number / 240 % 65536
    uint32_t axis_count;  // as in the machine file
    uint32_t nonce;       // of the board's session, 24 bits
    uint16_t tool;
    uint8_t mode, flags;            // docs/reference/board.md, "Samples and the flags byte"
    uint8_t reserved[4];            // 0
    double position[AXG_AXES_MAX];  // mm or degrees, in the order of the machine file
} axg_sample;

// Result of the guard for the newest sample that it evaluated.
typedef struct axg_proof {
    uint64_t samples_evaluated;  // 0: none yet, and nothing else is set
    const char*
        reason;  // none: proven; else why not: contact, predicted, contained, left_limits ...
    const char* withheld;  // why that sample has no permit: nothing, not proven, late, motion ...
    uint32_t pair;         // not proven; or proven, with the worst clearance level; or AXG_NO_PAIR
    uint8_t sync_counter;  // of the sample
    uint8_t is_proven;
    uint8_t samples;  // n: a permit for it is valid for so many samples; 0: not proven
    uint8_t level;    // 0 clear, 1 warn, 2 slow, 3 stop
    uint8_t cap;      // 1/250 of rapid; 250: none
    uint8_t reserved[7];
    double clearance_mm;  // proven lower bound of the distance of `pair`; -1: unknown
    double needed_mm;     // distance that `pair` needs in a stop; -1: no pair
} axg_proof;

// Texts are static; docs/reference/states.md, docs/reference/commands.md and
// docs/reference/protocol.md define them.
typedef struct axg_state {
    axg_phase phase;
    const char* cause;        // of the stop: none, verdict, input, output, silence ...
    const char* reason;       // verdict: contact, predicted, contained ...
    uint32_t pair;            // verdict: for axg_guard_pair_name; or AXG_NO_PAIR
    const char* input_fault;  // the last fault that stopped: stale, spoofed, jump ...; or ""
    uint32_t input_frame;     // id of the frame that caused it; 0: the clock
    const char* refused;      // why the last arm, reset or operator message was rejected; or ""
    const char* bus_fault;    // text of the last bus fault; or ""
    int64_t next_due_us;      // call axg_guard_process at this time, or when a frame arrives
    uint8_t has_query;        // 1: call axg_guard_evaluate
    uint8_t is_confirmed;     // 1: stopped, and the axes are at rest since
    uint64_t snapshots;       // complete samples
    uint64_t permits, stops;  // sent
    uint64_t late;            // results after the deadline of the machine file
    uint64_t samples_lost;
    axg_proof proof;  // since version 3
} axg_state;

// The stop in force, for a person.
typedef struct axg_stop {
    uint32_t pair;        // that stopped; or AXG_NO_PAIR
    uint32_t line_count;  // of text
    // Proven lower bound of the distance of `pair` when it stopped, and the distance that its proof
    // needed, mm; -1: unknown.
    double clearance_mm, needed_mm;
    char text[AXG_STOP_TEXT_BYTES];  // cause, distances, and what leads out, in lines
} axg_stop;

// An axis as the machine file states it, in mm or degrees.
typedef struct axg_axis {
    char name[8];
    uint8_t is_rotary, is_endless;
    uint8_t reserved[2];
    float skew_mm;    // of a gantry's two joints, rounded down; 0: one joint
    double min, max;  // travel; 0 of an endless axis
    double speed, acceleration;
    double jerk;                         // 0: no limit is promised
    double stopping;                     // the least deceleration in a stop
    double jog_speed, jog_acceleration;  // 0: guard.single_jog is not stated
} axg_axis;

// Values of the machine file that a board needs; the names are those of axg_board_options.
typedef struct axg_terms {
    uint32_t period_us, jitter_us, reaction_us;  // jitter_us: and most of can.latched_age_us
    uint32_t permit_id, stop_id;
    uint32_t hashes_in_id, hashes_out_id;      // 0: hashes are not compared
    uint32_t operator_in_id, operator_out_id;  // of a panel's messages, and of the status
    uint32_t hashes[AXG_HASH_PARTS];
    uint32_t axis_count;
    uint16_t first_tool;
    uint8_t permit_version, permit_samples_max;
    uint8_t takes_samples;   // 1: axg_guard_put_sample works with this format
    uint8_t is_independent;  // 1: each axis stops by itself (guard.promise)
    uint8_t reserved[2];
    axg_axis axes[AXG_AXES_MAX];
} axg_terms;

// What people see of a guard, as of axguardd; null or 0: not.
typedef struct axg_show_options {
    const char* name;           // in the place of axguardd's bus: 1 to 32 letters, digits, - or _
    const char* status_socket;  // read by axguardd status --socket and axguard watch --socket
    const char* metrics_file;   // of the Prometheus node exporter, replaced once a second
    const char* state_dir;      // folder of the dumps of the black box
    uint32_t black_boxes;       // number of dumps to keep, one for each stop of an armed guard. A
                                // process far ahead of real time loses records, which stops it
} axg_show_options;

typedef struct axg_guard axg_guard;

// Reads machine file and meshes, creates the engine, and reserves all memory. Needs seconds with a
// GPU. `text` receives the faults and the next step, truncated to `text_bytes`; it may be null. On
// AXG_STATUS_OK the caller destroys *out with axg_guard_destroy; otherwise *out is null.
AXG_API axg_status axg_guard_create(const axg_options* options, axg_guard** out, char* text,
                                    size_t text_bytes);

// Shows the guard until axg_guard_destroy, by two threads of the library, which take no signal and
// for which no call waits, but axg_guard_explain. Call it once, before axg_guard_start. On
// AXG_STATUS_BAD_CALL `text` has the fault, unless a pointer or the order was wrong.
AXG_API axg_status axg_guard_show(axg_guard* guard, const axg_show_options* options, char* text,
                                  size_t text_bytes);

// Call once. The guard allocates no memory afterwards, but in axg_guard_explain.
AXG_API axg_status axg_guard_start(axg_guard* guard, int64_t now_us);

// Queues a frame of the bus, in order of arrival, including the guard's own with AXG_FRAME_OWN, for
// the next axg_guard_process. Capacity: 256 frames.
AXG_API axg_status axg_guard_receive(axg_guard* guard, const axg_frame* frame);

// Queues a sample as the frames that a board would send: SYNC, positions, heartbeat, session. All
// receiver rules apply, and positions are rounded to the counts of the format. Call it in the order
// of the samples; its frames count against the capacity.
// @param now_us  time of arrival
// @return  AXG_STATUS_BAD_CALL: another format or number of axes, or a position or tool number
//          that does not fit
AXG_API axg_status axg_guard_put_sample(axg_guard* guard, const axg_sample* sample, int64_t now_us);

// Writes the frames that axg_guard_put_sample would queue: for a board that sends its samples to a
// guard on another computer. The guard need not be started; samples in order, as above.
// @param out    [capacity] out; AXG_SAMPLE_FRAMES_MAX are always enough
// @param count  out
// @return  AXG_STATUS_BAD_CALL: as axg_guard_put_sample, or too small a capacity
AXG_API axg_status axg_guard_encode_sample(axg_guard* guard, const axg_sample* sample,
                                           axg_frame out[], uint32_t capacity, uint32_t* count);

// Does all work due at now_us except geometry; needs microseconds. now_us must not decrease. A
// result of axg_guard_evaluate counts as received at the start of the next axg_guard_process.
AXG_API axg_status axg_guard_process(axg_guard* guard, int64_t now_us, axg_state* out);

// Evaluates the geometry of the newest sample: costs one cycle of the engine. One separate thread
// may call it concurrently with all calls except start and destroy. With clearance levels, it
// queries those after the result is available: axg_guard_process in another thread does not wait
// for them.
AXG_API axg_status axg_guard_evaluate(axg_guard* guard);

// Returns the next frame to send: call after axg_guard_process until AXG_STATUS_EMPTY. Send it at
// once; a frame not seen on the bus (AXG_FRAME_OWN) within two periods stops the guard.
AXG_API axg_status axg_guard_next_tx_frame(axg_guard* guard, axg_frame* out);

// Reports an event of the calling process or of a person.
// @param event  axg_event
AXG_API axg_status axg_guard_notify(axg_guard* guard, int32_t event, int64_t now_us);

// Returns "cutter - c", valid until axg_guard_destroy; "" for AXG_NO_PAIR and invalid pairs.
AXG_API const char* axg_guard_pair_name(const axg_guard* guard, uint32_t pair);

// Explains the stop in force; in every other phase there are no lines. Once the axes are at rest
// (is_confirmed) its last line may be a proven jog. Allocates, and may take milliseconds: at the
// stop, and at rest; call it then only.
// @param program_line  of the control, at the stop; 0: not known
AXG_API axg_status axg_guard_explain(axg_guard* guard, int32_t program_line, axg_stop* out);

// Returns the length_mm of a tool of the machine file, also before the start; -1: it has no such
// tool. Tool 0 is first_tool, as in samples.
AXG_API double axg_guard_tool_length_mm(const axg_guard* guard, uint16_t tool);

// Returns what the machine file states for a board; also before the start.
AXG_API axg_status axg_guard_terms(const axg_guard* guard, axg_terms* out);

AXG_API void axg_guard_destroy(axg_guard* guard);  // null is allowed

// Initializes a new latch: no stop is stored.
AXG_API void axg_latch_clear(axg_latch* latch);

// Text of a status.
AXG_API const char* axg_status_text(axg_status status);
// The version of the library, such as 0.1.0.
AXG_API const char* axg_library_version(void);

#ifdef __cplusplus
}
#endif

#endif
