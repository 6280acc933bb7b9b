// SPDX-License-Identifier: Apache-2.0
// The section `axes` of a machine file. Degrees become radians here and in machine_keys.cpp.
#include <algorithm>
#include <array>
#include <numeric>
#include <utility>
#include <vector>

#include "config/machine/machine_keys.hpp"
#include "config/machine/read_sections.hpp"
#include "config/text/fault_list.hpp"
#include "config/text/map_reader.hpp"
#include "config/text/number_text.hpp"
#include "config/text/quote_text.hpp"
#include "core/base/finite.hpp"
#include "core/base/sincos.hpp"

namespace axg {
namespace {

constexpr Range kTravelMm{-kCoordinateMmMax, kCoordinateMmMax};
constexpr Range kTravelDeg{-360'000, 360'000};  // a thousand turns; beyond, an axis is unlimited
// Defaults: an encoder's error from one sample to the next, and a board that reports measured
// positions.
constexpr double kPositionErrorMm = 0.001, kPositionErrorDeg = 0.0005;

/// The letter that a program and a trace call the axis by; lower case would be another axis to some
/// readers.
bool is_axis_name(std::string_view name) noexcept {
    if (name.empty() || name.size() > 8 || name[0] < 'A' || name[0] > 'Z') {
        return false;
    }
    for (const char c : name) {
        if (!((c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'))) {
            return false;
        }
    }
    return true;
}

void read_travel(MapReader& reader, Axis& axis) {
    const bool rotary = axis.kind == AxisKind::rotary;
    const char* key = rotary ? "travel_deg" : "travel_mm";
    const char* wanted =
        rotary ? "two angles, low then high, or unlimited" : "two positions, low then high";
    const YamlNode* value = reader.find(key, Need::required, wanted);
    if (value == nullptr) {
        return;
    }
    if (rotary && value->kind == YamlNode::Kind::scalar && value->text == "unlimited") {
        axis.unlimited = true;
        return;
    }
    std::array<double, 2> travel{};
    if (!reader.numbers(key, Need::required, rotary ? kTravelDeg : kTravelMm, travel)) {
        return;
    }
    if (!(travel[0] < travel[1])) {
        reader.report(key, '[' + shown(travel[0]) + ", " + shown(travel[1]) + ']',
                      std::string{wanted} + "; swap the two");
        return;
    }
    axis.min = rotary ? travel[0] * kPi / 180.0 : travel[0];
    axis.max = rotary ? travel[1] * kPi / 180.0 : travel[1];
}

/// The number of a key as the file has it; 0: none that can be read.
double in_file(const MapReader& reader, std::string_view key) {
    for (const YamlEntry& entry : reader.node().entries) {
        if (entry.key == key) {
            return decimal_number(entry.value.text).value_or(0);
        }
    }
    return 0;
}

/// The hardest stop: no softer than the guaranteed one, nor than free motion may brake.
void check_stopping_most(MapReader& reader, const Axis& axis) {
    if (!is_finite(axis.stopping_most)) {
        return;
    }
    const std::string unit = axis.kind == AxisKind::rotary ? "_deg_s2" : "_mm_s2";
    const double least =
        std::max(in_file(reader, "stopping" + unit), in_file(reader, "acceleration" + unit));
    const std::string key = "stopping_most" + unit;
    const double most = in_file(reader, key);
    if (most < least) {
        reader.report(key, shown(most),
                      "at least " + shown(least) + ", the larger of stopping and acceleration");
    }
}

/// The place of an axis on the bus, where the file states it.
struct Slot {
    bool is_stated = false;
    std::uint32_t place = kNoIndex;  // kNoIndex: not stated, or not readable
};

Slot read_slot(MapReader& reader) {
    Slot slot{.is_stated = reader.has("slot")};
    reader.whole("slot", Need::optional, {0, kAxesMax - 1}, slot.place);
    return slot;
}

/// YAML gives the keys of a map no order, and a tool that writes the file again may change it.
/// Stated places are the order on the bus, whatever the order of the keys.
void put_in_order(const std::vector<Slot>& slots, MachineDraft& draft) {
    std::vector<Axis>& axes = draft.machine.axes;
    const bool any =
        std::any_of(slots.begin(), slots.end(), [](const Slot& slot) { return slot.is_stated; });
    if (!any) {
        return;
    }
    std::vector<Axis> ordered(axes.size());
    std::vector<int> lines(axes.size(), 0);  // 0: nobody has this place yet
    bool is_sound = true;
    for (std::size_t i = 0; i < axes.size(); ++i) {
        const std::uint32_t place = slots[i].place;
        const std::string path = "axes." + escaped(axes[i].name, kNameLengthMax) + ".slot";
        const int line = draft.axis_lines[i];
        const std::string wanted = "each of 0 to " + std::to_string(axes.size() - 1) +
                                   " once, one for each axis, or no slot at all";
        if (!slots[i].is_stated) {
            draft.faults.add(line, path, "no slot, and other axes with one", wanted);
        } else if (place != kNoIndex && place >= axes.size()) {
            draft.faults.add(line, path, std::to_string(place), wanted);
        } else if (place != kNoIndex && lines[place] != 0) {
            draft.faults.add(line, path,
                             std::to_string(place) + ", the slot of axis " + ordered[place].name,
                             wanted);
        } else if (place != kNoIndex) {
            ordered[place] = axes[i];
            lines[place] = line;
            continue;
        }
        is_sound = false;
    }
    if (is_sound) {
        axes = std::move(ordered);
        draft.axis_lines = std::move(lines);
    }
}

void read_axis(const YamlNode& node, const std::string& path, FaultList& faults, Axis& axis,
               Slot& slot) {
    const bool is_rotary = axis.kind == AxisKind::rotary;
    const ScalarKeys<Axis> table = axis_keys(axis.kind);
    MapReader reader{node, path,
                     keys_of(table, {}, {"kind", "slot", is_rotary ? "travel_deg" : "travel_mm"}),
                     faults};
    slot = read_slot(reader);
    read_travel(reader, axis);
    axis.position_error = is_rotary ? kPositionErrorDeg * kPi / 180.0 : kPositionErrorMm;
    read_scalars(reader, table, axis, axis);
    check_stopping_most(reader, axis);
}

/// Reports a missing or invalid kind of an axis; keys of both kinds are allowed.
void report_kind(const YamlNode& node, const std::string& path, FaultList& faults) {
    constexpr std::array<std::string_view, 2> kKinds{"linear", "rotary"};
    std::vector<std::string_view> keys =
        keys_of(axis_keys(AxisKind::linear), {"travel_deg"}, {"kind", "slot", "travel_mm"});
    const std::vector<std::string_view> rotary = keys_of(axis_keys(AxisKind::rotary));
    keys.insert(keys.end(), rotary.begin(), rotary.end());
    MapReader reader{node, path, keys, faults};
    std::size_t kind = 0;
    reader.choice("kind", Need::required, kKinds, kind);
}

/// The keys of an axis depend on its kind, so the kind is looked for before they are judged.
AxisKind kind_of(const YamlNode& node, bool& known) {
    known = false;
    for (const YamlEntry& entry : node.entries) {
        if (entry.key == "kind" && entry.value.kind == YamlNode::Kind::scalar) {
            known = entry.value.text == "linear" || entry.value.text == "rotary";
            return entry.value.text == "rotary" ? AxisKind::rotary : AxisKind::linear;
        }
    }
    return AxisKind::linear;
}

}  // namespace

void read_axes(MapReader& top, MachineDraft& draft) {
    const YamlNode* section = top.find("axes", Need::required, "a map of 1 to 16 axes");
    if (section == nullptr) {
        return;
    }
    if (section->kind != YamlNode::Kind::map || section->entries.empty() ||
        section->entries.size() > kAxesMax) {
        top.report("axes",
                   section->kind == YamlNode::Kind::map
                       ? std::to_string(section->entries.size()) + " axes"
                       : shown(*section),
                   "a map of 1 to 16 axes, such as X: {kind: linear, ...}");
        return;
    }
    std::vector<Slot> slots;
    for (const YamlEntry& entry : section->entries) {
        const std::string path = "axes." + escaped(entry.key, kNameLengthMax);
        if (!is_axis_name(entry.key)) {
            draft.faults.add(
                entry.line, path, "the axis name " + quoted(entry.key),
                "a capital letter A-Z, then capitals or digits (at most 8 characters)");
        }
        Axis axis;
        axis.name = entry.key;
        bool known = false;
        axis.kind = kind_of(entry.value, known);
        if (!known) {
            report_kind(entry.value, path, draft.faults);
            slots.emplace_back();
        } else {
            read_axis(entry.value, path, draft.faults, axis, slots.emplace_back());
        }
        draft.machine.axes.push_back(std::move(axis));
        draft.axis_lines.push_back(entry.line);
    }
    const double skew_mm =
        std::accumulate(draft.machine.axes.begin(), draft.machine.axes.end(), 0.0,
                        [](double sum, const Axis& axis) { return sum + axis.skew_mm; });
    draft.machine.pose_errors.are_stated |= skew_mm > 0;
    if (skew_mm > kSkewMmMax * (1 + 1e-9)) {
        top.report("axes", "skew_mm of " + shown(skew_mm) + " in sum",
                   "at most " + shown(kSkewMmMax) + " for all axes together");
    }
    put_in_order(slots, draft);
}

}  // namespace axg
