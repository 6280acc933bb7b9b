// SPDX-License-Identifier: Apache-2.0
// `format: dbc`: the signals of a DBC file that carry axes, status bits and counters.
#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "config/can/dbc.hpp"
#include "config/can/dbc_signal.hpp"
#include "config/can/read_signals.hpp"
#include "config/can/signal_rules.hpp"
#include "config/text/fault_list.hpp"
#include "config/text/machine_draft.hpp"
#include "config/text/map_reader.hpp"
#include "config/text/nearest_word.hpp"
#include "config/text/quote_text.hpp"
#include "core/base/sincos.hpp"

namespace axg {
namespace {

constexpr std::array<const char*, 4> kDbcKeys{"file", "axes", "status", "counters"};
constexpr std::uint32_t kCounterBitsMax = 8;

struct State {
    std::string_view key;
    SignalRole role;
};
constexpr std::array<State, 4> kStates{{{"tool", SignalRole::tool},
                                        {"moving", SignalRole::moving},
                                        {"tool_change", SignalRole::tool_change},
                                        {"homed", SignalRole::homed}}};

/// A signal that the machine file names: its entry in the DBC file, and the line that names it.
struct Named {
    const DbcMessage* message = nullptr;
    const DbcSignal* signal = nullptr;
    CanSignal wire;
    std::string path;  // can.axes.X
    int line = 0;
};

/// Whether no frame is of both: some run of bits is to have one value here, another there.
bool are_apart(const SignalSelector& a, const SignalSelector& b) noexcept {
    const SignalSelector::Range* of_a = a.ranges.data();
    for (std::uint32_t i = 0; i < a.level_count; of_a += a.levels[i++].range_count) {
        const SignalSelector::Range* of_b = b.ranges.data();
        for (std::uint32_t j = 0; j < b.level_count; of_b += b.levels[j++].range_count) {
            SignalSelector::Level same = b.levels[j];
            same.range_count = a.levels[i].range_count;
            const auto meets = [&](const SignalSelector::Range& one) {
                return std::any_of(of_b, of_b + b.levels[j].range_count, [&](const auto& other) {
                    return one.least <= other.most && other.least <= one.most;
                });
            };
            if (same == a.levels[i] && std::none_of(of_a, of_a + a.levels[i].range_count, meets)) {
                return true;
            }
        }
    }
    return false;
}

class DbcReader {
  public:
    DbcReader(MapReader& can, MachineDraft& draft, const Dbc& dbc, std::string file)
        : can_(can), draft_(draft), dbc_(dbc), file_(std::move(file)) {}

    void read();

  private:
    void report(const std::string& path, int line, std::string got, std::string wanted) {
        draft_.faults.add(line, path, std::move(got), std::move(wanted));
    }
    [[nodiscard]] std::string place(int line) const {
        return " (" + escaped(file_) + ':' + std::to_string(line) + ')';
    }
    [[nodiscard]] std::optional<Named> find(const YamlNode& node, const std::string& path);
    void read_axis(const YamlEntry& entry, std::uint32_t axis);
    void read_axes();
    void read_states();
    void read_counters();
    void read_unit(Named& named, const YamlNode* unit, const Axis& axis);
    void check_axis(const Named& named, const Axis& axis);
    void check_frames();

    MapReader& can_;
    MachineDraft& draft_;
    const Dbc& dbc_;
    std::string file_;
    std::vector<Named> named_;
};

template <class NamedThing>
const NamedThing* thing_of(const std::vector<NamedThing>& all, std::string_view name) noexcept {
    const std::uint32_t index = index_of(all, name);
    return index == kNoIndex ? nullptr : &all[index];
}

/// The nearest name, and all of them where they are few.
template <class NamedThing>
std::string wanted_of(const std::string& what, std::string_view got,
                      const std::vector<NamedThing>& all) {
    constexpr std::size_t kListedMax = 20;
    const std::vector<std::string_view> names = names_of(all);
    const std::string_view nearest = nearest_word(got, names);
    const std::string meant = nearest.empty() ? "" : "; did you mean " + quoted(nearest) + '?';
    return what + (names.empty() || names.size() > kListedMax ? "" : ": " + listed(names)) + meant;
}

/// "Message.Signal", both in the file and usable.
std::optional<Named> DbcReader::find(const YamlNode& node, const std::string& path) {
    const std::size_t dot = node.text.find('.');
    if (node.kind != YamlNode::Kind::scalar || dot == std::string::npos) {
        report(path, node.line, shown(node),
               "a message and a signal of the file, such as Message.Signal");
        return std::nullopt;
    }
    const std::string_view text = node.text;
    Named named{.message = thing_of(dbc_.messages, text.substr(0, dot)),
                .signal = nullptr,
                .wire = {},
                .path = path,
                .line = node.line};
    if (named.message == nullptr) {
        report(path, node.line, quoted(text.substr(0, dot)),
               wanted_of("a message of " + escaped(file_), text.substr(0, dot), dbc_.messages));
        return std::nullopt;
    }
    named.signal = thing_of(named.message->signals, text.substr(dot + 1));
    if (named.signal == nullptr) {
        report(path, node.line, quoted(text.substr(dot + 1)) + place(named.message->line),
               wanted_of("a signal of " + named.message->name, text.substr(dot + 1),
                         named.message->signals));
        return std::nullopt;
    }
    const std::string refused = to_can_signal(*named.message, *named.signal, named.wire);
    if (!refused.empty()) {
        report(path, node.line, "a signal of " + refused + place(named.signal->line),
               "another signal; see docs/reference/protocol.md");
        return std::nullopt;
    }
    return named;
}

/// Uses the unit of the DBC file, or the machine file's if the DBC file has no supported unit. Two
/// stated units must agree.
void DbcReader::read_unit(Named& named, const YamlNode* unit, const Axis& axis) {
    const std::optional<std::size_t> of_file = unit_named(named.signal->unit);
    std::optional<std::size_t> chosen = of_file;
    const std::string shown_unit = quoted(named.signal->unit, 40) + place(named.signal->line);
    if (unit != nullptr) {
        const auto* const found =
            std::find(kSignalUnitNames.begin(), kSignalUnitNames.end(), unit->text);
        if (found == kSignalUnitNames.end()) {
            report(named.path + ".unit", unit->line, shown(*unit), units_of(axis.kind));
            return;
        }
        chosen = static_cast<std::size_t>(found - kSignalUnitNames.begin());
        if (of_file && *of_file != *chosen) {
            report(named.path + ".unit", unit->line,
                   shown(*unit) + ", and in the DBC file " + shown_unit,
                   "the unit of the DBC file; correct either file");
            return;
        }
    }
    if (!chosen) {
        report(named.path, named.line, "the unit " + shown_unit,
               "the unit stated here, such as {signal: " + named.message->name + '.' +
                   named.signal->name +
                   ", unit: " + (axis.kind == AxisKind::rotary ? "deg}" : "mm}"));
        return;
    }
    if (signal_unit(*chosen).kind != axis.kind) {
        report(named.path, named.line,
               quoted(kSignalUnitNames[*chosen]) + " for a " +
                   (axis.kind == AxisKind::rotary ? "rotary" : "linear") + " axis" +
                   place(named.signal->line),
               units_of(axis.kind));
        return;
    }
    named.wire.factor *= signal_unit(*chosen).factor;
    named.wire.offset *= signal_unit(*chosen).factor;
    check_axis(named, axis);
}

void DbcReader::check_axis(const Named& named, const Axis& axis) {
    if (axis.unlimited && named.wire.type != SignalType::integer) {
        report(named.path, named.line,
               "a floating-point signal for an endless axis" + place(named.signal->line),
               "an integer signal; a float loses resolution with every turn");
        return;
    }
    const SignalReach reach = reach_of(named.wire, axis);
    if (!reach.fits) {
        report(named.path, named.line, reach.got + place(named.signal->line), reach.wanted);
        return;
    }
    // The board sends no value outside the range that the DBC file states.
    const DbcSignal& signal = *named.signal;
    const double unit = named.wire.factor / signal.factor;
    const double to_file = axis.kind == AxisKind::rotary ? 180.0 / kPi : 1.0;
    const double slack = std::abs(named.wire.factor);
    if (signal.minimum < signal.maximum && !axis.unlimited &&
        (signal.minimum * unit > axis.min * to_file + slack ||
         signal.maximum * unit < axis.max * to_file - slack)) {
        report(named.path, named.line,
               "a range from " + shown(signal.minimum * unit) + " to " +
                   shown(signal.maximum * unit) + place(signal.line),
               reach_of({}, axis).wanted);
    }
}

void DbcReader::read_axis(const YamlEntry& entry, std::uint32_t axis_index) {
    const std::string path = "can.axes." + entry.key;
    const YamlNode* signal = &entry.value;
    const YamlNode* unit = nullptr;
    if (entry.value.kind == YamlNode::Kind::map) {
        MapReader reader{entry.value, path, {"signal", "unit"}, draft_.faults};
        signal = reader.find("signal", Need::required, "Message.Signal");
        unit = reader.find("unit", Need::optional, "a unit");
    }
    std::optional<Named> named = signal == nullptr ? std::nullopt : find(*signal, path);
    if (named) {
        named->wire.axis = axis_index;
        read_unit(*named, unit, draft_.machine.axes[axis_index]);
        named_.push_back(*named);
    }
}

void DbcReader::read_axes() {
    const YamlNode* section =
        can_.find("axes", Need::required, "a map with a signal for each axis");
    if (section == nullptr || section->kind != YamlNode::Kind::map) {
        if (section != nullptr) {
            can_.report("axes", shown(*section), "a map, such as {X: Message.Signal}");
        }
        return;
    }
    std::vector<bool> found(draft_.machine.axes.size(), false);
    for (const YamlEntry& entry : section->entries) {
        const std::uint32_t axis = index_of(draft_.machine.axes, entry.key);
        if (axis == kNoIndex) {
            report("can.axes." + escaped(entry.key, kNameLengthMax), entry.line, quoted(entry.key),
                   wanted_name("an axis", entry.key, names_of(draft_.machine.axes)));
            continue;
        }
        found[axis] = true;
        read_axis(entry, axis);
    }
    for (std::size_t i = 0; i < found.size(); ++i) {
        if (!found[i]) {
            can_.report("axes", "no signal for axis " + escaped(draft_.machine.axes[i].name, 64),
                        "exactly one signal for each axis");
        }
    }
}

void DbcReader::read_states() {
    const YamlNode* section =
        can_.find("status", Need::optional, "a map with tool, moving, tool_change or homed");
    if (section == nullptr) {
        return;
    }
    MapReader reader{
        *section, "can.status", {"tool", "moving", "tool_change", "homed"}, draft_.faults};
    for (const State& state : kStates) {
        const YamlNode* signal = reader.find(state.key, Need::optional, "Message.Signal");
        std::uint32_t yes = 1;
        if (signal != nullptr && signal->kind == YamlNode::Kind::map &&
            state.role != SignalRole::tool) {
            MapReader one{*signal, reader.path_of(state.key), {"signal", "is"}, draft_.faults};
            one.whole("is", Need::required, {0, 0xFFFF}, yes);
            signal = one.find("signal", Need::required, "Message.Signal");
        }
        std::optional<Named> named =
            signal == nullptr ? std::nullopt : find(*signal, reader.path_of(state.key));
        if (!named) {
            continue;
        }
        named->wire.role = state.role;
        named->wire.axis = 0;
        named->wire.mark = yes;
        if (state.role != SignalRole::tool && named->wire.type != SignalType::integer) {
            report(named->path, named->line, "a floating-point signal" + place(named->signal->line),
                   "an integer signal whose raw value means yes or no");
            continue;
        }
        named_.push_back(*named);
    }
}

void DbcReader::read_counters() {
    const YamlNode* list = can_.find("counters", Need::optional, "a list of counters");
    if (list == nullptr) {
        return;
    }
    if (list->kind != YamlNode::Kind::sequence ||
        list->entries.size() > kAxesMax + kStates.size()) {
        can_.report("counters", shown(*list), "a list, such as [Positions.Counter]");
        return;
    }
    const std::size_t frames = named_.size();
    for (std::size_t i = 0; i < list->entries.size(); ++i) {
        std::optional<Named> named =
            find(list->entries[i].value, "can.counters[" + std::to_string(i) + ']');
        if (!named) {
            continue;
        }
        const DbcSignal& signal = *named->signal;
        if (signal.is_signed || signal.type != SignalType::integer ||
            signal.length_bits > kCounterBitsMax) {
            report(
                named->path, named->line,
                "a counter of " + std::to_string(signal.length_bits) + " bits" + place(signal.line),
                "an unsigned integer of at most 8 bits");
            continue;
        }
        const bool carries =
            std::any_of(named_.begin(), named_.begin() + static_cast<std::ptrdiff_t>(frames),
                        [&](const Named& other) { return other.message == named->message; });
        if (!carries) {
            report(named->path, named->line, named->message->name + place(named->message->line),
                   "a message that carries an axis, or a state");
            continue;
        }
        // The range in the DBC file bounds the count (AUTOSAR profile 1: 0..14); else all bits do.
        const double range = signal.maximum / signal.factor;
        const std::uint32_t all = 1U << signal.length_bits;
        const bool has_range = signal.minimum == 0 && range >= 1 && range < all;
        named->wire.mark = has_range ? static_cast<std::uint32_t>(range) + 1 : all;
        named->wire.role = SignalRole::counter;
        named->wire.axis = 0;
        named_.push_back(*named);
    }
}

/// Rejects signals that share bits (states may), a message of which only some of the signals are
/// multiplexed, and pages that overlap in part: one frame would be of both.
void DbcReader::check_frames() {
    for (std::size_t i = 0; i < named_.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            const Named& a = named_[j];
            const Named& b = named_[i];
            if (a.message != b.message) {
                continue;
            }
            if ((a.wire.selector.level_count == 0) != (b.wire.selector.level_count == 0)) {
                report(b.path, b.line,
                       "a multiplexed signal and one in every frame of " + a.message->name +
                           place(b.signal->line),
                       "all signals of a message multiplexed, or none");
                continue;
            }
            if (a.wire.selector != b.wire.selector &&
                !are_apart(a.wire.selector, b.wire.selector)) {
                report(b.path, b.line,
                       "pages of which some are those of " + a.path + place(b.signal->line),
                       "the same pages, or no page of it");
                continue;
            }
            const bool is_state =
                a.wire.role != SignalRole::position && b.wire.role != SignalRole::position;
            FrameBits of_a;
            FrameBits of_b;
            if (!is_state && a.wire.selector == b.wire.selector &&
                covered_bits(a.wire, kFrameBitsMax, of_a) &&
                covered_bits(b.wire, kFrameBitsMax, of_b) && (of_a & of_b).any()) {
                report(b.path, b.line,
                       "bits that " + a.path + " uses in the same frame" + place(b.signal->line),
                       "bits of its own for each");
            }
            if (a.wire.role == b.wire.role && a.wire.role == SignalRole::counter &&
                a.wire.selector == b.wire.selector) {
                report(b.path, b.line, "a second counter of " + a.message->name,
                       "one counter for each message");
            }
        }
    }
}

void DbcReader::read() {
    read_axes();
    read_states();
    read_counters();
    check_frames();
    std::stable_sort(named_.begin(), named_.end(), [](const Named& a, const Named& b) {
        return a.wire.role != b.wire.role ? a.wire.role < b.wire.role : a.wire.axis < b.wire.axis;
    });
    for (const Named& named : named_) {
        draft_.machine.can.signals.push_back(named.wire);
    }
}

}  // namespace

void read_dbc(MapReader& can, MachineDraft& draft) {
    if (draft.can_source != "dbc") {
        for (const char* key : kDbcKeys) {
            if (can.has(key)) {
                can.report(key, std::string{key} + " without format: dbc",
                           "format: dbc, or no such key");
            }
        }
        return;
    }
    std::string name;
    if (!can.text("file", Need::required, 4096, name)) {
        return;
    }
    NamedFile read{
        {}, "no files here", "a machine file on disk, with its DBC file in the same folder"};
    if (draft.files) {
        read = draft.files(name, kDbcSizeBytesMax);
    }
    if (!read.got.empty()) {
        can.report("file", quoted(name) + ": " + read.got, read.wanted);
        return;
    }
    Dbc dbc;
    const std::vector<ConfigFault> faults = parse_dbc(read.text, name, dbc);
    draft.faults.add_all(can.line_of("file"), faults);
    if (faults.empty()) {
        DbcReader{can, draft, dbc, name}.read();
    }
}

}  // namespace axg
