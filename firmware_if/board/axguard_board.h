// SPDX-License-Identifier: Apache-2.0
// Board side of permit version 2, for firmware: a motion board passes its latches and received
// frames, and gets the time until which it may move, and its speed bounds. C99, integers only: no
// heap, no clock, no global state, no dependency outside this folder. One axg_board serves one
// machine; calls for it must not overlap. Further duties of a board:
// docs/reference/board.md.
//
// Times are 64-bit microseconds of the board's timer and never wrap: a 32-bit instant stored for 36
// minutes would appear to be in the future, and an ended permit to be valid.
// axg_board_extend_us derives them from a 32-bit timer.
#ifndef AXG_AXGUARD_BOARD_H
#define AXG_AXGUARD_BOARD_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define AXG_BOARD_RECORDS 16U  // samples that a permit may name; n is at most one less
#define AXG_BOARD_PERIOD_US_MAX 100000U
#define AXG_BOARD_AXES_MAX 13U   // capacity of one fd frame
#define AXG_BOARD_CAP_GROUPS 8U  // axes 0 to 6 each, then all others together
#define AXG_BOARD_CAP_NONE 250U  // 1/250 of rapid: the axis may run at rapid
#define AXG_BOARD_SYNC_MAX 240U  // SYNC counts 1 to this
#define AXG_BOARD_NONCE_MAX 0xFFFFFFU
#define AXG_BOARD_NO_POSITION INT32_MIN  // position unknown
#define AXG_BOARD_HASH_PARTS 4U
#define AXG_BOARD_PERMITS_FIRST 3U  // usable permits in a row before the first motion
#define AXG_BOARD_CLASSICAL_FRAMES_MAX 7U

typedef struct axg_board_can_frame {
    uint32_t id;     // 11 bits
    bool is_fd;      // flexible data rate
    uint8_t length;  // bytes of data, 0 to 64
    uint8_t data[64];
} axg_board_can_frame;

// Bound of the axis speeds: guard.cap of the machine file.
typedef enum axg_board_cap_kind {
    AXG_BOARD_CAP_IGNORED = 0,  // the board guarantees nothing; the cap is advice
    AXG_BOARD_CAP_ENFORCED      // all_axes and per_axis: the board reports by axg_board_keeps
} axg_board_cap_kind;

// The same numbers as in the machine file. Ids: docs/reference/board.md has the defaults.
typedef struct axg_board_options {
    uint32_t period_us;          // T, can.sample_us
    uint32_t jitter_us;          // guard.latch_jitter_us and the most of can.latched_age_us
    uint32_t reaction_us;        // t_board, guard.board_reaction_ms
    uint8_t permit_samples_max;  // largest n of a permit; 1 to 15
    uint8_t axis_count;          // 1 to AXG_BOARD_AXES_MAX
    uint16_t endless_axes;       // bit i: axis i has no end; its angle is sent modulo 360 deg
    axg_board_cap_kind cap_kind;
    uint32_t permit_id;  // its inverted twin has the next id
    uint32_t stop_id;
    uint32_t hashes_id;  // 0: hashes are not compared
    uint32_t hashes[AXG_BOARD_HASH_PARTS];
} axg_board_options;

// First byte of a permit. Any two differ in four bits or more.
typedef enum axg_board_word {
    AXG_BOARD_WORD_NONE = 0,
    AXG_BOARD_WORD_RUN = 0xA5,
    AXG_BOARD_WORD_SLOW = 0xC3,  // like run; advice to feed slower
    AXG_BOARD_WORD_JOG = 0x3C,
    AXG_BOARD_WORD_STOP = 0x5A
} axg_board_word;

// Kind of a received frame. Only PERMIT extends the end of motion.
typedef enum axg_board_heard {
    AXG_BOARD_HEARD_NOTHING = 0,   // another id
    AXG_BOARD_HEARD_PLAIN,         // half a pair
    AXG_BOARD_HEARD_PERMIT,        // usable and counted
    AXG_BOARD_HEARD_NOT_YET,       // the word stop before the first motion
    AXG_BOARD_HEARD_STOP,          // the stop frame, or the word stop after motion: latched
    AXG_BOARD_HEARD_HASH,          // reply with axg_board_encode_hash
    AXG_BOARD_HEARD_HASH_DIFFERS,  // reply; no motion until the hashes are equal
    AXG_BOARD_HEARD_REFUSED        // reason: last_refusal
} axg_board_heard;

// Reason of a rejected frame, in the order of the checks; refused[] counts each.
typedef enum axg_board_refusal {
    AXG_BOARD_REFUSED_NOTHING = 0,
    AXG_BOARD_REFUSED_SHAPE,         // the id of a permit or hash, wrong length or format
    AXG_BOARD_REFUSED_TWIN_MISSING,  // a plain frame after a plain frame
    AXG_BOARD_REFUSED_TWIN_ALONE,    // an inverted frame without its plain one
    AXG_BOARD_REFUSED_TWIN_LATE,     // more than T after its plain one
    AXG_BOARD_REFUSED_TWIN_DIFFERS,  // not every bit inverted
    AXG_BOARD_REFUSED_WORD,          // no permit word
    AXG_BOARD_REFUSED_STOPPED,       // only a person ends a stop
    AXG_BOARD_REFUSED_ECHO,          // no such sample in the records, or stamped after now
    AXG_BOARD_REFUSED_ANSWER,        // wrong for this nonce, or for the lap of the record
    AXG_BOARD_REFUSED_LIVE,          // 0 or more than 15 ahead, or the first after arming
    AXG_BOARD_REFUSED_VALUE,         // a cap above 250, or a level above 3
    AXG_BOARD_REFUSED_SAMPLES,       // n is 0, or above permit_samples_max
    AXG_BOARD_REFUSED_OLD_ECHO,      // older than the newest echo used
    AXG_BOARD_REFUSED_LATE,          // t_k + n T has passed
    AXG_BOARD_REFUSED_JOG,           // run or slow during a jog, or jog otherwise
    AXG_BOARD_REFUSED_CAP,           // an axis was faster since t_k than the proof assumes
    AXG_BOARD_REFUSALS
} axg_board_refusal;

typedef enum axg_board_phase { AXG_BOARD_STOPPED = 0, AXG_BOARD_ARMED } axg_board_phase;

// Cause of a stop.
typedef enum axg_board_cause {
    AXG_BOARD_CAUSE_POWER_UP = 0,
    AXG_BOARD_CAUSE_STOP_FRAME,
    AXG_BOARD_CAUSE_STOP_WORD,
    AXG_BOARD_CAUSE_PERMIT_ENDED,   // in motion
    AXG_BOARD_CAUSE_NOT_PERMITTED,  // axes moved without permission
    AXG_BOARD_CAUSE_CHANGED,        // the reported state changed in motion
    AXG_BOARD_CAUSE_LATCH_ORDER,    // samples out of order in number or time
    AXG_BOARD_CAUSE_HASH_DIFFERS,
    AXG_BOARD_CAUSE_PERSON
} axg_board_cause;

// A cap for each group of axes, 1/250 of rapid.
typedef struct axg_board_caps {
    uint8_t of[AXG_BOARD_CAP_GROUPS];
} axg_board_caps;

// One sample: number and instant of the latch.
typedef struct axg_board_sample {
    uint64_t latched_us;
    uint16_t lap;  // +1 whenever SYNC begins again; it wraps
    uint8_t sync;  // 1 to 240
} axg_board_sample;

typedef struct axg_board_record {
    axg_board_sample sample;
    axg_board_caps highest;  // largest cap of each group since the latch
    axg_board_caps acked;    // caps of the permit named by the sample; none without one
    bool is_kept;
    bool has_ack;
    uint8_t ack;  // low nibble of that permit's live counter
} axg_board_record;

typedef struct axg_board_permit {
    uint64_t end_us;  // t_k + n T
    axg_board_caps caps;
    axg_board_word word;
    uint8_t live;
    uint8_t level;
    bool is_given;
} axg_board_permit;

typedef enum axg_board_tool {
    AXG_BOARD_TOOL_STAYS = 0,
    AXG_BOARD_TOOL_WANTED,
    AXG_BOARD_TOOL_ANNOUNCED,
    AXG_BOARD_TOOL_CANCELLED
} axg_board_tool;

// State, about 1,000 bytes; only the library writes it. Zeroed memory is stopped.
typedef struct axg_board {
    axg_board_options options;
    uint64_t now_us;        // the latest time passed to a call; stamps are none
    uint64_t forgotten_us;  // earlier samples do not permit motion
    bool is_ready;
    axg_board_phase phase;
    axg_board_cause cause;
    uint32_t nonce;
    bool is_jogging;

    uint8_t plain[8];
    uint64_t plain_us;
    bool has_plain;
    bool has_live;
    uint8_t live;  // of the last pair with a correct answer
    axg_board_record records[AXG_BOARD_RECORDS];
    axg_board_sample newest;
    bool has_newest;
    bool has_reference;  // the next number and stamp have to be after those of `newest`
    uint8_t newest_record;
    uint32_t used_sample;  // the newest echo of a usable permit
    bool has_used;
    uint8_t permits_in_a_row;
    bool is_admitted;      // reached the number of permits since arming
    uint8_t hashes_equal;  // bit by part

    uint64_t end_us;  // E
    bool has_end;
    axg_board_permit last;     // the permit counted last
    axg_board_permit ordered;  // the newest usable permit: target of the caps
    bool is_newest_counted;    // they are the same permit
    axg_board_permit acked;
    uint32_t acked_sample;  // it is for this one
    bool is_acked_named;    // by a sample
    axg_board_caps keeps;   // u
    uint64_t keeps_us;      // of the last call of axg_board_keeps

    bool moves;
    bool has_moved;
    uint64_t rests_since_us;
    axg_board_tool tool;
    uint64_t tool_us;

    uint8_t axes_counter;
    uint8_t session_counter;
    bool has_session_changed;
    uint64_t session_us;
    axg_board_refusal last_refusal;
    uint32_t refused[AXG_BOARD_REFUSALS];  // saturating
    uint32_t permits;                      // counted
} axg_board;

// --- Time and power-up -----------------------------------------------------------------------

// The 64-bit instant of a reading of a free-running 32-bit timer of 1 us: the nearest one. So a
// capture may be extended with a time read after it.
// @param last_us  an instant at most 35 minutes before or after the reading
uint64_t axg_board_extend_us(uint64_t last_us, uint32_t timer_us);

// Initializes without permission to move. The nonce has to differ from that of the last power-up.
// @return  false: an option or the nonce is out of range; the board cannot be armed
bool axg_board_power_up(axg_board* board, const axg_board_options* options, uint32_t nonce,
                        uint64_t now_us);

typedef enum axg_board_arming {
    AXG_BOARD_ARMING_DONE = 0,
    AXG_BOARD_ARMING_MOVES,        // an axis moves
    AXG_BOARD_ARMING_REST,         // it rests for less than 16 strides
    AXG_BOARD_ARMING_NONCE,        // above AXG_BOARD_NONCE_MAX
    AXG_BOARD_ARMING_NONCE_AGAIN,  // same answers as with the last one: draw another
    AXG_BOARD_ARMING_NO_OPTIONS    // axg_board_power_up returned false
} axg_board_arming;

// A person arms: the only way out of a stop. Discards all permits and records.
axg_board_arming axg_board_arm(axg_board* board, uint32_t nonce, uint64_t now_us);

// --- In every period -------------------------------------------------------------------------

// Reports that the board latched its positions. Call it before encoding the sample's frames, and
// before axg_board_keeps with a later time: an older stamp counts as a sample at rapid. A sample
// stamped after the time of a later call permits nothing in it.
// @return  false: number or time do not follow the last sample in order since arming; all permits
//     and records are discarded, and a board in motion is stopped
bool axg_board_latch(axg_board* board, const axg_board_sample* sample);

// Processes a received data frame with an 11-bit id; do not pass extended, remote or error frames.
axg_board_heard axg_board_frame(axg_board* board, const axg_board_can_frame* frame,
                                uint64_t now_us);

typedef struct axg_board_motion {
    bool may_move;           // false: do not start; in motion: brake now, then axg_board_arm
    uint64_t end_us;         // E: if may_move, brake at this time at the latest
    axg_board_word word;     // of the permit that counted last
    uint8_t level;           // its advice, 0 to 3
    axg_board_caps keeps;    // bound of each group now
    axg_board_caps ordered;  // target: slow down to it at once, rise by axg_board_keeps
} axg_board_motion;

// Whether axes may move at now_us. Call it in every tick of each channel with the current time: E
// passed in motion latches in this or any other call with a time.
axg_board_motion axg_board_may_move(axg_board* board, uint64_t now_us);

// Reports that axes start to move, or that all are at rest. Motion without permit latches a stop.
void axg_board_moves(axg_board* board, bool moves, uint64_t now_us);

// Requests new speed bounds (AXG_BOARD_CAP_ENFORCED). A lower bound is in effect at once: the axes
// have to obey it already, in stops too. A higher bound is granted up to that of the newest permit,
// and only if that permit counts and no other axis still has to slow down for it.
// @return  the bounds to obey from now on
axg_board_caps axg_board_keeps(axg_board* board, const axg_board_caps* wanted, uint64_t now_us);

// Reports a stop by another cause: emergency stop, drive fault, a person.
void axg_board_stop(axg_board* board, uint64_t now_us);

// Reports a change of state: a jog starts, ends or reverses, another tool, another promise.
// Discards all permits and records; in motion it is a stop.
void axg_board_change(axg_board* board, bool is_jog, uint64_t now_us);

// --- Tool change -----------------------------------------------------------------------------

// Announces a tool change in the samples from the next latch on.
// @return  false: cancelled by a stop; arm first
bool axg_board_announce_tool(axg_board* board);
// Whether it may start: H(n_max) after the first announcing sample, no stop since, and axes might
// move.
bool axg_board_may_change_tool(axg_board* board, uint64_t now_us);
// Ends or abandons it. Call axg_board_change afterwards if the tool is another one.
void axg_board_end_tool(axg_board* board);
// H(n) = 1.01 n T + jitter + t_board, rounded up.
uint64_t axg_board_horizon_us(const axg_board_options* options, uint8_t samples);

// --- Frames of the board ---------------------------------------------------------------------

// State that the samples report in addition to positions.
typedef struct axg_board_says {
    uint8_t mode;  // 0 standstill, 1 moving, 2 tool change, 3 jog
    uint16_t tool;
    bool is_homed;
    bool is_spindle_on;  // this and is_rapid:
    bool is_rapid;       // not in mode 3; false if unknown
    bool jogs_down;      // mode 3: towards smaller positions
    uint8_t jog_axis;    // mode 3
} axg_board_says;

// Flags byte of the sample latched last.
uint8_t axg_board_flags(const axg_board* board, const axg_board_says* says);

typedef struct axg_board_axis_ids {
    uint32_t id;       // can.ids.axes
    uint16_t data_id;  // can.data_ids
} axg_board_axis_ids;

// Encodes the classical axis frames of the sample latched last: 1 um and 0.0001 deg per count.
// @param positions  [axis_count] counts, or AXG_BOARD_NO_POSITION
// @param ids  [frames] one for each frame
// @param out  [frames] out
// @return     frames: axis_count / 2 + 1; 0: no sample yet, a position beyond 24 bits, or a tool
//             number beyond 255, which only flexible frames have
uint8_t axg_board_encode_classical(axg_board* board, const axg_board_says* says,
                                   const int32_t positions[], const axg_board_axis_ids ids[],
                                   axg_board_can_frame out[]);
// The same as one FD frame: 0.1 um and 0.0001 deg per count.
// @return  1; 0: no sample yet
uint8_t axg_board_encode_fd(axg_board* board, const axg_board_says* says, const int32_t positions[],
                            axg_board_axis_ids ids, axg_board_can_frame* out);

// Whether the session frame is due: every 100 ms, and after a change of lap or nonce.
bool axg_board_is_session_due(const axg_board* board, uint64_t now_us);
// Encodes the session frame: nonce and lap.
// @param ids  can.ids.session_in, and its Data ID, the same number
// @return     false: no sample yet
bool axg_board_encode_session(axg_board* board, axg_board_axis_ids ids, uint64_t now_us,
                              axg_board_can_frame* out);
// Encodes the board's hash of a part, 0 to 3, in reply to the guard's.
bool axg_board_encode_hash(const axg_board* board, uint32_t id, uint8_t part,
                           axg_board_can_frame* out);
// Encodes SYNC with its counter, 1 to 240.
void axg_board_encode_sync(uint32_t id, uint8_t sync, axg_board_can_frame* out);
// Encodes the board's heartbeat: 5 operational, 127 pre-operational, 4 stopped, 0 boot-up.
void axg_board_encode_heartbeat(uint32_t id, uint8_t state, axg_board_can_frame* out);

#ifdef __cplusplus
}  // extern "C"
#endif

#endif
