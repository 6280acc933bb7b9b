// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "config/text/quote_text.hpp"
#include "firmware_if/proof_test/proof_steps.hpp"

namespace axg {
namespace {

using Json = nlohmann::json;

bool has_text(const Json& json, const char* key) {
    const auto found = json.find(key);
    return found != json.end() && found->is_string();
}
bool has_count(const Json& json, const char* key) {
    const auto found = json.find(key);
    return found != json.end() && found->is_number_unsigned();
}
bool has_flag(const Json& json, const char* key) {
    const auto found = json.find(key);
    return found != json.end() && found->is_boolean();
}
bool has_pair(const Json& json, const char* key) {
    const auto found = json.find(key);
    return found != json.end() &&
           (found->is_null() || (found->is_array() && found->size() == 2 &&
                                 (*found)[0].is_string() && (*found)[1].is_string()));
}

std::string text_of(const Json& json, const char* key) {
    return escaped(json.at(key).get<std::string>());
}
std::string pair_of(const Json& json, const char* key) {
    const Json& pair = json.at(key);
    return pair.is_null()
               ? std::string()
               : escaped(pair[0].get<std::string>()) + " - " + escaped(pair[1].get<std::string>());
}

bool is_view(const Json& json) {
    return has_count(json, "age_ms") && has_count(json, "permits") && has_text(json, "cause") &&
           has_text(json, "reason") && has_text(json, "withheld") && has_pair(json, "pair") &&
           has_pair(json, "withheld_pair") && has_flag(json, "stands") &&
           has_flag(json, "confirmed");
}

}  // namespace

std::optional<GuardSight> sight_of(std::string_view status_line) {
    const Json json = Json::parse(status_line, nullptr, false);
    if (!json.is_object() || !has_text(json, "bus") || !has_text(json, "machine") ||
        !has_text(json, "configuration_sha256") || !has_text(json, "phase")) {
        return std::nullopt;
    }
    GuardSight out;
    out.bus = text_of(json, "bus");
    out.machine = text_of(json, "machine");
    out.configuration = text_of(json, "configuration_sha256");
    out.phase = text_of(json, "phase");
    if (!json.contains("age_ms")) {
        return out.phase == "init" ? std::optional(out) : std::nullopt;
    }
    if (!is_view(json)) {
        return std::nullopt;
    }
    out.has_view = true;
    out.age_ms = json.at("age_ms").get<std::uint64_t>();
    out.permits = json.at("permits").get<std::uint64_t>();
    out.cause = text_of(json, "cause");
    out.reason = text_of(json, "reason");
    out.pair = pair_of(json, "pair");
    out.withheld = text_of(json, "withheld");
    out.withheld_pair = pair_of(json, "withheld_pair");
    out.stands = json.at("stands").get<bool>();
    out.is_confirmed = json.at("confirmed").get<bool>();
    return out;
}

}  // namespace axg
