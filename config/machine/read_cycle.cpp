// SPDX-License-Identifier: Apache-2.0
#include <cstdint>

#include "config/machine/read_sections.hpp"
#include "config/text/map_reader.hpp"

namespace axg {

namespace {

void read_lists(MapReader reader, WorkLists& out) {
    reader.whole("node_pairs", Need::optional, {8, 1U << 20U}, out.node_pairs);
    reader.whole("leaf_pairs", Need::optional, {8, 1U << 20U}, out.leaf_pairs);
    reader.whole("box_rows", Need::optional, {32, 1U << 24U}, out.box_rows);
    reader.whole("triangle_pairs", Need::optional, {32, 1U << 24U}, out.triangle_pairs);
    reader.whole("rechecks", Need::optional, {0, 1U << 20U}, out.rechecks);
}

}  // namespace

void read_cycle(MapReader& top, MachineDraft& draft) {
    constexpr const char* kWanted = "auto, or a map, such as {stages: 3}";
    const YamlNode* section = top.find("cycle", Need::optional, kWanted);
    if (section == nullptr) {
        return;
    }
    if (section->kind == YamlNode::Kind::scalar) {
        if (section->text != "auto") {
            top.report("cycle", shown(*section), kWanted);
        }
        return;
    }
    MapReader reader{*section, "cycle", {"stages", "queries", "lists"}, draft.faults};
    CycleRules& out = draft.machine.cycle;
    out.is_pinned = true;
    reader.whole("stages", Need::optional, {2, 3}, out.stages);
    reader.whole("queries", Need::optional, {2, 65'536}, out.queries);
    if (const YamlNode* lists = reader.find("lists", Need::optional, "a map of list lengths")) {
        read_lists({*lists,
                    "cycle.lists",
                    {"node_pairs", "leaf_pairs", "box_rows", "triangle_pairs", "rechecks"},
                    draft.faults},
                   out.lists);
    }
}

}  // namespace axg
