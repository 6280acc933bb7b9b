// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/commands/black_box_command.hpp"
#include "firmware_if/setup/format_plan.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <cstring>
#include <optional>
#include <string_view>

#include "config/machine/effective_text.hpp"
#include "config/text/quote_text.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/cli/guard_exit.hpp"
#include "firmware_if/setup/choose_engine.hpp"
#include "firmware_if/setup/guard_parts.hpp"
#include "hil_replay/commands/commands_json.hpp"
#include "hil_replay/replay/black_box_file.hpp"
#include "hil_replay/replay/black_box_replay.hpp"
#include "hil_replay/replay/replay_csv.hpp"
#include "hil_replay/replay/why_stop.hpp"
#include "hil_replay/trace/candump_log.hpp"
#include "hil_replay/trace/kept_input.hpp"

namespace axg {
namespace {

std::string_view configuration_of(const BlackBoxFile& black_box) {
    return {black_box.header().configuration.data(), black_box.header().configuration.size()};
}

/// Another machine gives other verdicts: only with any_machine.
bool is_its_machine(const BlackBoxArguments& arguments, const BlackBoxFile& black_box,
                    const LoadedMachine& loaded) {
    const std::string here = configuration_hash(loaded.machine, loaded.meshes);
    if (here == configuration_of(black_box)) {
        return true;
    }
    fmt::print(stderr, "{}: configuration mismatch (found {}, expected {} of this machine). {}\n",
               escaped(arguments.file, 4096), escaped(configuration_of(black_box)), here,
               arguments.any_machine ? "Replaying with this machine (--lenient)."
                                     : "Pass the machine file and meshes of that run, or replay "
                                       "with this machine with --lenient.");
    return arguments.any_machine;
}

/// A reason, and the pair where it is about one.
std::string reason_text(StopReason reason, std::uint32_t pair, const Machine& machine,
                        const char* between) {
    const bool has_pair = pair < machine.pairs.size();
    return has_pair ? to_text(reason) + (between + pair_name(machine, pair)) : to_text(reason);
}

/// One line of what the guard noted, as its own log had it.
void print_note(const LiveNote& note, const Machine& machine, std::FILE* words) {
    fmt::print(words, "{:6}.{:06} ", note.time_us / 1'000'000, note.time_us % 1'000'000);
    switch (note.kind) {
        case LiveNote::Kind::phase:
            fmt::print(words, "{}", to_text(note.phase));
            if (note.phase == GuardPhase::stopped) {
                fmt::print(words, ": {}", to_text(note.cause));
            }
            if (note.cause == GuardFault::verdict && note.phase == GuardPhase::stopped) {
                fmt::print(words, ": {}", reason_text(note.reason, note.pair, machine, ": "));
            }
            break;
        case LiveNote::Kind::input:
            fmt::print(words, "input: {}, frame {:03X}", fault_row(note.fault).name, note.frame_id);
            if (note.fault == ReceiverFault::sync_period) {
                fmt::print(words, ", measured {:.3f} us, declared {:.0f} us", note.theirs / 1000.0,
                           note.ours / 1000.0);
            }
            break;
        case LiveNote::Kind::hashes:
            fmt::print(words, "hashes: {}: board {:08x}, guard {:08x}", escaped(note.words),
                       note.theirs, note.ours);
            break;
        case LiveNote::Kind::withheld:
            fmt::print(words, "withheld: {}", reason_text(note.reason, note.pair, machine, ": "));
            break;
        case LiveNote::Kind::motion:
            fmt::print(words, "{} {}",
                       note.axis < machine.axes.size() ? machine.axes[note.axis].name : "an axis",
                       escaped(note.words));
            break;
        default:
            fmt::print(words, "{}", escaped(note.words));
    }
    fmt::print(words, "\n");
}

std::string describe(const BlackBoxStop& stop, const Machine& machine) {
    switch (stop.cause) {
        case GuardFault::verdict:
            return fmt::format("{}, sample of {}.{:06} s",
                               reason_text(stop.reason, stop.pair, machine, ", "),
                               stop.latched_us / 1'000'000, stop.latched_us % 1'000'000);
        case GuardFault::input:
            return fmt::format("input: {}", fault_row(stop.fault).name);
        default:
            return to_text(stop.cause);
    }
}

void print_comparison(const char* what, const BlackBoxComparison& all, std::FILE* words) {
    fmt::print(words, "{}: {} equal to the record, {} different", what, all.same, all.different);
    if (all.run_in != 0) {
        fmt::print(words, "; {} not compared: the dump does not reach back to the start",
                   all.run_in);
    }
    fmt::print(words, "\n");
}

void print_sent(const ReplayedBlackBox& result, std::FILE* words) {
    if (!result.sent) {
        fmt::print(words, "frames sent: not compared: the dump does not reach back to the start\n");
        return;
    }
    fmt::print(words, "frames sent: {} equal to the record, {} different\n", result.sent->same,
               result.sent->different);
    if (const std::optional<SentFrame>& first = result.sent->first_different) {
        fmt::print(words, "first difference: {}.{:06} s, frame {:03X}\n",
                   first->frame.time_us / 1'000'000, first->frame.time_us % 1'000'000,
                   first->frame.id);
    }
}

void print_stop(const ReplayedBlackBox& result, const Machine& machine, std::FILE* words) {
    if (!result.recorded) {
        fmt::print(words, "no stop was recorded\n");
        return;
    }
    fmt::print(words, "stop recorded: {}\n", describe(*result.recorded, machine));
    if (!can_be_reproduced(result)) {
        fmt::print(words, "stop replayed: not reproducible, caused by timing or by the wire\n");
    } else if (is_reproduced(result)) {
        fmt::print(words, "stop replayed: equal to the record\n");
    } else {
        fmt::print(words, "stop replayed: {}\n",
                   result.replayed ? describe(*result.replayed, machine) : "none");
    }
}

std::optional<StopWhy> why_of_refused(const ReplayedBlackBox& result, const WhySources& sources) {
    if (!result.refused) {
        return std::nullopt;
    }
    const RefusedCycle& refused = *result.refused;
    return why_of(sources, {refused.reason, refused.pair, refused.snapshot, refused.unproven});
}

void print_why(const ReplayedBlackBox& result, const std::optional<StopWhy>& why,
               const ProgramLines& lines, const Machine& machine, Detail detail, std::FILE* words) {
    if (!result.recorded && result.refused) {
        fmt::print(words, "permit withheld to the end: {}\n",
                   reason_text(result.refused->reason, result.refused->pair, machine, ", "));
    }
    if (result.refused) {
        fmt::print(words, "{}", format_step_at(lines, result.refused->snapshot.arrived_us));
    }
    if (why) {
        fmt::print(words, "{}", format_why(machine, *why, detail));
    }
}

/// Time from the last frame of a sample until its permit was on the bus.
void print_times(const ReplayedBlackBox& result, std::FILE* words) {
    const TimeHistogram& times = result.permit_time;
    if (times.count() != 0) {
        fmt::print(words, "sample to permit, us: p50 {}, p90 {}, p99 {}, max {}, count {}\n",
                   times.at_share_ns(0.5) / 1000, times.at_share_ns(0.9) / 1000,
                   times.at_share_ns(0.99) / 1000, times.most_ns() / 1000, times.count());
    }
    if (result.stop_us >= 0) {
        fmt::print(words, "sample to stop, us: {}\n", result.stop_us);
    }
}

/// Every record: judged, its notes printed, its frames written down, its samples matched.
void feed(BlackBoxFile& black_box, BlackBoxReplay& replay, CandumpWriter* frames,
          ProgramFinder* program, const Machine& machine, std::FILE* words) {
    BlackBoxRecord record;
    while (black_box.next(record)) {
        replay.on_record(record);
        if (const auto* note = std::get_if<LiveNote>(&record.entry.content)) {
            print_note(*note, machine, words);
        }
        const auto* query = std::get_if<LiveQuery>(&record.entry.content);
        if (program != nullptr && query != nullptr && query->kind == LiveQuery::Kind::snapshot) {
            program->add(query->event.snapshot);
        }
        const auto* arrival = std::get_if<CanArrival>(&record.entry.content);
        if (arrival != nullptr && frames != nullptr) {
            CanFrame frame = arrival->frame;
            frame.sent_by_host = arrival->is_own;
            frames->write(frame);
        }
    }
}

int exit_code_of(const BlackBoxFile& black_box, const ReplayedBlackBox& result) {
    if (!black_box.error().empty()) {
        return kExitCan;
    }
    const bool is_found_again = !can_be_reproduced(result) || is_reproduced(result);
    const std::uint64_t different = result.snapshots.different + result.verdicts.different +
                                    (result.sent ? result.sent->different : 0);
    if (different != 0 || !is_found_again) {
        return kExitInternal;
    }
    return result.recorded ? exit_code_of(result.recorded->cause) : kExitClean;
}

int judge(const BlackBoxArguments& arguments, BlackBoxFile& black_box, const LoadedMachine& loaded,
          Engine engine, const ContainmentTest& containment_test, CycleParts& parts) {
    std::FILE* const words = arguments.json.words();
    const Machine& machine = loaded.machine;
    GuardChain chain(machine, engine, containment_test, parts.chain());
    LiveOptions options;
    options.accepts_local = black_box.header().accepts_local;
    options.hashes = configuration_hashes(machine, loaded.meshes);
    BlackBoxReplay replay(machine, chain, options);
    std::optional<CandumpWriter> frames;
    if (!arguments.frames_out.empty()) {
        frames.emplace(arguments.frames_out, "can0", true);
    }
    const std::time_t seconds = black_box.header().unix_us / 1'000'000;
    fmt::print(words, "{}: {}, {} mode, written {:%Y-%m-%d %H:%M:%S} UTC\n",
               escaped(arguments.file, 4096), machine.name,
               black_box.header().is_stoppable ? "stoppable" : "contact", fmt::gmtime(seconds));
    if (black_box.header().is_stoppable) {
        fmt::print(words, "plan: {}\n", format_plan(black_box.header().plan));
    }
    feed(black_box, replay, frames ? &*frames : nullptr, arguments.program, machine, words);
    const ProgramLines lines =
        arguments.program != nullptr ? arguments.program->finish() : ProgramLines{};
    const ReplayedBlackBox result = replay.result();
    fmt::print(words, "{:.3f} s, {} records, {} lost; frames: {} read, {} sent, {} refused\n",
               static_cast<double>(result.last_us - result.first_us) * 1e-6, result.records,
               result.lost, result.frames_read, result.frames_sent, result.frames_refused);
    print_comparison("snapshots", result.snapshots, words);
    print_comparison("verdicts", result.verdicts, words);
    print_sent(result, words);
    print_stop(result, machine, words);
    const std::optional<StopWhy> why = why_of_refused(result, {loaded, chain.engine()});
    print_why(result, why, lines, machine, arguments.detail, words);
    print_times(result, words);
    if (!black_box.error().empty()) {
        fmt::print(stderr, "{}\n", black_box.error());
    }
    bool is_written =
        write_json(arguments.json,
                   describe_black_box({arguments.file, machine, black_box, result, why, lines}));
    if (frames && !frames->finish()) {
        fmt::print(stderr, "{}\n", frames->error());
        is_written = false;
    }
    return is_written ? exit_code_of(black_box, result) : kExitInternal;
}

}  // namespace

bool is_black_box_file(const std::string& path) {
    std::FILE* const file = open_input(path);
    if (file == nullptr) {
        return false;
    }
    std::array<char, kBlackBoxMagic.size()> bytes{};
    const std::size_t count = std::fread(bytes.data(), 1, bytes.size(), file);
    std::fclose(file);
    return count == bytes.size() &&
           std::memcmp(bytes.data(), kBlackBoxMagic.data(), bytes.size()) == 0;
}

int replay_black_box(const BlackBoxArguments& arguments, LoadedMachine& loaded) {
    BlackBoxFile black_box = BlackBoxFile::open(arguments.file);
    if (!black_box.error().empty()) {
        fmt::print(stderr, "{}\n", black_box.error());
        return kExitCan;
    }
    if (!is_its_machine(arguments, black_box, loaded)) {
        return kExitInput;
    }
    const bool is_stoppable = black_box.header().is_stoppable;
    loaded.machine.plan = black_box.header().plan;  // of whatever device it was written on
    GuardParts parts(loaded, is_stoppable);
    if (!parts.fault().empty()) {
        fmt::print(stderr, "{}\n", parts.fault());
        return kExitUnfit;
    }
    ChosenEngine chosen = choose_and_report(loaded, *parts.engine, arguments.engine,
                                            cycle_demand(loaded.machine, is_stoppable));
    if (chosen.refusal != EngineRefusal::none) {
        return exit_code_of(chosen.refusal);
    }
    const int code = judge(arguments, black_box, loaded, chosen.engine(*parts.engine),
                           *parts.containment_test, parts.cycle);
    return report_if_gave_up(chosen) ? static_cast<int>(kExitGpu) : code;
}

}  // namespace axg
