// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/sincos.hpp"
#include "core/guard/margin_advisory.hpp"
#include "firmware_if/cli/document_json.hpp"
#include "firmware_if/protocol/obeyed_by.hpp"
#include "hil_replay/drive/drive_report.hpp"
#include "hil_replay/replay/replay_csv.hpp"
#include "hil_replay/replay/stop_cause_json.hpp"

namespace axg {
namespace {

nlohmann::ordered_json jogs_json(const Machine& machine, const JogOut& out) {
    auto jogs = nlohmann::ordered_json::array();
    for (const JogDone& jog : out.jogs) {
        const bool rotary = machine.axes[jog.move.axis].kind == AxisKind::rotary;
        jogs.push_back({{"axis", machine.axes[jog.move.axis].name},
                        {"direction", jog.move.is_negative ? "-" : "+"},
                        {rotary ? "moved_deg" : "moved_mm",
                         std::abs(jog.moved) * (rotary ? 180.0 / kPi : 1.0)},
                        {"clearance_mm", jog.clearance_mm},
                        {"stopped", jog.is_stopped}});
    }
    return jogs;
}

nlohmann::ordered_json bus_json(const Machine& machine, const BusReport& bus) {
    nlohmann::ordered_json out{{"interface", bus.interface},
                               {"late_periods", bus.wire.late_periods},
                               {"late_us_max", bus.wire.late_us_max},
                               {"lost", bus.wire.is_lost}};
    if (bus.wire.emergency) {
        out["emergency"] = {{"code", to_text(bus.wire.emergency->code)}};
        if (bus.wire.emergency->pair < machine.pairs.size()) {
            out["emergency"]["pair"] = pair_name(machine, bus.wire.emergency->pair);
        }
    }
    return out;
}

nlohmann::ordered_json cap_json(const Machine& machine, const DriveResult& result) {
    auto slow_downs = nlohmann::ordered_json::array();
    for (const SlowDown& one : result.slow_downs) {
        slow_downs.push_back({{"at_s", one.begin_s},
                              {"duration_s", one.seconds},
                              {"cap_least", one.least},
                              {"lost_s", one.lost_s}});
    }
    return {{"promise", to_text(machine.guard.cap)},
            {"held", result.is_held},
            {"lost_s", result.lost_s},
            {"slow_downs", slow_downs}};
}

nlohmann::ordered_json guard_stop_json(const DriveReport& report) {
    const DriveStop& stop = report.result.guard_stop;
    nlohmann::ordered_json out{{"reason", reason_text(stop)}, {"sample", stop.snapshot.sample}};
    add_stop_cause(report.machine, stop.reason, stop.pair, stop.fault, stop.limit, out);
    if (stop.reason == StopReason::left_cap) {
        out["cap"] = to_text(stop.cap.kind);
        if (stop.cap.axis != kNoIndex) {
            out["axis"] = report.machine.axes[stop.cap.axis].name;
        }
    }
    if (report.why) {
        out["why"] = why_json(report.machine, *report.why);
    }
    return out;
}

nlohmann::ordered_json rest_json(const Machine& machine, const DriveResult& result) {
    auto out = nlohmann::ordered_json::object();
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const Axis& axis = machine.axes[i];
        out[axis.name + (axis.kind == AxisKind::rotary ? "_deg" : "_mm")] =
            in_file_units(axis, result.rest[i].position);
    }
    return out;
}

nlohmann::ordered_json pairs_json(const DriveReport& report) {
    auto pairs = nlohmann::ordered_json::array();
    for (const PairAtRest& pair : pairs_at_rest(report)) {
        pairs.push_back({{"pair", pair_name(report.machine, pair.pair)},
                         {"clearance_mm", pair.clearance_mm},
                         {"margin_mm", report.machine.pairs[pair.pair].margin_mm},
                         {"touching", pair.is_touching}});
    }
    return pairs;
}

}  // namespace

std::string describe_drive(const DriveReport& report) {
    const DriveResult& result = report.result;
    const Machine& machine = report.machine;
    nlohmann::ordered_json out{{"program", report.program},
                               {"machine", machine.name},
                               {"mode", report.mode},
                               {"seed", report.seed},
                               {"state", to_text(result.state)},
                               {"samples", result.samples},
                               {"permits", result.permits},
                               {"frames_lost", result.frames_lost},
                               {"obeyed_by", to_text(machine.guard.obeyed_by)}};
    if (const std::string refusal = obeyed_by_refusal(machine); !refusal.empty()) {
        out["not_obeyed"] = refusal;
    }
    if (report.bus) {
        out.erase("mode");
        out["bus"] = bus_json(machine, *report.bus);
    }
    if (result.state != BoardState::waiting) {
        out["machine_s"] = motion_s(result);
    }
    if (report.free_s > 0) {
        out["machine_s_without_cap"] = report.free_s;
    }
    if (report.has_cap) {
        out["speed_cap_least"] = result.speed_cap;
    }
    if (result.samples_least != 0) {
        out["permit_samples_least"] = result.samples_least;
    }
    if (machine.guard.cap != CapPromise::none) {
        out["cap"] = cap_json(machine, result);
    }
    if (has_clearance_levels(machine)) {
        out["samples_slow"] = result.slow_samples;
    }
    if (result.state == BoardState::stopped) {
        const BoardStopRecord& stop = result.board_stop;
        out["board_stop"] = {{"why", to_text(stop.why)},
                             {"certified_us", stop.certified_us},
                             {"asked_us", stop.asked_us},
                             {"brake_us", stop.brake_us},
                             {"rest_us", stop.rest_us}};
    }
    if (result.state != BoardState::finished) {
        add_program_line(report.lines, stopped_at_us(result), out);
    }
    if (has_reason(result.guard_stop)) {
        out["guard_stop"] = guard_stop_json(report);
    }
    if (report.contact) {
        out["contact"] = {{"after_s", seconds_after_start(*report.contact)},
                          {"pair", pair_name(machine, report.contact->pair)}};
    }
    out["rest"] = rest_json(machine, result);
    out["pairs"] = pairs_json(report);
    if (result.state != BoardState::finished) {
        out["escapes"] = escapes_json(machine, report.escapes);
    }
    if (report.jogs) {
        out["jogs"] = jogs_json(machine, *report.jogs);
        out["is_out"] = report.jogs->is_out;
    }
    return text_of(out);
}

std::string describe_stops(const DriveReport& report) {
    auto stops = nlohmann::ordered_json::array();
    const DriveStop& stop = report.result.guard_stop;
    if (has_reason(stop)) {
        stops.push_back({{"time_us", stop.snapshot.arrived_us}, {"reason", reason_text(stop)}});
        add_program_line(report.lines, stop.snapshot.latched_us, stops.back());
        if (report.why) {
            stops.back()["why"] = page_why_json(report.machine, *report.why);
        }
    }
    return stops.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace axg
