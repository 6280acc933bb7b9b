// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/axguardd/status_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "config/text/quote_text.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/cli/guard_exit.hpp"
#include "firmware_if/explain/why_sentences.hpp"

namespace axg {
namespace {

using Json = nlohmann::ordered_json;

/// Parts of a need that not every reach has.
struct WhyPart {
    const char* key;
    const char* words;
};
constexpr std::array<WhyPart, 5> kWhyParts{{{"to_standstill_mm", "motion to standstill"},
                                            {"until_braking_mm", "motion until braking"},
                                            {"braking_mm", "braking"},
                                            {"position_error_mm", "uncertainty of position"},
                                            {"speed_uncertainty_mm", "of speed"}}};

constexpr std::size_t kWayOutMax = 500;  // characters: a jog each way for every axis
constexpr std::uint64_t kHeldMs = 1000;  // a bus thread that turns has shown more since

/// Text of a line that passed is_status, escaped: foreign text that a terminal shows.
std::string text_at(const Json& json, const char* key) {
    return escaped(json.at(key).get<std::string>());
}
std::string pair_at(const Json& json, const char* key) {
    const Json& pair = json.at(key);
    return pair.is_null() ? std::string()
                          : fmt::format(": {} - {}", escaped(pair[0].get<std::string>()),
                                        escaped(pair[1].get<std::string>()));
}
std::uint64_t count_at(const Json& json, const char* key) {
    return json.at(key).get<std::uint64_t>();
}
bool is_at(const Json& json, const char* key) {
    return json.at(key).get<bool>();
}

using IsOfType = bool (*)(const Json&);

bool is_text(const Json& value) {
    return value.is_string();
}
bool is_flag(const Json& value) {
    return value.is_boolean();
}
bool is_flag_or_null(const Json& value) {
    return value.is_boolean() || value.is_null();
}
bool is_number_or_null(const Json& value) {
    return value.is_number() || value.is_null();
}
bool is_count(const Json& value) {
    return value.is_number_unsigned();
}
bool is_pair_or_null(const Json& value) {
    return value.is_null() ||
           (value.is_array() && value.size() == 2 && value[0].is_string() && value[1].is_string());
}
bool is_mm(const Json& json, const char* key) {
    const auto found = json.find(key);
    return found != json.end() && found->is_number();
}
bool is_mm_or_null(const Json& json, const char* key) {
    const auto found = json.find(key);
    return found != json.end() && (found->is_number() || found->is_null());
}
bool has_distances(const Json& value) {
    return value.is_object() && is_mm(value, "needed_mm") && is_mm(value, "available_mm");
}
bool is_distances_or_null(const Json& value) {
    return value.is_null() || has_distances(value);
}
bool is_count_or_null(const Json& value) {
    return value.is_null() || is_count(value);
}
bool is_why_or_null(const Json& value) {
    if (value.is_null()) {
        return true;
    }
    if (!has_distances(value) || !is_mm(value, "within_mm") || !is_mm(value, "margin_mm") ||
        !is_mm(value, "arithmetic_mm")) {
        return false;
    }
    const auto is_part = [&value](const char* key) { return is_mm_or_null(value, key); };
    const auto is_in = [&value](const char* key, IsOfType is_of_type) {
        const auto found = value.find(key);
        return found != value.end() && is_of_type(*found);
    };
    return std::all_of(kWhyParts.begin(), kWhyParts.end(),
                       [&](const WhyPart& part) { return is_part(part.key); }) &&
           is_in("list_full", is_flag) && is_in("jog", is_flag) &&
           is_in("tool", is_count_or_null) && is_in("open", is_distances_or_null);
}
bool is_hashes(const Json& value) {
    return value == "required" || value == "none";
}
bool is_text_or_null(const Json& value) {
    return value.is_null() || is_text(value);
}
bool is_board_test(const Json& value) {
    if (!value.is_object() || !value.contains("record") || !value.contains("serial") ||
        !value.contains("date") || !value.contains("differs")) {
        return false;
    }
    const Json& differs = value["differs"];
    return is_text(value["record"]) && is_text_or_null(value["serial"]) &&
           is_text_or_null(value["date"]) && differs.is_array() &&
           std::all_of(differs.begin(), differs.end(), is_text);
}

struct StatusKey {
    const char* name;
    IsOfType is_of_type;
};
/// In every line, and after the phase in a line with a view.
constexpr std::array<StatusKey, 8> kHeadKeys{{{"axguardd", is_text},
                                              {"bus", is_text},
                                              {"machine", is_text},
                                              {"file", is_text},
                                              {"configuration_sha256", is_text},
                                              {"mode", is_text},
                                              {"board_test", is_board_test},
                                              {"phase", is_text}}};
constexpr std::array<StatusKey, 33> kViewKeys{{{"age_ms", is_count},
                                               {"phase_ms", is_count},
                                               {"cause", is_text},
                                               {"reason", is_text},
                                               {"pair", is_pair_or_null},
                                               {"why", is_why_or_null},
                                               {"program_line", is_count_or_null},
                                               {"unknown_tool", is_count_or_null},
                                               {"way_out", is_text_or_null},
                                               {"withheld", is_text},
                                               {"withheld_reason", is_text},
                                               {"withheld_pair", is_pair_or_null},
                                               {"withheld_why", is_why_or_null},
                                               {"tool", is_count_or_null},
                                               {"guarded_tool", is_count_or_null},
                                               {"stands", is_flag},
                                               {"confirmed", is_flag},
                                               {"session", is_flag_or_null},
                                               {"sample_us", is_count},
                                               {"period_us", is_number_or_null},
                                               {"hashes", is_hashes},
                                               {"snapshots", is_count},
                                               {"permits", is_count},
                                               {"permits_slow", is_count},
                                               {"stop_frames", is_count},
                                               {"late", is_count},
                                               {"refused", is_count},
                                               {"send_faults", is_count},
                                               {"samples_lost", is_count},
                                               {"frames_dropped", is_count},
                                               {"operator_acts", is_count},
                                               {"operator_refused", is_count},
                                               {"operator_ignored", is_count}}};

bool has(const Json& json, std::span<const StatusKey> keys) {
    return std::all_of(keys.begin(), keys.end(), [&json](const StatusKey& key) {
        const auto found = json.find(key.name);
        return found != json.end() && key.is_of_type(*found);
    });
}

std::optional<GuardPhase> phase_of(const Json& json) {
    for (std::uint32_t i = 0; i < kGuardPhases; ++i) {
        if (json.at("phase") == to_text(static_cast<GuardPhase>(i))) {
            return static_cast<GuardPhase>(i);
        }
    }
    return std::nullopt;
}

std::optional<GuardFault> cause_of(const Json& json) {
    for (unsigned fault = 0; fault <= static_cast<unsigned>(kGuardFaultLast); ++fault) {
        if (json.at("cause") == to_text(static_cast<GuardFault>(fault))) {
            return static_cast<GuardFault>(fault);
        }
    }
    return std::nullopt;
}

std::string words_of_stop(const Json& json) {
    const std::string reason = text_at(json, "reason");
    const Json& line = json.at("program_line");
    return fmt::format(
        ": {}{}{}{}", text_at(json, "cause"), reason == "none" ? "" : ": " + reason,
        pair_at(json, "pair"),
        line.is_null() ? "" : fmt::format(", program line {}", line.get<std::uint64_t>()));
}

double mm_at(const Json& json, const char* key) {
    return json.at(key).get<double>();
}

/// The sentences that a reader needs first, as a replay prints them.
std::string sentences_of(const Json& json, const Json& why, const Json& pair) {
    std::string out;
    if (pair.is_null()) {
        return out;
    }
    const std::vector<std::string> sentences =
        why_sentences({.cause = is_at(why, "list_full") ? WhyCause::capacity : WhyCause::not_proven,
                       .a = escaped(pair[0].get<std::string>()),
                       .b = escaped(pair[1].get<std::string>()),
                       .is_of_stop = json.at("mode") == "stoppable",
                       .available_mm = mm_at(why, "available_mm"),
                       .needed_mm = mm_at(why, "needed_mm"),
                       .margin_mm = mm_at(why, "margin_mm")});
    for (const std::string& sentence : sentences) {
        out += "  " + sentence + "\n";
    }
    return out;
}

/// Lines below the stop or the withheld permit; empty without distances.
std::string words_of_why(const Json& json, const char* key, const char* pair) {
    const Json& why = json.at(key);
    if (why.is_null()) {
        return {};
    }
    const double available_mm = mm_at(why, "available_mm");
    const bool is_all = available_mm < mm_at(why, "within_mm");
    std::string out = sentences_of(json, why, json.at(pair));
    out += fmt::format("  needs {:.4f} mm and has {}", mm_at(why, "needed_mm"),
                       available_mm <= 0
                           ? "none"
                           : fmt::format("{}{:.4f} mm", is_all ? "" : "at least ", available_mm));
    out +=
        why.at("tool").is_null() ? "\n    " : fmt::format(", tool {}\n    ", count_at(why, "tool"));
    for (const WhyPart& part : kWhyParts) {
        if (!why.at(part.key).is_null()) {
            out += fmt::format("{} {:.4f}, ", part.words, mm_at(why, part.key));
        }
    }
    out += fmt::format("{} {:g}, arithmetic {:.2g} mm\n",
                       is_at(why, "jog") ? "clearance to keep in this jog" : "margin",
                       mm_at(why, "margin_mm"), mm_at(why, "arithmetic_mm"));
    const Json& open = why.at("open");
    if (!open.is_null()) {
        out += fmt::format("    the first part left open needs {:.4f} mm and has {:.4f} mm\n",
                           mm_at(open, "needed_mm"), mm_at(open, "available_mm"));
    }
    return out + (is_at(why, "list_full")
                      ? "    a list of the engine was full (cycle: in the machine file)\n"
                      : "");
}

/// Empty in phase armed: the guard then sends permits, or stops.
std::string words_of_withheld(const Json& json) {
    const std::string why = text_at(json, "withheld");
    const std::string reason = text_at(json, "withheld_reason");
    return why == "nothing"
               ? std::string()
               : fmt::format("no permit: {}{}{}\n", why, reason == "none" ? "" : ": " + reason,
                             pair_at(json, "withheld_pair"));
}

std::string words_of_board_test(const Json& test) {
    const std::string state = text_at(test, "record");
    const std::string whose =
        test["serial"].is_null() ? std::string()
                                 : fmt::format(": serial {}, {}", text_at(test, "serial"),
                                               test["date"].is_null() ? "" : text_at(test, "date"));
    std::string differs;
    for (const Json& name : test["differs"]) {
        differs += fmt::format("{}{}", differs.empty() ? " (other " : ", ",
                               escaped(name.get<std::string>(), 80));
    }
    return fmt::format("board test: {}{}{}\n",
                       state == "this_configuration" ? "record for this configuration"
                       : state == "another"          ? "record of another configuration"
                       : state == "none"             ? "no record"
                                                     : "record unreadable",
                       differs.empty() ? "" : differs + ")", whose);
}

std::string words_of_guard(const Json& json) {
    return fmt::format("{}, {} mode, axguardd {}, configuration {:.8}\n{}",
                       text_at(json, "machine"), text_at(json, "mode"), text_at(json, "axguardd"),
                       text_at(json, "configuration_sha256"),
                       words_of_board_test(json.at("board_test")));
}

/// What leads out of the stop; empty: nothing that the guard knows of.
std::vector<std::string> ways_out_of(const Json& json) {
    std::vector<std::string> out;
    if (const Json& tool = json.at("unknown_tool"); !tool.is_null()) {
        out.push_back(unknown_tool_sentence(tool.get<std::uint64_t>(), text_at(json, "file")));
    }
    if (const Json& way = json.at("way_out"); !way.is_null()) {
        out.push_back(escaped(way.get<std::string>(), kWayOutMax));
    }
    return out;
}

std::string words_of_tool(const Json& json) {
    const Json &tool = json.at("tool"), &guarded = json.at("guarded_tool");
    if (tool.is_null()) {
        return {};
    }
    std::string number = fmt::format(", tool {}", tool.get<std::uint64_t>());
    if (tool == guarded) {
        return number;
    }
    return guarded.is_null()
               ? number + " (empty)"
               : number + fmt::format(" (guarded as first_tool, {})", guarded.get<std::uint64_t>());
}

std::string words_of_view(const Json& json, const std::vector<std::string>& ways_out) {
    std::string out = words_of_why(json, "why", "pair");
    for (const std::string& sentence : ways_out) {
        out += "  " + sentence + "\n";
    }
    out += words_of_withheld(json) + words_of_why(json, "withheld_why", "withheld_pair");
    if (count_at(json, "age_ms") > kHeldMs) {
        out += fmt::format("no update for {} ms: the bus thread of the guard is blocked\n",
                           count_at(json, "age_ms"));
    }
    out += fmt::format("axes {}{}{}{}\n", is_at(json, "stands") ? "at rest" : "not at rest",
                       is_at(json, "confirmed") ? ", stop confirmed" : "",
                       json.at("session").is_null() ? ""
                       : is_at(json, "session")     ? ", board session received"
                                                    : ", no board session",
                       words_of_tool(json));
    if (!json.at("period_us").is_null()) {
        out += fmt::format("period {:.3f} us, declared {} us\n", json.at("period_us").get<double>(),
                           count_at(json, "sample_us"));
    }
    if (json.at("hashes") == "none") {
        out += "hashes are not compared: verify that the board is configured for this machine\n";
    }
    out +=
        fmt::format("{} samples, {} permits, {} late, {} lost; {} guard frames failed\n",
                    count_at(json, "snapshots"), count_at(json, "permits"), count_at(json, "late"),
                    count_at(json, "samples_lost"), count_at(json, "send_faults"));
    return out;
}

/// For a guard whose bus thread has not turned yet: its state is unknown, so not exit code 0.
StatusWords words_of_init(const Json& json) {
    return {
        .text = fmt::format("{}: init: no update of the bus thread yet\n", text_at(json, "bus")) +
                words_of_guard(json),
        .json = json.dump(-1, ' ', true) + '\n',
        .exit_code = kExitDeadline};
}

}  // namespace

std::optional<StatusWords> words_of_status(std::string_view line) {
    const Json json = Json::parse(line, nullptr, false);
    if (!json.is_object() || !has(json, kHeadKeys)) {
        return std::nullopt;
    }
    const std::optional<GuardPhase> phase = phase_of(json);
    if (phase == GuardPhase::init && !json.contains("age_ms")) {
        return words_of_init(json);
    }
    const std::optional<GuardFault> cause =
        phase && has(json, kViewKeys) ? cause_of(json) : std::nullopt;
    if (!cause) {
        return std::nullopt;
    }
    const bool is_stopped = phase == GuardPhase::stopped;
    StatusWords out;
    out.exit_code = is_stopped                           ? exit_code_of(*cause)
                    : count_at(json, "age_ms") > kHeldMs ? kExitDeadline
                                                         : kExitClean;
    out.text = fmt::format("{}: {}{}, for {:.1f} s\n", text_at(json, "bus"), to_text(*phase),
                           is_stopped ? words_of_stop(json) : "",
                           static_cast<double>(count_at(json, "phase_ms")) * 1e-3);
    out.ways_out = ways_out_of(json);
    out.text += words_of_view(json, out.ways_out) + words_of_guard(json);
    out.json = json.dump(-1, ' ', true) + '\n';
    return out;
}

}  // namespace axg
