// SPDX-License-Identifier: Apache-2.0
// The lines that a stop advises are followed: each is put into the machine file as a person would,
// with an editor, and the same command runs again. The stop is as much nearer as was printed, or
// gone. Runs axguard itself, for every shipped program that stops and the README's example.
// ctest-labels: long
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <ostream>
#include <string>

#include "firmware_if/cli/exit_codes.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/machine_text.hpp"
#include "tests/support/replay_fixture.hpp"
#include "tests/support/screen.hpp"

namespace axg::test {
namespace {

constexpr double kAgreesMm = 0.1;
constexpr double kBoardSampleS = 1e-3;

/// A machine, a program that stops, and whether the command drives it or replays its trace.
struct Advised {
    const char *name, *machine, *program;
    bool is_driven;
    bool has_advice;  // a setting that gains
};
std::ostream& operator<<(std::ostream& out, const Advised& row) {
    return out << row.name;
}

const std::string kGuessed = "G21 G90\nG0 X60\nG0 Z-300\nM2\n";

/// The README's second step, as its sed does it.
std::string edited(std::string text) {
    const std::string z = "  Z: {slot: 2, kind: linear, travel_mm: [-200, 200]";
    text = with(std::move(text), z, "  Z: {slot: 2, kind: linear, travel_mm: [-380, 60]");
    for (const std::string body : {"\n  - name: a\n", "\n  - name: c\n"}) {
        const std::size_t at = text.find(body), end = text.find("mesh:", at);
        for (std::size_t key = text.find("_mm: [0, 0, ", at); key < end;
             key = text.find("_mm: [0, 0, ", key + 1)) {
            text.replace(key, text.find(']', key) + 1 - key, "_mm: [0, 0, -380]");
        }
    }
    return text;
}

/// "{a: b, c: {d: e}}" without its outer braces.
std::string inside(const std::string& braced) {
    return braced.substr(1, braced.size() - 2);
}

/// A key of a map in one line, with its value: until the comma or brace at its own depth.
std::size_t end_of_value(const std::string& text, std::size_t at) {
    int depth = 0;
    while (at < text.size() && !(depth == 0 && (text[at] == ',' || text[at] == '}'))) {
        depth += text[at] == '{' || text[at] == '['   ? 1
                 : text[at] == '}' || text[at] == ']' ? -1
                                                      : 0;
        ++at;
    }
    return at;
}

/// Replaces the values of an axis that stands in one line: "Z: {speed_mm_min: 5000}".
std::string with_axis(std::string text, const std::string& change) {
    const std::string name = change.substr(0, change.find(':'));
    std::size_t line = text.find("\n  " + name + ": {");
    EXPECT_NE(line, std::string::npos) << change;
    std::string keys = inside(change.substr(change.find('{')));
    while (!keys.empty()) {
        const std::size_t end = end_of_value(keys, 0), colon = keys.find(':');
        const std::string key = keys.substr(0, colon);
        const std::size_t at = text.find(key + ": ", line);
        EXPECT_LT(at, text.find('\n', line + 1)) << change;
        text.replace(at, end_of_value(text, at) - at, keys.substr(0, end));
        keys.erase(0, std::min(keys.size(), end + 2));
    }
    return text;
}

/// The machine file with a printed line: its keys stand below the section, in place of old ones.
std::string followed(std::string text, const std::string& line) {
    const std::string section = line.substr(0, line.find(':'));
    std::string keys = inside(line.substr(line.find('{')));
    if (section == "axes") {
        return with_axis(std::move(text), keys);
    }
    const std::size_t head = text.find("\n" + section + ":");
    if (head == std::string::npos) {
        return text + line + "\n";
    }
    const std::size_t below = text.find('\n', head + 1) + 1;
    while (!keys.empty()) {
        const std::size_t end = end_of_value(keys, 0);
        const std::string key = "\n  " + keys.substr(0, keys.find(':')) + ":";
        if (const std::size_t old = text.find(key, head); old != std::string::npos) {
            text.erase(old + 1, text.find('\n', old + 1) - old);
        }
        text.insert(below, "  " + keys.substr(0, end) + "\n");
        keys.erase(0, std::min(keys.size(), end + 2));
    }
    return text;
}

class Advice : public testing::TestWithParam<Advised> {
  protected:
    void SetUp() override {
        const bool is_readme = GetParam().machine == std::string("readme");
        if (is_readme) {
            machine = edited(written_machine());
            program = shop.write("down.ngc", kGuessed);
        } else {
            const std::string name = std::string("config/machines/") + GetParam().machine + ".yaml";
            machine = content_of(source_file(name));
            program =
                source_file(std::string("hil_replay/programs/") + GetParam().program + ".ngc");
            options = " --mesh-root " + source_file("config/machines");
        }
        (void)shop.write("machine.yaml", machine);
    }

    /// The machine file that init writes for the example's meshes.
    std::string written_machine() {
        std::filesystem::copy(source_file("config/machines/meshes/paper-trunnion"),
                              shop.file("meshes"));
        EXPECT_EQ(shop.run("init meshes -o machine.yaml --unit mm"), kExitClean) << shop.err;
        options = "";
        return content_of(shop.file("machine.yaml"));
    }

    /// Where the run ends: of a drive the whole document, of a replay its first stop.
    Json run(bool is_driven, const std::string& file, const std::string& more) {
        if (is_driven) {
            (void)shop.run("drive " + file + options + " " + program + more + " --json=end.json");
            return Json::parse(content_of(shop.file("end.json")));
        }
        if (!std::filesystem::exists(shop.file("trace.log"))) {
            EXPECT_EQ(shop.run("simulate " + file + options + " " + program + " -o trace.log"),
                      kExitClean)
                << shop.err;
        }
        (void)shop.run("replay " + file + options + " trace.log --deadline-us 10000000" + more +
                       " --json=end.json");
        const Json all = Json::parse(content_of(shop.file("end.json")));
        return all["stops"].empty() ? Json() : all["stops"][0];
    }

    static const Json& why_of(const Json& end) {
        return end.contains("guard_stop") ? end["guard_stop"]["why"] : end["why"];
    }
    static std::uint64_t sample_of(const Json& end) {
        return (end.contains("guard_stop") ? end["guard_stop"] : end)["sample"]
            .get<std::uint64_t>();
    }
    static bool is_stopped(const Json& end) {
        return end.is_object() && (end.contains("guard_stop") || end.contains("reason"));
    }

    void expect_follows(const Json& setting, const Json& first) {
        std::string text = machine;
        std::string lines;
        for (const Json& line : setting["lines"]) {
            text = followed(text, line.get<std::string>());
            lines += line.get<std::string>() + "\n";
        }
        (void)shop.write("followed.yaml", text);
        const Json end = run(setting["driven"].get<bool>(), "followed.yaml", " --advice-s 0");
        if (setting["gone"].get<bool>()) {
            const bool is_later =
                !is_stopped(end) || static_cast<double>(sample_of(end)) >=
                                        static_cast<double>(sample_of(first)) +
                                            setting["after_s"].get<double>() / kBoardSampleS;
            EXPECT_TRUE(is_later) << lines << end;
            return;
        }
        ASSERT_TRUE(is_stopped(end)) << lines << shop.err;
        EXPECT_NEAR(why_of(end)["available_mm"].get<double>(), setting["left_mm"].get<double>(),
                    kAgreesMm)
            << lines;
        // A trace and a drive of the same program stop at one sample more or less.
        EXPECT_NEAR(
            why_of(first)["available_mm"].get<double>() - why_of(end)["available_mm"].get<double>(),
            setting["gain_mm"].get<double>(), kAgreesMm)
            << lines;
    }

    Workshop shop;
    std::string machine, program, options;
};

TEST_P(Advice, MovesTheStopAsPrintedWhenItIsFollowed) {
    const Json first = run(GetParam().is_driven, "machine.yaml", "");
    EXPECT_LE(lines_of(shop.out).size(), kScreenLines) << shop.out;
    ASSERT_TRUE(is_stopped(first)) << shop.out << shop.err;
    const Json& advice = why_of(first)["advice"];
    ASSERT_TRUE(advice.is_object()) << first;
    EXPECT_EQ(!advice["settings"].empty(), GetParam().has_advice) << advice;
    double before_mm = 1e9;
    for (const Json& setting : advice["settings"]) {
        if (!setting["gone"].get<bool>()) {
            const double gain_mm = setting["gain_mm"].get<double>();
            EXPECT_GE(gain_mm, 0.5);
            EXPECT_LE(gain_mm, before_mm) << "best first";
            before_mm = gain_mm;
        }
        expect_follows(setting, first);
    }
}

TEST_P(Advice, CanBeLeftOut) {
    const Json first = run(GetParam().is_driven, "machine.yaml", " --advice-s 0");
    ASSERT_TRUE(is_stopped(first)) << shop.out << shop.err;
    EXPECT_FALSE(why_of(first).contains("advice"));
    EXPECT_EQ(shop.out.find("nearer"), std::string::npos) << shop.out;
}

const Advised kAdvised[] = {
    {"ReadmeTrace", "readme", "", false, true},
    {"ReadmeDrive", "readme", "", true, true},
    {"DemoTrace", "paper-trunnion", "paper-trunnion-demo", false, true},
    {"DemoDrive", "paper-trunnion", "paper-trunnion-demo", true, true},
    {"NearTrace", "paper-trunnion", "paper-trunnion-near", false, false},
    {"NearDrive", "paper-trunnion", "paper-trunnion-near", true, true},
    {"ProbeTrace", "table-spindle-tilting", "table-spindle-tilting-near", false, false},
    {"ProbeDrive", "table-spindle-tilting", "table-spindle-tilting-near", true, true}};

INSTANTIATE_TEST_SUITE_P(Each, Advice, testing::ValuesIn(kAdvised),
                         [](const auto& row) { return std::string(row.param.name); });

/// A kind of advice, and how a feed of mm/min is the program's or the machine's.
class SlowerFeed : public Advice {
  protected:
    void expect_nearer_or_equal(const std::string& line, bool is_limit) {
        const std::string given = followed(machine, line);
        double before_mm = 1e9;
        for (const int feed : {10'000, 9'000, 7'600, 6'000, 4'000, 2'000}) {
            const std::string text =
                is_limit ? followed(given, fmt::format("axes: {{Z: {{speed_mm_min: {}}}}}", feed))
                         : given;
            (void)shop.write("slower.yaml", text);
            program = shop.write(
                "slower.ngc",
                is_limit ? kGuessed : fmt::format("G21 G90\nG0 X60\nG1 Z-300 F{}\nM2\n", feed));
            std::filesystem::remove(shop.file("trace.log"));
            const Json end = run(GetParam().is_driven, "slower.yaml", " --advice-s 0");
            const double left_mm = why_of(end)["available_mm"].get<double>();
            EXPECT_LE(left_mm, before_mm + 1e-3) << line << " at " << feed;
            before_mm = left_mm;
        }
    }
};

// The unknown acceleration counts below the axis limit, so with free_jerk: any a slower feed may
// stop earlier. What is advised instead never does.
TEST_P(SlowerFeed, StopsNoEarlierWithWhatIsAdvised) {
    if (GetParam().is_driven) {
        expect_nearer_or_equal("guard: {cap: all_axes, free_jerk: limited}", false);
        return;
    }
    expect_nearer_or_equal("guard: {free_jerk: limited}", false);
    expect_nearer_or_equal("guard: {free_jerk: any}", true);
}

INSTANTIATE_TEST_SUITE_P(Readme, SlowerFeed, testing::Values(kAdvised[0], kAdvised[1]),
                         [](const auto& row) { return std::string(row.param.name); });

}  // namespace
}  // namespace axg::test
