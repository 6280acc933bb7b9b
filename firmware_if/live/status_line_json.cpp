// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "firmware_if/live/status_line.hpp"

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

/// Names of bodies need no escape: docs/reference/machine-file.md.
void put_pair(Line& line, const char* key, const Machine& machine, std::uint32_t number) {
    if (number >= machine.pairs.size()) {
        line.put(",\"{}\":null", key);
        return;
    }
    const Pair& pair = machine.pairs[number];
    line.put(",\"{}\":[\"{}\",\"{}\"]", key, machine.bodies[pair.a].name,
             machine.bodies[pair.b].name);
}

void put_mm(Line& line, const char* key, double value_mm) {
    line.put(",\"{}\":{:.4f}", key, value_mm);
}

/// Keys of "why" in docs/reference/json.md; null: of another kind of reach.
void put_parts(Line& line, const PairWhy& why) {
    const DistanceNeed& need = why.distances.need;
    const std::array<std::pair<const char*, double>, 4> parts{
        {{"until_braking_mm", need.until_braking_mm},
         {"braking_mm", need.braking_mm},
         {"position_error_mm", need.position_error_mm},
         {"speed_uncertainty_mm", need.speed_uncertainty_mm}}};
    if (why.is_whole) {
        put_mm(line, "to_standstill_mm", need.until_braking_mm);
    } else {
        line.put(",\"to_standstill_mm\":null");
    }
    for (const auto& [key, value_mm] : parts) {
        if (why.is_whole || why.is_pose) {
            line.put(",\"{}\":null", key);
        } else {
            put_mm(line, key, value_mm);
        }
    }
    put_mm(line, "margin_mm", need.margin_mm);
    line.put(",\"arithmetic_mm\":{:.4g}", need.arithmetic_mm);  // of 1e-7 mm and more
}

void put_why(Line& line, const char* key, const Machine& machine,
             const std::optional<PairWhy>& why) {
    if (!why) {
        line.put(",\"{}\":null", key);
        return;
    }
    const PairDistances& distances = why->distances;
    line.put(",\"{}\":{{\"needed_mm\":{:.4f}", key, distances.need.sum_mm());
    put_mm(line, "available_mm", distances.available_mm);
    put_mm(line, "within_mm", distances.within_mm);
    put_parts(line, *why);
    line.put(",\"list_full\":{},\"jog\":{}", why->is_list_full, why->is_jog);
    if (why->tool < machine.tools.size()) {
        line.put(",\"tool\":{}", machine.tools[why->tool].number);
    } else {
        line.put(",\"tool\":null");
    }
    if (distances.open) {
        line.put(",\"open\":{{\"needed_mm\":{:.4f}", distances.open->needed_mm);
        put_mm(line, "available_mm", distances.open->available_mm);
        line.put("}}}}");
    } else {
        line.put(",\"open\":null}}");
    }
}

/// Writes the way out and the line of the control. Names of axes need no escape.
void put_way_out(Line& line, const LiveView& view, const StopAccount& account) {
    const bool is_stopped = view.phase == GuardPhase::stopped;
    if (is_stopped && view.program_line > 0) {
        line.put(",\"program_line\":{}", view.program_line);
    } else {
        line.put(",\"program_line\":null");
    }
    if (is_stopped && account.unknown_tool) {
        line.put(",\"unknown_tool\":{}", *account.unknown_tool);
    } else {
        line.put(",\"unknown_tool\":null");
    }
    if (is_stopped && !account.ways_out.empty()) {
        line.put(",\"way_out\":\"{}\"", account.ways_out);
    } else {
        line.put(",\"way_out\":null");
    }
}

/// Without a number of its own the spindle has first_tool, whatever it holds (judge_snapshot).
void put_tool(Line& line, const Machine& machine, std::optional<std::uint16_t> tool) {
    if (!tool) {
        line.put(",\"tool\":null,\"guarded_tool\":null");
        return;
    }
    const std::uint16_t guarded = *tool != 0 ? *tool : machine.first_tool;
    line.put(",\"tool\":{}", *tool);
    if (guarded != 0) {
        line.put(",\"guarded_tool\":{}", guarded);
    } else {
        line.put(",\"guarded_tool\":null");
    }
}

void put_state(Line& line, const LiveView& view, const StatusWhy& more, const Machine& machine,
               std::int64_t now_us) {
    const bool is_stopped = view.phase == GuardPhase::stopped;
    line.put(",\"age_ms\":{},\"phase\":\"{}\",\"phase_ms\":{}",
             std::max<std::int64_t>(0, now_us - view.time_us) / 1000, to_text(view.phase),
             std::max<std::int64_t>(0, view.time_us - view.phase_us) / 1000);
    line.put(",\"cause\":\"{}\",\"reason\":\"{}\"",
             to_text(is_stopped ? view.cause : GuardFault::none),
             to_text(is_stopped ? view.reason : StopReason::none));
    put_pair(line, "pair", machine, is_stopped ? view.pair : kNoIndex);
    put_why(line, "why", machine, is_stopped ? more.stop.why : std::nullopt);
    put_way_out(line, view, more.stop.account);
    line.put(",\"withheld\":\"{}\",\"withheld_reason\":\"{}\"", to_text(view.withheld.why),
             to_text(view.withheld.reason));
    put_pair(line, "withheld_pair", machine, view.withheld.pair);
    put_why(line, "withheld_why", machine, more.withheld);
    put_tool(line, machine, more.tool);
    line.put(",\"stands\":{},\"confirmed\":{}", view.stands, is_stopped && view.is_confirmed);
    if (has_sample_counter(machine.can)) {
        line.put(",\"session\":{}", view.has_session);
    } else {
        line.put(",\"session\":null");
    }
    line.put(",\"sample_us\":{}", machine.can.sample_us);
    if (view.input.measured_period_ns != 0) {
        line.put(",\"period_us\":{:.3f}",
                 static_cast<double>(view.input.measured_period_ns) / 1000);
    } else {
        line.put(",\"period_us\":null");
    }
    line.put(",\"hashes\":\"{}\"", view.compares_hashes ? "required" : "none");
}

void put_counters(Line& line, const LiveView& view) {
    const LiveCounters& counters = view.counters;
    line.put(",\"snapshots\":{},\"permits\":{},\"permits_slow\":{},\"stop_frames\":{},\"late\":{}",
             counters.snapshots, counters.permits, counters.slow, counters.stops, counters.late);
    line.put(",\"refused\":{},\"send_faults\":{},\"samples_lost\":{},\"frames_dropped\":{}",
             counters.refused, counters.send_faults, view.input.samples_lost, view.frames_dropped);
    line.put(",\"operator_acts\":{},\"operator_refused\":{},\"operator_ignored\":{}",
             counters.operator_acts, counters.operator_refused, counters.operator_ignored);
}

}  // namespace

const char* to_text(RecordState state) noexcept {
    switch (state) {
        case RecordState::none:
            return "none";
        case RecordState::this_configuration:
            return "this_configuration";
        case RecordState::another:
            return "another";
        case RecordState::unreadable:
            return "unreadable";
    }
    return "unreadable";
}

StatusLine::StatusLine(const Machine& machine, std::string_view file, std::string_view bus,
                       std::string_view mode, std::string_view configuration_sha256,
                       const TestedBoard& board_test)
    : machine_(machine) {
    const auto text_or_null = [](const std::string& text) {
        return text.empty() ? Json(nullptr) : Json(text);
    };
    const Json head{{"axguardd", AXG_VERSION},
                    {"bus", bus},
                    {"machine", machine.name.substr(0, 200)},
                    {"file", file.substr(0, 64)},
                    {"configuration_sha256", configuration_sha256},
                    {"mode", mode},
                    {"board_test",
                     {{"record", to_text(board_test.state)},
                      {"serial", text_or_null(board_test.serial)},
                      {"date", text_or_null(board_test.date)},
                      {"differs", board_test.differs}}}};
    head_ = head.dump(-1, ' ', true, Json::error_handler_t::replace);
    head_.pop_back();  // what follows is in the same braces
}

std::size_t StatusLine::write(const LiveView* view, const StatusWhy& more, std::int64_t now_us,
                              std::span<char> out) const noexcept {
    Line line(out);
    line.put("{}", head_);
    if (view == nullptr) {
        line.put(",\"phase\":\"init\"");
    } else {
        put_state(line, *view, more, machine_, now_us);
        put_counters(line, *view);
    }
    line.put("}}\n");
    return line.size();
}

}  // namespace axg
