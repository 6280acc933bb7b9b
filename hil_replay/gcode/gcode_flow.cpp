// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/gcode/gcode_flow.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <set>
#include <utility>

#include "hil_replay/gcode/gcode_lexer.hpp"

namespace axg {
namespace {

using enum FlowWord;
using std::string_view_literals::operator""sv;

constexpr std::size_t kFramesMax = 100;

// A word that is a prefix of another one is listed after it.
constexpr std::array kWords = {
    std::pair{"ENDSUB", endsub},  std::pair{"SUB", sub},      std::pair{"CALL", call},
    std::pair{"RETURN", return_}, std::pair{"ENDIF", endif},  std::pair{"ELSEIF", elseif},
    std::pair{"ELSE", else_},     std::pair{"IF", if_},       std::pair{"ENDWHILE", endwhile},
    std::pair{"WHILE", while_},   std::pair{"DO", do_},       std::pair{"ENDREPEAT", endrepeat},
    std::pair{"REPEAT", repeat},  std::pair{"BREAK", break_}, std::pair{"CONTINUE", continue_},
};

/// The text after line number and block delete if it begins with an O-word, else an empty text.
std::string flow_text(std::string_view line) {
    const std::size_t first = line.find_first_not_of(" \t\r/");
    if (first == std::string_view::npos ||
        std::string_view("oOnNmM").find(line[first]) == std::string_view::npos) {
        return {};
    }
    GcodeLine fault;
    std::string text;
    if (!strip_gcode_line(line, text, fault)) {
        return {};
    }
    std::size_t at = text.find_first_not_of('/');
    if (at != std::string::npos && text[at] == 'N') {
        at = text.find_first_not_of("0123456789.", at + 1);
    }
    if (at == std::string::npos) {
        return {};
    }
    text.erase(0, at);
    const bool is_call = (text.starts_with("M98") || text.starts_with("M99")) &&
                         (text.size() == 3 || "0123456789.+-"sv.find(text[3]) == std::string::npos);
    return text[0] == 'O' || is_call ? text : std::string();
}

/// Reads one O-line. On failure returns nothing and sets `fault`.
std::optional<FlowLine> read_flow_line(std::size_t line, std::string_view text,
                                       std::string& fault) {
    FlowLine out;
    out.line = line;
    if (text.front() == 'M') {
        out.word = text[2] == '8' ? m98 : m99;
        out.rest = std::string(text.substr(3));
        if (out.word == m99 && !out.rest.empty()) {
            fault = "M99: no other word may be in its line";
            return std::nullopt;
        }
        return out;
    }
    std::string_view rest = text.substr(1);
    if (!rest.empty() && rest.front() == '<') {
        const std::size_t end = rest.find('>');
        if (end == std::string_view::npos) {
            fault = "expected a name and '>'";
            return std::nullopt;
        }
        out.id = std::string(rest.substr(0, end + 1));
        rest.remove_prefix(end + 1);
    } else {
        const std::size_t end = std::min(rest.find_first_not_of("0123456789"), rest.size());
        if (const std::size_t call_at = rest.find("CALL"); end == 0 && call_at < rest.size()) {
            out.word = FlowWord::call;
            out.computed_id = std::string(rest.substr(0, call_at));
            out.rest = std::string(rest.substr(call_at + 4));
            return out;
        }
        if (end == 0) {
            fault = "expected a number or <name> after O; only calls may compute it";
            return std::nullopt;
        }
        const std::size_t zeros = std::min(rest.find_first_not_of('0'), end - 1);
        out.id = std::string(rest.substr(zeros, end - zeros));
        rest.remove_prefix(end);
    }
    if (rest.empty()) {
        out.word = number;
        return out;
    }
    const auto* const word = std::find_if(kWords.begin(), kWords.end(), [rest](const auto& one) {
        return rest.substr(0, std::string_view(one.first).size()) == one.first;
    });
    if (word == kWords.end()) {
        fault =
            "expected sub, call, return, if, while, do, repeat, break, continue, or the end of "
            "one, or nothing after the number of a program";
        return std::nullopt;
    }
    out.word = word->second;
    out.rest = std::string(rest.substr(std::string_view(word->first).size()));
    return out;
}

}  // namespace

GcodeFlow::GcodeFlow(std::span<const std::string_view> lines, std::span<const std::size_t> starts,
                     GcodeParameters& parameters)
    : parameters_(parameters) {
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const std::string text = flow_text(lines[i]);
        if (text.empty()) {
            continue;
        }
        std::string fault;
        if (std::optional<FlowLine> found = read_flow_line(i, text, fault)) {
            place_of_line_.emplace(i, flow_.size());
            found->file = static_cast<std::size_t>(
                std::upper_bound(starts.begin(), starts.end(), i) - starts.begin());
            flow_.push_back(std::move(*found));
        } else {
            fault_of_line_.emplace(i, std::move(fault));
        }
    }
}

std::vector<std::string> GcodeFlow::missing_subs(std::span<const std::string_view> lines) {
    std::set<std::string> called, found;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        std::string fault;
        const std::string text = flow_text(lines[i]);
        const std::optional<FlowLine> line =
            text.empty() ? std::nullopt : read_flow_line(i, text, fault);
        if (line && !line->id.empty() && (line->word == FlowWord::call || line->word == sub)) {
            (line->word == sub ? found : called).insert(line->id);
        }
    }
    std::vector<std::string> missing;
    std::set_difference(called.begin(), called.end(), found.begin(), found.end(),
                        std::back_inserter(missing));
    return missing;
}

std::size_t GcodeFlow::calls() const {
    return static_cast<std::size_t>(std::count_if(
        frames_.begin(), frames_.end(), [](const Frame& frame) { return frame.is_call(); }));
}

std::string GcodeFlow::run(std::size_t line, std::size_t& next) {
    const auto place = place_of_line_.find(line);
    if (place == place_of_line_.end()) {
        const std::string fault = fault_of(line);
        return fault.empty() ? "cannot be read" : fault;
    }
    const FlowLine& at = flow_[place->second];
    fault_.clear();
    switch (at.word) {
        case sub:
            run_sub(at, next);
            break;
        case FlowWord::call:
            call(at, next);
            break;
        case endsub:
        case return_:
            end_call(at, next);
            break;
        case if_:
            choose(at, next);
            break;
        case elseif:
        case else_:
            skip_to_endif(at, next);
            break;
        case endif:
            break;
        case number:
            pass_number();
            break;
        case m98:
            call_number(at, next);
            break;
        case m99:
            end_number(next);
            break;
        case while_:
            loop_while(at, next);
            break;
        case do_:
            frames_.push_back({&at});
            break;
        case repeat:
            loop_repeat(at, next);
            break;
        case endwhile:
        case endrepeat:
            end_loop(at, next);
            break;
        case break_:
        case continue_:
            leave_loop(at, next);
            break;
    }
    if (fault_.empty() && frames_.size() > kFramesMax) {
        fault_ = "more than 100 nested calls and loops; check for a subroutine that calls itself";
    }
    return fault_;
}

const FlowLine* GcodeFlow::find_after(const FlowLine& from,
                                      std::initializer_list<FlowWord> words) const {
    for (const FlowLine* at = &from + 1; at != flow_.data() + flow_.size(); ++at) {
        if (at->file != from.file) {
            return nullptr;
        }
        if (at->id == from.id && std::find(words.begin(), words.end(), at->word) != words.end()) {
            return at;
        }
    }
    return nullptr;
}

bool GcodeFlow::read_values(const FlowLine& at, std::vector<double>& values) {
    std::string_view rest = at.rest;
    while (!rest.empty()) {
        GcodeValueReader reader(rest, &parameters_);
        const std::optional<double> value = rest.front() == '[' ? reader.value() : std::nullopt;
        if (!value) {
            fault_ = rest.front() == '[' ? reader.fault() : "expected [ and an expression";
            return false;
        }
        values.push_back(*value);
        rest = reader.rest();
    }
    return true;
}

bool GcodeFlow::read_condition(const FlowLine& at, bool& is_true) {
    std::vector<double> values;
    if (!read_values(at, values)) {
        return false;
    }
    if (values.size() != 1) {
        fault_ = "expected one [condition]";
        return false;
    }
    is_true = values[0] != 0;
    return true;
}

bool GcodeFlow::is_number(std::size_t line) const {
    const auto place = place_of_line_.find(line);
    return place != place_of_line_.end() && flow_[place->second].word == number;
}

std::string GcodeFlow::fault_of(std::size_t line) const {
    const auto fault = fault_of_line_.find(line);
    return fault == fault_of_line_.end() ? std::string() : fault->second;
}

/// LinuxCNC 2.9 begins a subroutine here, and one within another is an error.
void GcodeFlow::pass_number() {
    if (is_in_call()) {
        fault_ = "a program number inside a subroutine; delete the line";
    }
}

/// Skips the subroutine: it runs only when it is called.
void GcodeFlow::run_sub(const FlowLine& at, std::size_t& next) {
    const FlowLine* const end = find_after(at, {endsub});
    if (end == nullptr) {
        fault_ = "there is no O" + at.id + " endsub";
        return;
    }
    const bool has_inner =
        std::any_of(&at + 1, end, [](const FlowLine& one) { return one.word == sub; });
    if (has_inner) {
        fault_ = "a subroutine begins inside O" + at.id + "; move it behind its endsub";
        return;
    }
    const FlowLine* const other = find_after(at, {sub});
    if (other != nullptr) {
        fault_ = "O" + at.id + " sub comes again in line " + std::to_string(other->line + 1) +
                 "; give one of them another name";
        return;
    }
    next = end->line + 1;
}

/// A whole number, as LinuxCNC has it: to 0.0001.
std::string GcodeFlow::computed_id(const FlowLine& at) {
    GcodeValueReader reader(at.computed_id, &parameters_);
    const std::optional<double> value = reader.value();
    const double nearest = std::round(value.value_or(-1));
    if (!value || !reader.rest().empty() || nearest < 0 || nearest > 1e9 ||
        std::abs(*value - nearest) > 1e-4) {
        fault_ = "expected the number of a subroutine";
        return {};
    }
    return std::to_string(static_cast<std::int64_t>(nearest));
}

void GcodeFlow::call(const FlowLine& at, std::size_t& next) {
    const std::string id = at.computed_id.empty() ? at.id : computed_id(at);
    if (id.empty()) {
        return;
    }
    const auto found = std::find_if(flow_.begin(), flow_.end(), [&id](const FlowLine& one) {
        return one.word == sub && one.id == id;
    });
    if (found == flow_.end()) {
        fault_ = "there is no O" + id +
                 " sub in this file; pass the folder that has a file of this name with --sub";
        return;
    }
    std::vector<double> arguments;
    if (!read_values(at, arguments)) {
        return;
    }
    frames_.push_back({.start = &*found, .return_to = next});
    parameters_.enter(arguments);
    parameters_.set_named("_VALUE", 0);
    parameters_.set_named("_VALUE_RETURNED", 0);
    next = found->line + 1;
}

/// As in LinuxCNC, the parameters #1 to #30 are the caller's.
void GcodeFlow::call_number(const FlowLine& at, std::size_t& next) {
    std::string_view rest = at.rest;
    std::optional<double> place, repeats = 1;
    while (!rest.empty()) {
        const char letter = rest.front();
        GcodeValueReader reader(rest.substr(1), &parameters_);
        const std::optional<double> value = reader.value();
        if (!value || (letter != 'P' && letter != 'L')) {
            fault_ = "M98: expected only P and L, with numbers";
            return;
        }
        (letter == 'P' ? place : repeats) = value;
        rest = reader.rest();
    }
    if (!place || *place != std::floor(*place) || *place < 0 || *place > 1e9) {
        fault_ = "M98: expected P, the number of a subroutine";
        return;
    }
    const std::string id = std::to_string(static_cast<std::int64_t>(*place));
    const auto found = std::find_if(flow_.begin(), flow_.end(), [&](const FlowLine& one) {
        return one.word == number && one.id == id && one.file == at.file;
    });
    if (found == flow_.end()) {
        fault_ = "M98: there is no line O" + id + " in this file that M99 would end";
        return;
    }
    if (std::round(*repeats) < 1) {
        return;
    }
    frames_.push_back({.start = &*found, .return_to = next, .remaining = std::round(*repeats)});
    parameters_.enter_names();
    next = found->line + 1;
}

void GcodeFlow::end_number(std::size_t& next) {
    while (!frames_.empty() && !frames_.back().is_call()) {
        frames_.pop_back();  // loops that M99 leaves
    }
    if (frames_.empty() || frames_.back().start->word != number) {
        fault_ = frames_.empty() ? "M99: repeats the program endlessly; write M2"
                                 : "M99: ends no O sub; write endsub";
        return;
    }
    Frame& frame = frames_.back();
    parameters_.leave();
    if (--frame.remaining >= 1) {
        parameters_.enter_names();
        next = frame.start->line + 1;
        return;
    }
    next = frame.return_to;
    frames_.pop_back();
}

void GcodeFlow::end_call(const FlowLine& at, std::size_t& next) {
    std::vector<double> values;
    if (!read_values(at, values)) {
        return;
    }
    while (!frames_.empty() && !frames_.back().is_call()) {
        frames_.pop_back();  // loops that the return leaves
    }
    const bool is_any = at.word == return_;  // LinuxCNC does not ask for the sub's name there
    if (frames_.empty() || frames_.back().start->word != sub ||
        (!is_any && frames_.back().start->id != at.id)) {
        fault_ = "no call of O" + at.id + " is under way";
        return;
    }
    next = frames_.back().return_to;
    frames_.pop_back();
    parameters_.leave();
    parameters_.set_named("_VALUE", values.empty() ? 0 : values[0]);
    parameters_.set_named("_VALUE_RETURNED", values.empty() ? 0 : 1);
}

void GcodeFlow::choose(const FlowLine& at, std::size_t& next) {
    const FlowLine* here = &at;
    bool is_true = false;
    while (here->word == if_ || here->word == elseif) {
        if (!read_condition(*here, is_true)) {
            return;
        }
        if (is_true) {
            break;
        }
        const FlowLine* const other = find_after(*here, {elseif, else_, endif});
        if (other == nullptr) {
            fault_ = "there is no O" + at.id + " endif";
            return;
        }
        here = other;
    }
    next = here->line + 1;
}

/// Leaves the conditional after a branch that ran.
void GcodeFlow::skip_to_endif(const FlowLine& at, std::size_t& next) {
    const FlowLine* const end = find_after(at, {endif});
    if (end == nullptr) {
        fault_ = "there is no O" + at.id + " endif";
        return;
    }
    next = end->line + 1;
}

const FlowLine* GcodeFlow::end_of(const FlowLine& start) const {
    return start.word == while_ ? find_after(start, {endwhile})
           : start.word == do_  ? find_after(start, {while_})
                                : find_after(start, {endrepeat});
}

/// Runs a while line: the start of a while loop, or the end of a do loop.
void GcodeFlow::loop_while(const FlowLine& at, std::size_t& next) {
    bool is_true = false;
    if (!read_condition(at, is_true)) {
        return;
    }
    const bool ends_do =
        !frames_.empty() && frames_.back().start->word == do_ && frames_.back().start->id == at.id;
    if (ends_do) {
        if (is_true) {
            next = frames_.back().start->line + 1;
        } else {
            frames_.pop_back();
        }
        return;
    }
    const FlowLine* const end = end_of(at);
    if (end == nullptr) {
        fault_ = "there is no O" + at.id + " endwhile";
        return;
    }
    if (is_true && !is_in(at)) {
        frames_.push_back({&at});
    } else if (!is_true) {
        if (is_in(at)) {
            frames_.pop_back();
        }
        next = end->line + 1;
    }
}

void GcodeFlow::loop_repeat(const FlowLine& at, std::size_t& next) {
    std::vector<double> values;
    if (!read_values(at, values)) {
        return;
    }
    const FlowLine* const end = end_of(at);
    if (values.size() != 1 || end == nullptr) {
        fault_ = end == nullptr ? "there is no O" + at.id + " endrepeat" : "expected one [count]";
        return;
    }
    const double count = std::round(values[0]);
    if (count < 1) {
        next = end->line + 1;
        return;
    }
    frames_.push_back({.start = &at, .return_to = 0, .remaining = count});
}

void GcodeFlow::end_loop(const FlowLine& at, std::size_t& next) {
    if (frames_.empty() || frames_.back().start->id != at.id ||
        end_of(*frames_.back().start) != &at) {
        fault_ = "no loop O" + at.id + " is under way";
        return;
    }
    Frame& frame = frames_.back();
    if (at.word == endwhile) {
        next = frame.start->line;
    } else if (--frame.remaining >= 1) {
        next = frame.start->line + 1;
    } else {
        frames_.pop_back();
    }
}

void GcodeFlow::leave_loop(const FlowLine& at, std::size_t& next) {
    while (!frames_.empty() && !frames_.back().is_call() && frames_.back().start->id != at.id) {
        frames_.pop_back();
    }
    const FlowLine* const end =
        frames_.empty() || frames_.back().is_call() ? nullptr : end_of(*frames_.back().start);
    if (end == nullptr) {
        fault_ = "no loop O" + at.id + " is under way";
        return;
    }
    if (at.word == continue_) {
        next = end->line;
        return;
    }
    next = end->line + 1;
    frames_.pop_back();
}

}  // namespace axg
