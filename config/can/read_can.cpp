// SPDX-License-Identifier: Apache-2.0
// The section `can` of a machine file: identifiers, receiver rules, and which frame carries which
// axis.
#include "config/can/read_can.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

#include "config/can/read_signals.hpp"
#include "config/text/fault_list.hpp"
#include "config/text/machine_draft.hpp"
#include "config/text/map_reader.hpp"
#include "config/text/quote_text.hpp"
#include "core/base/sincos.hpp"
#include "core/machine/frame_ids.hpp"
#include "core/reach/look_ahead_path.hpp"

namespace axg {
namespace {

constexpr WholeRange kCanId{0x001, 0x7FF};
constexpr std::uint32_t kAgePeriodsMax = 10;  // of positions at their latch
constexpr std::uint32_t kHashesIn = 0x582, kHashesOut = 0x602;

/// Largest position in a frame of our formats.
struct FrameReach {
    double mm, deg;
};
constexpr double kCountsPerDegree = 1.0e4;  // of own frames

std::string hex(std::uint32_t id) {
    std::array<char, 16> buffer{};
    std::snprintf(buffer.data(), buffer.size(), "0x%03X", static_cast<unsigned>(id));
    return buffer.data();
}

/// A DBC file only locates the signals: the receiver reads them like those of format: signals.
struct CanSource {
    std::string_view name;
    CanFormat format;
};
constexpr auto kSources = [] {
    std::array<CanSource, kWireFormats.size() + 1> out{};
    std::size_t count = 0;
    for (const WireFormat& wire : kWireFormats) {
        out[count++] = {wire.name, wire.format};
        if (wire.format == CanFormat::signals) {
            out[count++] = {"dbc", wire.format};
        }
    }
    return out;
}();

std::string source_of(const MachineDraft& draft) {
    return std::string{draft.can_source};
}

/// A list of exactly `count` numbers in hexadecimal or decimal; what is read replaces `out`.
template <class Number>
void read_ids(MapReader& reader, const char* key, WholeRange range, std::size_t count,
              FaultList& faults, std::vector<Number>& out) {
    const std::string wanted =
        "a list of " + std::to_string(count) +
        ", one for each frame of axis positions, such as [0x181, 0x281, 0x381]";
    const YamlNode* list = reader.find(key, Need::optional, wanted);
    if (list == nullptr) {
        return;
    }
    if (list->kind != YamlNode::Kind::sequence || list->entries.size() != count) {
        reader.report(key, shown(*list), wanted);
        return;
    }
    std::vector<Number> ids;
    for (std::size_t i = 0; i < count; ++i) {
        const std::string path = reader.path_of(key) + '[' + std::to_string(i) + ']';
        std::uint32_t id = 0;
        if (read_whole({list->entries[i].value, path, faults}, range, true, id)) {
            ids.push_back(static_cast<Number>(id));
        }
    }
    if (ids.size() == count) {
        out = std::move(ids);
    }
}

/// One identifier for each drive to be stopped [default: none].
void read_quick_stops(MapReader& reader, FaultList& faults, std::vector<std::uint32_t>& out) {
    constexpr std::string_view kWanted =
        "a list of 1 to 16 identifiers, such as [0x303, 0x304]: a receive PDO of each drive";
    const YamlNode* list = reader.find("quick_stop", Need::optional, std::string{kWanted});
    if (list == nullptr) {
        return;
    }
    if (list->kind != YamlNode::Kind::sequence || list->entries.empty() ||
        list->entries.size() > kAxesMax) {
        reader.report("quick_stop", shown(*list), std::string{kWanted});
        return;
    }
    read_ids(reader, "quick_stop", kCanId, list->entries.size(), faults, out);
}

/// Default: the transmit objects of node 1, one for each frame.
void default_axis_ids(MapReader& reader, std::size_t count, std::size_t axis_count,
                      CanLayout& can) {
    constexpr std::array<std::uint32_t, 4> kObjects{0x181, 0x281, 0x381, 0x481};
    can.axis_ids.assign(kObjects.begin(), kObjects.begin() + std::min(count, kObjects.size()));
    if (count > kObjects.size()) {
        reader.report("ids", "no axis ids",
                      "can.format: fd, whose frame has room for 13 axes, or " +
                          std::to_string(count) + " identifiers under can.ids.axes; " +
                          std::to_string(axis_count) + " axes need that many frames");
    }
}

/// Two senders under one identifier destroy each other's frames, and one meaning would pass for the
/// other.
void check_distinct(MapReader& reader, const std::vector<NamedId>& ids) {
    for (std::size_t i = 0; i < ids.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            if (ids[i].id == ids[j].id) {
                reader.report("ids",
                              hex(ids[i].id) + " for both " + ids[j].name + " and " + ids[i].name,
                              "a different id for each (the permit uses its own and the next one)");
            }
        }
    }
}

void read_single_ids(const YamlNode& node, std::size_t frames, MachineDraft& draft) {
    CanLayout& can = draft.machine.can;
    FaultList& faults = draft.faults;
    const bool has_hashes = can.hashes_in_id != 0;
    std::vector<std::string_view> keys;
    for (const FrameId& row : kFrameIds) {
        keys.emplace_back(row.key);
    }
    keys.insert(keys.begin() + 1, "axes");
    MapReader reader{node, "can.ids", keys, faults};
    for (const FrameId& row : kFrameIds) {
        const bool has_twin = row.id == &CanLayout::permit_id;
        reader.can_id(row.key, Need::optional, {kCanId.min, kCanId.max - (has_twin ? 1U : 0U)},
                      can.*row.id);
    }
    for (const char* const key : {"hashes_in", "hashes_out"}) {
        if (!has_hashes && reader.has(key)) {
            reader.report(key, "an id of hashes with hashes: none", "hashes: required, or no id");
        }
    }
    if (!is_native(can) && reader.has("axes")) {
        reader.report("axes", "ids of axis frames with format: " + source_of(draft),
                      "no such key; each signal has its own id");
    } else {
        read_ids(reader, "axes", kCanId, frames, faults, can.axis_ids);
    }
}

void read_frame_ids(MapReader& reader, MachineDraft& draft) {
    CanLayout& can = draft.machine.can;
    const std::size_t frames = own_axis_frames(wire_of(can), draft.machine.axes.size());
    const YamlNode* ids = reader.find("ids", Need::optional, "a map of identifiers");
    bool axes_written = false;
    if (ids != nullptr) {
        for (const YamlEntry& entry : ids->entries) {
            axes_written |= entry.key == "axes";
        }
    }
    can.axis_ids.clear();
    if (!axes_written) {
        default_axis_ids(reader, frames, draft.machine.axes.size(), can);
    }
    if (ids != nullptr) {
        read_single_ids(*ids, frames, draft);
    }
    // Default: the Data ID of a frame equals its identifier. So Data IDs are distinct, and the
    // checksum covers the identifier.
    can.data_ids.assign(can.axis_ids.begin(), can.axis_ids.end());
    if (!is_native(can) && reader.has("data_ids")) {
        reader.report("data_ids", "data ids with format: " + source_of(draft),
                      "no such key; only axguard's own frame formats carry data ids");
    } else {
        read_ids(reader, "data_ids", {0, 0xFFFF}, frames, draft.faults, can.data_ids);
    }
    read_quick_stops(reader, draft.faults, can.quick_stop_ids);
    std::vector<NamedId> all;
    for (const FrameId& row : kFrameIds) {
        if (is_stated(can, row.use)) {
            all.push_back({can.*row.id, row.key});
        }
        if (row.id == &CanLayout::permit_id) {
            all.push_back({can.permit_id + 1, "the permit's twin"});
        }
    }
    if (can.look_ahead_samples != 0) {
        all.push_back({can.look_ahead_id, "ahead"});
    }
    for (std::size_t i = 0; i < can.axis_ids.size(); ++i) {
        all.push_back({can.axis_ids[i], "axes[" + std::to_string(i) + ']'});
    }
    for (std::size_t i = 0; i < can.quick_stop_ids.size(); ++i) {
        all.push_back({can.quick_stop_ids[i], "quick_stop[" + std::to_string(i) + ']'});
    }
    check_distinct(reader, all);
    check_signal_ids(reader, can, all);
}

/// The frame of the look-ahead path: without the section there is none.
void read_look_ahead(MapReader& can_reader, MachineDraft& draft) {
    const YamlNode* section = can_reader.find(
        "ahead", Need::optional, "a map, such as {id: 0x481, data_id: 0x0481, samples: 300}");
    if (section == nullptr) {
        return;
    }
    CanLayout& can = draft.machine.can;
    MapReader reader{*section, "can.ahead", {"id", "data_id", "samples"}, draft.faults};
    reader.can_id("id", Need::optional, kCanId, can.look_ahead_id);
    can.look_ahead_data_id = static_cast<std::uint16_t>(can.look_ahead_id);
    std::uint32_t data_id = 0;
    if (reader.can_id("data_id", Need::optional, {0, 0xFFFF}, data_id)) {
        can.look_ahead_data_id = static_cast<std::uint16_t>(data_id);
    }
    reader.whole("samples", Need::required, {kLookAheadSamplesMin, kLookAheadSamplesMax},
                 can.look_ahead_samples);
    if (!wire_of(can).has_look_ahead) {
        can_reader.report("ahead", "can.ahead with a format other than fd",
                          "format: fd, or no such key; the frame has 48 bytes for five axes");
    } else if (draft.machine.axes.size() > kLookAheadAxesMax) {
        can_reader.report("ahead", std::to_string(draft.machine.axes.size()) + " axes",
                          "at most " + std::to_string(kLookAheadAxesMax) +
                              ", or no such key; a frame has 64 bytes");
    }
}

template <class Small>
void read_small(MapReader& reader, const char* key, WholeRange range, Small& out) {
    std::uint32_t value = out;
    if (reader.whole(key, Need::optional, range, value)) {
        out = static_cast<Small>(value);
    }
}

/// Up to a quarter of a period every sample that follows up to 20 lost ones is still numbered
/// exactly (arrival_anchor.hpp); above it one could be counted a period short.
void read_arrival_jitter(MapReader& reader, CanLayout& can) {
    constexpr std::uint32_t kJitterShare = 4;
    const std::uint32_t most_us = can.sample_us / kJitterShare;
    if (reader.whole("arrival_jitter_us", Need::optional, {1, most_us}, can.arrival_jitter_us) &&
        has_sync(wire_of(can))) {
        reader.report("arrival_jitter_us", "arrival_jitter_us with frames that follow SYNC",
                      "format: signals or dbc, or no such key");
    }
}

void read_period(MapReader& reader, MachineDraft& draft) {
    CanLayout& can = draft.machine.can;
    draft.machine.states.sample_us =
        reader.whole("sample_us", Need::optional, {50, 100'000}, can.sample_us);
    read_arrival_jitter(reader, can);
}

/// One number, or the least and the most. False: `ends` does not hold what the key has.
bool read_ends(MapReader& reader, const char* key, WholeRange range, FaultList& faults,
               std::array<std::uint32_t, 2>& ends) {
    const std::string wanted = "an integer from " + std::to_string(range.min) + " to " +
                               std::to_string(range.max) + ", or two of them: [least, most]";
    const YamlNode* node = reader.find(key, Need::optional, wanted);
    if (node == nullptr) {
        return false;
    }
    const bool is_list = node->kind == YamlNode::Kind::sequence;
    if (is_list && node->entries.size() != 2) {
        reader.report(key, "a list of " + std::to_string(node->entries.size()), wanted);
        return false;
    }
    const std::string path = reader.path_of(key);
    for (std::size_t i = 0; i < ends.size(); ++i) {
        const YamlNode& one = is_list ? node->entries[i].value : *node;
        if (!read_whole({one, path, faults}, range, false, ends[i])) {
            return false;
        }
    }
    if (ends[0] > ends[1]) {
        reader.report(key, shown(*node), "[least, most], the least first");
        return false;
    }
    return true;
}

void read_permit_samples(MapReader& reader, MachineDraft& draft) {
    CanLayout& can = draft.machine.can;
    // With one sample no permit is ever a period ahead of its end.
    const WholeRange range{2, wire_of(can).permit_samples_most};
    can.permit_samples = !has_sample_counter(can)      ? PermitSamples{}
                         : can.look_ahead_samples != 0 ? kPermitSamplesLonger
                                                       : kPermitSamplesUsual;
    draft.states_permit_samples = reader.has("permit_samples");
    std::array<std::uint32_t, 2> ends{};
    if (!read_ends(reader, "permit_samples", range, draft.faults, ends)) {
        return;
    }
    if (ends[0] != ends[1] && !has_sample_counter(can)) {
        reader.report("permit_samples",
                      "[" + std::to_string(ends[0]) + ", " + std::to_string(ends[1]) +
                          "] with samples that have no SYNC counter from 1 to 240",
                      "one integer; the guard sends no permits for these samples");
    } else {
        can.permit_samples = {static_cast<std::uint8_t>(ends[0]),
                              static_cast<std::uint8_t>(ends[1])};
    }
}

void read_latched_age(MapReader& reader, MachineDraft& draft) {
    CanLayout& can = draft.machine.can;
    can.latched_age = {0, wire_of(can).latched_age_samples * can.sample_us};
    std::array<std::uint32_t, 2> ends{};
    draft.machine.states.latched_age_us = read_ends(
        reader, "latched_age_us", {0, kAgePeriodsMax * can.sample_us}, draft.faults, ends);
    if (draft.machine.states.latched_age_us) {
        can.latched_age = {ends[0], ends[1]};
    }
}

void read_receiver_rules(MapReader& reader, CanLayout& can) {
    // A snapshot is of no use when the longest permit for it has run out.
    const std::uint8_t least = wire_of(can).stale_samples_least;
    can.stale_after_us = std::max(least, can.permit_samples.most) * can.sample_us;
    if (reader.whole("stale_after_us", Need::optional, {50, 1'000'000}, can.stale_after_us) &&
        can.stale_after_us < can.sample_us) {
        reader.report("stale_after_us", std::to_string(can.stale_after_us),
                      "at least sample_us, " + std::to_string(can.sample_us) +
                          "; otherwise every snapshot is stale before the next one arrives");
    }
    // A board with a period longer than its heartbeat's sends both at once.
    can.heartbeat_timeout_us = std::max(can.heartbeat_timeout_us, 3 * can.sample_us);
    if (reader.whole("heartbeat_timeout_us", Need::optional, {1000, 10'000'000},
                     can.heartbeat_timeout_us) &&
        can.heartbeat_timeout_us < can.sample_us) {
        reader.report("heartbeat_timeout_us", std::to_string(can.heartbeat_timeout_us),
                      "at least sample_us, " + std::to_string(can.sample_us) +
                          "; a board may send its heartbeat with its samples");
    }
    read_small(reader, "frozen_samples", {2, 100'000}, can.frozen_samples);
    read_small(reader, "counter_delta_max", {1, 13}, can.counter_delta_max);
}

/// A snapshot has a bit for each of its frames.
void check_signal_frames(MapReader& reader, const CanLayout& can) {
    if (const std::size_t frames = signal_frames(can.signals); frames > kAxisFramesMax) {
        reader.report("format", std::to_string(frames) + " frames with positions and states",
                      "at most " + std::to_string(kAxisFramesMax) +
                          "; map the objects of a drive in fewer PDOs");
    }
}

/// Version 2 names the lap of its sample; there is no other.
void check_permit_version(MapReader& reader, const CanLayout& can) {
    constexpr std::uint32_t kVersion = 2, kMost = 255;
    std::uint32_t version = kVersion;
    if (!reader.whole("permit", Need::optional, {0, kMost}, version)) {
        return;
    }
    if (version != kVersion) {
        reader.report(
            "permit", std::to_string(version),
            "2, or no such key; a permit of version 1 has no session, so that a board may "
            "accept an old one, from before a reset or delayed for a lap of SYNC");
    } else if (!has_sample_counter(can)) {
        reader.report("permit", "2 with samples that have no SYNC counter from 1 to 240",
                      "no such key, or format: classical or fd, or cia402 with sync_counter: 240");
    }
}

/// A board whose SYNC counts to 240 has to send hashes by default.
void read_hashes(MapReader& reader, CanLayout& can) {
    constexpr std::array<std::string_view, 2> kHashes{"none", "required"};
    std::size_t choice = has_sample_counter(can) ? 1 : 0;
    reader.choice("hashes", Need::optional, kHashes, choice);
    if (choice == 1) {
        can.hashes_in_id = kHashesIn;
        can.hashes_out_id = kHashesOut;
    }
}

/// A position beyond the range of a frame would arrive as another position.
void check_reach(MapReader& top, MachineDraft& draft) {
    const Machine& machine = draft.machine;
    const WireFormat& wire = wire_of(machine.can);
    const double most = wire.position_most;
    const FrameReach reach{most / wire.counts_per_mm, most / kCountsPerDegree};
    const bool has_wider = wire.position_most < INT32_MAX;
    if (machine.axes.size() > wire.axes_max) {
        top.report("can", std::to_string(machine.axes.size()) + " axes in one FD frame",
                   "at most " + std::to_string(wire.axes_max) + ", or format: classical");
    }
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const Axis& axis = machine.axes[i];
        const bool rotary = axis.kind == AxisKind::rotary;
        const double limit = rotary ? reach.deg * kPi / 180.0 : reach.mm;
        if (axis.unlimited || (axis.min >= -limit && axis.max <= limit)) {
            continue;
        }
        draft.faults.add(
            draft.axis_lines[i],
            "axes." + escaped(axis.name, kNameLengthMax) + ".travel_" + (rotary ? "deg" : "mm"),
            "travel beyond the range of the CAN frames",
            "at most " + shown(rotary ? reach.deg : reach.mm) + (rotary ? " degrees" : " mm") +
                " either way, or can: {format: " + (has_wider ? "fd" : "signals") + '}');
    }
    for (std::size_t i = 0; i < machine.tools.size(); ++i) {
        if (machine.tools[i].number > wire.tool_most) {
            draft.faults.add(draft.tool_lines[i],
                             "tools." + std::to_string(machine.tools[i].number) + ".number",
                             std::to_string(machine.tools[i].number) + " with can format classical",
                             "at most 255, or format: fd; the classical frame has one byte for it");
        }
    }
}

void read_source(MapReader& reader, MachineDraft& draft) {
    std::array<std::string_view, kSources.size()> names;
    for (std::size_t i = 0; i < names.size(); ++i) {
        names[i] = kSources[i].name;
    }
    std::size_t source = 0;
    reader.choice("format", Need::optional, names, source);
    draft.can_source = names[source];
    draft.machine.can.format = kSources[source].format;
}

}  // namespace

void read_can(MapReader& top, MachineDraft& draft) {
    static const YamlNode kNoKeys{
        .kind = YamlNode::Kind::map, .line = 1, .is_quoted = false, .text = {}, .entries = {}};
    const YamlNode* section =
        top.find("can", Need::optional, "a map; see docs/reference/machine-file.md");
    MapReader reader{section == nullptr ? kNoKeys : *section,
                     "can",
                     {"format",
                      "sample_us",
                      "ids",
                      "data_ids",
                      "permit",
                      "permit_samples",
                      "latched_age_us",
                      "hashes",
                      "stale_after_us",
                      "frozen_samples",
                      "counter_delta_max",
                      "signals",
                      "signal_frame_bytes",
                      "file",
                      "axes",
                      "status",
                      "counters",
                      "drives",
                      "sync",
                      "sync_counter",
                      "sync_window_us",
                      "arrival_jitter_us",
                      "ahead",
                      "heartbeat_timeout_us",
                      "quick_stop"},
                     draft.faults};
    read_source(reader, draft);
    read_period(reader, draft);
    read_signals(reader, draft);
    read_look_ahead(reader, draft);
    read_dbc(reader, draft);
    read_drives(reader, draft);
    check_signal_frames(reader, draft.machine.can);
    check_permit_version(reader, draft.machine.can);
    read_permit_samples(reader, draft);
    read_latched_age(reader, draft);
    read_receiver_rules(reader, draft.machine.can);
    read_hashes(reader, draft.machine.can);
    read_frame_ids(reader, draft);
    if (is_native(draft.machine.can)) {
        check_reach(top, draft);
    }
}

}  // namespace axg
