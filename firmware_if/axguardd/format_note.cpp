// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/axguardd/format_note.hpp"

#include <fmt/format.h>

#include <string_view>

#include "firmware_if/explain/why_sentences.hpp"

namespace axg {
namespace {

std::string_view next_step(const LiveNote& note) noexcept {
    switch (note.phase) {
        case GuardPhase::stopped:
            return "; when the machine is at rest and the cause is removed, reset with kill -USR2";
        case GuardPhase::ready:
            return "; arm with kill -USR1";
        default:
            return "";
    }
}

/// A reason, and the pair by its names in the machine file.
char* write_reason(const LiveNote& note, const Machine& machine, char* out, std::size_t size) {
    char* const end = fmt::format_to_n(out, size, ": {}", to_text(note.reason)).out;
    if (note.pair >= machine.pairs.size()) {
        return end;
    }
    const Pair& pair = machine.pairs[note.pair];
    return fmt::format_to_n(end, size - static_cast<std::size_t>(end - out), ": {} - {}",
                            machine.bodies[pair.a].name, machine.bodies[pair.b].name)
        .out;
}

char* write_cause(const LiveNote& note, const Machine& machine, char* out, std::size_t size) {
    if (note.phase != GuardPhase::stopped) {
        return out;
    }
    char* const end = fmt::format_to_n(out, size, ": {}", to_text(note.cause)).out;
    if (note.cause != GuardFault::verdict) {
        return end;
    }
    char* const next = write_reason(note, machine, end, size - static_cast<std::size_t>(end - out));
    return note.reason == StopReason::tool
               ? fmt::format_to_n(next, size - static_cast<std::size_t>(next - out),
                                  "; the machine file does not have it: {}", kUnknownToolWay)
                     .out
               : next;
}

char* write_period(const LiveNote& note, char* out, std::size_t size) {
    return fmt::format_to_n(out, size,
                            "; measured {:.3f} us, declared {:.0f} us: correct can.sample_us, or "
                            "the board's period",
                            note.theirs / 1000.0, note.ours / 1000.0)
        .out;
}

char* write_body(const LiveNote& note, const Machine& machine, char* out, std::size_t size) {
    switch (note.kind) {
        case LiveNote::Kind::phase: {
            char* const begin = fmt::format_to_n(out, size, "{}", to_text(note.phase)).out;
            const std::size_t left = size - static_cast<std::size_t>(begin - out);
            char* const end = write_cause(note, machine, begin, left);
            return fmt::format_to_n(end, size - static_cast<std::size_t>(end - out), "{}",
                                    next_step(note))
                .out;
        }
        case LiveNote::Kind::input: {
            const std::string_view axis = note.axis < machine.axes.size()
                                              ? std::string_view(machine.axes[note.axis].name)
                                              : std::string_view("-");
            char* const end = fmt::format_to_n(out, size, "input: {} ({}), frame {:03X}, axis {}",
                                               fault_row(note.fault).name,
                                               fault_row(note.fault).meaning, note.frame_id, axis)
                                  .out;
            return note.fault == ReceiverFault::sync_period
                       ? write_period(note, end, size - static_cast<std::size_t>(end - out))
                       : end;
        }
        case LiveNote::Kind::wire:
            return note.frame_id == 0
                       ? fmt::format_to_n(out, size, "bus: {}", note.words).out
                       : fmt::format_to_n(out, size, "bus: {} ({:03X})", note.words, note.frame_id)
                             .out;
        case LiveNote::Kind::refused:
            return note.frame_id == 0 ? fmt::format_to_n(out, size, "rejected: {}", note.words).out
                                      : fmt::format_to_n(out, size, "rejected: {} ({:03X})",
                                                         note.words, note.frame_id)
                                            .out;
        case LiveNote::Kind::hashes:
            return fmt::format_to_n(out, size,
                                    "hashes: {}: board {:08x}, guard {:08x}; configure both for "
                                    "the same machine (axguard check prints the hashes)",
                                    note.words, note.theirs, note.ours)
                .out;
        case LiveNote::Kind::withheld: {
            char* const begin = fmt::format_to_n(out, size, "withheld").out;
            char* const end =
                write_reason(note, machine, begin, size - static_cast<std::size_t>(begin - out));
            const char* const what =
                note.reason == StopReason::left_limits
                    ? "; an axis exceeded a declared limit, see the line left_limits"
                : note.reason == StopReason::own_stop
                    ? "; the board stops by itself, see the line own_stop: at rest, arm the board, "
                      "then the guard"
                    : "; not proven at this position: jog away, or move the machine by hand";
            return fmt::format_to_n(end, size - static_cast<std::size_t>(end - out), "{}", what)
                .out;
        }
        case LiveNote::Kind::motion:
            return fmt::format_to_n(
                       out, size, "{} {}",
                       note.axis < machine.axes.size() ? machine.axes[note.axis].name : "an axis",
                       note.words)
                .out;
        case LiveNote::Kind::person:
            return fmt::format_to_n(out, size, "{} ({:03X})", note.words, note.frame_id).out;
        case LiveNote::Kind::lost:
            return fmt::format_to_n(out, size, "{} messages lost", note.count).out;
    }
    return out;
}

}  // namespace

std::size_t format_note(const LiveNote& note, const Machine& machine,
                        std::span<char> out) noexcept {
    const std::size_t room = out.size() - 1;
    const auto head = fmt::format_to_n(out.data(), room, "{}.{:06} ", note.time_us / 1'000'000,
                                       note.time_us % 1'000'000);
    char* end =
        write_body(note, machine, head.out, room - static_cast<std::size_t>(head.out - out.data()));
    *end++ = '\n';
    return static_cast<std::size_t>(end - out.data());
}

}  // namespace axg
