// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/page/page_program_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "config/text/quote_text.hpp"
#include "hil_replay/trace/program_lines.hpp"

namespace axg {
namespace {

constexpr std::size_t kFileCharactersMax = 4096;

/// As on the terminal: control characters and those that turn the direction of writing as escapes.
std::string json_text(const std::string& text, std::size_t length_max) {
    return nlohmann::json(escaped(text, length_max))
        .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// Size of a JSON text within a script, in which a '<' has six bytes.
std::size_t size_in_script_bytes(const std::string& text) {
    return text.size() + 5 * static_cast<std::size_t>(std::count(text.begin(), text.end(), '<'));
}

/// Text of one column, and its separators.
template <typename Append>
void append_column(std::string& out, const std::vector<const ProgramStep*>& steps,
                   const Append& append) {
    out += '[';
    for (const ProgramStep* step : steps) {
        out += step == steps.front() ? "" : ",";
        append(*step);
    }
    out += ']';
}

std::string steps_text(const ProgramLines& lines, const std::vector<const ProgramStep*>& steps) {
    std::string out =
        fmt::format("{{\"file\":{},\"read_as\":{},\"count\":{},\"steps\":{{\"time_s\":",
                    json_text(lines.program, kFileCharactersMax),
                    json_text(lines.read_as, kFileCharactersMax), lines.steps.size());
    append_column(out, steps, [&out](const ProgramStep& step) {
        fmt::format_to(std::back_inserter(out), "{:.6f}", static_cast<double>(step.time_us) * 1e-6);
    });
    out += ",\"line\":";
    append_column(out, steps, [&out](const ProgramStep& step) {
        fmt::format_to(std::back_inserter(out), "{}", step.line);
    });
    std::map<std::uint32_t, const std::string*> blocks;  // a loop comes back to its lines
    for (const ProgramStep* step : steps) {
        if (step->line != 0) {
            blocks.try_emplace(step->line, &step->block);
        }
    }
    out += "},\"blocks\":{";
    const char* separator = "";
    for (const auto& [line, block] : blocks) {
        fmt::format_to(std::back_inserter(out), "{}\"{}\":{}", separator, line,
                       json_text(*block, kBlockCharactersMax));
        separator = ",";
    }
    return out + "}}";
}

/// The instants that the page can draw, in order.
std::vector<std::int64_t> drawn_times_us(const RunPage& page) {
    std::vector<std::int64_t> times_us;
    for (std::size_t row = 0; row < page.samples.rows(); ++row) {
        times_us.push_back(std::llround(page.samples.row(row)[0] * 1e6));
    }
    const auto stops = nlohmann::json::parse(page.stops, nullptr, false);
    for (const nlohmann::json& stop : stops.is_array() ? stops : nlohmann::json::array()) {
        times_us.push_back(stop.value("time_us", std::int64_t{0}));
    }
    std::sort(times_us.begin(), times_us.end());
    return times_us;
}

std::vector<const ProgramStep*> drawn_steps(const RunPage& page) {
    const std::vector<ProgramStep>& steps = page.program->steps;
    std::vector<const ProgramStep*> drawn;
    std::size_t begun = 0;
    for (const std::int64_t time_us : drawn_times_us(page)) {
        while (begun < steps.size() && steps[begun].time_us <= time_us) {
            ++begun;
        }
        if (begun != 0 && (drawn.empty() || drawn.back() != &steps[begun - 1])) {
            drawn.push_back(&steps[begun - 1]);
        }
    }
    return drawn;
}

}  // namespace

std::string program_data(const RunPage& page) {
    if (page.program == nullptr || page.program->is_empty()) {
        return {};
    }
    std::vector<const ProgramStep*> all;
    for (const ProgramStep& step : page.program->steps) {
        all.push_back(&step);
    }
    std::string text = steps_text(*page.program, all);
    return size_in_script_bytes(text) <= kProgramBytesMax
               ? text
               : steps_text(*page.program, drawn_steps(page));
}

}  // namespace axg
