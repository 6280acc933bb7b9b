// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/watch/watch_state.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "config/text/quote_text.hpp"

namespace axg {
namespace {

constexpr std::uint64_t kHeldMs = 1000;  // as axguardd status has it

bool is_recent(std::int64_t time_us, std::int64_t now_us, std::int64_t within_us) {
    return time_us != kNeverSeen && now_us - time_us <= within_us;
}

bool is_heard(const WatchInput& input) {
    return input.bus != nullptr && is_recent(input.bus->guard_us, input.now_us, kGuardSilentUs);
}

bool has_status(const WatchInput& input) {
    return input.status.has_value() && is_recent(input.status_us, input.now_us, kStatusOldUs) &&
           input.status_fault.empty();
}

/// The phase in the words of the page.
WatchHeadline headline_of_phase(const std::string& phase) {
    if (phase == "armed") {
        return {"armed", "Armed", {}};
    }
    if (phase == "ready") {
        return {"ready", "Ready to be armed", {}};
    }
    if (phase == "selftest") {
        return {"selftest", "Self-test", {}};
    }
    return {"init", "Starting", {}};
}

std::string words_of_stop(const GuardLine& line) {
    std::string out = "STOP: " + line.cause;
    out += line.reason == "none" ? "" : ": " + line.reason;
    out += line.pair.empty() ? "" : ": " + line.pair;
    return line.program_line == 0 ? out
                                  : fmt::format("{}, program line {}", out, line.program_line);
}

/// Empty: the frame has none.
std::string pair_of_emergency(const WatchInput& input) {
    const std::optional<Emergency>& emergency = input.bus->emergency;
    constexpr std::uint8_t kNoPair = 255;
    const bool has_pair =
        emergency && emergency->pair != kNoPair && emergency->pair < input.machine.pairs.size();
    return has_pair ? words_of_pair(input.machine, emergency->pair) : std::string();
}

std::string words_of_emergency(const WatchInput& input) {
    const std::optional<Emergency>& emergency = input.bus->emergency;
    if (!emergency) {
        return "STOP";
    }
    const std::string pair = pair_of_emergency(input);
    return fmt::format("STOP: {}{}", to_text(emergency->code), pair.empty() ? "" : ": " + pair);
}

WatchHeadline headline_of_line(const WatchInput& input) {
    const GuardLine& line = *input.status;
    WatchHeadline out = line.phase == "stopped" ? WatchHeadline{"stopped", words_of_stop(line), {}}
                                                : headline_of_phase(line.phase);
    out.since_ms =
        line.has_view ? std::optional(static_cast<std::int64_t>(line.phase_ms)) : std::nullopt;
    if (line.phase != "stopped" && line.age_ms > kHeldMs) {
        return {"unreachable", "The guard's bus thread is blocked",
                static_cast<std::int64_t>(line.age_ms)};
    }
    return out;
}

/// The headline of a guard that sends on the bus, and whose socket is not read.
WatchHeadline headline_of_bus(const WatchInput& input) {
    const BusState& bus = *input.bus;
    if (bus.heartbeat == GuardHeartbeat::tripped) {
        return {"stopped", words_of_emergency(input), {}};
    }
    constexpr std::int64_t kPhaseOldUs = 1'000'000;
    if (bus.phase && is_recent(bus.phase_us, input.now_us, kPhaseOldUs)) {
        return *bus.phase == GuardPhase::stopped
                   ? WatchHeadline{"stopped", words_of_emergency(input), {}}
                   : headline_of_phase(to_text(*bus.phase));
    }
    if (bus.permit_end_us != kNeverSeen && bus.permit_end_us > input.now_us - kGuardSilentUs) {
        return headline_of_phase("armed");
    }
    return bus.heartbeat == GuardHeartbeat::running
               ? WatchHeadline{"running", "Running: ready or armed", {}}
               : headline_of_phase("init");
}

WatchHeadline headline_now(const WatchInput& input) {
    if (has_status(input)) {
        return headline_of_line(input);
    }
    if (is_heard(input)) {
        return headline_of_bus(input);
    }
    if (input.traces != nullptr) {
        return {"unreachable",
                input.traces->has_guard ? "No frame of the guard" : "No guard in this trace",
                {}};
    }
    const std::int64_t heard_us =
        std::max(input.bus != nullptr ? input.bus->guard_us : kNeverSeen, input.status_us);
    return {
        "unreachable",
        heard_us == kNeverSeen ? "Guard not reachable" : "Guard not reachable any more",
        heard_us == kNeverSeen ? std::nullopt : std::optional((input.now_us - heard_us) / 1000)};
}

}  // namespace

std::string words_of_pair(const Machine& machine, std::uint32_t pair) {
    const Pair& bodies = machine.pairs[pair];
    return machine.bodies[bodies.a].name + " - " + machine.bodies[bodies.b].name;
}

WatchHeadline headline_of(const WatchInput& input) {
    WatchHeadline out = headline_now(input);
    if (input.traces != nullptr && input.traces->is_over && input.traces->has_guard) {
        out.text = "End of the trace: " + out.text;
    }
    return out;
}

std::vector<WatchWhy> whys_of(const WatchInput& input) {
    std::vector<WatchWhy> out;
    const auto add = [&out](const char* of, const std::string& pair, const std::string& why) {
        const bool is_known = !why.empty() && why != "null";
        if (!pair.empty()) {
            out.push_back({of, pair, is_known ? why : "", is_known ? "" : "not known"});
        }
    };
    if (has_status(input)) {
        const GuardLine& line = *input.status;
        if (line.phase == "stopped") {
            add("stop", line.pair, line.why);
            if (out.empty() && !line.ways_out.empty()) {
                out.push_back({"stop", "", "", ""});
            }
            if (!out.empty()) {
                out.back().ways_out = line.ways_out;
            }
        }
        if (line.withheld == "not proven") {
            add("permit withheld", line.withheld_pair, line.withheld_why);
        }
        return out;
    }
    const std::string kind = headline_of(input).kind;
    const bool is_stopped = kind == "stopped";
    const bool is_withheld =
        kind == "selftest" || (kind == "armed" && input.bus->permit_end_us <= input.now_us);
    const std::string words = input.reads_status ? "not known: the status socket is not reachable"
                                                 : "not known: the status socket is not read";
    if (is_stopped || is_withheld) {
        const std::string pair = is_stopped ? pair_of_emergency(input) : std::string();
        out.push_back({is_stopped ? "stop" : "permit withheld", pair, "", words});
    }
    return out;
}

std::vector<std::string> notes_of(const WatchInput& input) {
    std::vector<std::string> out;
    if (input.status && input.status->configuration != input.configuration) {
        out.push_back(fmt::format(
            "Another machine file than the guard's: {:.8} here, {:.8} there ({}). Start axguard "
            "watch with the guard's file.",
            input.configuration, escaped(input.status->configuration),
            escaped(input.status->machine)));
    }
    if (input.bus != nullptr && input.bus->other_hashes != 0) {
        std::string parts;
        for (std::uint32_t part = 0; part < kHashParts; ++part) {
            if ((input.bus->other_hashes & (1U << part)) != 0) {
                parts += (parts.empty() ? "" : ", ") + std::string(kHashPartNames[part]);
            }
        }
        out.push_back(
            "The guard sends other hashes on the bus than this machine file has: " + parts + ".");
    }
    if (input.traces != nullptr) {
        for (const std::string& note : input.traces->notes) {
            out.push_back(escaped(note, 1000));
        }
    }
    if (!input.bus_fault.empty()) {
        out.push_back(escaped(input.bus_fault, 300));
    }
    if (input.reads_status && !input.status_fault.empty()) {
        out.push_back(escaped(input.status_fault, 300));
    }
    if (input.bus == nullptr) {
        return out;
    }
    const BusState& bus = *input.bus;
    if (has_status(input) && input.bus_fault.empty() && !is_heard(input)) {
        out.push_back(bus.guard_us == kNeverSeen
                          ? fmt::format("No frame of the guard on {} yet.", input.bus_name)
                          : fmt::format("No frame of the guard on {} for {:.1f} s.", input.bus_name,
                                        static_cast<double>(input.now_us - bus.guard_us) * 1e-6));
    }
    if (bus.answer == PermitAnswer::wrong) {
        out.push_back("The newest permit does not answer for the board's session.");
    }
    constexpr std::int64_t kFaultShownUs = 5'000'000;
    if (is_recent(bus.input_fault_us, input.now_us, kFaultShownUs)) {
        out.push_back(fmt::format("Samples of the board could not be read: {}.",
                                  fault_row(bus.input_fault).name));
    }
    if (bus.bad != 0) {
        out.push_back(fmt::format("{} malformed frames with identifiers of the guard.", bus.bad));
    }
    return out;
}

}  // namespace axg
