// SPDX-License-Identifier: Apache-2.0
#include "config/init/linuxcnc_ini.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <map>
#include <utility>

#include "config/machine/program_settings.hpp"
#include "config/text/fault_text.hpp"
#include "config/text/quote_text.hpp"
#include "core/base/sincos.hpp"

namespace axg {
namespace {

constexpr double kNoLimit = 1e9;         // LinuxCNC's default limits are +-1e99
constexpr double kLinearMm = 8388.607;   // what a frame can hold; farther limits are no machine's
constexpr double kRotaryDeg = 838.8607;  // the same
constexpr double kTurnsDeg = 10 * 360;   // a rotary axis that may go farther does not end
constexpr std::string_view kAxisLetters = "XYZABCUVW";
constexpr double kPeriodNsMin = 50e3, kPeriodNsMax = 100e6;  // what can.sample_us can be
constexpr std::uint32_t kIncludesMax = 64;  // an include that includes itself ends here
constexpr std::size_t kIncludeBytesMax = 1U << 20U;
constexpr auto kLeast = [](double a, double b) { return std::min(a, b); };
constexpr auto kMost = [](double a, double b) { return std::max(a, b); };
/// Kinematics whose joints are slides and turntables, with the default letters of their joints
/// (without `coordinates=`). Only with trivkins are the axes the joints.
struct Kinematics {
    std::string_view name, letters;
};
constexpr std::array<Kinematics, 8> kKinematics{{{"trivkins", "XYZABCUVW"},
                                                 {"xyzac-trt-kins", "XYZAC"},
                                                 {"xyzbc-trt-kins", "XYZBC"},
                                                 {"xyzab_tdr_kins", "XYZAB"},
                                                 {"5axiskins", "XYZBCW"},
                                                 {"maxkins", "XYZABCUVW"},
                                                 {"xyzacb_trsrn", "XYZABC"},
                                                 {"xyzbca_trsrn", "XYZABC"}}};

/// Why other kinematics are not read. Source: LinuxCNC 2.10, src/emc/kinematics and
/// src/hal/components.
struct Unread {
    std::string_view name, reason;
};
constexpr std::string_view kParallel =
    "its struts move one platform together, and bodies here are carried one by one";
constexpr std::string_view kArm = "its joints are those of an arm, and X, Y and Z are none of them";
constexpr std::array<Unread, 12> kUnread{
    {{"genhexkins", kParallel},
     {"lineardeltakins", kParallel},
     {"rotarydeltakins", kParallel},
     {"pentakins", kParallel},
     {"tripodkins", kParallel},
     {"genserkins", kArm},
     {"pumakins", kArm},
     {"scarakins", kArm},
     {"scorbot-kins", kArm},
     {"corexykins", "both motors move X as well as Y, so no joint is the place of a slide"},
     {"rosekins", "X and Y become a radius and an angle, so a slide has another place than X"},
     {"millturn", "M428 and M429 exchange the joints of its axes"}}};

struct Value {
    std::string text, file;
    std::uint32_t line = 0;
};
using Sections = std::map<std::string, std::map<std::string, Value>>;

std::string_view trimmed(std::string_view text) {
    const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
    while (!text.empty() && is_blank(text.front())) {
        text.remove_prefix(1);
    }
    while (!text.empty() && is_blank(text.back())) {
        text.remove_suffix(1);
    }
    return text;
}

std::string upper(std::string_view text) {
    std::string out(text);
    std::transform(out.begin(), out.end(), out.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    return out;
}

class SectionReader {
  public:
    SectionReader(const NamedFiles& includes, std::vector<std::string>& faults)
        : includes_(includes), faults_(faults) {}

    /// The first value of a name counts, as in LinuxCNC.
    void read(std::string_view text, const std::string& name) {
        std::uint32_t number = 0;
        while (!text.empty()) {
            const std::size_t end = std::min(text.find('\n'), text.size());
            const std::string_view line = trimmed(text.substr(0, end));
            text.remove_prefix(std::min(end + 1, text.size()));
            ++number;
            const std::size_t equals = line.find('=');
            if (line.starts_with("#INCLUDE")) {
                include(trimmed(line.substr(8)), name + ':' + std::to_string(number));
            } else if (line.empty() || line.front() == '#' || line.front() == ';') {
                continue;
            } else if (line.front() == '[') {
                section_ = upper(line.substr(1, line.find(']') - 1));
            } else if (equals != std::string_view::npos) {
                const std::string_view value = trimmed(line.substr(equals + 1));
                sections_[section_].try_emplace(upper(trimmed(line.substr(0, equals))),
                                                Value{std::string(value), name, number});
            }
        }
    }

    [[nodiscard]] const Sections& sections() const noexcept { return sections_; }

  private:
    void include(std::string_view file, const std::string& place) {
        const std::string name(file);
        NamedFile included{"", "too many files", "at most 64 included files"};
        if (++includes_count_ <= kIncludesMax) {
            included = includes_(name, kIncludeBytesMax);
        }
        if (included.got.empty()) {
            read(included.text, name);
        } else if (includes_count_ <= kIncludesMax + 1) {
            faults_.push_back(place + ": #INCLUDE " + quoted(name, 200) + ": " +
                              fault_text("invalid file", included.got, included.wanted));
        }
    }

    const NamedFiles& includes_;
    std::vector<std::string>& faults_;
    Sections sections_;
    std::string section_;
    std::uint32_t includes_count_ = 0;
};

/// As C's strtod would read it, the whole word.
std::optional<double> number_of(std::string_view word) {
    if (word.starts_with('+')) {
        word.remove_prefix(1);
    }
    double value = 0;
    const auto read = std::from_chars(word.data(), word.data() + word.size(), value);
    const bool is_whole = read.ec == std::errc{} && read.ptr == word.data() + word.size();
    return is_whole && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

/// The letters in `text`, in order, upper case.
std::string letters_in(std::string_view text) {
    std::string out;
    for (const char c : upper(text)) {
        if (kAxisLetters.find(c) != std::string_view::npos) {
            out += c;
        }
    }
    return out;
}

class Reader {
  public:
    Reader(const Sections& sections, const std::string& name, const NamedFiles& files)
        : sections_(sections), name_(name), files_(files) {}

    IniAxes read(std::vector<std::string> faults) {
        out_.faults = std::move(faults);
        const Value* coordinates = find("TRAJ", "COORDINATES");
        read_units();
        if (coordinates == nullptr) {
            fault("TRAJ", "COORDINATES", nullptr, "the letters of the axes, such as XYZAC");
        }
        const std::string letters =
            coordinates == nullptr ? "" : letters_in(without_comment(coordinates->text));
        if (coordinates != nullptr) {
            check_letters(*coordinates);
        }
        read_kinematics(letters);
        read_period();
        if (!out_.faults.empty()) {
            return std::move(out_);
        }
        for (const char letter : letters) {
            const bool is_known = std::any_of(
                out_.axes.begin(), out_.axes.end(),
                [letter](const IniAxis& axis) { return axis.name == std::string(1, letter); });
            if (!is_known) {
                take_axis(letter);
            }
        }
        read_program();
        read_tools();
        return std::move(out_);
    }

  private:
    const Value* find(const std::string& section, const std::string& key) const {
        const auto in = sections_.find(section);
        if (in == sections_.end()) {
            return nullptr;
        }
        const auto value = in->second.find(key);
        return value == in->second.end() ? nullptr : &value->second;
    }

    static std::string_view without_comment(std::string_view text) {
        return trimmed(text.substr(0, text.find_first_of("#;")));
    }

    /// Reads the length of the machine's linear unit in mm. Angles are in degrees.
    void read_units() {
        constexpr const char* kWanted = "mm or inch";
        const Value* linear = find("TRAJ", "LINEAR_UNITS");
        const std::string unit = linear == nullptr ? "" : upper(without_comment(linear->text));
        const bool is_inch = unit == "INCH" || unit == "IN" || unit == "IMPERIAL";
        const double per_mm = number_of(unit).value_or(0);  // LinuxCNC also accepts units in a mm
        if (unit == "MM" || unit == "METRIC") {
            linear_ = 1;
        } else if (is_inch) {
            linear_ = 25.4;
        } else if (per_mm > 0) {
            linear_ = 1 / per_mm;
        } else {
            fault("TRAJ", "LINEAR_UNITS", linear, kWanted);
        }
        const Value* angular = find("TRAJ", "ANGULAR_UNITS");
        const std::string angle =
            angular == nullptr ? "DEG" : upper(without_comment(angular->text));
        const double per_degree = number_of(angle).value_or(0);
        if (angle != "DEG" && angle != "DEGREE" && std::abs(per_degree - 1) > 1e-9) {
            fault("TRAJ", "ANGULAR_UNITS", angular,
                  "degree: axguard_stop takes no other unit. Convert speeds and limits of the "
                  "rotary axes, too");
        }
    }

    /// Which joint is which axis; without the key as COORDINATES has them.
    void read_kinematics(const std::string& coordinates) {
        joints_ = coordinates;
        const Value* value = find("KINS", "KINEMATICS");
        if (value == nullptr) {
            return;
        }
        const std::string_view words = without_comment(value->text);
        const std::string_view name = words.substr(0, words.find_first_of(" \t"));
        const auto known = std::find_if(kKinematics.begin(), kKinematics.end(),
                                        [name](const Kinematics& one) { return one.name == name; });
        if (known == kKinematics.end()) {
            fault("KINS", "KINEMATICS", value, wanted_kinematics(name));
            return;
        }
        is_trivial_ = known == kKinematics.begin();
        joints_ = known->letters;
        if (name.ends_with("_trsrn")) {
            doubt(source_of(*value, "KINS", "KINEMATICS") + ": " +
                  (name == "xyzbca_trsrn" ? 'A' : 'B') +
                  " is tilted by the pin nut-angle; state its direction as three numbers");
        }
        if (name.ends_with("_trsrn") || words.find("identityfirst") != std::string_view::npos) {
            doubt(source_of(*value, "KINS", "KINEMATICS") +
                  ": M429 switches tool centre point control on and M428 off, and simulate reads "
                  "them the other way; exchange them in the program");
        }
        constexpr std::string_view kKey = "COORDINATES=";
        const std::string upper_words = upper(words);
        const std::size_t at = upper_words.find(kKey);
        if (at != std::string::npos) {
            const std::string_view rest = std::string_view(upper_words).substr(at + kKey.size());
            joints_ = letters_in(rest.substr(0, rest.find_first_of(" \t")));
        }
    }

    static std::string wanted_kinematics(std::string_view name) {
        std::string text;
        for (const Kinematics& one : kKinematics) {
            text += (text.empty() ? "" : &one == &kKinematics.back() ? " or " : ", ");
            text += one.name;
        }
        const auto unread = std::find_if(kUnread.begin(), kUnread.end(),
                                         [name](const Unread& one) { return one.name == name; });
        text += "; ";
        text += unread == kUnread.end() ? "what its joints are is not known here" : unread->reason;
        return text +
               ": run init on the folder of the STL files and state the limits of each moving part "
               "by hand";
    }

    /// LinuxCNC passes over other letters, and a misspelt axis would be missing.
    void check_letters(const Value& coordinates) {
        for (const char c : upper(without_comment(coordinates.text))) {
            if (c != ' ' && c != '\t' && kAxisLetters.find(c) == std::string_view::npos) {
                fault("TRAJ", "COORDINATES", &coordinates,
                      "letters of X Y Z A B C U V W only; remove " + quoted(std::string(1, c), 8));
                return;
            }
        }
    }

    /// Reads the period of the thread that moves the axes and sends the samples.
    void read_period() {
        const Value* value = find("EMCMOT", "SERVO_PERIOD");
        if (value == nullptr) {
            return;
        }
        const double period_ns = number_of(without_comment(value->text)).value_or(0);
        if (period_ns >= kPeriodNsMin && period_ns <= kPeriodNsMax &&
            period_ns == std::floor(period_ns)) {
            out_.servo_period_ns = static_cast<std::int64_t>(period_ns);
        } else {
            fault("EMCMOT", "SERVO_PERIOD", value, "50000 to 100000000, whole nanoseconds");
        }
    }

    void take_axis(char letter) {
        const std::size_t faults_before = out_.faults.size();
        IniAxis& axis = out_.axes.emplace_back();
        axis.name = std::string(1, letter);
        axis.is_rotary = letter >= 'A' && letter <= 'C';
        axis.follows_tip = !is_trivial_;
        scale_ = axis.is_rotary ? 1 : linear_;
        if (is_trivial_) {
            take(std::string("AXIS_") + letter, axis, axis, kLeast);
        }
        IniAxis joints;  // a gantry may do what either of its joints may
        for (std::size_t joint = 0; joint < joints_.size(); ++joint) {
            if (joints_[joint] == letter) {
                take("JOINT_" + std::to_string(joint), axis, joints, kMost);
            }
        }
        axis.is_gantry = std::count(joints_.begin(), joints_.end(), letter) > 1;
        combine(axis.speed, joints.speed, kLeast);
        combine(axis.acceleration, joints.acceleration, kLeast);
        const Value* wrapped = find(std::string("AXIS_") + letter, "WRAPPED_ROTARY");
        const bool is_wrapped = wrapped != nullptr && is_switched_on(wrapped->text);
        const bool has_end = (axis.min && *axis.min > -kTurnsDeg) ||  //
                             (axis.max && *axis.max < kTurnsDeg);
        axis.is_unlimited = axis.is_rotary && (is_wrapped || !has_end);
        if (out_.faults.size() == faults_before) {
            check_ends(std::string("AXIS_") + letter, axis);
        }
    }

    static std::string source_of(const Value& value, const std::string& section,
                                 const std::string& key) {
        return value.file + ':' + std::to_string(value.line) + ": [" + section + "] " + key +
               " = " + escaped(value.text, 200);
    }

    /// As LinuxCNC reads it: an integer, and not 0.
    static bool is_switched_on(std::string_view text) {
        int value = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        return error == std::errc() && end == text.data() + text.size() && value != 0;
    }

    void doubt(std::string text) { out_.program_doubts.push_back(std::move(text)); }
    void set(std::string key, char letter, std::string value, std::string source) {
        out_.program.push_back({std::move(key), letter, std::move(value), std::move(source)});
    }

    /// What decides the meaning of a program. Source: LinuxCNC 2.9, rs274ngc_pre.cc.
    void read_program() {
        const Value* const units = find("TRAJ", "LINEAR_UNITS");
        if (units != nullptr && (linear_ == 1 || std::abs(linear_ - 25.4) < 1e-6)) {
            set("start_unit", 0, linear_ == 1 ? "mm" : "inch",
                source_of(*units, "TRAJ", "LINEAR_UNITS"));
        }
        for (const IniAxis& axis : out_.axes) {
            const std::string section = std::string("AXIS_") + axis.name;
            const Value* const wrapped = find(section, "WRAPPED_ROTARY");
            if (axis.is_unlimited && wrapped != nullptr && is_switched_on(wrapped->text)) {
                set("rotary", axis.name[0], "wrapped",
                    source_of(*wrapped, section, "WRAPPED_ROTARY"));
            } else if (axis.is_unlimited) {
                set("rotary", axis.name[0], "programmed",
                    name_ + ": [" + section + "] WRAPPED_ROTARY is not on");
            }
        }
        constexpr const char* kSection = "RS274NGC";
        const Value* const code = find(kSection, "RS274NGC_STARTUP_CODE");
        if (code != nullptr && !trimmed(code->text).empty()) {
            set("startup_code", 0, quoted(code->text, 250),
                source_of(*code, kSection, "RS274NGC_STARTUP_CODE"));
        }
        for (const char* const unit : {"MM", "INCH"}) {
            const std::string key = std::string("CENTER_ARC_RADIUS_TOLERANCE_") + unit;
            const Value* const value = find(kSection, key);
            if (value == nullptr) {
                continue;
            }
            // LinuxCNC keeps its own one in place of a smaller or a larger value than these.
            const bool is_mm = *unit == 'M';
            const double least = is_mm ? 0.001 : 0.00004;
            const ProgramSettings own;
            const double most = is_mm ? own.arc_tolerance_mm : own.arc_tolerance_inch;
            const std::optional<double> read = number_of(without_comment(value->text));
            if (read && *read >= least && *read <= most) {
                set(is_mm ? "arc_tolerance_mm" : "arc_tolerance_inch", 0,
                    std::string(without_comment(value->text)), source_of(*value, kSection, key));
            } else {
                doubt(source_of(*value, kSection, key) + ": LinuxCNC keeps its own tolerance");
            }
        }
        const Value* const fanuc = find(kSection, "DISABLE_FANUC_STYLE_SUB");
        if (fanuc != nullptr && without_comment(fanuc->text) == "1") {
            set("program_numbers", 0, "false",
                source_of(*fanuc, kSection, "DISABLE_FANUC_STYLE_SUB"));
        }
        if (const Value* const remap = find(kSection, "REMAP")) {
            doubt(source_of(*remap, kSection, "REMAP") + ": simulate reads the word itself");
        }
        read_stored_positions();
    }

    /// A table that cannot be read is the table's fault, not the INI's.
    void read_tools() {
        const Value* const value = find("EMCIO", "TOOL_TABLE");
        if (value == nullptr) {
            return;
        }
        const std::string name(without_comment(value->text));
        const NamedFile file = files_(name, kToolTableBytesMax);
        if (file.got.empty()) {
            out_.tools = read_tool_table(file.text, escaped(name, 400), linear_);
        } else {
            out_.tools.faults.push_back(source_of(*value, "EMCIO", "TOOL_TABLE") +
                                        ": cannot be read: no tool is taken from it");
        }
    }

    /// Parameters 5161 to 5169 and 5181 to 5189 of the file of parameters, in the machine's units.
    void read_stored_positions() {
        const Value* const value = find("RS274NGC", "PARAMETER_FILE");
        if (value == nullptr) {
            return;
        }
        const std::string name(without_comment(value->text));
        const NamedFile file = files_(name, kIncludeBytesMax);
        const std::string source = source_of(*value, "RS274NGC", "PARAMETER_FILE");
        if (!file.got.empty()) {  // LinuxCNC makes it at its first start
            doubt(source + ": cannot be read: G28 and G30 stay unknown");
            return;
        }
        if (const auto system = parameter(file.text, 5220); system && *system != 1) {
            doubt(source + ": parameter 5220: programs start in another work offset than G54");
        }
        if (const auto shift = parameter(file.text, 5210); shift && *shift != 0) {
            doubt(source + ": parameter 5210: G92 is on when programs start");
        }
        for (const auto& [key, first] : {std::pair{"g28", 5161}, std::pair{"g30", 5181}}) {
            for (const IniAxis& axis : out_.axes) {
                const auto place = static_cast<int>(kAxisLetters.find(axis.name));
                // The file has X Y Z A B C U V W, as kAxisLetters.
                const int index = first + place;
                if (const auto stored = parameter(file.text, index)) {
                    char text[40];
                    std::snprintf(text, sizeof text, "%.9g",
                                  *stored * (axis.is_rotary ? 1 : linear_));
                    set(key, axis.name[0], text,
                        source + ", parameters " + std::to_string(first) + " on");
                }
            }
        }
    }

    /// The value in a line "5161	12.5", or nothing.
    static std::optional<double> parameter(std::string_view text, int index) {
        while (!text.empty()) {
            const std::string_view line = trimmed(text.substr(0, text.find('\n')));
            text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
            const std::size_t gap = line.find_first_of(" \t");
            if (gap != std::string_view::npos && line.substr(0, gap) == std::to_string(index)) {
                return number_of(trimmed(line.substr(gap)));
            }
        }
        return std::nullopt;
    }

    void fault(const std::string& section, const std::string& key, const Value* value,
               const std::string& wanted) {
        std::string text = value == nullptr ? name_ : value->file;
        if (value != nullptr) {
            text.append(":").append(std::to_string(value->line));
        }
        text.append(": [").append(section).append("] ").append(key).append(": ");
        out_.faults.push_back(text +
                              (value == nullptr
                                   ? fault_text("missing required key", "", wanted)
                                   : fault_text("invalid value", quoted(value->text, 40), wanted)));
    }

    template <class Pick>
    static void combine(std::optional<double>& kept, const std::optional<double>& other,
                        Pick pick) {
        kept = kept && other ? pick(*kept, *other) : kept ? kept : other;
    }

    /// In mm or degrees; of two, by `pick`.
    template <class Pick>
    void number(const std::string& section, const char* key, bool is_size,
                std::optional<double>& kept, Pick pick, double limit = kNoLimit) {
        const Value* value = find(section, key);
        if (value == nullptr) {
            return;
        }
        const std::string_view word =
            std::string_view(value->text).substr(0, value->text.find_first_of(" \t#;"));
        const std::optional<double> read = number_of(word);
        if (!read || (is_size && !(*read > 0))) {
            fault(section, key, value, is_size ? "a number above 0" : "a number");
        } else if (std::abs(*read * scale_) < limit) {
            combine(kept, std::optional(*read * scale_), pick);
        }
    }

    /// Programs count A, B and C in degrees and the others in the unit of length, whatever the
    /// joint.
    void check_type(const std::string& section, const IniAxis& axis) {
        const Value* const type = find(section, "TYPE");
        const std::string wanted = axis.is_rotary ? "ANGULAR" : "LINEAR";
        if (type == nullptr || upper(without_comment(type->text)) == wanted) {
            return;
        }
        const std::string word = upper(without_comment(type->text));
        if (word == "LINEAR" || word == "ANGULAR") {
            fault(section, "TYPE", type,
                  wanted + ": programs count " + axis.name +
                      (axis.is_rotary
                           ? " in degrees. Give a slide the letter U, V or W, and a second motor "
                             "the letter of its axis, as in coordinates=XYYZ"
                           : " in the unit of length"));
        }
    }

    /// A rotary axis with one end: the other cannot be farther than frames reach.
    void check_ends(const std::string& section, IniAxis& axis) {
        const bool is_far_up = axis.max && *axis.max > kRotaryDeg;
        const bool is_far_down = axis.min && *axis.min < -kRotaryDeg;
        if (axis.is_rotary && !axis.is_unlimited && (is_far_up || is_far_down)) {
            const std::string key = is_far_up ? "MAX_LIMIT" : "MIN_LIMIT";
            const Value* value = find(section, key);
            for (std::size_t joint = 0; value == nullptr && joint < joints_.size(); ++joint) {
                if (joints_[joint] == axis.name[0]) {
                    value = find("JOINT_" + std::to_string(joint), key);
                }
            }
            fault(section, key, value,
                  "an end within 838 degrees, or none on either side within ten turns: an endless "
                  "axis");
        }
    }

    /// @param sizes  whose speed and acceleration are combined, by `pick`
    template <class Pick>
    void take(const std::string& section, IniAxis& axis, IniAxis& sizes, Pick pick) {
        check_type(section, axis);
        const double limit = axis.is_rotary ? kNoLimit : kLinearMm;
        number(section, "MIN_LIMIT", false, axis.min, kMost, limit);
        number(section, "MAX_LIMIT", false, axis.max, kLeast, limit);
        std::optional<double> acceleration;
        number(section, "MAX_VELOCITY", true, sizes.speed, pick);
        number(section, "MAX_ACCELERATION", true, acceleration, pick);
        combine(sizes.acceleration, acceleration, pick);
        combine(axis.braking, acceleration, kLeast);
        const bool is_empty = axis.min && axis.max && !(*axis.min < *axis.max);
        const Value* const low = find(section, "MIN_LIMIT");
        const Value* const high = find(section, "MAX_LIMIT");
        if (is_empty && high != nullptr) {
            fault(section, "MAX_LIMIT", high, "more than MIN_LIMIT");
        } else if (is_empty && low != nullptr) {
            fault(section, "MIN_LIMIT", low, "less than MAX_LIMIT");
        }
    }

    const Sections& sections_;
    const std::string& name_;
    const NamedFiles& files_;
    IniAxes out_;
    std::string joints_;  // the axis of each joint
    bool is_trivial_ = true;
    double linear_ = 1, scale_ = 1;
};

}  // namespace

IniAxes read_linuxcnc_ini(std::string_view text, const std::string& name,
                          const NamedFiles& includes) {
    std::vector<std::string> faults;
    SectionReader reader(includes, faults);
    reader.read(text, name);
    return Reader(reader.sections(), name, includes).read(std::move(faults));
}

}  // namespace axg
