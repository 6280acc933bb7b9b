// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/axguardd/status_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/cli/guard_exit.hpp"

namespace axg {
namespace {

using Json = nlohmann::ordered_json;

/// Writes on while there is room, which the longest line leaves.
class Line {
  public:
    explicit Line(std::span<char> out) noexcept : out_(out) {}

    template <class... Values>
    void put(fmt::format_string<Values...> text, Values&&... values) {
        const auto end = fmt::format_to_n(out_.data() + size_, out_.size() - size_, text,
                                          std::forward<Values>(values)...);
        size_ += std::min(end.size, out_.size() - size_);
    }
    [[nodiscard]] std::size_t size() const noexcept { return size_; }

  private:
    std::span<char> out_;
    std::size_t size_ = 0;
};

/// Names of bodies need no escape: docs/machine-file.md.
void put_pair(Line& line, const char* key, const Machine& machine, std::uint32_t number) {
    if (number >= machine.pairs.size()) {
        line.put(",\"{}\":null", key);
        return;
    }
    const Pair& pair = machine.pairs[number];
    line.put(",\"{}\":[\"{}\",\"{}\"]", key, machine.bodies[pair.a].name,
             machine.bodies[pair.b].name);
}

void put_state(Line& line, const LiveView& view, const Machine& machine, std::int64_t now_us) {
    const bool is_stopped = view.phase == GuardPhase::stopped;
    line.put(",\"age_ms\":{},\"phase\":\"{}\",\"phase_ms\":{}", (now_us - view.time_us) / 1000,
             to_text(view.phase), (view.time_us - view.phase_us) / 1000);
    line.put(",\"cause\":\"{}\",\"reason\":\"{}\"",
             to_text(is_stopped ? view.cause : GuardFault::none),
             to_text(is_stopped ? view.reason : StopReason::none));
    put_pair(line, "pair", machine, is_stopped ? view.pair : kNoIndex);
    line.put(",\"withheld\":\"{}\",\"withheld_reason\":\"{}\"", to_text(view.withheld.why),
             to_text(view.withheld.reason));
    put_pair(line, "withheld_pair", machine, view.withheld.pair);
    line.put(",\"stands\":{},\"confirmed\":{}", view.stands, is_stopped && view.is_confirmed);
    if (has_session(machine.can)) {
        line.put(",\"session\":{}", view.has_session);
    } else {
        line.put(",\"session\":null");
    }
    line.put(",\"hashes\":\"{}\"", view.compares_hashes ? "required" : "none");
}

void put_counters(Line& line, const LiveView& view) {
    const LiveCounters& counters = view.counters;
    line.put(",\"pictures\":{},\"permits\":{},\"permits_slow\":{},\"stop_frames\":{},\"late\":{}",
             counters.snapshots, counters.permits, counters.slow, counters.stops, counters.late);
    line.put(",\"refused\":{},\"send_faults\":{},\"samples_lost\":{},\"frames_dropped\":{}",
             counters.refused, counters.send_faults, view.input.samples_lost, view.frames_dropped);
    line.put(",\"operator_acts\":{},\"operator_refused\":{},\"operator_ignored\":{}",
             counters.operator_acts, counters.operator_refused, counters.operator_ignored);
}

std::string text_at(const Json& json, const char* key) {
    const auto found = json.find(key);
    return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
}
std::int64_t number_at(const Json& json, const char* key) {
    const auto found = json.find(key);
    return found != json.end() && found->is_number_integer() ? found->get<std::int64_t>() : 0;
}
bool is_at(const Json& json, const char* key) {
    const auto found = json.find(key);
    return found != json.end() && found->is_boolean() && found->get<bool>();
}
std::string pair_at(const Json& json, const char* key) {
    const auto found = json.find(key);
    const bool is_pair = found != json.end() && found->is_array() && found->size() == 2 &&
                         (*found)[0].is_string() && (*found)[1].is_string();
    return is_pair ? fmt::format(": {} - {}", (*found)[0].get<std::string>(),
                                 (*found)[1].get<std::string>())
                   : std::string();
}

int code_of(const std::string& cause) {
    for (auto fault = static_cast<unsigned>(GuardFault::none) + 1;
         fault <= static_cast<unsigned>(kGuardFaultLast); ++fault) {
        if (cause == to_text(static_cast<GuardFault>(fault))) {
            return exit_code_of(static_cast<GuardFault>(fault));
        }
    }
    return kExitClean;
}

std::string words_of_stop(const Json& json) {
    const std::string reason = text_at(json, "reason");
    return fmt::format(": {}{}{}", text_at(json, "cause"),
                       reason.empty() || reason == "none" ? "" : ": " + reason,
                       pair_at(json, "pair"));
}

/// Nothing in armed: the permit then flows, or the guard stops.
std::string words_of_withheld(const Json& json) {
    const std::string why = text_at(json, "withheld");
    const std::string reason = text_at(json, "withheld_reason");
    return why.empty() || why == "nothing"
               ? std::string()
               : fmt::format("no permit: {}{}{}\n", why,
                             reason.empty() || reason == "none" ? "" : ": " + reason,
                             pair_at(json, "withheld_pair"));
}

}  // namespace

StatusLine::StatusLine(const Machine& machine, std::string_view bus, std::string_view mode,
                       std::string_view configuration_sha256)
    : machine_(machine) {
    const Json head{{"axguardd", AXG_VERSION},
                    {"bus", bus},
                    {"machine", machine.name.substr(0, 200)},
                    {"configuration_sha256", configuration_sha256},
                    {"mode", mode}};
    head_ = head.dump(-1, ' ', true, Json::error_handler_t::replace);
    head_.pop_back();  // what follows is in the same braces
}

std::size_t StatusLine::write(const LiveView* view, std::int64_t now_us,
                              std::span<char> out) const noexcept {
    Line line(out);
    line.put("{}", head_);
    if (view == nullptr) {
        line.put(",\"phase\":\"init\"");
    } else {
        put_state(line, *view, machine_, now_us);
        put_counters(line, *view);
    }
    line.put("}}\n");
    return line.size();
}

std::optional<StatusWords> words_of_status(std::string_view line) {
    const Json json = Json::parse(line, nullptr, false);
    if (!json.is_object() || text_at(json, "axguardd").empty() || text_at(json, "phase").empty()) {
        return std::nullopt;
    }
    const std::string phase = text_at(json, "phase");
    const bool is_stopped = phase == to_text(GuardPhase::stopped);
    StatusWords out;
    out.exit_code = is_stopped ? code_of(text_at(json, "cause")) : kExitClean;
    out.text = fmt::format("{}: {}{}, for {:.1f} s\n", text_at(json, "bus"), phase,
                           is_stopped ? words_of_stop(json) : "",
                           static_cast<double>(number_at(json, "phase_ms")) * 1e-3);
    out.text += words_of_withheld(json);
    if (number_at(json, "age_ms") > 1000) {
        out.text += fmt::format("the guard has shown nothing for {} ms: its bus thread is held\n",
                                number_at(json, "age_ms"));
    }
    const auto session = json.find("session");
    out.text += fmt::format("axes {}{}{}\n", is_at(json, "stands") ? "stand" : "do not stand",
                            is_at(json, "confirmed") ? ", the stop is confirmed" : "",
                            session == json.end() || session->is_null() ? ""
                            : is_at(json, "session") ? ", the board has a session"
                                                     : ", the board has said no session");
    if (text_at(json, "hashes") == "none") {
        out.text +=
            "hashes are not compared: whether the board is set up for this machine, a "
            "person has to know\n";
    }
    out.text += fmt::format(
        "{} samples, {} permits, {} late, {} lost; {} frames of ours failed\n"
        "{}, {} mode, axguardd {}, configuration {:.8}\n",
        number_at(json, "pictures"), number_at(json, "permits"), number_at(json, "late"),
        number_at(json, "samples_lost"), number_at(json, "send_faults"), text_at(json, "machine"),
        text_at(json, "mode"), text_at(json, "axguardd"), text_at(json, "configuration_sha256"));
    return out;
}

}  // namespace axg
