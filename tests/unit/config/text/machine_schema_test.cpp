// SPDX-License-Identifier: Apache-2.0
// ctest-labels: long
// The schema that editors use and the loader that decides must not drift apart: the same files, the
// same keys.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wrestrict"  // false alarm in std::string, GCC bug 105329
#endif
#include <gtest/gtest.h>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>

#include "config/machine/machine_keys.hpp"
#include "config/text/fault_list.hpp"
#include "config/text/number_text.hpp"
#include "config/text/yaml_tree.hpp"
#include "tests/support/dbc_text.hpp"
#include "tests/support/drive_text.hpp"
#include "tests/support/machine_text.hpp"

namespace axg::test {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

std::string read(const fs::path& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
}

Json schema_document() {
    return Json::parse(read(AXG_SOURCE_DIR "/config/schema/machine.schema.json"));
}

/// As a YAML editor sees a value.
Json json_of(const YamlNode& node) {
    switch (node.kind) {
        case YamlNode::Kind::scalar:
            if (node.is_quoted) {
                return node.text;
            }
            if (const auto whole = hex_number(node.text)) {
                return *whole;
            }
            if (const auto number = decimal_number(node.text)) {
                return *number;
            }
            if (node.text == "true" || node.text == "false") {
                return node.text == "true";
            }
            return node.text;
        case YamlNode::Kind::sequence: {
            Json list = Json::array();
            for (const YamlEntry& entry : node.entries) {
                list.push_back(json_of(entry.value));
            }
            return list;
        }
        case YamlNode::Kind::map: {
            Json map = Json::object();
            for (const YamlEntry& entry : node.entries) {
                map[entry.key] = json_of(entry.value);
            }
            return map;
        }
        default:
            return nullptr;
    }
}

Json json_of(const std::string& text) {
    FaultList faults{"m"};
    YamlNode root;
    EXPECT_TRUE(parse_yaml(text, faults, root));
    return json_of(root);
}

/// What the schema has against a document; empty when nothing.
std::string objections(const Json& document) {
    static const Json schema_json = schema_document();
    valijson::Schema schema;
    valijson::SchemaParser parser;
    parser.populateSchema(valijson::adapters::NlohmannJsonAdapter(schema_json), schema);
    valijson::Validator validator;
    valijson::ValidationResults results;
    const valijson::adapters::NlohmannJsonAdapter target(document);
    if (validator.validate(schema, target, &results)) {
        return "";
    }
    std::string out = "invalid\n";
    valijson::ValidationResults::Error error;
    while (results.popError(error)) {
        for (const std::string& part : error.context) {
            out += part;
        }
        out += ": " + error.description + '\n';
    }
    return out;
}

std::string signal_machine() {
    const std::string text = kSmallMachine;
    const std::size_t begin = text.find("can:\n");
    return text.substr(0, begin) + R"(can:
  format: signals
  signals:
    X: {id: 0x181, start: 0, length: 32, order: little, signed: true, factor: 1.0e-4, unit: mm}
    A: {id: 0x182, start: 7, length: 32, order: big, signed: true, factor: 1.0e-4, unit: deg}
    C: {id: 0x182, start: 39, length: 32, order: big, signed: true, factor: 1.0e-4, unit: deg}
)";
}

std::string shape_machine() {
    const std::string text =
        with(kSmallMachine, "mesh: {file: base.stl, unit: mm}", R"(mesh: {shapes: [
     {box_mm: [200, 100, 30]}, {cylinder: {radius_mm: 1, height_mm: 50}, segments: 12},
     {cone: {radius_mm: 2, top_radius_mm: 1, height_mm: 7}, at_mm: [0, 0, 1]},
     {sphere: {radius_mm: 3}, rotate_deg: [0, 90, 0]}]})");
    return with(text, "mesh: {file: tool.stl, unit: mm}", R"(sections: [
     {name: flutes, cylinder: {radius_mm: 4, height_mm: 20}, at_mm: [0, 0, -50]},
     {name: holder, profile_mm: [[0, -30], [9, -30], [0, 0]], segments: 16}])");
}

TEST(MachineSchema, AcceptsWhatTheLoaderAccepts) {
    EXPECT_EQ(faults_of(shape_machine()), "");
    EXPECT_EQ(objections(json_of(shape_machine())), "");
    EXPECT_EQ(objections(json_of(kSmallMachine)), "");
    EXPECT_EQ(faults_of(signal_machine()), "");
    EXPECT_EQ(objections(json_of(signal_machine())), "");
    EXPECT_EQ(faults_with_file(dbc_machine(), kBoardDbc), "");
    EXPECT_EQ(objections(json_of(dbc_machine())), "");
    EXPECT_EQ(faults_with_file(drive_machine(), kDriveEds), "");
    EXPECT_EQ(objections(json_of(drive_machine())), "");
}

TEST(MachineSchema, EveryExampleLoadsAndFollowsIt) {
    int count = 0;
    const fs::path folder = AXG_SOURCE_DIR "/config/machines";
    for (const auto& entry : fs::directory_iterator(fs::exists(folder) ? folder : fs::path("."))) {
        if (entry.path().extension() != ".yaml" || !fs::exists(folder)) {
            continue;
        }
        ++count;
        const std::string text = read(entry.path());
        EXPECT_EQ(faults_of(text), "") << entry.path();
        EXPECT_EQ(objections(json_of(text)), "") << entry.path();
        EXPECT_TRUE(
            text.starts_with("# yaml-language-server: $schema=../schema/machine.schema.json\n"))
            << entry.path() << ": the modeline comes first, so that editors check as one types";
    }
    std::printf("%d examples\n", count);
    if (count == 0) {
        GTEST_SKIP() << "config/machines holds no example yet";
    }
}

/// One way to reach each map of the format: the place in the schema, and a text with `@` where a
/// key can be added.
struct MapPlace {
    const char* definition;  // in the schema; "" is the top
    const char* section;     // below it, "" for itself
    std::string text;
};

std::vector<MapPlace> maps() {
    const std::string s = kSmallMachine;
    return {
        {"", "", with(s, "version: 1\n", "version: 1\n@: 1\n")},
        {"linear_axis", "", with(s, "{kind: linear,", "{@: 1, kind: linear,")},
        {"rotary_axis", "", with(s, "{kind: rotary,", "{@: 1, kind: rotary,")},
        {"body", "", with(s, "{name: slide,", "{@: 1, name: slide,")},
        {"mesh", "", with(s, "{file: slide.stl,", "{@: 1, file: slide.stl,")},
        {"tool", "", with(s, "{number: 1,", "{@: 1, number: 1,")},
        {"shape", "", with(shape_machine(), "{box_mm:", "{@: 1, box_mm:")},
        {"cylinder", "", with(shape_machine(), "{radius_mm: 1,", "{@: 1, radius_mm: 1,")},
        {"cone", "", with(shape_machine(), "{radius_mm: 2,", "{@: 1, radius_mm: 2,")},
        {"sphere", "", with(shape_machine(), "{radius_mm: 3}", "{@: 1, radius_mm: 3}")},
        {"section", "", with(shape_machine(), "{name: flutes,", "{@: 1, name: flutes,")},
        {"pair", "", with(s, "{a: cutter,", "{@: 1, a: cutter,")},
        {"exclusion", "", with(s, "{a: slide,", "{@: 1, a: slide,")},
        {"can", "", with(s, "can:\n", "can:\n  @: 1\n")},
        {"can", "ids", with(s, "{sync:", "{@: 1, sync:")},
        {"can", "ahead",
         with(s, "format: classical\n", "format: fd\n  ahead: {@: 1, samples: 9}\n")},
        {"signal", "", with(signal_machine(), "{id: 0x181,", "{@: 1, id: 0x181,")},
        {"can", "status", with(dbc_machine(), "status:\n", "status:\n    @: 1\n")},
        {"dbc_axis", "", with(dbc_machine(), "{signal: Tilt.C,", "{@: 1, signal: Tilt.C,")},
        {"dbc_state", "",
         with(dbc_machine(), "{signal: Linear.State, is: 1", "{@: 1, signal: Linear.State, is: 1")},
        {"drive", "", with(drive_machine(), "{node: 3,", "{@: 1, node: 3,")},
        {"pdo", "", with(drive_machine(), "{cob_id:", "{@: 1, cob_id:")},
        {"drive_velocity", "",
         with(drive_machine(), "velocity: {counts:", "velocity: {@: 1, counts:")},
        {"", "program", with(s, "version: 1\n", "version: 1\nprogram: {@: 1}\n")},
        {"", "guard", with(s, "{promise:", "{@: 1, promise:")},
        {"", "capacities", with(s, "{node_pairs:", "{@: 1, node_pairs:")}};
}

// The loader lists its keys when it meets one it does not know; the schema has them as properties.
TEST(MachineSchema, KnowsExactlyTheKeysOfTheLoader) {
    const Json schema = schema_document();
    for (const MapPlace& map : maps()) {
        const Json* place = &schema;
        place = *map.definition == '\0' ? place : &schema["definitions"][map.definition];
        place = *map.section == '\0' ? place : &(*place)["properties"][map.section];
        std::set<std::string> in_schema;
        for (const auto& [key, value] : (*place)["properties"].items()) {
            in_schema.insert(key);
        }
        const std::string changed = with(map.text, "@", "qqqqqqqq");
        const std::string faults = faults_with_file(
            changed, map.text.find("format: dbc") == std::string::npos ? kDriveEds : kBoardDbc);
        const std::string lead = "unknown key (expected one of ";
        const std::size_t at = faults.find(lead);
        ASSERT_NE(at, std::string::npos) << map.definition << '.' << map.section << faults;
        std::string list = faults.substr(at + lead.size());
        list = list.substr(0, list.find(')'));
        std::set<std::string> in_loader;
        for (std::size_t begin = 0; begin < list.size();) {
            const std::size_t end = std::min(list.find(", ", begin), list.size());
            in_loader.insert(list.substr(begin, end - begin));
            begin = end + 2;
        }
        EXPECT_EQ(in_schema, in_loader) << map.definition << '.' << map.section;
        EXPECT_NE(objections(json_of(with(map.text, "@", "qqqqqqqq"))), "") << map.definition;
    }
}

// Each key misspelt, one after the other, in a file that holds them: both refuse.
TEST(MachineSchema, RefusesEachMisspeltKeyAsTheLoaderDoes) {
    int count = 0;
    for (const std::string& text :
         {std::string{kSmallMachine}, signal_machine(), shape_machine()}) {
        for (std::size_t colon = text.find(':'); colon != std::string::npos;
             colon = text.find(':', colon + 1)) {
            std::string broken = text;
            broken.insert(colon, 1, 'q');
            EXPECT_NE(faults_of(broken), "") << broken.substr(0, colon + 1);
            EXPECT_NE(objections(json_of(broken)), "") << broken.substr(0, colon + 1);
            ++count;
        }
    }
    std::printf("%d keys misspelt\n", count);
    EXPECT_GT(count, 150);
}

/// Whether the schema has the same kind of value for a row of a table, and the same range.
template <class Owner>
bool is_in(const Json& properties, const ScalarKey<Owner>& row) {
    Json rule = properties.value(row.key, Json::object());
    if (row.place != nullptr) {
        return rule["enum"] == Json(std::vector<std::string>(row.words.begin(), row.words.end()));
    }
    if (row.is_on != nullptr) {
        return rule["type"] == "boolean";
    }
    if (row.none != 0) {
        rule = rule["oneOf"][1];
    }
    if (rule.contains("enum")) {  // few whole numbers: each of them
        return rule["enum"].front() == row.range.min && rule["enum"].back() == row.range.max;
    }
    return rule["type"] == (row.whole != nullptr ? "integer" : "number") &&
           rule["minimum"] == row.range.min && rule["maximum"] == row.range.max;
}

template <class Owner>
void compare(ScalarKeys<Owner> table, const Json& properties) {
    for (const ScalarKey<Owner>& row : table) {
        EXPECT_TRUE(is_in(properties, row)) << row.key;
    }
}

TEST(MachineSchema, HasTheRangeOfEachScalarKey) {
    const Json schema = schema_document();
    const Json& top = schema["properties"];
    compare(top_keys(), top);
    compare(axis_keys(AxisKind::linear), schema["definitions"]["linear_axis"]["properties"]);
    compare(axis_keys(AxisKind::rotary), schema["definitions"]["rotary_axis"]["properties"]);
    const Json& body = schema["definitions"]["body"]["properties"];
    compare(joint_keys(AxisKind::rotary), body);
    compare(body_keys(), body);
    compare(tool_keys(), schema["definitions"]["tool"]["properties"]);
    const Json& guard = top["guard"]["properties"];
    compare(guard_keys(), guard);
    compare(jog_keys(), guard["single_jog"]["properties"]);
    const Json& capacities = top["capacities"]["properties"];
    compare(capacity_keys(), capacities);
    compare(batch_keys(), capacities["batch"]["properties"]);
    const Json& cycle = top["cycle"]["oneOf"][1]["properties"];
    compare(cycle_keys(), cycle);
    compare(list_keys(), cycle["lists"]["properties"]);
}

TEST(MachineSchema, EveryKeyIsExplained) {
    const auto check = [](const auto& self, const Json& place, const std::string& path) -> void {
        if (place.is_object() && place.contains("properties") && place.contains("type")) {
            for (const auto& [key, value] : place["properties"].items()) {
                EXPECT_TRUE(value.contains("description") || value.contains("$ref"))
                    << path << '.' << key;
            }
        }
        if (place.is_structured()) {
            for (const auto& [key, value] : place.items()) {
                self(self, value, path + '.' + key);
            }
        }
    };
    check(check, schema_document(), "");
}

}  // namespace
}  // namespace axg::test
