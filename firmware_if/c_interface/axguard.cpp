// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/axguard.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <new>
#include <string>
#include <utility>

#include "config/machine/effective_text.hpp"
#include "firmware_if/c_interface/board_terms.hpp"
#include "firmware_if/c_interface/guard_object.hpp"
#include "firmware_if/c_interface/live_view_of.hpp"
#include "firmware_if/explain/why_sentences.hpp"
#include "firmware_if/guard/live_engine.hpp"
#include "firmware_if/guard/live_refusal.hpp"
#include "firmware_if/setup/guard_engine.hpp"

static_assert(AXG_SAMPLE_FRAMES_MAX >= axg::kFramesPerSnapshotMax);
static_assert(sizeof(axg_latch) == sizeof(axg::LatchCell) &&
              offsetof(axg_latch, inverse) == offsetof(axg::LatchCell, inverse));
static_assert(AXG_AXES_MAX == axg::kAxesMax && AXG_HASH_PARTS == axg::kHashParts);

namespace {

using axg::GuardPhase;
using axg::LiveNote;

void put_text(const std::string& words, char* text, std::size_t text_bytes) noexcept {
    if (text != nullptr && text_bytes != 0) {
        const std::size_t size = std::min(words.size(), text_bytes - 1);
        std::memcpy(text, words.data(), size);
        text[size] = '\0';
    }
}

/// Machine file and meshes; what the programs would print is in `words`.
bool read_machine(const axg_options& options, axg::LoadedMachine& out, std::string& words) {
    char* buffer = nullptr;
    std::size_t size = 0;
    std::FILE* const messages = open_memstream(&buffer, &size);
    if (messages == nullptr) {
        throw std::bad_alloc();
    }
    const bool is_read = axg::load(
        options.machine_file, options.mesh_root == nullptr ? "" : options.mesh_root, out, messages);
    std::fclose(messages);
    const std::unique_ptr<char, decltype(&std::free)> owned(buffer, &std::free);
    words.assign(buffer, size);
    return is_read;
}

/// A line for each; empty: a guard may run.
std::string refusals_of(const axg::Machine& machine) {
    std::string words;
    for (const std::string& refusal : axg::live_refusals(machine)) {
        words += (words.empty() ? "" : "\n") + refusal;
    }
    return words;
}

axg::ChosenEngine choose(const axg_options& options, const axg::LoadedMachine& loaded,
                         axg::CpuEngine& cpu) {
    constexpr std::array<const char*, 4> kWords{"", "cpu", "cuda", "auto"};
    const axg::Machine& machine = loaded.machine;
    const char* const word = kWords[static_cast<std::size_t>(options.engine)];
    return axg::choose_engine(loaded, cpu, axg::engine_choice(word, machine),
                              axg::cycle_demand(machine, options.mode == AXG_MODE_STOPPABLE));
}

/// AXG_STATUS_OK if every requested part exists, else the reason.
axg_status status_of(const axg_guard& guard) noexcept {
    if (!guard.parts.engine) {
        return AXG_STATUS_UNFIT;
    }
    if (!guard.has_all()) {
        return AXG_STATUS_NO_MEMORY;
    }
    switch (guard.chosen->refusal) {
        case axg::EngineRefusal::none:
            return AXG_STATUS_OK;
        case axg::EngineRefusal::no_gpu:
            return AXG_STATUS_NO_GPU;
        default:
            return AXG_STATUS_UNFIT;
    }
}

bool is_sound(const axg_options& options) noexcept {
    return options.machine_file != nullptr && options.engine >= 0 &&
           options.engine <= AXG_ENGINE_AUTO && options.mode >= 0 &&
           options.mode <= AXG_MODE_CONTACT && options.takes_local <= 1;
}

axg::CanFrame from_c(const axg_frame& frame) noexcept {
    axg::CanFrame out;
    out.time_us = frame.time_us;
    out.id = frame.id;
    out.extended = (frame.flags & AXG_FRAME_EXTENDED) != 0;
    out.remote = (frame.flags & AXG_FRAME_REMOTE) != 0;
    out.error = (frame.flags & AXG_FRAME_ERROR) != 0;
    out.fd = (frame.flags & AXG_FRAME_FD) != 0;
    out.bit_rate_switch = (frame.flags & AXG_FRAME_BIT_RATE_SWITCH) != 0;
    out.error_state = (frame.flags & AXG_FRAME_ERROR_STATE) != 0;
    out.sent_by_host = (frame.flags & AXG_FRAME_LOCAL) != 0;
    out.raw_dlc = frame.raw_dlc;
    out.length_bytes = frame.length_bytes;
    std::copy_n(frame.data, sizeof frame.data, out.data.begin());
    return out;
}

axg_frame to_c(const axg::CanFrame& frame) noexcept {
    axg_frame out{};
    out.time_us = frame.time_us;
    out.id = frame.id;
    out.flags = static_cast<std::uint8_t>((frame.extended ? AXG_FRAME_EXTENDED : 0) |
                                          (frame.fd ? AXG_FRAME_FD : 0) |
                                          (frame.bit_rate_switch ? AXG_FRAME_BIT_RATE_SWITCH : 0));
    out.length_bytes = frame.length_bytes;
    std::copy(frame.data.begin(), frame.data.end(), out.data);
    return out;
}

void take_notes(axg_guard& guard) noexcept {
    LiveNote note;
    while (guard.queues.notes.pop(note)) {
        if (guard.service) {
            guard.service->note(note);
        }
        switch (note.kind) {
            case LiveNote::Kind::input:
                guard.input_fault = note.fault;
                guard.input_frame = note.frame_id;
                break;
            case LiveNote::Kind::wire:
                guard.bus_fault = note.words;
                break;
            case LiveNote::Kind::refused:
                guard.refused = note.words;
                break;
            case LiveNote::Kind::phase:
                if (note.phase == GuardPhase::init) {  // reset: those of the stop are over
                    guard.input_fault = axg::ReceiverFault::none;
                    guard.input_frame = 0;
                    guard.bus_fault = "";
                }
                break;
            default:  // lost notes have no field
                break;
        }
    }
}

axg_phase phase_of(GuardPhase phase) noexcept {
    switch (phase) {
        case GuardPhase::init:
            return AXG_PHASE_INIT;
        case GuardPhase::selftest:
            return AXG_PHASE_SELFTEST;
        case GuardPhase::ready:
            return AXG_PHASE_READY;
        case GuardPhase::armed:
            return AXG_PHASE_ARMED;
        default:
            return AXG_PHASE_STOPPED;
    }
}

/// The version before this one had no proof in its state.
constexpr std::uint32_t kVersionWithoutProof = 2;

std::size_t state_bytes(const axg_guard& guard) noexcept {
    return guard.version == kVersionWithoutProof ? offsetof(axg_state, proof) : sizeof(axg_state);
}

axg_proof proof_of(const axg_guard& guard) noexcept {
    const axg::CycleResult& result = guard.last.result;
    const axg::GuardNode& live = *guard.guard;
    axg_proof proof{};
    proof.samples_evaluated = guard.evaluated;
    proof.reason = axg::to_text(result.reason);
    proof.withheld = axg::to_text(live.withheld().why);
    proof.pair = AXG_NO_PAIR;
    proof.cap = axg::kPermitCapNone;
    proof.clearance_mm = proof.needed_mm = -1;
    if (guard.evaluated == 0) {
        return proof;
    }
    const axg::Permit permit = axg::permit_of(result, 0, guard.last.sync_counter);
    proof.sync_counter = permit.sync_counter;
    proof.is_proven = result.has_permit ? 1 : 0;
    proof.samples = permit.samples;
    proof.level = permit.level;
    proof.cap = permit.cap;
    proof.pair = result.has_permit ? result.advisories.pair : result.pair;
    if (proof.pair < guard.loaded.machine.pairs.size()) {
        proof.needed_mm = guard.loaded.machine.pairs[proof.pair].margin_mm;
        proof.clearance_mm = result.has_permit ? result.advisories.distance_mm : -1;
    }
    return proof;
}

axg_state state_of(const axg_guard& guard) noexcept {
    const axg::GuardNode& live = *guard.guard;
    axg_state state{};
    state.phase = phase_of(live.guard().phase);
    state.cause = axg::to_text(live.guard().cause);
    state.reason = axg::to_text(live.reason());
    state.pair = live.pair();
    state.input_fault =
        guard.input_fault == axg::ReceiverFault::none ? "" : axg::fault_row(guard.input_fault).name;
    state.input_frame = guard.input_frame;
    state.refused = guard.refused;
    state.bus_fault = guard.bus_fault;
    state.next_due_us = live.next_due_us();
    state.has_query = guard.has_query.load() ? 1 : 0;
    state.is_confirmed =
        live.guard().phase == GuardPhase::stopped && live.guard().is_confirmed ? 1 : 0;
    state.snapshots = live.counters().snapshots;
    state.permits = live.counters().permits;
    state.stops = live.counters().stops;
    state.late = live.counters().late;
    state.samples_lost = live.receiver().counters().samples_lost;
    state.proof = proof_of(guard);
    return state;
}

/// Returns the fault of the input or the bus that stopped.
std::string detail_of(const axg_guard& guard, axg::GuardFault cause) {
    if (cause == axg::GuardFault::input && guard.input_fault != axg::ReceiverFault::none) {
        const axg::FaultRow& row = axg::fault_row(guard.input_fault);
        return std::string(row.name) + " (" + row.meaning + ")";
    }
    const bool is_bus = cause == axg::GuardFault::input || cause == axg::GuardFault::output;
    return is_bus ? guard.bus_fault : "";
}

void explain(axg_guard& guard, std::int32_t program_line, axg_stop& out) {
    axg::StopView view = guard.desk->view(axg::stop_in_force(*guard.guard));
    view.account.program_line = guard.program_line = program_line;
    view.account.detail = detail_of(guard, view.account.cause);
    std::string words;
    for (const std::string& sentence : axg::stop_sentences(view.account)) {
        words += (words.empty() ? "" : "\n") + sentence;
        ++out.line_count;
    }
    put_text(words, out.text, sizeof out.text);
    out.pair = view.account.a.empty() ? AXG_NO_PAIR : guard.guard->pair();
    if (view.why) {
        out.clearance_mm = std::max(0.0, view.why->distances.available_mm);
        out.needed_mm = view.why->distances.need.sum_mm();
    }
}

}  // namespace

axg_guard::axg_guard(axg::LoadedMachine&& machine, const axg_options& wanted)
    : loaded(std::move(machine)),
      parts(loaded, wanted.mode == AXG_MODE_STOPPABLE),
      is_stoppable(wanted.mode == AXG_MODE_STOPPABLE),
      file(std::filesystem::path(wanted.machine_file).filename().string()),
      samples(loaded.machine),
      version(wanted.version) {
    if (!has_all()) {
        words = parts.fault();
        return;
    }
    chosen.emplace(choose(wanted, loaded, *parts.engine));
    words = chosen->words;
    for (const std::string& warning : axg::live_warnings(loaded.machine)) {
        words += (words.empty() ? "" : "\n") + warning;
    }
    for (const axg::Pair& pair : loaded.machine.pairs) {
        pairs.push_back(loaded.machine.bodies[pair.a].name + " - " +
                        loaded.machine.bodies[pair.b].name);
    }
    chain.emplace(loaded.machine, chosen->engine(*parts.engine), *parts.containment_test,
                  parts.cycle.chain());
    desk.emplace(loaded, *parts.engine, *parts.containment_test, file);
    options.accepts_local = wanted.takes_local != 0;
    options.hashes = axg::configuration_hashes(loaded.machine, loaded.meshes);
    axg::set_latch(forgotten, false);
    if (wanted.latch != nullptr) {
        latch = reinterpret_cast<axg::LatchCell*>(wanted.latch);
    }
}

extern "C" {

axg_status axg_guard_create(const axg_options* options, axg_guard** out, char* text,
                            size_t text_bytes) {
    put_text("", text, text_bytes);
    if (out != nullptr) {
        *out = nullptr;
    }
    if (options == nullptr || out == nullptr) {
        return AXG_STATUS_BAD_CALL;
    }
    if (options->version != AXG_INTERFACE_VERSION && options->version != kVersionWithoutProof) {
        return AXG_STATUS_BAD_VERSION;
    }
    if (!is_sound(*options)) {
        return AXG_STATUS_BAD_CALL;
    }
    try {
        axg::LoadedMachine loaded;
        std::string words;
        const bool is_read = read_machine(*options, loaded, words);
        if (is_read) {
            words = refusals_of(loaded.machine);
        }
        if (!is_read || !words.empty()) {
            put_text(words, text, text_bytes);
            return AXG_STATUS_BAD_INPUT;
        }
        auto guard = std::make_unique<axg_guard>(std::move(loaded), *options);
        put_text(guard->words, text, text_bytes);
        const axg_status status = status_of(*guard);
        *out = status == AXG_STATUS_OK ? guard.release() : nullptr;
        return status;
    } catch (const std::bad_alloc&) {
        put_text("out of memory. Close other programs.", text, text_bytes);
        return AXG_STATUS_NO_MEMORY;
    } catch (...) {
        put_text("internal error. Report it with the machine file.", text, text_bytes);
        return AXG_STATUS_INTERNAL;
    }
}

axg_status axg_guard_start(axg_guard* guard, int64_t now_us) {
    if (guard == nullptr || guard->guard) {
        return AXG_STATUS_BAD_CALL;
    }
    guard->guard.emplace(guard->loaded.machine, guard->options, guard->wire, guard->queues,
                         *guard->latch, now_us);
    guard->has_query.store(true);  // the self-test; where it is latched, nothing is there
    return AXG_STATUS_OK;
}

axg_status axg_guard_receive(axg_guard* guard, const axg_frame* frame) {
    if (guard == nullptr || !guard->guard || frame == nullptr ||
        frame->length_bytes > sizeof frame->data || frame->reserved != 0) {
        return AXG_STATUS_BAD_CALL;
    }
    const axg::CanArrival arrival{.frame = from_c(*frame),
                                  .is_own = (frame->flags & AXG_FRAME_OWN) != 0};
    return guard->wire.arrive(arrival) ? AXG_STATUS_OK : AXG_STATUS_QUEUE_FULL;
}

axg_status axg_guard_put_sample(axg_guard* guard, const axg_sample* sample, int64_t now_us) {
    if (guard == nullptr || !guard->guard || sample == nullptr) {
        return AXG_STATUS_BAD_CALL;
    }
    const std::span<const axg::CanFrame> frames = guard->samples.encode(*sample, now_us);
    if (frames.empty()) {
        return AXG_STATUS_BAD_CALL;
    }
    bool is_queued = true;
    for (const axg::CanFrame& frame : frames) {
        is_queued = guard->wire.arrive({.frame = frame}) && is_queued;
    }
    return is_queued ? AXG_STATUS_OK : AXG_STATUS_QUEUE_FULL;
}

axg_status axg_guard_encode_sample(axg_guard* guard, const axg_sample* sample, axg_frame out[],
                                   uint32_t capacity, uint32_t* count) {
    if (guard == nullptr || sample == nullptr || out == nullptr || count == nullptr) {
        return AXG_STATUS_BAD_CALL;
    }
    const std::span<const axg::CanFrame> frames =
        guard->samples.encode(*sample, sample->latched_us);
    if (frames.empty() || frames.size() > capacity) {
        return AXG_STATUS_BAD_CALL;
    }
    std::transform(frames.begin(), frames.end(), out, to_c);
    *count = static_cast<std::uint32_t>(frames.size());
    return AXG_STATUS_OK;
}

axg_status axg_guard_process(axg_guard* guard, int64_t now_us, axg_state* out) {
    if (guard == nullptr || !guard->guard || out == nullptr) {
        return AXG_STATUS_BAD_CALL;
    }
    axg::LiveResult live_result;
    while (guard->undated.pop(live_result)) {
        live_result.done_us = now_us;
        if (live_result.kind == axg::LiveQuery::Kind::snapshot) {
            guard->last = live_result;
            ++guard->evaluated;
        }
        // Both queues have one capacity, and the turn below empties that one.
        [[maybe_unused]] const bool is_pushed = guard->queues.results.push(live_result);
    }
    guard->guard->turn(now_us);
    guard->desk->set_stop(*guard->guard);
    if (guard->guard->has_submitted()) {
        guard->has_query.store(true);
    }
    take_notes(*guard);
    if (guard->service) {
        guard->service->show(now_us, [&] { return axg::live_view_of(*guard, now_us); });
    }
    const axg_state state = state_of(*guard);
    std::memcpy(out, &state, state_bytes(*guard));
    return AXG_STATUS_OK;
}

axg_status axg_guard_evaluate(axg_guard* guard) {
    if (guard == nullptr || !guard->guard) {
        return AXG_STATUS_BAD_CALL;
    }
    guard->has_query.store(false);
    const axg::LiveEngine live{.machine = guard->loaded.machine, .chain = *guard->chain};
    axg::run_queries(live, guard->queues, [guard](const axg::LiveResult& live_result) {
        // Full only if no thread processes; then no thread needs it.
        [[maybe_unused]] const bool is_kept = guard->undated.push(live_result);
        guard->desk->note(live_result, *guard->chain);
    });
    return AXG_STATUS_OK;
}

axg_status axg_guard_next_tx_frame(axg_guard* guard, axg_frame* out) {
    if (guard == nullptr || out == nullptr) {
        return AXG_STATUS_BAD_CALL;
    }
    axg::CanFrame frame;
    if (!guard->wire.take(frame)) {
        return AXG_STATUS_EMPTY;
    }
    *out = to_c(frame);
    return AXG_STATUS_OK;
}

axg_status axg_guard_notify(axg_guard* guard, int32_t event, int64_t now_us) {
    if (guard == nullptr || !guard->guard) {
        return AXG_STATUS_BAD_CALL;
    }
    guard->refused = "";
    switch (event) {
        case AXG_EVENT_ARM:
            guard->guard->arm(now_us);
            break;
        case AXG_EVENT_RESET:
            guard->guard->reset(now_us);
            guard->has_query.store(true);  // after one that had an effect there is a self-test
            break;
        case AXG_EVENT_BUS_DOWN:
            guard->wire.go_down();
            break;
        case AXG_EVENT_FRAMES_LOST:
            guard->guard->report(axg::GuardFault::input_noise, now_us);
            break;
        case AXG_EVENT_SUSPENDED:
            guard->guard->report(axg::GuardFault::gap, now_us);
            break;
        default:
            return AXG_STATUS_BAD_CALL;
    }
    take_notes(*guard);
    return AXG_STATUS_OK;
}

const char* axg_guard_pair_name(const axg_guard* guard, uint32_t pair) {
    return guard == nullptr || pair >= guard->pairs.size() ? "" : guard->pairs[pair].c_str();
}

axg_status axg_guard_explain(axg_guard* guard, int32_t program_line, axg_stop* out) {
    if (guard == nullptr || !guard->guard || out == nullptr) {
        return AXG_STATUS_BAD_CALL;
    }
    *out = {.pair = AXG_NO_PAIR, .line_count = 0, .clearance_mm = -1, .needed_mm = -1, .text = {}};
    if (guard->guard->guard().phase != GuardPhase::stopped) {
        return AXG_STATUS_OK;
    }
    try {
        explain(*guard, program_line, *out);
        return AXG_STATUS_OK;
    } catch (...) {
        return AXG_STATUS_NO_MEMORY;
    }
}

double axg_guard_tool_length_mm(const axg_guard* guard, uint16_t tool) {
    if (guard == nullptr) {
        return -1;
    }
    const axg::Machine& machine = guard->loaded.machine;
    const std::uint16_t number = tool != 0 ? tool : machine.first_tool;
    const auto found =
        std::find_if(machine.tools.begin(), machine.tools.end(),
                     [number](const axg::Tool& one) { return one.number == number; });
    return found == machine.tools.end() ? -1 : found->length_mm;
}

axg_status axg_guard_terms(const axg_guard* guard, axg_terms* out) {
    if (guard == nullptr || out == nullptr) {
        return AXG_STATUS_BAD_CALL;
    }
    *out = axg::board_terms(guard->loaded.machine, guard->options.hashes);
    return AXG_STATUS_OK;
}

void axg_guard_destroy(axg_guard* guard) {
    if (guard != nullptr && guard->guard) {
        guard->guard->end();
    }
    delete guard;
}

void axg_latch_clear(axg_latch* latch) {
    if (latch != nullptr) {
        axg::set_latch(*reinterpret_cast<axg::LatchCell*>(latch), false);
    }
}

const char* axg_status_text(axg_status status) {
    switch (status) {
        case AXG_STATUS_OK:
            return "ok";
        case AXG_STATUS_EMPTY:
            return "no frame available";
        case AXG_STATUS_BAD_CALL:
            return "a null pointer, a value out of range, or a call before or after the start";
        case AXG_STATUS_BAD_VERSION:
            return "another version of the interface; compile with this library's axguard.h";
        case AXG_STATUS_BAD_INPUT:
            return "the machine file or its meshes are invalid. Run axguard check.";
        case AXG_STATUS_NO_GPU:
            return "no usable GPU. Use AXG_ENGINE_CPU.";
        case AXG_STATUS_UNFIT:
            return "this processor or GPU cannot run the guard in time";
        case AXG_STATUS_NO_MEMORY:
            return "out of memory";
        case AXG_STATUS_QUEUE_FULL:
            return "256 frames are already queued. Call axg_guard_process more often.";
        case AXG_STATUS_INTERNAL:
            return "an internal error";
    }
    return "unknown status";
}

const char* axg_library_version(void) {
    return AXG_VERSION;
}

}  // extern "C"
