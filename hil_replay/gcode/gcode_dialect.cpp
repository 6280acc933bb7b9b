// SPDX-License-Identifier: Apache-2.0
// Sources: Siemens, "SINUMERIK 840D sl Programming Manual, Job Planning"; Heidenhain, "TNC 640
// User's Manual, Klartext Programming".
#include "hil_replay/gcode/gcode_dialect.hpp"

#include <algorithm>
#include <cctype>
#include <string>

namespace axg {
namespace {

/// Words at the start of a Klartext block, after its number.
constexpr std::string_view kHeidenhain[] = {
    "BEGIN PGM", "END PGM",  "BLK FORM", "TOOL CALL", "TOOL DEF", "CYCL DEF",
    "CYCL CALL", "CALL LBL", "LBL ",     "PLANE ",    "FUNCTION", "APPR ",
    "DEP ",      "FN ",      "L ",       "LN ",       "CC ",
};
/// Words anywhere in a block.
constexpr std::string_view kSiemens[] = {
    "TRAORI",  "TRAFOOF", "TRANS ", "ATRANS", "AROT",    "CYCLE",     "POCKET",
    "SUPA",    "ORIAXES", "ORIWKS", "ORIMKS", "CFTCP",   "COMPCAD",   "COMPCURV",
    "COMPOF",  "STOPRE",  "FFWON",  "GOTOF",  "GOTOB",   "MCALL",     "DEF REAL",
    "DEF INT", "=DC(",    "=IC(",   "=AC(",   "REPEATB", "WORKPIECE",
};

std::string without_comments(std::string_view line) {
    std::string out;
    bool is_comment = false;
    for (const char c : line.substr(0, std::min(line.find(';'), line.size()))) {
        is_comment = is_comment || c == '(';
        if (!is_comment) {
            out.push_back(static_cast<char>(std::toupper(static_cast<unsigned char>(c))));
        } else if (out.empty() || out.back() != '(') {
            out.push_back('(');  // "=DC(90)" is no comment; its beginning is enough to match
        }
        is_comment = is_comment && c != ')';
    }
    return out;
}

/// Removes a block number: "N10 ", "12 ".
std::string_view without_number(std::string_view line) {
    std::size_t at = line.find_first_not_of(" \t");
    if (at != std::string_view::npos && line[at] == 'N') {
        ++at;
    }
    at = line.find_first_not_of("0123456789 \t", std::min(at, line.size()));
    return at == std::string_view::npos ? std::string_view{} : line.substr(at);
}

}  // namespace

std::string_view foreign_control(std::string_view line) {
    const std::string text = without_comments(line);
    const std::string_view block = without_number(text);
    const auto begins = [block](std::string_view word) { return block.starts_with(word); };
    if (std::any_of(std::begin(kHeidenhain), std::end(kHeidenhain), begins)) {
        return "Heidenhain";
    }
    const auto holds = [&text](std::string_view word) {
        return text.find(word) != std::string::npos;
    };
    return std::any_of(std::begin(kSiemens), std::end(kSiemens), holds) ? "Siemens" : "";
}

}  // namespace axg
