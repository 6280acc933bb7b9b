// SPDX-License-Identifier: Apache-2.0
// `format: cia402`: location and scale of each drive's position in its process data.
// Source: CiA 301 (PDOs, SYNC), CiA 402 (objects 0x6041, 0x6064, 0x606C).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <vector>

#include "config/can/eds.hpp"
#include "config/can/read_signals.hpp"
#include "config/can/signal_rules.hpp"
#include "config/text/fault_list.hpp"
#include "config/text/machine_draft.hpp"
#include "config/text/map_reader.hpp"
#include "config/text/nearest_word.hpp"
#include "config/text/quote_text.hpp"
#include "core/machine/can_id.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kPosition = 0x60640020, kVelocity = 0x606C0020, kStatusWord = 0x60410010;
constexpr std::uint32_t kPdoOff = 0x80000000U, kExtendedId = 0x20000000U;
constexpr std::uint32_t kWholeMax = 0x7FFFFFFF;
constexpr std::uint32_t kPdoBitsMax = 64;

std::string hex(std::uint32_t value, int digits) {
    std::array<char, 16> buffer{};
    std::snprintf(buffer.data(), buffer.size(), "0x%0*X", digits, value);
    return buffer.data();
}

/// As object 0x1800 + n, sub 1, has it: bit 29 marks an identifier of 29 bits.
std::uint32_t id_of_cob(std::uint32_t cob_id) noexcept {
    const bool is_extended = (cob_id & kExtendedId) != 0;
    return wire_id(cob_id & (is_extended ? kExtendedIdMax : kStandardIdMax), is_extended);
}

bool read_cob_id(MapReader& reader, std::uint32_t& id) {
    std::uint32_t cob_id = 0;
    if (!reader.can_id("cob_id", Need::required, {0x001, kExtendedId | kExtendedIdMax}, cob_id)) {
        return false;
    }
    if (cob_id == kExtendedId || (cob_id < kExtendedId && cob_id > kStandardIdMax)) {
        reader.report("cob_id", hex(cob_id, 3),
                      "0x001 to 0x7FF, or 0x20000000 plus an identifier of 29 bits");
        return false;
    }
    id = id_of_cob(cob_id);
    return true;
}

std::string id_text(std::uint32_t id) {
    return hex(id_number(id), is_extended_id(id) ? 8 : 3);
}

/// A PDO that counts: sent after every SYNC.
struct Pdo {
    std::uint32_t cob_id = 0;  // bit 31: of 29 bits
    std::vector<std::uint32_t> map;
    std::string place;  // " (drive.dcf:628)", or nothing
};

class DriveReader {
  public:
    DriveReader(const YamlEntry& entry, std::uint32_t axis_index, MachineDraft& draft)
        : reader_(entry.value, "can.drives." + entry.key,
                  {"node", "file", "pdos", "counts", "per_mm", "per_deg", "reversed", "zero_counts",
                   "range_counts", "absolute", "homed_bit", "velocity"},
                  draft.faults),
          draft_(draft),
          axis_(draft.machine.axes[axis_index]),
          axis_index_(axis_index) {}

    void read();

  private:
    bool read_scale(CanSignal& position);
    bool read_homed(std::uint32_t& mask);
    bool read_velocity(CanSignal& velocity);
    bool read_pdos(std::vector<Pdo>& pdos);
    bool read_written(const YamlNode& list, std::vector<Pdo>& pdos);
    bool read_file(std::vector<Pdo>& pdos);
    void place(const std::vector<Pdo>& pdos, std::uint32_t object, std::uint32_t bits,
               CanSignal signal, bool is_required);
    void check_endless(std::uint32_t counts, std::uint32_t per);

    MapReader reader_;
    MachineDraft& draft_;
    const Axis& axis_;
    std::uint32_t axis_index_;
};

/// The counter of an endless axis has to overflow at a whole number of turns: otherwise the same
/// count would mean another angle after it, undetected.
void DriveReader::check_endless(std::uint32_t counts, std::uint32_t per) {
    double range_counts = 4294967296.0;
    const bool is_stated =
        reader_.number("range_counts", Need::optional, {2, 4294967296.0}, range_counts);
    if (!axis_.unlimited) {
        if (is_stated) {
            reader_.report("range_counts", "a range for an axis that has travel limits",
                           "no such key");
        }
        return;
    }
    // Turns in the range: range * per / (counts * 360), a whole number of them.
    const double parts = range_counts * per;
    const double whole = 360.0 * counts;
    if (range_counts != std::floor(range_counts) || parts > 9.0e15 ||
        std::fmod(parts, whole) != 0) {
        reader_.report("range_counts",
                       shown(range_counts) + " counts, " + shown(parts / whole) + " turns",
                       "the drive's position range (object 0x607B), a whole number of turns");
    }
}

bool DriveReader::read_scale(CanSignal& position) {
    const bool is_rotary = axis_.kind == AxisKind::rotary;
    const char* const key = is_rotary ? "per_deg" : "per_mm";
    const char* const other = is_rotary ? "per_mm" : "per_deg";
    if (reader_.has(other)) {
        reader_.report(other,
                       std::string{other} + " of a " + (is_rotary ? "rotary" : "linear") + " axis",
                       key);
    }
    std::uint32_t counts = 0;
    std::uint32_t per = 0;
    double zero_counts = 0;
    bool is_reversed = false;
    bool is_sound = reader_.whole("counts", Need::required, {1, kWholeMax}, counts);
    is_sound = reader_.whole(key, Need::required, {1, 1'000'000}, per) && is_sound;
    reader_.boolean("reversed", Need::optional, is_reversed);
    reader_.number("zero_counts", Need::optional, {-2147483648.0, 2147483647.0}, zero_counts);
    if (zero_counts != std::floor(zero_counts)) {
        reader_.report("zero_counts", shown(zero_counts), "a whole number of counts");
    }
    if (!is_sound) {
        return false;
    }
    position.factor = static_cast<double>(per) / counts * (is_reversed ? -1 : 1);
    position.offset = -zero_counts * position.factor;
    check_endless(counts, per);
    const SignalReach reach = reach_of(position, axis_);
    if (!axis_.unlimited && !reach.fits) {
        reader_.report("counts", "32 " + reach.got, reach.wanted);
    }
    return true;
}

/// The status word of CiA 402 has no standard bit for a homed axis: makers use a bit of their own,
/// or the encoder is absolute.
bool DriveReader::read_homed(std::uint32_t& mask) {
    bool is_absolute = false;
    std::uint32_t bit = 0;
    const bool has_absolute = reader_.boolean("absolute", Need::optional, is_absolute);
    const bool has_bit = reader_.whole("homed_bit", Need::optional, {0, 15}, bit);
    if (has_bit == (has_absolute && is_absolute)) {
        reader_.report(has_bit ? "homed_bit" : "absolute",
                       has_bit ? "homed_bit and absolute" : "neither absolute: true nor homed_bit",
                       "absolute: true for an absolute encoder, or homed_bit, the bit of the "
                       "status word that means homed");
        return false;
    }
    mask = has_bit ? 1U << bit : 0;
    return true;
}

/// Object 0x606C comes in the unit that the drive was set to.
bool DriveReader::read_velocity(CanSignal& velocity) {
    const YamlNode* section = reader_.find("velocity", Need::optional, "a map");
    if (section == nullptr) {
        return false;
    }
    const bool is_rotary = axis_.kind == AxisKind::rotary;
    const char* const key = is_rotary ? "per_deg_s" : "per_mm_s";
    MapReader one{
        *section, reader_.path_of("velocity"), {"counts", "per_mm_s", "per_deg_s"}, draft_.faults};
    std::uint32_t counts = 0;
    std::uint32_t per = 0;
    bool is_sound = one.whole("counts", Need::required, {1, kWholeMax}, counts);
    is_sound = one.whole(key, Need::required, {1, 1'000'000}, per) && is_sound;
    if (is_sound) {
        velocity.factor = static_cast<double>(per) / counts;
    }
    return is_sound;
}

bool DriveReader::read_written(const YamlNode& list, std::vector<Pdo>& pdos) {
    if (list.kind != YamlNode::Kind::sequence || list.entries.empty() || list.entries.size() > 4) {
        reader_.report(
            "pdos", shown(list),
            "a list of 1 to 4, such as [{cob_id: 0x183, map: [0x60410010, 0x60640020]}]");
        return false;
    }
    bool is_sound = true;
    for (std::size_t i = 0; i < list.entries.size(); ++i) {
        const std::string path = reader_.path_of("pdos") + '[' + std::to_string(i) + ']';
        MapReader one{list.entries[i].value, path, {"cob_id", "map"}, draft_.faults};
        Pdo pdo;
        is_sound = read_cob_id(one, pdo.cob_id) && is_sound;
        const YamlNode* map = one.find("map", Need::required, "a list of mapped objects");
        if (map == nullptr || map->kind != YamlNode::Kind::sequence) {
            if (map != nullptr) {
                one.report("map", shown(*map), "a list, such as [0x60410010, 0x60640020]");
            }
            is_sound = false;
            continue;
        }
        for (const YamlEntry& entry : map->entries) {
            std::uint32_t object = 0;
            const std::string at = path + ".map";
            is_sound =
                read_whole({entry.value, at, draft_.faults}, {1, UINT32_MAX}, true, object) &&
                is_sound;
            pdo.map.push_back(object);
        }
        pdos.push_back(std::move(pdo));
    }
    return is_sound;
}

bool DriveReader::read_file(std::vector<Pdo>& pdos) {
    std::string name;
    std::uint32_t node = 0;
    const bool has_node = reader_.whole("node", Need::required, {1, 127}, node);
    if (!reader_.text("file", Need::required, 4096, name) || !has_node) {
        return false;
    }
    NamedFile read{
        {}, "no files here", "a machine file on disk, with its EDS or DCF file in the same folder"};
    if (draft_.files) {
        read = draft_.files(name, kEdsSizeBytesMax);
    }
    if (!read.got.empty()) {
        reader_.report("file", quoted(name) + ": " + read.got, read.wanted);
        return false;
    }
    Eds eds;
    const std::vector<ConfigFault> faults = parse_eds(read.text, name, node, eds);
    draft_.faults.add_all(reader_.line_of("file"), faults);
    for (const EdsPdo& one : eds.pdos) {
        const std::string place = " (" + escaped(name) + ':' + std::to_string(one.line) + ')';
        const bool has_position =
            std::find(one.map.begin(), one.map.end(), kPosition) != one.map.end();
        if ((one.cob_id & kPdoOff) != 0) {
            continue;
        }
        if (one.transmission_type != 1) {
            if (has_position) {
                reader_.report("file",
                               "TPDO" + std::to_string(one.number) +
                                   " with the position, of transmission type " +
                                   std::to_string(one.transmission_type) + place,
                               "type 1: latched and sent at every SYNC");
                return false;
            }
            continue;
        }
        if (one.default_cob_id) {
            draft_.doubts.push_back(
                draft_.faults.where(reader_.line_of("file")) + ": " + reader_.path_of("file") +
                ": TPDO" + std::to_string(one.number) + " is awaited under ParameterValue " +
                hex(one.cob_id, 3) + place + "; DefaultValue makes it " +
                hex(*one.default_cob_id, 3) + " for node " + std::to_string(node) +
                ". Delete ParameterValue if it is that of another node.");
        }
        pdos.push_back({id_of_cob(one.cob_id), one.map, place});
    }
    return faults.empty();
}

bool DriveReader::read_pdos(std::vector<Pdo>& pdos) {
    const bool is_written = reader_.has("pdos");
    if (is_written == reader_.has("file")) {
        reader_.report(is_written ? "pdos" : "file", is_written ? "pdos and file" : "neither",
                       "either pdos, or the EDS or DCF file of the drive");
        return false;
    }
    if (!is_written) {
        return read_file(pdos);
    }
    if (std::uint32_t node = 0; reader_.has("node")) {
        reader_.whole("node", Need::optional, {1, 127}, node);
    }
    const YamlNode* list = reader_.find("pdos", Need::required, "a list");
    return list != nullptr && read_written(*list, pdos);
}

/// Finds an object among the PDOs; a signal without its bits becomes one with them.
void DriveReader::place(const std::vector<Pdo>& pdos, std::uint32_t object, std::uint32_t bits,
                        CanSignal signal, bool is_required) {
    for (const Pdo& pdo : pdos) {
        std::uint32_t at = 0;
        std::optional<std::uint32_t> found;
        for (const std::uint32_t mapped : pdo.map) {
            found = mapped == object && !found ? std::optional{at} : found;
            at += mapped & 0xFFU;
        }
        if (!found) {
            continue;
        }
        if (at > kPdoBitsMax || at % 8 != 0) {
            reader_.report(
                reader_.has("file") ? "file" : "pdos",
                "a PDO of " + std::to_string(at) + " bits under " + id_text(pdo.cob_id) + pdo.place,
                "whole bytes, at most 8 of them");
            return;
        }
        signal.id = pdo.cob_id;
        signal.axis = axis_index_;
        signal.start_bit = static_cast<std::uint16_t>(*found);
        signal.length_bits = static_cast<std::uint8_t>(bits);
        signal.frame_bytes = static_cast<std::uint8_t>(at / 8);
        draft_.machine.can.signals.push_back(signal);
        return;
    }
    if (is_required) {
        reader_.report(reader_.has("file") ? "file" : "pdos",
                       "no PDO at every SYNC with " + hex(object, 8),
                       object == kPosition ? "the position, 0x6064 of 32 bits, mapped"
                       : object == kStatusWord
                           ? "the status word, 0x6041 of 16 bits, mapped; it reports faults"
                           : "the velocity, 0x606C of 32 bits, mapped, or no key velocity");
    }
}

void DriveReader::read() {
    CanSignal position;
    position.length_bits = 32;
    CanSignal status;
    status.role = SignalRole::drive_status;
    status.is_signed = false;
    CanSignal velocity;
    velocity.role = SignalRole::velocity;
    std::vector<Pdo> pdos;
    const bool has_scale = read_scale(position);
    const bool has_homed = read_homed(status.mark);
    const bool has_velocity = read_velocity(velocity);
    if (!read_pdos(pdos) || !has_scale || !has_homed) {
        return;
    }
    place(pdos, kPosition, 32, position, true);
    place(pdos, kStatusWord, 16, status, true);
    if (has_velocity) {
        place(pdos, kVelocity, 32, velocity, true);
    }
}

/// The guard as the producer of SYNC counts to 240: nothing less dates a permit.
void read_sync(MapReader& can, CanLayout& layout) {
    constexpr std::array<std::string_view, 2> kProducers{"board", "guard"};
    constexpr std::uint32_t kGuardCounts = 240;
    std::size_t producer = 0;
    layout.guard_sends_sync =
        can.choice("sync", Need::optional, kProducers, producer) && kProducers[producer] == "guard";
    std::uint32_t most = layout.guard_sends_sync ? kGuardCounts : 0;
    can.whole("sync_counter", Need::optional, {0, kGuardCounts}, most);
    if (layout.guard_sends_sync && most != kGuardCounts) {
        can.report("sync_counter", std::to_string(most) + " with sync: guard",
                   "240, or no such key; the guard counts SYNC to 240");
    } else if (most == 1) {
        can.report("sync_counter", "1", "0 (SYNC without a counter), or 2 to 240: object 0x1019");
    }
    layout.sync_counter_max = static_cast<std::uint8_t>(most);
    layout.sync_window_us = layout.sample_us;
    can.whole("sync_window_us", Need::optional, {10, layout.sample_us}, layout.sync_window_us);
}

/// Two PDOs under one identifier destroy each other's frames.
void check_drive_ids(MapReader& can, const Machine& machine) {
    const std::vector<CanSignal>& signals = machine.can.signals;
    for (std::size_t i = 0; i < signals.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            const CanSignal &a = signals[j], &b = signals[i];
            if (a.id == b.id && (a.axis != b.axis || a.frame_bytes != b.frame_bytes)) {
                can.report("drives",
                           id_text(a.id) + " for both " + machine.axes[a.axis].name + " and " +
                               (a.axis == b.axis ? "another PDO" : machine.axes[b.axis].name),
                           "identifiers of its own for each drive");
                return;
            }
        }
    }
}

}  // namespace

void read_drives(MapReader& can, MachineDraft& draft) {
    if (draft.can_source != "cia402") {
        for (const char* key : {"drives", "sync", "sync_counter", "sync_window_us"}) {
            if (can.has(key)) {
                can.report(key, std::string{key} + " without format: cia402",
                           "format: cia402, or no such key");
            }
        }
        return;
    }
    read_sync(can, draft.machine.can);
    const YamlNode* section =
        can.find("drives", Need::required, "a map with a drive for each axis");
    if (section == nullptr || section->kind != YamlNode::Kind::map) {
        if (section != nullptr) {
            can.report("drives", shown(*section), "a map with a drive for each axis");
        }
        return;
    }
    std::vector<bool> found(draft.machine.axes.size(), false);
    for (const YamlEntry& entry : section->entries) {
        const std::uint32_t axis = index_of(draft.machine.axes, entry.key);
        if (axis == kNoIndex) {
            draft.faults.add(entry.line, "can.drives." + escaped(entry.key, kNameLengthMax),
                             quoted(entry.key),
                             wanted_name("an axis", entry.key, names_of(draft.machine.axes)));
            continue;
        }
        found[axis] = true;
        DriveReader{entry, axis, draft}.read();
    }
    for (std::size_t i = 0; i < found.size(); ++i) {
        if (!found[i]) {
            can.report("drives", "no drive for axis " + escaped(draft.machine.axes[i].name, 64),
                       "exactly one drive for each axis");
        }
    }
    check_drive_ids(can, draft.machine);
    std::stable_sort(draft.machine.can.signals.begin(), draft.machine.can.signals.end(),
                     [](const CanSignal& a, const CanSignal& b) {
                         return a.role != b.role ? a.role < b.role : a.axis < b.axis;
                     });
}

}  // namespace axg
