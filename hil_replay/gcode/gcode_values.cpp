// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/gcode/gcode_values.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "core/base/sincos.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kOwnParameters = 30;     // local to a subroutine: #1 to #30
constexpr std::uint32_t kFirstOfControl = 5061;  // from here on only LinuxCNC itself writes
constexpr std::uint32_t kFirstPosition = 5420;
constexpr std::uint32_t kDebugComments = 5599;  // whether they are printed
constexpr double kEqual = 1e-4;                 // LinuxCNC's tolerance of EQ and NE
constexpr int kDepthMax = 50;                   // brackets within brackets
constexpr const char* kWantedNumber = "expected a number after the letter, such as 12, -0.5 or .25";
constexpr double kRadPerDegree = kPi / 180.0;

// Named parameters that LinuxCNC 2.9 has by itself (interp_namedparams.cc): they exist, and no
// value is known here.
constexpr std::string_view kNamesOfControl =
    " _ABS_A _ABS_B _ABS_C _ABS_X _ABS_Y _ABS_Z _ABSOLUTE _ADAPTIVE_FEED _CALL_LEVEL "
    "_CCOMP _COORD_SYSTEM _CURRENT_POCKET _CURRENT_TOOL _FEED _FEED_HOLD _FEED_OVERRIDE "
    "_FLOOD _IJK_ABSOLUTE_MODE _IMPERIAL _INCREMENTAL _INVERSE_TIME _LATHE_DIAMETER_MODE "
    "_LATHE_RADIUS_MODE _LINE _METRIC _METRIC_MACHINE _MIST _MOTION_MODE _PLANE "
    "_REMAP_LEVEL _RETRACT_OLD_Z _RETRACT_R_PLANE _RPM _SELECTED_POCKET _SELECTED_TOOL "
    "_SPEED_OVERRIDE _SPINDLE_CSS_MODE _SPINDLE_CW _SPINDLE_ON _SPINDLE_RPM_MODE _TASK "
    "_TOOL_OFFSET _UNITS_PER_MINUTE _UNITS_PER_REV _VALUE _VALUE_RETURNED _VMAJOR _VMINOR ";

bool is_of_control(const std::string& name) {
    return kNamesOfControl.find(' ' + name + ' ') != std::string_view::npos;
}

bool is_number_char(char c) {
    return (c >= '0' && c <= '9') || c == '.' || c == '+' || c == '-';
}

/// RS274 number: sign, digits, one point; no exponent.
std::optional<double> read_number(std::string_view text) {
    if (!text.empty() && text.front() == '+') {
        text.remove_prefix(1);
        if (!text.empty() && text.front() == '-') {
            return std::nullopt;
        }
    }
    double value = 0;
    const auto [end, error] =
        std::from_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed);
    if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) {
        return std::nullopt;
    }
    return value;
}

struct Operator {
    const char* text;
    int level;  // precedence: lower levels apply later
    double (*apply)(double, double);
};

double modulo(double a, double b) {
    const double rest = std::fmod(a, b);
    return rest < 0 ? rest + std::abs(b) : rest;
}

// ** precedes * so that the longer one is found first. All are left-associative.
constexpr std::array kOperators = {
    Operator{"**", 3, [](double a, double b) { return std::pow(a, b); }},
    Operator{"*", 2, [](double a, double b) { return a * b; }},
    Operator{"/", 2, [](double a, double b) { return a / b; }},
    Operator{"MOD", 2, [](double a, double b) { return modulo(a, b); }},
    Operator{"+", 1, [](double a, double b) { return a + b; }},
    Operator{"-", 1, [](double a, double b) { return a - b; }},
    Operator{"EQ", 0, [](double a, double b) { return std::abs(a - b) < kEqual ? 1.0 : 0.0; }},
    Operator{"NE", 0, [](double a, double b) { return std::abs(a - b) >= kEqual ? 1.0 : 0.0; }},
    Operator{"GT", 0, [](double a, double b) { return a > b ? 1.0 : 0.0; }},
    Operator{"GE", 0, [](double a, double b) { return a >= b ? 1.0 : 0.0; }},
    Operator{"LT", 0, [](double a, double b) { return a < b ? 1.0 : 0.0; }},
    Operator{"LE", 0, [](double a, double b) { return a <= b ? 1.0 : 0.0; }},
    Operator{"AND", -1, [](double a, double b) { return a != 0 && b != 0 ? 1.0 : 0.0; }},
    Operator{"OR", -1, [](double a, double b) { return a != 0 || b != 0 ? 1.0 : 0.0; }},
    Operator{"XOR", -1, [](double a, double b) { return (a != 0) != (b != 0) ? 1.0 : 0.0; }},
};
constexpr int kLevelMin = -1, kLevelMax = 3;

struct Function {
    const char* text;
    double (*apply)(double);
};
constexpr std::array kFunctions = {
    Function{"ABS", [](double a) { return std::abs(a); }},
    Function{"ACOS", [](double a) { return std::acos(a) / kRadPerDegree; }},
    Function{"ASIN", [](double a) { return std::asin(a) / kRadPerDegree; }},
    Function{"COS", [](double a) { return std::cos(a * kRadPerDegree); }},
    Function{"EXP", [](double a) { return std::exp(a); }},
    Function{"FIX", [](double a) { return std::floor(a); }},
    Function{"FUP", [](double a) { return std::ceil(a); }},
    Function{"LN", [](double a) { return std::log(a); }},
    Function{"ROUND", [](double a) { return std::round(a); }},
    Function{"SIN", [](double a) { return std::sin(a * kRadPerDegree); }},
    Function{"SQRT", [](double a) { return std::sqrt(a); }},
    Function{"TAN", [](double a) { return std::tan(a * kRadPerDegree); }},
};

}  // namespace

GcodeParameters::GcodeParameters(Live live)
    : live_(std::move(live)),
      numbered_(kGcodeParametersMax, 0.0),
      global_{{"_VALUE", 0.0}, {"_VALUE_RETURNED", 0.0}} {}

std::optional<double> GcodeParameters::numbered(std::uint32_t index) const {
    if (index < kFirstOfControl) {
        return numbered_[index];
    }
    return live_ ? live_(index) : std::nullopt;
}

std::optional<double> GcodeParameters::named(const std::string& name) const {
    // "_X" is parameter 5420, and so on.
    constexpr std::string_view kAxes = "XYZABCUVW";
    const std::size_t axis =
        name.size() == 2 && is_global(name) ? kAxes.find(name[1]) : std::string_view::npos;
    if (axis != std::string_view::npos) {
        return live_ ? live_(kFirstPosition + static_cast<std::uint32_t>(axis)) : std::nullopt;
    }
    const Names& names = is_global(name) ? global_ : local_;
    const auto at = names.find(name);
    return at == names.end() ? std::nullopt : std::optional(at->second);
}

bool GcodeParameters::set_numbered(std::uint32_t index, double value) {
    if (index == kDebugComments) {
        return true;  // moves nothing
    }
    if (index == 0 || index >= kFirstOfControl) {
        return false;
    }
    numbered_[index] = value;
    return true;
}

bool GcodeParameters::is_read_only(const std::string& name) {
    return is_of_control(name) || name.starts_with("_INI[") || name.starts_with("_HAL[");
}

void GcodeParameters::set_named(const std::string& name, double value) {
    (is_global(name) ? global_ : local_)[name] = value;
}

void GcodeParameters::enter(const std::vector<double>& arguments) {
    const auto first = numbered_.begin() + 1;
    callers_.push_back({{first, first + kOwnParameters}, std::exchange(local_, {})});
    std::fill_n(first, kOwnParameters, 0.0);
    std::copy_n(arguments.begin(), std::min<std::size_t>(arguments.size(), kOwnParameters), first);
}

void GcodeParameters::enter_names() {
    callers_.push_back({{}, std::exchange(local_, {})});
}

void GcodeParameters::leave() {
    std::copy(callers_.back().numbered.begin(), callers_.back().numbered.end(),
              numbered_.begin() + 1);
    local_ = std::move(callers_.back().names);
    callers_.pop_back();
}

std::optional<double> GcodeValueReader::refuse(std::string message) {
    if (fault_.empty()) {
        fault_ = std::move(message);
    }
    return std::nullopt;
}

bool GcodeValueReader::take(std::string_view text) {
    if (rest_.substr(0, text.size()) != text) {
        return false;
    }
    rest_.remove_prefix(text.size());
    return true;
}

std::optional<double> GcodeValueReader::value() {
    if (rest_.empty()) {
        return refuse(kWantedNumber);
    }
    const char first = rest_.front();
    const bool has_sign = (first == '-' || first == '+') && rest_.size() > 1 &&
                          (rest_[1] == '#' || rest_[1] == '[' ||
                           (parameters_ != nullptr && rest_[1] >= 'A' && rest_[1] <= 'Z'));
    if (has_sign) {
        rest_.remove_prefix(1);
        const std::optional<double> inner = value();
        return inner && first == '-' ? -*inner : inner;
    }
    if (parameters_ == nullptr && (first == '#' || first == '[')) {
        return refuse("not supported here (parameters and expressions; write the number itself)");
    }
    if (first == '[') {
        return bracket();
    }
    if (first == '#') {
        return parameter();
    }
    if (first >= 'A' && first <= 'Z' && parameters_ != nullptr) {
        return function();
    }
    return number();
}

std::optional<double> GcodeValueReader::number() {
    std::size_t end = 0;
    // In an expression a sign after the first character is the next operator.
    while (end < rest_.size() && is_number_char(rest_[end]) &&
           (end == 0 || depth_ == 0 || (rest_[end] != '+' && rest_[end] != '-'))) {
        ++end;
    }
    const std::optional<double> number = read_number(rest_.substr(0, end));
    if (!number) {
        return refuse(kWantedNumber);
    }
    rest_.remove_prefix(end);
    return number;
}

std::optional<double> GcodeValueReader::bracket() {
    if (!take("[")) {
        return refuse("expected [ and an expression");
    }
    if (++depth_ > kDepthMax) {
        return refuse("more than 50 nested brackets");
    }
    const std::optional<double> inner = sum_of(kLevelMin);
    if (!inner) {
        return std::nullopt;
    }
    if (!take("]")) {
        return refuse("the expression is not closed; add ']', or correct a misspelt operator");
    }
    --depth_;
    return std::isfinite(*inner)
               ? inner
               : refuse("the expression has no value: it divides by zero, or is not a number");
}

/// Evaluates operators of this precedence level and higher ones.
std::optional<double> GcodeValueReader::sum_of(int level) {
    if (level > kLevelMax) {
        return value();
    }
    std::optional<double> left = sum_of(level + 1);
    while (left) {
        const auto* found =
            std::find_if(kOperators.begin(), kOperators.end(), [this](const Operator& one) {
                return rest_.substr(0, std::string_view(one.text).size()) == one.text;
            });
        if (found == kOperators.end() || found->level != level) {
            break;
        }
        rest_.remove_prefix(std::string_view(found->text).size());
        const std::optional<double> right = sum_of(level + 1);
        left = right ? std::optional(found->apply(*left, *right)) : std::nullopt;
    }
    return left;
}

std::optional<double> GcodeValueReader::function() {
    if (take("EXISTS")) {
        return exists();
    }
    if (take("ATAN")) {
        const std::optional<double> y = bracket();
        if (!y || !take("/")) {
            return refuse("ATAN: expected ATAN[y]/[x]");
        }
        const std::optional<double> x = bracket();
        return x ? std::optional(std::atan2(*y, *x) / kRadPerDegree) : std::nullopt;
    }
    for (const Function& one : kFunctions) {
        if (take(one.text)) {
            const std::optional<double> inner = bracket();
            if (!inner) {
                return std::nullopt;
            }
            const double result = one.apply(*inner);
            return std::isfinite(result)
                       ? std::optional(result)
                       : refuse(std::string(one.text) + ": undefined for this argument");
        }
    }
    return refuse(kWantedNumber);
}

std::optional<double> GcodeValueReader::exists() {
    if (take("[#") && !rest_.starts_with('<')) {
        if (!index()) {
            return std::nullopt;
        }
        return take("]") ? std::optional(1.0) : refuse("EXISTS: expected EXISTS[#number]");
    }
    if (!take("<")) {
        return refuse("EXISTS: expected EXISTS[#<name>]");
    }
    const std::optional<std::string> asked = name();
    if (!asked || !take("]")) {
        return refuse("EXISTS: expected EXISTS[#<name>]");
    }
    if (parameters_->named(*asked) || is_of_control(*asked)) {
        return 1.0;
    }
    if (asked->starts_with("_HAL[") || asked->starts_with("_INI[")) {
        return refuse("EXISTS: pins and INI keys of the control are unknown here");
    }
    return 0.0;
}

std::optional<std::string> GcodeValueReader::name() {
    const std::size_t end = rest_.find('>');
    if (end == std::string_view::npos || end == 0) {
        refuse("expected a name and '>'");
        return std::nullopt;
    }
    std::string found(rest_.substr(0, end));
    rest_.remove_prefix(end + 1);
    return found;
}

std::optional<std::uint32_t> GcodeValueReader::index() {
    const std::optional<double> number = value();
    if (!number) {
        return std::nullopt;
    }
    const double nearest = std::round(*number);
    if (std::abs(*number - nearest) > 1e-4 || nearest < 1 || nearest >= kGcodeParametersMax) {
        refuse("expected a parameter from 1 to 5601");
        return std::nullopt;
    }
    return static_cast<std::uint32_t>(nearest);
}

std::optional<double> GcodeValueReader::parameter() {
    take("#");
    if (take("<")) {
        const std::optional<std::string> asked = name();
        if (!asked) {
            return std::nullopt;
        }
        const std::optional<double> found = parameters_->named(*asked);
        return found ? found
                     : refuse("#<" + *asked + ">: no line has set it" +
                              ((*asked)[0] == '_' ? "; names that LinuxCNC sets are not available"
                                                  : ""));
    }
    const std::optional<std::uint32_t> asked = index();
    if (!asked) {
        return std::nullopt;
    }
    const std::optional<double> found = parameters_->numbered(*asked);
    return found ? found
                 : refuse(std::string("#").append(std::to_string(*asked)) +
                          ": not available; of the control's own parameters, 5220, 5400 and 5420 "
                          "to 5428 are");
}

std::optional<GcodeAssignment> GcodeValueReader::assignment() {
    GcodeAssignment out;
    if (parameters_ == nullptr) {
        refuse("not supported here (parameters and expressions; write the number itself)");
        return std::nullopt;
    }
    take("#");
    if (take("<")) {
        const std::optional<std::string> target = name();
        if (!target) {
            return std::nullopt;
        }
        out.name = *target;
    } else {
        const std::optional<std::uint32_t> target = index();
        if (!target) {
            return std::nullopt;
        }
        out.index = *target;
    }
    if (!take("=")) {
        refuse("expected '=' and a value: a parameter at this position has to be set");
        return std::nullopt;
    }
    const std::optional<double> set = value();
    if (!set) {
        return std::nullopt;
    }
    out.value = *set;
    return out;
}

}  // namespace axg
