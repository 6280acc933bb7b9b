// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/explain/why_sentences.hpp"

#include <fmt/format.h>

namespace axg {
namespace {

/// Whether the clearance suffices for a stop, so that only the work of a cycle was short.
bool has_clearance(const WhyFacts& facts) noexcept {
    return facts.available_mm > 0 && facts.available_mm >= facts.needed_mm;
}

std::string cause_sentence(const WhyFacts& facts) {
    const std::string pair = facts.a + " and " + facts.b;
    const bool is_about_work =
        facts.cause == WhyCause::capacity || facts.cause == WhyCause::halving;
    if (is_about_work && facts.is_of_stop && !has_clearance(facts)) {
        return pair + " are too near to be proven clear";
    }
    switch (facts.cause) {
        case WhyCause::margin:
            return pair + " are not proven to be farther apart than their margin";
        case WhyCause::contained:
            return "one of " + pair + " is inside the other";
        case WhyCause::reach:
            return pair + " can come too near before the axes stand";
        case WhyCause::halving:
            return pair + " need more steps of proof than the time of a cycle allows";
        case WhyCause::shared:
            return pair + " are proven clear alone, but not in a cycle with all other pairs";
        case WhyCause::capacity:
            return pair + " could not be proven clear within the time of a cycle";
        case WhyCause::not_known:
            return "too little is known of the motion to come to prove a stop of " + pair;
        case WhyCause::not_proven:
            break;
    }
    return pair + " could not be proven clear";
}

/// In the words of the status: verdict: predicted: cutter - c.
std::string stop_sentence(const StopAccount& account) {
    std::string out = fmt::format("stopped: {}", to_text(account.cause));
    if (account.cause == GuardFault::verdict) {
        out += fmt::format(": {}", to_text(account.reason));
    }
    if (!account.a.empty()) {
        out += fmt::format(": {} - {}", account.a, account.b);
    }
    out += account.detail.empty() ? "" : ": " + account.detail;
    return account.program_line > 0 ? fmt::format("{}, program line {}", out, account.program_line)
                                    : out;
}

}  // namespace

const char* to_text(WhyCause cause) noexcept {
    switch (cause) {
        case WhyCause::margin:
            return "margin";
        case WhyCause::contained:
            return "contained";
        case WhyCause::reach:
            return "reach";
        case WhyCause::halving:
            return "halving";
        case WhyCause::shared:
            return "shared";
        case WhyCause::capacity:
            return "capacity";
        case WhyCause::not_known:
            return "not_known";
        case WhyCause::not_proven:
            break;
    }
    return "not_proven";
}

std::vector<std::string> why_sentences(const WhyFacts& facts) {
    std::vector<std::string> out{cause_sentence(facts)};
    if (facts.cause == WhyCause::contained || facts.cause == WhyCause::not_known) {
        return out;
    }
    const std::string available =
        facts.available_mm <= 0
            ? "no distance between them is proven"
            : fmt::format("they are at least {:.4f} mm apart", facts.available_mm);
    if (facts.is_of_stop && has_clearance(facts)) {
        out.push_back(fmt::format("{}, enough for a stop ({:.4f} mm): the proof ran out of steps",
                                  available, facts.needed_mm));
        return out;
    }
    out.push_back(available +
                  (facts.is_of_stop
                       ? fmt::format(", the proof of a stop needs up to {:.4f} mm", facts.needed_mm)
                       : fmt::format(", their margin is {:g} mm", facts.margin_mm)));
    return out;
}

std::string unknown_tool_sentence(std::uint64_t tool, std::string_view file) {
    return fmt::format("tool {} is not in {}: {}", tool, file, kUnknownToolWay);
}

std::vector<std::string> stop_sentences(const StopAccount& account) {
    std::vector<std::string> out{stop_sentence(account)};
    if (account.why) {
        const std::vector<std::string> sentences = why_sentences(*account.why);
        out.insert(out.end(), sentences.begin(), sentences.end());
    }
    if (account.unknown_tool) {
        out.push_back(unknown_tool_sentence(*account.unknown_tool, account.file));
    }
    if (!account.ways_out.empty()) {
        out.push_back(account.ways_out);
    }
    return out;
}

}  // namespace axg
