// SPDX-License-Identifier: Apache-2.0
// docs/reference/protocol.md is what a board's firmware is written from: each frame that it shows
// is encoded again, from the values beside it, by the functions that the guard and the simulated
// board use, and each frame that they can make must be shown.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <regex>
#include <set>

#include "config/machine/parse_machine.hpp"
#include "core/base/sincos.hpp"
#include "core/machine/configuration_hashes.hpp"
#include "firmware_if/protocol/axis_frames.hpp"
#include "firmware_if/protocol/guard_frames.hpp"
#include "firmware_if/protocol/handshake.hpp"
#include "firmware_if/protocol/hints_frame.hpp"
#include "firmware_if/protocol/permit_frames.hpp"
#include "tests/support/page_text.hpp"

namespace axg {
namespace {

using test::blocks_of;
using test::frame_lines;
using test::FrameLine;
using test::page_bytes;
using test::page_of;

/// What stands beside a frame: `name: key = value unit, key = value`. Each must be used.
class Words {
  public:
    explicit Words(const std::string& words) : name(words.substr(0, words.find(": "))) {
        if (name.size() == words.size()) {
            return;
        }
        std::istringstream text(words.substr(name.size() + 2));
        for (std::string part; std::getline(text, part, ',');) {
            const std::size_t equal = part.find(" = ");
            EXPECT_NE(equal, std::string::npos) << words;
            const std::size_t begin = part.find_first_not_of(' ');
            values_[part.substr(begin, equal - begin)] = part.substr(equal + 3);
        }
    }

    std::string name;

    [[nodiscard]] bool has(const std::string& key) const { return values_.contains(key); }
    [[nodiscard]] std::string text(const std::string& key) {
        EXPECT_TRUE(has(key)) << name << " says no " << key;
        used_.insert(key);
        return values_[key];
    }
    /// Hexadecimal with 0x; what follows the number is its unit, or what it means.
    [[nodiscard]] double number(const std::string& key) {
        return std::strtod(text(key).c_str(), nullptr);
    }
    template <class Integer>
    [[nodiscard]] Integer integer(const std::string& key) {
        return static_cast<Integer>(number(key));
    }
    void expect_all_used() const {
        for (const auto& [key, value] : values_) {
            EXPECT_TRUE(used_.contains(key)) << name << ": unknown value " << key;
        }
    }

  private:
    std::map<std::string, std::string> values_;
    std::set<std::string> used_;
};

// An enumerator without a name here does not compile: so none is without an example.
const char* name_of(PermitWord word) {
    switch (word) {
        case PermitWord::run:
            return "run";
        case PermitWord::slow:
            return "slow";
        case PermitWord::jog:
            return "jog";
        case PermitWord::stop:
            return "stop";
    }
    return nullptr;
}
const char* name_of(EmergencyCode code) {
    switch (code) {
        case EmergencyCode::reset:
            return "cause gone and acknowledged";
        case EmergencyCode::bus:
            return "bus";
        case EmergencyCode::predicted_collision:
            return "predicted collision";
        case EmergencyCode::contact:
            return "contact";
        case EmergencyCode::deadline:
            return "deadline";
        case EmergencyCode::known_answer:
            return "known-answer test";
        case EmergencyCode::input_stale:
            return "input stale";
        case EmergencyCode::model_hash:
            return "model hash";
    }
    return nullptr;
}
const char* name_of(GuardHeartbeat heartbeat) {
    switch (heartbeat) {
        case GuardHeartbeat::silent:  // not sent
            return nullptr;
        case GuardHeartbeat::tripped:
            return "tripped";
        case GuardHeartbeat::running:
            return "running";
        case GuardHeartbeat::starting:
            return "starting";
    }
    return nullptr;
}

template <class Enum>
std::map<std::string, Enum> names_of() {
    std::map<std::string, Enum> names;
    for (std::uint32_t value = 0; value <= std::numeric_limits<std::underlying_type_t<Enum>>::max();
         ++value) {
        const char* const name = name_of(static_cast<Enum>(value));
        if (name != nullptr) {
            names[name] = static_cast<Enum>(value);
        }
    }
    return names;
}

/// Of `0xFF01 predicted collision`: both, which must belong together.
template <class Enum>
Enum named(Words& words, const std::string& key) {
    const std::string text = words.text(key);
    const std::string name = text.substr(std::min(text.find(' '), text.size() - 1) + 1);
    const auto names = names_of<Enum>();
    EXPECT_TRUE(names.contains(name)) << words.name << ": " << key << " = " << text;
    const Enum value = names.contains(name) ? names.at(name) : Enum{};
    EXPECT_EQ(static_cast<std::uint32_t>(std::strtoul(text.c_str(), nullptr, 0)),
              static_cast<std::uint32_t>(value))
        << text;
    return value;
}

/// The example machine of the page on machine files, with the ids that the protocol page adds.
std::string example_text(std::size_t can_block) {
    const auto yaml = blocks_of(page_of("reference/machine-file.md"), "yaml");
    if (can_block == 0) {
        return yaml.at(0);
    }
    const std::string whole = yaml.at(0);
    return whole.substr(0, whole.find("\ncan:") + 1) + yaml.at(can_block) +
           whole.substr(whole.find("capacities:"));
}

Machine example_machine(std::size_t can_block, const std::string& file = "") {
    Machine machine;
    for (const ConfigFault& fault : parse_machine(example_text(can_block), "page", machine,
                                                  [&file](const std::string&, std::size_t) {
                                                      return NamedFile{file, {}, {}};
                                                  })) {
        ADD_FAILURE() << to_string(fault);
    }
    return machine;
}

CanLayout guard_layout() {
    CanLayout layout = example_machine(0).can;
    layout.quick_stop_ids = {0x303, 0x304};
    return layout;
}

/// The frame that the guard, or a board's answer to it, makes of the values in `words`; the name
/// of its kind in `kind`. Nothing: unknown.
std::optional<CanFrame> encode_words(const CanLayout& can, Words& words, CanFrame& inverse,
                                     std::string& kind) {
    kind = words.name;
    if (words.name == "permit") {
        const auto word = named<PermitWord>(words, "word");
        kind += std::string(" ") + name_of(word);
        const std::string level = words.text("level");
        const Permit permit{.word = word,
                            .sync_counter = words.integer<std::uint8_t>("echo"),
                            .live_counter = words.integer<std::uint8_t>("live counter"),
                            .known_answer_signature = kKnownAnswerSignature,
                            .cap = words.integer<std::uint8_t>("cap"),
                            .mask = words.integer<std::uint8_t>("mask"),
                            .samples = words.integer<std::uint8_t>("n"),
                            .level = static_cast<std::uint8_t>(std::stoul(level)),
                            .nonce = words.integer<std::uint32_t>("nonce"),
                            .lap = words.integer<std::uint16_t>("lap")};
        EXPECT_EQ(level.substr(2), to_text(static_cast<ClearanceLevel>(3 - permit.level)));
        const auto frames = encode_permit(can, permit, 0);
        inverse = frames[1];
        return frames[0];
    }
    if (words.name == "session") {
        return encode_session(can.session_in_id,
                              {.nonce = words.integer<std::uint32_t>("nonce"),
                               .lap = words.integer<std::uint16_t>("lap"),
                               .sync_counter = words.integer<std::uint8_t>("SYNC"),
                               .counter = words.integer<std::uint8_t>("counter")},
                              0);
    }
    if (words.name == "hints") {
        return encode_hints(can,
                            {.sync_counter = words.integer<std::uint8_t>("SYNC"),
                             .pair = words.integer<std::uint16_t>("pair"),
                             .distance_10um = static_cast<std::uint16_t>(
                                 std::lround(words.number("distance") * 100))},
                            0);
    }
    if (words.name == "inverse") {
        return inverse;
    }
    if (words.name == "stop") {
        return encode_stop(can, 0);
    }
    if (words.name == "quick stop") {
        const auto drive = words.integer<std::size_t>("drive");
        return encode_quick_stop(can.quick_stop_ids.at(drive - 1), 0);
    }
    if (words.name == "emergency") {
        const auto code = named<EmergencyCode>(words, "code");
        kind += std::string(" ") + name_of(code);
        const Emergency emergency{
            .code = code,
            .error_register = words.integer<std::uint8_t>("register"),
            .pair = words.integer<std::uint8_t>("pair"),
            .clearance_10um = emergency_clearance(words.number("clearance")),
            .time_to_contact_100us = emergency_time(words.number("time") * 1.0e-3)};
        return encode_emergency(can, emergency, 0);
    }
    if (words.name == "heartbeat") {
        const auto state = named<GuardHeartbeat>(words, "state");
        kind += std::string(" ") + name_of(state);
        return encode_guard_heartbeat(can, state, 0);
    }
    if (words.name == "hash asked" || words.name == "hash answered") {
        const std::string part = words.text("part");
        const HashFrame hash{.part = static_cast<std::uint8_t>(std::stoul(part)),
                             .hash = words.integer<std::uint32_t>("hash")};
        EXPECT_EQ(part.substr(2), kHashPartNames.at(hash.part));
        kind += " " + part;
        const bool is_asked = words.name == "hash asked";
        return encode_hash(is_asked ? can.hashes_out_id : can.hashes_in_id, hash, 0);
    }
    if (words.name == "board heartbeat") {
        const std::string state = words.text("state");
        kind += " " + state;
        return encode_heartbeat(can.heartbeat_in_id, static_cast<std::uint8_t>(std::stoul(state)),
                                0);
    }
    return std::nullopt;
}

std::set<std::string> every_kind() {
    std::set<std::string> kinds{"stop",
                                "quick stop",
                                "inverse",
                                "session",
                                "hints",
                                "board heartbeat 0 boot-up",
                                "board heartbeat 4 stopped",
                                "board heartbeat 5 operational",
                                "board heartbeat 127 pre-operational"};
    for (const auto& [name, word] : names_of<PermitWord>()) {
        kinds.insert("permit " + name);
    }
    for (const auto& [name, code] : names_of<EmergencyCode>()) {
        kinds.insert("emergency " + name);
    }
    for (const auto& [name, state] : names_of<GuardHeartbeat>()) {
        kinds.insert("heartbeat " + name);
    }
    for (std::uint32_t part = 0; part < kHashParts; ++part) {
        for (const char* const side : {"hash asked ", "hash answered "}) {
            kinds.insert(side + std::to_string(part) + " " + kHashPartNames[part]);
        }
    }
    return kinds;
}

TEST(ProtocolPage, EveryFrameWithoutPositionsIsShownByteByByte) {
    const CanLayout can = guard_layout();
    std::set<std::string> shown;
    for (const std::string& block : blocks_of(page_of("reference/protocol.md"), "frames")) {
        CanFrame inverse;
        for (const FrameLine& line : frame_lines(block)) {
            Words words(line.words);
            std::string kind;
            const auto frame = encode_words(can, words, inverse, kind);
            ASSERT_TRUE(frame.has_value()) << "unknown frame: " << line.words;
            EXPECT_EQ(line.bytes, page_bytes(*frame)) << line.words;
            words.expect_all_used();
            shown.insert(kind);
        }
    }
    EXPECT_EQ(shown, every_kind());
}

// The tables of ids and lengths, against the same functions.
TEST(ProtocolPage, TheTablesOfFramesHaveTheirIdsAndLengths) {
    const CanLayout can = guard_layout();
    const std::string page = page_of("reference/protocol.md");
    const std::string table = page.substr(page.find("\n## From the guard"));
    const auto pair = encode_permit(can, {}, 0);
    for (const CanFrame& frame :
         {pair[0], pair[1], encode_stop(can, 0), encode_emergency(can, {}, 0),
          encode_hints(can, {}, 0), encode_hash(can.hashes_out_id, {}, 0),
          encode_guard_heartbeat(can, GuardHeartbeat::running, 0)}) {
        char row[32];
        std::snprintf(row, sizeof row, "\n| 0x%03X | %d |", frame.id, frame.length_bytes);
        EXPECT_NE(table.find(row), std::string::npos) << row;
    }
    EXPECT_NE(table.find("\n| `quick_stop` | 2 |"), std::string::npos);
    EXPECT_EQ(encode_sync(can.sync_id, 1, 0).length_bytes, 1);
    EXPECT_NE(page.find("\n| 0x080 SYNC | 1 | every `sample_us` |"), std::string::npos);
    EXPECT_EQ(encode_heartbeat(can.heartbeat_in_id, kHeartbeatOperational, 0).length_bytes, 1);
    EXPECT_NE(page.find("\n| 0x701 | 1 | 10 ms |"), std::string::npos);
    EXPECT_EQ(can.session_in_id, 0x583U);
    EXPECT_NE(page.find("\n| 0x583 | 8 | 100 ms, each lap |"), std::string::npos);
    EXPECT_EQ(kSessionPeriodUs, 100'000);
    EXPECT_EQ(can.hashes_in_id, 0x582U);
    EXPECT_NE(page.find("\n| 0x582 | 8 | for each 0x602 |"), std::string::npos);
    EXPECT_EQ(kHeartbeatPeriodUs, 10'000);
    EXPECT_EQ(can.sync_id, 0x080U);
    EXPECT_EQ(can.heartbeat_in_id, 0x701U);
    EXPECT_EQ(encode_quick_stop(0x303, 0).length_bytes, 2);
}

// A function that is new in the room has no example yet: it is to be added above, and on the page.
TEST(ProtocolPage, NoEncoderOfTheRoomIsForgotten) {
    std::set<std::string> found;
    const std::regex encoder("\\b(encode\\w*|\\w+Encoder)\\b(?=\\(| \\{)");
    for (const auto& entry : std::filesystem::directory_iterator(std::string(AXG_SOURCE_DIR) +
                                                                 "/firmware_if/protocol")) {
        if (entry.path().extension() != ".hpp") {
            continue;
        }
        std::ifstream file(entry.path());
        const std::string text{std::istreambuf_iterator<char>(file), {}};
        for (std::sregex_iterator at(text.begin(), text.end(), encoder), end; at != end; ++at) {
            found.insert((*at)[1]);
        }
    }
    const std::set<std::string> known{"AxisEncoder",
                                      "encode",
                                      "encode_any_permit",
                                      "encode_emergency",
                                      "encode_guard_heartbeat",
                                      "encode_hash",
                                      "encode_heartbeat",
                                      "encode_permit",
                                      "encode_hints",
                                      "encode_operator_status",
                                      "encode_quick_stop",
                                      "encode_session",
                                      "encode_stop",
                                      "encode_sync"};
    EXPECT_EQ(found, known);
}

/// What the lines of a sample say, all together.
struct ShownSample {
    AxisSnapshot snapshot, before;
    PathPoints look_ahead;
    std::uint32_t counter = 0;
    std::uint32_t look_ahead_samples = 0;
    std::set<std::uint32_t> axes;  // whose position is shown
};

constexpr double kRadiansPerDegree = kPi / 180.0;

void read_axes(const Machine& machine, Words& words, ShownSample& shown) {
    for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
        const Axis& axis = machine.axes[i];
        const double unit = axis.kind == AxisKind::rotary ? kRadiansPerDegree : 1;
        const auto value = [&](const std::string& key) { return unit * words.number(key); };
        if (words.has(axis.name)) {
            shown.snapshot.position[i] = value(axis.name);
            shown.axes.insert(i);
        }
        if (words.has(axis.name + " ahead")) {
            shown.look_ahead.position[i] = value(axis.name + " ahead");
            shown.look_ahead.before[i] = value(axis.name + " before");
        }
        if (words.has(axis.name + " speed")) {
            shown.before.position[i] = value(axis.name + " speed");
        }
    }
}

ShownSample read_sample(const Machine& machine, const std::vector<FrameLine>& lines) {
    ShownSample shown;
    AxisSnapshot& snapshot = shown.snapshot;
    snapshot.latched_us = 1'000'000;
    snapshot.axis_count = static_cast<std::uint32_t>(machine.axes.size());
    for (const FrameLine& line : lines) {
        Words words(line.words);
        if (words.name == "SYNC" && words.has("counter")) {
            snapshot.sample = words.integer<std::uint64_t>("counter") - 1;
        } else if (words.has("counter")) {
            shown.counter = words.integer<std::uint32_t>("counter");
        }
        read_axes(machine, words, shown);
        if (words.has("mode")) {
            snapshot.mode = words.integer<std::uint8_t>("mode");
        }
        snapshot.tool = words.has("tool") ? words.integer<std::uint16_t>("tool") : snapshot.tool;
        snapshot.flags = words.has("flags") ? words.integer<std::uint8_t>("flags") : snapshot.flags;
        snapshot.latched_us =
            words.has("clock") ? words.integer<std::int64_t>("clock") : snapshot.latched_us;
        if (words.has("m")) {
            shown.look_ahead_samples = words.integer<std::uint32_t>("m");
        }
        if (words.has("sample index")) {  // compared with what the frame decodes to
            EXPECT_EQ(words.integer<std::uint64_t>("sample index"),
                      machine.can.format == CanFormat::classical
                          ? snapshot.sample % kSyncCounterMax % 16
                          : sync_counter_of(snapshot.sample));
        }
        if (words.has("k")) {
            EXPECT_EQ(words.integer<std::uint64_t>("k"), sync_counter_of(snapshot.sample));
        }
        if (words.has("homed")) {
            EXPECT_EQ(words.text("homed"), "yes");
        }
        for (const Axis& axis : machine.axes) {
            if (words.has(axis.name + " status")) {  // the first that its drive maps
                EXPECT_EQ(words.integer<std::uint32_t>(axis.name + " status"),
                          line.frame.data[0] | line.frame.data[1] << 8U);
            }
        }
        words.expect_all_used();
    }
    // What the axes did in the period before is known by their speed.
    const double period_s = machine.can.sample_us * 1.0e-6;
    for (std::uint32_t i = 0; i < snapshot.axis_count; ++i) {
        shown.before.position[i] = snapshot.position[i] - shown.before.position[i] * period_s;
    }
    shown.before.axis_count = snapshot.axis_count;
    shown.before.latched_us = snapshot.latched_us - machine.can.sample_us;
    shown.before.sample = snapshot.sample;
    shown.before.mode = snapshot.mode;
    return shown;
}

/// The frames of one sample as a simulated board sends them, its heartbeat apart.
std::vector<CanFrame> encoded(const Machine& machine, const ShownSample& shown) {
    AxisEncoder encoder(machine);
    std::vector<CanFrame> frames(kFramesPerSnapshotMax);
    for (std::uint32_t i = 0; i < std::max(1U, shown.counter); ++i) {
        EXPECT_EQ(encoder.encode(shown.before, frames, &shown.look_ahead).status, EncodeStatus::ok);
    }
    const EncodeResult result = encoder.encode(shown.snapshot, frames, &shown.look_ahead);
    EXPECT_EQ(result.status, EncodeStatus::ok) << result.axis;
    frames.resize(result.frame_count);
    std::erase_if(frames,
                  [&](const CanFrame& frame) { return frame.id == machine.can.heartbeat_in_id; });
    return frames;
}

/// The guard reads in each line what is said beside it.
void expect_decoded(const Machine& machine, const std::vector<FrameLine>& lines,
                    const ShownSample& shown) {
    const AxisFrameSet set = make_frame_set(machine);
    std::set<std::uint32_t> axes;
    for (const FrameLine& line : lines) {
        const std::uint32_t slot = slot_of(set, line.frame);
        LookAheadFrameContent ahead;
        if (decode_look_ahead_frame(set, line.frame, ahead) == FrameStatus::ok) {
            EXPECT_EQ(ahead.samples, shown.look_ahead_samples);
            EXPECT_EQ(ahead.sync_counter, sync_counter_of(shown.snapshot.sample));
            EXPECT_NEAR(ahead.position[0], shown.look_ahead.position[0], 1.0e-9);
            EXPECT_NEAR(ahead.before[0], shown.look_ahead.before[0], 1.0e-9);
            continue;
        }
        if (line.words.starts_with("SYNC")) {
            EXPECT_EQ(line.frame.id, set.sync_id);
            continue;
        }
        AxisFrameContent content;
        ASSERT_EQ(decode_axis_frame(set, slot, line.frame, content), FrameStatus::ok) << line.words;
        for (std::uint32_t i = 0; i < content.value_count; ++i) {
            const auto& value = content.values[i];
            EXPECT_NEAR(value.position, shown.snapshot.position[value.axis], 1.0e-4) << line.words;
            axes.insert(value.axis);
        }
        if (content.has_tool) {
            EXPECT_EQ(content.tool, shown.snapshot.tool);
        }
        if (set.wire->format != CanFormat::cia402 && content.has_status) {
            EXPECT_EQ(content.mode, shown.snapshot.mode);
        }
        EXPECT_EQ(content.drive_in_fault, kNoIndex);
    }
    EXPECT_EQ(axes.size(), machine.axes.size());
    EXPECT_EQ(axes, shown.axes);
}

// The whole sample is shown, in the order in which a board sends it.
void expect_sample_shown(const std::string& format, const Machine& machine) {
    SCOPED_TRACE(format);
    const auto blocks = blocks_of(page_of("reference/protocol.md"), "frames " + format);
    ASSERT_EQ(blocks.size(), 1U);
    const auto lines = frame_lines(blocks[0]);
    const ShownSample shown = read_sample(machine, lines);
    const auto frames = encoded(machine, shown);
    ASSERT_EQ(lines.size(), frames.size()) << "every frame of a sample";
    for (std::size_t i = 0; i < frames.size(); ++i) {
        EXPECT_EQ(lines[i].bytes, page_bytes(frames[i])) << lines[i].words;
    }
    expect_decoded(machine, lines, shown);
}

// As the page has it: the drive of X maps status word and position.
constexpr const char* kDriveOfX = R"([DeviceComissioning]
NodeID=3
[1800sub1]
DefaultValue=$NODEID+0x180
[1800sub2]
DefaultValue=1
[1A00sub0]
DefaultValue=2
[1A00sub1]
DefaultValue=0x60410010
[1A00sub2]
DefaultValue=0x60640020
)";

TEST(ProtocolPage, ASampleOfEachFormatIsShownByteByByte) {
    const auto dbc = blocks_of(page_of("reference/machine-file.md"), "dbc");
    ASSERT_EQ(dbc.size(), 1U);
    Machine classical = example_machine(0);
    expect_sample_shown("classical", classical);
    expect_sample_shown("fd", example_machine(6));
    expect_sample_shown("signals", example_machine(3));
    expect_sample_shown("dbc", example_machine(4, dbc[0]));
    expect_sample_shown("cia402", example_machine(5, kDriveOfX));
}

// Nothing else is fenced as frames, or it would be held by no test.
TEST(ProtocolPage, NoBlockOfFramesIsOfAnUnknownFormat) {
    const std::string page = page_of("reference/protocol.md");
    const std::regex fence("```frames([^\n]*)\n");
    std::multiset<std::string> tags;
    for (std::sregex_iterator at(page.begin(), page.end(), fence), end; at != end; ++at) {
        tags.insert((*at)[1]);
    }
    tags.erase("");
    EXPECT_EQ(tags,
              (std::multiset<std::string>{" cia402", " classical", " dbc", " fd", " signals"}));
}

}  // namespace
}  // namespace axg
