// SPDX-License-Identifier: Apache-2.0
// The state of the page as JSON, and the guard's line read.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "core/base/sincos.hpp"
#include "firmware_if/axguardd/status_json.hpp"
#include "hil_replay/watch/watch_state.hpp"

namespace axg {
namespace {

using Json = nlohmann::ordered_json;

std::string pair_at(const Json& json, const char* key) {
    const auto found = json.find(key);
    return found == json.end() || !found->is_array()
               ? std::string()
               : (*found)[0].get<std::string>() + " - " + (*found)[1].get<std::string>();
}

Json age_ms(std::int64_t time_us, std::int64_t now_us) {
    return time_us == kNeverSeen ? Json()
                                 : Json(std::max<std::int64_t>(0, now_us - time_us) / 1000);
}

const char* word_of(PermitWord word) {
    switch (word) {
        case PermitWord::run:
            return "run";
        case PermitWord::slow:
            return "slow";
        case PermitWord::jog:
            return "jog";
        case PermitWord::stop:
            return "stop";
    }
    return "unknown";
}

const char* word_of(PermitAnswer answer) {
    switch (answer) {
        case PermitAnswer::unknown:
            return "unknown";
        case PermitAnswer::right:
            return "right";
        case PermitAnswer::wrong:
            return "wrong";
    }
    return "unknown";
}

const char* word_of_mode(std::uint8_t mode) {
    constexpr const char* kWords[]{"standstill", "moving", "tool change", "jog"};
    return mode < std::size(kWords) ? kWords[mode] : "other";
}

Json permit_json(const WatchInput& input) {
    const BusState& bus = *input.bus;
    if (!bus.permit) {
        return {};
    }
    const Permit& permit = *bus.permit;
    constexpr const char* kLevels[]{"clear", "warn", "slow", "stop"};
    return {{"word", word_of(permit.word)},
            {"in_force", bus.permit_end_us != kNeverSeen && bus.permit_end_us > input.now_us},
            {"samples", permit.samples},
            {"valid_ms", permit.samples * 1e-3 * input.machine.can.sample_us},
            {"cap_percent", 100.0 * permit.cap / kPermitCapNone},
            {"mask", permit.mask},
            {"level", kLevels[permit.level & 3U]},
            {"answer", word_of(bus.answer)},
            {"age_ms", age_ms(bus.permit_us, input.now_us)}};
}

Json axes_json(const WatchInput& input) {
    const BusState& bus = *input.bus;
    if (!bus.axes) {
        return {};
    }
    auto positions = Json::array();
    for (std::size_t i = 0; i < input.machine.axes.size(); ++i) {
        const bool is_rotary = input.machine.axes[i].kind == AxisKind::rotary;
        const double shown = bus.axes->position.at(i) * (is_rotary ? 180.0 / kPi : 1.0);
        positions.push_back(std::round(shown * 1e4) / 1e4);
    }
    return {{"positions", std::move(positions)},
            {"tool", bus.axes->tool},
            {"guarded_tool", bus.axes->tool != 0 ? bus.axes->tool : input.machine.first_tool},
            {"mode", word_of_mode(bus.axes->mode)},
            {"age_ms", age_ms(bus.board_us, input.now_us)}};
}

Json hints_json(const WatchInput& input) {
    const BusState& bus = *input.bus;
    if (!bus.hints) {
        return {};
    }
    const bool has_pair = bus.hints->pair != kHintNone;
    constexpr double kCountsPerMm = 100;
    return {{"pair", has_pair ? Json(bus.hints->pair) : Json()},
            {"name", has_pair ? Json(words_of_pair(input.machine, bus.hints->pair)) : Json()},
            {"distance_mm", bus.hints->distance_10um / kCountsPerMm},
            {"is_more", bus.hints->distance_10um == kHintNone},
            {"age_ms", age_ms(bus.hints_us, input.now_us)}};
}

Json whys_json(const WatchInput& input) {
    auto out = Json::array();
    for (const WatchWhy& why : whys_of(input)) {
        out.push_back({{"of", why.of},
                       {"pair", why.pair.empty() ? Json() : Json(why.pair)},
                       {"distances", why.distances.empty() ? Json() : Json::parse(why.distances)},
                       {"words", why.words},
                       {"ways_out", why.ways_out}});
    }
    return out;
}

Json guard_json(const WatchInput& input) {
    if (!input.status) {
        return {};
    }
    const GuardLine& line = *input.status;
    const std::string withheld =
        line.withheld == "nothing" || line.withheld.empty()
            ? std::string()
            : line.withheld + (line.withheld_reason == "none" ? "" : ": " + line.withheld_reason) +
                  (line.withheld_pair.empty() ? "" : ": " + line.withheld_pair);
    return {{"version", line.version},
            {"bus", line.bus},
            {"machine", line.machine},
            {"mode", line.mode},
            {"phase", line.phase},
            {"withheld", withheld},
            {"stands", line.has_view ? Json(line.stands) : Json()},
            {"confirmed", line.is_confirmed},
            {"samples", line.samples},
            {"permits", line.permits},
            {"late", line.late},
            {"lost", line.lost},
            {"same_machine", line.configuration == input.configuration},
            {"age_ms", age_ms(input.status_us, input.now_us)}};
}

}  // namespace

std::optional<GuardLine> read_guard_line(std::string_view line) {
    const std::optional<StatusWords> words = words_of_status(line);
    if (!words) {
        return std::nullopt;
    }
    const Json json = Json::parse(words->json, nullptr, false);
    GuardLine out;
    out.phase = json.at("phase").get<std::string>();
    out.bus = json.at("bus").get<std::string>();
    out.machine = json.at("machine").get<std::string>();
    out.configuration = json.at("configuration_sha256").get<std::string>();
    out.version = json.at("axguardd").get<std::string>();
    out.mode = json.at("mode").get<std::string>();
    out.has_view = json.contains("age_ms");
    if (!out.has_view) {
        return out;
    }
    out.cause = json.at("cause").get<std::string>();
    out.reason = json.at("reason").get<std::string>();
    out.pair = pair_at(json, "pair");
    out.why = json.at("why").dump();
    out.ways_out = words->ways_out;
    out.program_line =
        json.at("program_line").is_null() ? 0 : json.at("program_line").get<std::uint64_t>();
    out.withheld_why = json.at("withheld_why").dump();
    out.withheld = json.at("withheld").get<std::string>();
    out.withheld_reason = json.at("withheld_reason").get<std::string>();
    out.withheld_pair = pair_at(json, "withheld_pair");
    out.stands = json.at("stands").get<bool>();
    out.is_confirmed = json.at("confirmed").get<bool>();
    out.age_ms = json.at("age_ms").get<std::uint64_t>();
    out.phase_ms = json.at("phase_ms").get<std::uint64_t>();
    out.permits = json.at("permits").get<std::uint64_t>();
    out.samples = json.at("snapshots").get<std::uint64_t>();
    out.late = json.at("late").get<std::uint64_t>();
    out.lost = json.at("samples_lost").get<std::uint64_t>();
    return out;
}

std::string watch_json(const WatchInput& input) {
    const WatchHeadline headline = headline_of(input);
    Json out{{"number", input.number},
             {"kind", headline.kind},
             {"headline", headline.text},
             {"since_ms", headline.since_ms ? Json(*headline.since_ms) : Json()},
             {"notes", notes_of(input)},
             {"configuration", input.configuration},
             {"reads_status", input.reads_status},
             {"guard", guard_json(input)},
             {"why", whys_json(input)}};
    if (input.bus != nullptr) {
        out["bus"] = {{"name", input.bus_name},
                      {"is_open", input.bus_fault.empty()},
                      {"frames", input.bus->frames},
                      {"bad", input.bus->bad},
                      {"guard_age_ms", age_ms(input.bus->guard_us, input.now_us)}};
        out["permit"] = permit_json(input);
        out["axes"] = axes_json(input);
        out["hints"] = hints_json(input);
    } else {
        out["bus"] = out["permit"] = out["axes"] = out["hints"] = nullptr;
    }
    return out.dump(-1, ' ', true, Json::error_handler_t::replace);
}

}  // namespace axg
