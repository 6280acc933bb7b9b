// SPDX-License-Identifier: Apache-2.0
#include "config/init/guess_roles.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "config/text/map_reader.hpp"

namespace axg {
namespace {

struct Word {
    std::string_view text;
    char role;  // an axis; 'T' tool; 'F' fixed
};
// One letter is the plainest hint, then the customary names of the parts.
constexpr std::array<Word, 34> kWords{
    {{"x", 'X'},         {"y", 'Y'},      {"z", 'Z'},       {"a", 'A'},         {"b", 'B'},
     {"c", 'C'},         {"tool", 'T'},   {"cutter", 'T'},  {"endmill", 'T'},   {"drill", 'T'},
     {"mill", 'T'},      {"frame", 'F'},  {"base", 'F'},    {"bed", 'F'},       {"column", 'F'},
     {"enclosure", 'F'}, {"saddle", 'Y'}, {"table", 'X'},   {"headstock", 'Z'}, {"head", 'Z'},
     {"spindle", 'Z'},   {"ram", 'Z'},    {"quill", 'Z'},   {"trunnion", 'A'},  {"cradle", 'A'},
     {"swivel", 'B'},    {"rotary", 'C'}, {"platter", 'C'}, {"plate", 'C'},     {"turntable", 'C'},
     {"faceplate", 'C'}, {"chuck", 'C'},  {"slide", 'X'},   {"ways", 'F'}}};

// German puts the part at the end: a Spindelkopf is a Kopf. Longer words first, for a Drehtisch is
// no mere Tisch. Umlauts are spelt out before.
constexpr std::array<Word, 28> kEndings{
    {{"drehtisch", 'C'}, {"rundtisch", 'C'},   {"drehteller", 'C'},   {"planscheibe", 'C'},
     {"futter", 'C'},    {"schwenkkopf", 'B'}, {"schwenktisch", 'A'}, {"schwenk", 'A'},
     {"wippe", 'A'},     {"wiege", 'A'},       {"kreuztisch", 'Y'},   {"kreuzschlitten", 'Y'},
     {"werkzeug", 'T'},  {"fraeser", 'T'},     {"bohrer", 'T'},       {"tisch", 'X'},
     {"schlitten", 'X'}, {"kopf", 'Z'},        {"spindel", 'Z'},      {"pinole", 'Z'},
     {"bett", 'F'},      {"gestell", 'F'},     {"rahmen", 'F'},       {"staender", 'F'},
     {"saeule", 'F'},    {"grundplatte", 'F'}, {"verkleidung", 'F'},  {"haube", 'F'}}};

bool is_letter(char c) noexcept {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

std::string stem_of(std::string_view file) {
    file = file.substr(file.find_last_of('/') + 1);
    return std::string{file.substr(0, file.find_last_of('.'))};
}

using Names = std::vector<std::string>;  // the words of one file's name, in small letters

bool is_capital(char c) noexcept {
    return c >= 'A' && c <= 'Z';
}

/// "XAxis" and "x_axis" are x and axis; so are "Xaxis" and "axisX", which no letter parts.
Names words_of(std::string_view stem) {
    constexpr std::string_view kAxis = "axis";
    Names words(1);
    for (std::size_t i = 0; i < stem.size(); ++i) {
        const char c = stem[i];
        const bool begins =
            i > 0 && is_capital(c) && is_letter(stem[i - 1]) &&
            (!is_capital(stem[i - 1]) ||
             (i + 1 < stem.size() && is_letter(stem[i + 1]) && !is_capital(stem[i + 1])));
        if ((begins || !is_letter(c)) && !words.back().empty()) {
            words.emplace_back();
        }
        if (is_letter(c)) {
            words.back() += is_capital(c) ? static_cast<char>(c - 'A' + 'a') : c;
        }
    }
    for (std::string& word : words) {
        if (word.size() == kAxis.size() + 1 && word.ends_with(kAxis)) {
            word.resize(1);
        } else if (word.size() == kAxis.size() + 1 && word.starts_with(kAxis)) {
            word = word.substr(kAxis.size());
        }
    }
    if (words.size() > 1 && words.back().empty()) {
        words.pop_back();
    }
    return words;
}

char role_of(const Names& words) {
    for (const Word& known : kWords) {
        if (std::find(words.begin(), words.end(), known.text) != words.end()) {
            return known.role;
        }
    }
    for (const Word& known : kEndings) {
        if (std::any_of(words.begin(), words.end(),
                        [&known](const std::string& word) { return word.ends_with(known.text); })) {
            return known.role;
        }
    }
    return '\0';
}

/// The German letters of UTF-8 as two of ASCII; other bytes stay.
std::string spelt_out(std::string_view text) {
    constexpr std::array<std::pair<std::string_view, std::string_view>, 7> kLetters{
        {{"\xc3\xa4", "ae"},
         {"\xc3\xb6", "oe"},
         {"\xc3\xbc", "ue"},
         {"\xc3\x9f", "ss"},
         {"\xc3\x84", "Ae"},
         {"\xc3\x96", "Oe"},
         {"\xc3\x9c", "Ue"}}};
    std::string out;
    while (!text.empty()) {
        const auto found = std::find_if(kLetters.begin(), kLetters.end(), [&text](const auto& one) {
            return text.starts_with(one.first);
        });
        out += found == kLetters.end() ? text.substr(0, 1) : found->second;
        text.remove_prefix(found == kLetters.end() ? 1 : found->first.size());
    }
    return out;
}

/// Without a last (or first) word that most files share, if the rest tells them apart: in
/// "table_b", "head_b" and "c_axis_b" the letter names the machine, not an axis.
void drop_shared_word(std::vector<Names>& files, bool is_last) {
    std::map<std::string, std::vector<std::size_t>> sharers;
    for (std::size_t i = 0; i < files.size(); ++i) {
        if (files[i].size() > 1) {
            sharers[is_last ? files[i].back() : files[i].front()].push_back(i);
        }
    }
    for (const auto& [word, places] : sharers) {
        std::set<char> roles;
        std::vector<Names> rest = files;
        for (const std::size_t place : places) {
            rest[place].erase(is_last ? rest[place].end() - 1 : rest[place].begin());
            roles.insert(role_of(rest[place]));
        }
        roles.erase('\0');
        if (2 * places.size() > files.size() && places.size() > 2 && roles.size() > 1) {
            files = std::move(rest);
            return;
        }
    }
}

std::vector<char> roles_of(const std::vector<std::string>& files) {
    std::vector<Names> names;
    for (const std::string& file : files) {
        names.push_back(words_of(spelt_out(stem_of(file))));
    }
    drop_shared_word(names, true);
    drop_shared_word(names, false);
    std::vector<char> roles;
    std::transform(names.begin(), names.end(), std::back_inserter(roles), role_of);
    return roles;
}

/// Position of a role in the chains: the fixed parts, the table's side from the bottom up, the
/// head's side.
int rank_of(char role) noexcept {
    constexpr std::string_view kOrder = "FYXABCZT";
    const std::size_t at = kOrder.find(role);
    return role == '\0' || at == std::string_view::npos ? static_cast<int>(kOrder.size())
                                                        : static_cast<int>(at);
}

/// Last one in the chain below `role`, on its side.
std::uint32_t carrier_of(char role, const std::vector<RoleGuess>& placed) {
    const bool head_side = role == 'Z' || role == 'T';
    std::uint32_t carrier = kNoParent;
    for (std::uint32_t i = 0; i < placed.size(); ++i) {
        if (!placed[i].axis.empty() && placed[i].is_table_side != head_side) {
            carrier = i;
        }
    }
    return carrier;
}

}  // namespace

void add_tool_body(std::vector<RoleGuess>& roles) {
    if (std::any_of(roles.begin(), roles.end(), [](const RoleGuess& one) { return one.is_tool; })) {
        return;
    }
    RoleGuess tool;
    tool.name = legal_name("tool", roles);
    tool.parent = carrier_of('T', roles);
    tool.is_tool = true;
    tool.file = kNoFile;
    roles.push_back(std::move(tool));
}

char axis_in(std::string_view name) {
    const Names words = words_of(name);
    const auto found = std::find_if(words.begin(), words.end(), [](const std::string& word) {
        return word.size() == 1 && std::string_view("xyzabc").find(word[0]) != std::string::npos;
    });
    return found == words.end() ? '\0' : static_cast<char>((*found)[0] - 'a' + 'A');
}

std::string legal_name(const std::string& stem, const std::vector<RoleGuess>& others) {
    std::string name;
    for (const char c : stem) {
        const bool is_plain = is_letter(c) || (c >= '0' && c <= '9') || c == '_' || c == '-';
        name += is_plain ? c : '_';
    }
    name.resize(std::min<std::size_t>(name.size(), kNameLengthMax - 4));
    if (!is_name(name)) {
        name = "body" + name;
    }
    const auto is_taken = [&others](const std::string& candidate) {
        return std::any_of(others.begin(), others.end(), [&candidate](const RoleGuess& other) {
            return other.name == candidate;
        });
    };
    std::string unique = name;
    for (int i = 2; is_taken(unique); ++i) {
        unique = name + '_' + std::to_string(i);
    }
    return unique;
}

void ride_in_boxes(std::vector<RoleGuess>& roles, const std::vector<Box>& boxes) {
    const auto volume_of = [&](std::uint32_t body) {
        const Box& box = boxes[roles[body].file];
        const Vec3d size = box.max_mm - box.min_mm;
        return size.x * size.y * size.z;
    };
    const auto contains = [&](std::uint32_t carrier, std::uint32_t body) {
        const Box &outer = boxes[roles[carrier].file], &inner = boxes[roles[body].file];
        return outer.min_mm.x <= inner.min_mm.x && inner.max_mm.x <= outer.max_mm.x &&
               outer.min_mm.y <= inner.min_mm.y && inner.max_mm.y <= outer.max_mm.y &&
               outer.min_mm.z <= inner.min_mm.z && inner.max_mm.z <= outer.max_mm.z &&
               volume_of(body) < volume_of(carrier);
    };
    for (std::uint32_t i = 0; i < roles.size(); ++i) {
        std::uint32_t& carrier = roles[i].parent;
        for (std::uint32_t k = 0; roles[i].is_unnamed && k < i; ++k) {
            if (!roles[k].is_unnamed && !roles[k].is_tool && contains(k, i) &&
                (carrier == kNoParent || volume_of(k) < volume_of(carrier))) {
                carrier = k;
            }
        }
    }
}

std::vector<RoleGuess> guess_roles(const std::vector<std::string>& files) {
    struct Candidate {
        std::uint32_t file;
        std::string stem;
        char role;
    };
    std::vector<Candidate> candidates;
    bool has_tool = false;
    bool moves = false;
    const std::vector<char> roles = roles_of(files);
    for (std::uint32_t i = 0; i < files.size(); ++i) {
        const std::string stem = spelt_out(stem_of(files[i]));
        char role = roles[i];
        role = role == 'T' && has_tool ? '\0' : role;  // one tool body at most
        has_tool |= role == 'T';
        moves |= role >= 'A' && role <= 'Z' && role != 'T' && role != 'F';
        candidates.push_back({i, stem, role});
    }
    if (!moves && !candidates.empty()) {
        const auto first = std::find_if(candidates.begin(), candidates.end(),
                                        [](const Candidate& one) { return one.role != 'T'; });
        (first == candidates.end() ? candidates.begin() : first)->role = 'X';
    }
    std::stable_sort(
        candidates.begin(), candidates.end(),
        [](const Candidate& a, const Candidate& b) { return rank_of(a.role) < rank_of(b.role); });
    std::vector<RoleGuess> out;
    for (const Candidate& one : candidates) {
        RoleGuess guess;
        guess.name = legal_name(one.stem, out);
        guess.file = one.file;
        guess.is_tool = one.role == 'T';
        const bool is_axis = one.role != '\0' && one.role != 'T' && one.role != 'F';
        const auto same = std::find_if(out.begin(), out.end(), [&one, is_axis](const RoleGuess& o) {
            return is_axis && o.axis == std::string(1, one.role);
        });
        if (same != out.end()) {  // a second part of the same axis rides on the first
            guess.parent = static_cast<std::uint32_t>(same - out.begin());
        } else if (is_axis || guess.is_tool) {
            guess.parent = carrier_of(one.role, out);
            guess.axis = is_axis ? std::string(1, one.role) : "";
            guess.is_table_side = is_axis && one.role != 'Z';
        } else {
            guess.is_unnamed = one.role == '\0';
        }
        out.push_back(std::move(guess));
    }
    return out;
}

}  // namespace axg
