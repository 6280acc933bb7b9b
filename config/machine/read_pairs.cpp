// SPDX-License-Identifier: Apache-2.0
// The sections `pairs` and `exclusions` of a machine file. Exactly one of them
// names each pair of bodies with a surface: a forgotten pair is a fault, not a gap in the guard.
#include <algorithm>
#include <map>
#include <utility>

#include "config/machine/read_sections.hpp"
#include "config/text/fault_list.hpp"
#include "config/text/map_reader.hpp"
#include "config/text/nearest_word.hpp"
#include "config/text/quote_text.hpp"

namespace axg {
namespace {

constexpr double kMarginMmMax = 1000;

class PairTable {
  public:
    explicit PairTable(MachineDraft& draft) : draft_(draft) {}

    /// True when the pair is valid: two bodies with a surface, not yet named on another line.
    bool take(std::uint32_t a, std::uint32_t b, int line, const std::string& path) {
        const std::string both = name(a) + " and " + name(b);
        if (a == b) {
            draft_.faults.add(line, path, "the body " + name(a) + " against itself", "two bodies");
            return false;
        }
        for (const std::uint32_t body : {a, b}) {
            if (!has_surface(draft_.machine.bodies[body])) {
                if (!draft_.surfaces_are_sound) {
                    return false;
                }
                draft_.faults.add(line, path, "the body " + name(body) + " without a surface",
                                  "bodies with mesh or tool: true");
                return false;
            }
        }
        const auto [entry, is_new] = lines_.emplace(std::minmax(a, b), line);
        if (!is_new) {
            draft_.faults.add(line, path,
                              "the pair of " + both + ", listed on line " +
                                  std::to_string(entry->second) + " already",
                              "each pair once, in pairs or in exclusions");
        }
        return is_new;
    }

    void report_missing(int line) const {
        const auto& bodies = draft_.machine.bodies;
        for (std::uint32_t a = 0; a < bodies.size(); ++a) {
            std::string missing;
            for (std::uint32_t b = a + 1; b < bodies.size(); ++b) {
                if (has_surface(bodies[a]) && has_surface(bodies[b]) && !lines_.contains({a, b})) {
                    missing += (missing.empty() ? "" : ", ") + name(b);
                }
            }
            if (!missing.empty()) {
                draft_.faults.add(
                    line, "pairs", "no entry for " + name(a) + " and " + missing,
                    "every pair of bodies in pairs or, with its reason, in exclusions");
            }
        }
    }

  private:
    static bool has_surface(const Body& body) noexcept { return body.has_mesh || body.is_tool; }
    std::string name(std::uint32_t body) const { return draft_.machine.bodies[body].name; }

    MachineDraft& draft_;
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> lines_;
};

void add_body(const YamlNode& node, const std::string& path, MachineDraft& draft,
              std::vector<std::uint32_t>& out) {
    std::string name;
    if (!read_name({node, path, draft.faults}, name)) {
        draft.names_are_sound = false;
        return;
    }
    const std::uint32_t body = index_of(draft.machine.bodies, name);
    if (body == kNoIndex) {
        draft.names_are_sound = false;
        draft.faults.add(node.line, path, quoted(name),
                         wanted_name("a body", name, names_of(draft.machine.bodies)));
        return;
    }
    out.push_back(body);
}

/// One name or a list of names.
std::vector<std::uint32_t> read_side(MapReader& reader, const char* key, MachineDraft& draft) {
    std::vector<std::uint32_t> out;
    const YamlNode* value = reader.find(key, Need::required, "a body's name or a list of names");
    if (value == nullptr) {
        draft.names_are_sound = false;
        return out;
    }
    const std::string path = reader.path_of(key);
    if (value->kind != YamlNode::Kind::sequence) {
        add_body(*value, path, draft, out);
        return out;
    }
    if (value->entries.empty() || value->entries.size() > kBodiesMax) {
        draft.names_are_sound = false;
        reader.report(key, shown(*value), "1 to " + std::to_string(kBodiesMax) + " names");
        return out;
    }
    for (std::size_t i = 0; i < value->entries.size(); ++i) {
        add_body(value->entries[i].value, path + '[' + std::to_string(i) + ']', draft, out);
    }
    return out;
}

void read_pair(const YamlEntry& item, const std::string& path, MachineDraft& draft,
               PairTable& table) {
    MapReader reader{item.value, path, {"a", "b", "margin_mm", "slow_mm", "warn_mm"}, draft.faults};
    const auto a = read_side(reader, "a", draft);
    const auto b = read_side(reader, "b", draft);
    double margin_mm = 0;
    reader.number("margin_mm", Need::required, {0, kMarginMmMax}, margin_mm);
    ClearanceLevelDistances clearance_levels = draft.usual_clearance_levels;
    read_clearance_levels(reader, clearance_levels);
    for (const std::uint32_t one : a) {
        for (const std::uint32_t other : b) {
            if (table.take(one, other, item.line, path)) {
                draft.machine.pairs.push_back({.a = one,
                                               .b = other,
                                               .margin_mm = margin_mm,
                                               .slow_mm = clearance_levels.slow_mm,
                                               .warn_mm = clearance_levels.warn_mm});
            }
        }
    }
}

void read_exclusion(const YamlEntry& item, const std::string& path, MachineDraft& draft,
                    PairTable& table) {
    MapReader reader{item.value, path, {"a", "b", "reason", "because"}, draft.faults};
    const auto a = read_side(reader, "a", draft);
    const auto b = read_side(reader, "b", draft);
    std::string reason, because;
    reader.text("reason", Need::required, 512, reason);
    reader.text("because", Need::optional, 512, because);
    for (const std::uint32_t one : a) {
        for (const std::uint32_t other : b) {
            if (table.take(one, other, item.line, path)) {
                draft.machine.exclusions.push_back(
                    {.a = one, .b = other, .reason = reason, .because = because});
            }
        }
    }
}

/// The items of a section; one item may name many pairs, but the machine has at most kItemsMax.
const YamlNode* list_of(MapReader& top, const char* key, Need need, MachineDraft& draft) {
    constexpr std::size_t kItemsMax = kBodiesMax * kBodiesMax / 2;
    const YamlNode* section = top.find(key, need, "a list");
    if (section != nullptr &&
        (section->kind != YamlNode::Kind::sequence || section->entries.size() > kItemsMax)) {
        draft.names_are_sound = false;
        top.report(key, shown(*section), "a list of at most " + std::to_string(kItemsMax));
        return nullptr;
    }
    draft.names_are_sound &= section != nullptr || !top.has(key);
    return section;
}

}  // namespace

void read_clearance_levels(MapReader& reader, ClearanceLevelDistances& clearance_levels) {
    bool is_stated =
        reader.number("slow_mm", Need::optional, {0, kMarginMmMax}, clearance_levels.slow_mm);
    is_stated |=
        reader.number("warn_mm", Need::optional, {0, kMarginMmMax}, clearance_levels.warn_mm);
    if (is_stated && clearance_levels.slow_mm > clearance_levels.warn_mm) {
        const bool is_slow = reader.has("slow_mm");
        reader.report(is_slow ? "slow_mm" : "warn_mm",
                      shown(is_slow ? clearance_levels.slow_mm : clearance_levels.warn_mm),
                      is_slow ? "at most warn_mm, which is " + shown(clearance_levels.warn_mm)
                              : "at least slow_mm, which is " + shown(clearance_levels.slow_mm));
    }
}

void read_pairs(MapReader& top, MachineDraft& draft) {
    PairTable table{draft};
    if (const YamlNode* pairs = list_of(top, "pairs", Need::required, draft)) {
        for (std::size_t i = 0; i < pairs->entries.size(); ++i) {
            read_pair(pairs->entries[i], "pairs[" + std::to_string(i) + ']', draft, table);
        }
        if (pairs->entries.empty()) {
            top.report("pairs", "an empty list", "at least one pair");
        }
    }
    if (const YamlNode* exclusions = list_of(top, "exclusions", Need::optional, draft)) {
        for (std::size_t i = 0; i < exclusions->entries.size(); ++i) {
            read_exclusion(exclusions->entries[i], "exclusions[" + std::to_string(i) + ']', draft,
                           table);
        }
    }
    if (draft.machine.pairs.size() > kPairsMax) {
        top.report("pairs", std::to_string(draft.machine.pairs.size()) + " pairs",
                   "at most " + std::to_string(kPairsMax));
    }
    if (draft.names_are_sound && draft.surfaces_are_sound && top.has("pairs")) {
        table.report_missing(top.line_of("pairs"));
    }
}

}  // namespace axg
