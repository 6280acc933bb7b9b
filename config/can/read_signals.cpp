// SPDX-License-Identifier: Apache-2.0
#include "config/can/read_signals.hpp"

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>
#include <map>
#include <vector>

#include "config/can/signal_rules.hpp"
#include "config/text/fault_list.hpp"
#include "config/text/machine_draft.hpp"
#include "config/text/map_reader.hpp"
#include "config/text/nearest_word.hpp"
#include "config/text/quote_text.hpp"
#include "core/machine/can_id.hpp"

namespace axg {
namespace {

void read_unit(MapReader& reader, const Axis& axis, CanSignal& signal) {
    std::size_t unit = 0;
    if (!reader.choice("unit", Need::required, kSignalUnitNames, unit)) {
        return;
    }
    if (signal_unit(unit).kind != axis.kind) {
        const bool rotary = axis.kind == AxisKind::rotary;
        reader.report(
            "unit",
            quoted(kSignalUnitNames[unit]) + " for a " + (rotary ? "rotary" : "linear") + " axis",
            units_of(axis.kind));
        return;
    }
    signal.factor *= signal_unit(unit).factor;
    signal.offset *= signal_unit(unit).factor;
}

/// A position beyond the range of the bits would arrive as another position.
void check_reach(MapReader& reader, const Axis& axis, const CanSignal& signal) {
    const SignalReach reach = reach_of(signal, axis);
    if (!reach.fits) {
        reader.report("length", reach.got, reach.wanted);
    }
}

/// An identifier has 29 bits only with `extended: true`: its number does not show its kind.
bool read_id(MapReader& reader, CanSignal& signal) {
    bool is_extended = false;
    if (reader.has("extended") && !reader.boolean("extended", Need::optional, is_extended)) {
        return false;
    }
    std::uint32_t number = 0;
    if (!reader.can_id("id", Need::required, {0x001, kExtendedIdMax}, number)) {
        return false;
    }
    signal.id = wire_id(number, is_extended);
    if (!is_wire_id(signal.id)) {
        reader.report("id", shown(*reader.find("id", Need::required, "an integer")),
                      "an integer from 0x001 to 0x7FF, or extended: true for 29 bits");
        return false;
    }
    return true;
}

bool read_layout(MapReader& reader, CanSignal& signal) {
    constexpr std::array<std::string_view, 2> kOrders{"little", "big"};
    std::uint32_t start = 0;
    std::uint32_t length = 0;
    std::size_t order = 0;
    bool sound = read_id(reader, signal);
    sound &= reader.whole("start", Need::required, {0, kFrameBitsMax - 1}, start);
    sound &= reader.whole("length", Need::required, {1, kExactBitsMax}, length);
    sound &= reader.choice("order", Need::required, kOrders, order);
    sound &= reader.boolean("signed", Need::required, signal.is_signed);
    sound &= reader.number("factor", Need::required, {-1e9, 1e9}, signal.factor);
    reader.number("offset", Need::optional, {-1e9, 1e9}, signal.offset);
    if (std::fabs(signal.factor) < 1e-12) {
        reader.report("factor", shown(signal.factor), "a factor of at least 1e-12 in size, not 0");
        sound = false;
    }
    signal.start_bit = static_cast<std::uint16_t>(start);
    signal.length_bits = static_cast<std::uint8_t>(length);
    signal.order = static_cast<ByteOrder>(order);
    return sound;
}

struct Taken {
    FrameBits bits;
    std::string axis;
};

void read_signal(const YamlEntry& entry, std::uint32_t axis_index, MachineDraft& draft,
                 std::map<std::uint32_t, std::vector<Taken>>& taken) {
    const Axis& axis = draft.machine.axes[axis_index];
    const std::string path = "can.signals." + entry.key;
    MapReader reader{
        entry.value,
        path,
        {"id", "extended", "start", "length", "order", "signed", "factor", "offset", "unit"},
        draft.faults};
    CanSignal signal;
    signal.axis = axis_index;
    const std::size_t faults_before = draft.faults.count();
    const bool sound = read_layout(reader, signal);
    read_unit(reader, axis, signal);
    const std::uint32_t frame_bytes = draft.machine.can.signal_frame_bytes;
    FrameBits bits;
    if (sound && !covered_bits(signal, frame_bytes * 8, bits)) {
        reader.report("start",
                      "bits that leave the frame of " + std::to_string(frame_bytes) + " bytes",
                      "start and length inside can.signal_frame_bytes");
    } else if (sound) {
        for (const Taken& other : taken[signal.id]) {
            if ((other.bits & bits).any()) {
                reader.report("start", "bits that axis " + other.axis + " uses in the same frame",
                              "bits of its own for each axis");
            }
        }
        taken[signal.id].push_back({bits, entry.key});
    }
    if (draft.faults.count() == faults_before) {
        check_reach(reader, axis, signal);
    }
    draft.machine.can.signals.push_back(signal);
}

void read_frame_bytes(MapReader& can, CanLayout& layout) {
    constexpr std::array<std::uint32_t, 15> kLengths{1,  2,  3,  4,  5,  6,  7, 8,
                                                     12, 16, 20, 24, 32, 48, 64};
    std::uint32_t bytes = layout.signal_frame_bytes;
    can.whole("signal_frame_bytes", Need::optional, {1, 64}, bytes);
    if (std::find(kLengths.begin(), kLengths.end(), bytes) == kLengths.end()) {
        can.report("signal_frame_bytes", std::to_string(bytes),
                   "a CAN payload length: 1 to 8, 12, 16, 20, 24, 32, 48 or 64");
        return;
    }
    layout.signal_frame_bytes = static_cast<std::uint8_t>(bytes);
}

}  // namespace

void read_signals(MapReader& can, MachineDraft& draft) {
    if (draft.can_source != "signals") {
        for (const char* key : {"signals", "signal_frame_bytes"}) {
            if (can.has(key)) {
                can.report(key, std::string{key} + " without format: signals",
                           "format: signals, or no such key");
            }
        }
        return;
    }
    read_frame_bytes(can, draft.machine.can);
    const YamlNode* section =
        can.find("signals", Need::required, "a map with a signal for each axis");
    if (section == nullptr) {
        return;
    }
    if (section->kind != YamlNode::Kind::map) {
        can.report("signals", shown(*section), "a map with a signal for each axis");
        return;
    }
    std::map<std::uint32_t, std::vector<Taken>> taken;
    std::vector<bool> found(draft.machine.axes.size(), false);
    for (const YamlEntry& entry : section->entries) {
        const std::uint32_t axis = index_of(draft.machine.axes, entry.key);
        if (axis == kNoIndex) {
            draft.faults.add(entry.line, "can.signals." + escaped(entry.key, kNameLengthMax),
                             quoted(entry.key),
                             wanted_name("an axis", entry.key, names_of(draft.machine.axes)));
            continue;
        }
        found[axis] = true;
        read_signal(entry, axis, draft, taken);
    }
    for (std::size_t i = 0; i < found.size(); ++i) {
        if (!found[i]) {
            can.report("signals", "no signal for axis " + escaped(draft.machine.axes[i].name, 64),
                       "exactly one signal for each axis");
        }
    }
    std::sort(draft.machine.can.signals.begin(), draft.machine.can.signals.end(),
              [](const CanSignal& a, const CanSignal& b) { return a.axis < b.axis; });
}

void check_signal_ids(MapReader& can, const CanLayout& layout, std::span<const NamedId> others) {
    for (const CanSignal& signal : layout.signals) {
        for (const NamedId& other : others) {
            if (signal.id == other.id) {
                can.report("signals", "an id that is also the one of " + other.name,
                           "an id of its own for the frames of signals");
            }
        }
    }
}

}  // namespace axg
