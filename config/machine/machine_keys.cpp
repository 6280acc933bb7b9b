// SPDX-License-Identifier: Apache-2.0
#include "config/machine/machine_keys.hpp"

#include <algorithm>
#include <array>
#include <type_traits>

#include "core/base/sincos.hpp"

namespace axg {
namespace {

constexpr KeyUnit kMilliseconds{1, 1e3, 1e3}, kMicroseconds{1, 1e6, 1e6};
constexpr KeyUnit kPerMinute{1, 60, 60}, kJogPerMinute{1 / 60.0, 1, 60};
constexpr KeyUnit kAxisDegrees{kPi, 180, 180 / kPi}, kDegrees{kPi / 180, 1, 180 / kPi};

template <class Owner>
constexpr ScalarKey<Owner> number(const char* key, const char* line, Range range,
                                  double Owner::*member, KeyUnit unit = {}) {
    return {.key = key, .line = line, .number = member, .range = range, .unit = unit};
}
template <class Owner>
constexpr ScalarKey<Owner> whole(const char* key, Range range, std::uint32_t Owner::*member) {
    return {.key = key, .line = key, .whole = member, .range = range};
}
template <class Owner>
constexpr ScalarKey<Owner> on_off(const char* key, bool Owner::*member, KeyLine when) {
    return {.key = key, .line = key, .is_on = member, .when = when};
}
/// An enumeration, or a switch that the file states by a word.
template <auto Member, class Owner>
constexpr ScalarKey<Owner> word(const char* key, const char* line,
                                std::span<const std::string_view> words, bool is_text,
                                KeyLine when) {
    return {.key = key,
            .line = line,
            .place = [](const Owner& owner) { return static_cast<std::size_t>(owner.*Member); },
            .set_place =
                [](Owner& owner, std::size_t place) {
                    using Value = std::remove_reference_t<decltype(owner.*Member)>;
                    owner.*Member = static_cast<Value>(place);
                },
            .words = words,
            .is_text = is_text,
            .when = when};
}

template <class Owner>
constexpr ScalarKey<Owner> required(ScalarKey<Owner> row, double none = 0) {
    row.need = Need::required;
    row.none = none;
    return row;
}
template <class Owner>
constexpr ScalarKey<Owner> stated(ScalarKey<Owner> row, bool StatesOf<Owner>::*member) {
    row.is_stated = member;
    return row;
}
template <class Owner>
constexpr ScalarKey<Owner> read_apart(ScalarKey<Owner> row) {
    row.is_read_apart = true;
    return row;
}

constexpr std::array<std::string_view, 3> kEngines{"auto", "cpu", "cuda"};
constexpr std::array kTopKeys{
    whole("deadline_us", {10, 1'000'000}, &Machine::deadline_us),
    word<&Machine::engine, Machine>("engine", "engine", kEngines, false, KeyLine::always),
    number("program_speed_mm_min", "program_speed_mm_s", {0.001, 1e6}, &Machine::program_speed_mm_s,
           kPerMinute),
};

/// A row a limit, for both kinds of axis.
constexpr std::array<ScalarKey<Axis>, 7> axis_rows(bool is_rotary) {
    constexpr Range kRate{0.001, 1e6};  // acceleration and deceleration
    const Range speed{0.001, is_rotary ? 1e5 : 1e6}, error{0, is_rotary ? 10.0 : 100.0};
    const KeyUnit unit = is_rotary ? kAxisDegrees : KeyUnit{};
    const auto key = [is_rotary](const char* linear, const char* rotary) {
        return is_rotary ? rotary : linear;
    };
    return {
        required(number(key("speed_mm_min", "speed_deg_s"), "speed", speed, &Axis::speed_max,
                        is_rotary ? unit : kPerMinute)),
        required(number(key("acceleration_mm_s2", "acceleration_deg_s2"), "acceleration", kRate,
                        &Axis::acceleration_max, unit)),
        required(
            number(key("jerk_mm_s3", "jerk_deg_s3"), "jerk", {0.001, 1e9}, &Axis::jerk_max, unit),
            kNoJerkLimit),
        required(number(key("stopping_mm_s2", "stopping_deg_s2"), "stopping", kRate,
                        &Axis::stopping_min, unit)),
        number(key("stopping_most_mm_s2", "stopping_most_deg_s2"), "stopping_most", kRate,
               &Axis::stopping_most, unit),
        stated(number(key("position_error_mm", "position_error_deg"), "position_error", error,
                      &Axis::position_error, unit),
               &Axis::states_position_error),
        stated(number(key("following_error_mm", "following_error_deg"), "following_error", error,
                      &Axis::following_error, unit),
               &Axis::states_following_error),
    };
}
constexpr std::array kRotaryKeys = axis_rows(true);

/// Only slides have a second joint.
constexpr std::array<ScalarKey<Axis>, 8> linear_rows() {
    std::array<ScalarKey<Axis>, 8> rows{};
    std::copy_n(axis_rows(false).begin(), 7, rows.begin());
    rows.back() = number("skew_mm", "skew_mm", {0, kSkewMmMax}, &Axis::skew_mm);
    rows.back().when = KeyLine::unless_first;
    return rows;
}
constexpr std::array kLinearKeys = linear_rows();

/// A line only where an error is stated: hashes of files without any stay as they are.
template <class Owner>
constexpr ScalarKey<Owner> error_of(const char* key, const char* line, double most,
                                    double Owner::*member, KeyUnit unit = {}) {
    ScalarKey<Owner> row = number(key, line, {0, most}, member, unit);
    row.when = KeyLine::unless_first;
    return row;
}
constexpr double kErrorMmMost = kPoseErrorMmMax, kErrorDegMost = 1;
constexpr std::array kJointKeys{
    error_of("direction_error_deg", "direction_error_rad", kErrorDegMost,
             &Joint::direction_error_rad, kDegrees),
    error_of("pivot_error_mm", "pivot_error_mm", kErrorMmMost, &Joint::pivot_error_mm)};
constexpr std::array kBodyKeys{
    error_of("place_error_mm", "place_error_mm", kErrorMmMost, &Body::place_error_mm)};
constexpr std::array kToolKeys{
    error_of("place_error_mm", "place_error_mm", kErrorMmMost, &Tool::place_error_mm)};

using Rules = GuardRules;
using States = StatedPromises;

constexpr ScalarKey<Rules> with_proofs(ScalarKey<Rules> row) {
    row.only_with = &Rules::travel_proofs;
    return row;
}
template <auto Member>
constexpr ScalarKey<Rules> guard_word(const char* key, const char* line,
                                      std::span<const std::string_view> words, bool is_text,
                                      KeyLine when) {
    return word<Member, Rules>(key, line, words, is_text, when);
}

constexpr std::array<std::string_view, 2> kPromises{"independent", "path_keeping"};
constexpr std::array<std::string_view, 2> kFreeJerk{"any", "limited"};
constexpr std::array<std::string_view, 3> kObeyedBy{"board", "line", "drives"};
constexpr std::array<std::string_view, 2> kReversals{"none", "jerk_limited"};
constexpr std::array<std::string_view, 2> kBroken{"stop", "report"};
constexpr std::array<std::string_view, 3> kCaps{"none", "all_axes", "per_axis"};
constexpr KeyLine kAlways = KeyLine::always, kUnlessFirst = KeyLine::unless_first;

constexpr std::array kGuardKeys{
    read_apart(guard_word<&Rules::promise>("promise", "promise", kPromises, true, kAlways)),
    stated(number("board_reaction_ms", "board_reaction_s", {0, 1000}, &Rules::board_reaction_s,
                  kMilliseconds),
           &States::board_reaction_ms),
    stated(number("latch_jitter_us", "latch_jitter_s", {0, 10'000}, &Rules::latch_jitter_s,
                  kMicroseconds),
           &States::latch_jitter_us),
    guard_word<&Rules::free_jerk_limited>("free_jerk", "free_jerk_limited", kFreeJerk, false,
                                          kAlways),
    guard_word<&Rules::obeyed_by>("obeyed_by", "obeyed_by", kObeyedBy, true, kUnlessFirst),
    stated(guard_word<&Rules::stop_reversal>("stop_reversal", "stop_reversal", kReversals, false,
                                             kUnlessFirst),
           &States::stop_reversal),
    guard_word<&Rules::reports_limits>("limits_broken", "reports_limits", kBroken, false,
                                       kUnlessFirst),
    on_off("travel_enforced", &Rules::travel_enforced, kAlways),
    on_off("travel_proofs", &Rules::travel_proofs, kUnlessFirst),
    with_proofs(number("overrun_mm", "overrun_mm", {0, 100}, &Rules::overrun_mm)),
    with_proofs(number("overrun_deg", "overrun_rad", {0, 10}, &Rules::overrun_rad, kDegrees)),
    on_off("speed_cap", &Rules::speed_cap, kAlways),
    number("cap_lead_ms", "cap_lead_s", {0, 1000}, &Rules::cap_lead_s, kMilliseconds),
    read_apart(guard_word<&Rules::cap>("cap", "cap", kCaps, true, kUnlessFirst)),
    number("level_band_mm", "level_band_mm", {0, 100}, &Rules::level_band_mm),
    whole("level_hold_samples", {1, 100'000}, &Rules::level_hold_samples),
};

constexpr Range kJogLimit{0.001, 100'000};
constexpr std::array kJogKeys{
    required(number("speed_mm_min", "speed_mm_s", kJogLimit, &JogRules::speed_mm_s, kJogPerMinute)),
    required(number("acceleration_mm_s2", "acceleration_mm_s2", kJogLimit,
                    &JogRules::acceleration_mm_s2)),
    required(number("speed_deg_s", "speed_rad_s", kJogLimit, &JogRules::speed_rad_s, kDegrees)),
    required(number("acceleration_deg_s2", "acceleration_rad_s2", kJogLimit,
                    &JogRules::acceleration_rad_s2, kDegrees)),
};

constexpr double kLeavesMost = 1U << 20U, kPairsMost = 1U << 24U;
constexpr std::array kCapacityKeys{
    whole("node_pairs", {32, 1U << 22U}, &Capacities::node_pairs),
    whole("triangle_pairs", {32, kPairsMost}, &Capacities::triangle_pairs),
    whole("rechecks", {0, kLeavesMost}, &Capacities::rechecks),
};
constexpr std::array kBatchKeys{
    whole("level_pairs", {512, 1U << 16U}, &BatchCapacities::level_pairs),
    whole("leaf_pairs", {32, kLeavesMost}, &BatchCapacities::leaf_pairs),
    whole("box_rows", {512, kPairsMost}, &BatchCapacities::box_rows),
    whole("triangle_pairs", {32, kPairsMost}, &BatchCapacities::triangle_pairs),
    whole("rechecks", {1, kLeavesMost}, &BatchCapacities::rechecks),
};
constexpr std::array kCycleKeys{
    whole("stages", {2, 3}, &CycleRules::stages),
    whole("queries", {2, 65'536}, &CycleRules::queries),
};
constexpr std::array kListKeys{
    whole("node_pairs", {8, kLeavesMost}, &WorkLists::node_pairs),
    whole("leaf_pairs", {8, kLeavesMost}, &WorkLists::leaf_pairs),
    whole("box_rows", {32, kPairsMost}, &WorkLists::box_rows),
    whole("triangle_pairs", {32, kPairsMost}, &WorkLists::triangle_pairs),
    whole("rechecks", {0, kLeavesMost}, &WorkLists::rechecks),
};

}  // namespace

ScalarKeys<Machine> top_keys() noexcept {
    return kTopKeys;
}
ScalarKeys<Axis> axis_keys(AxisKind kind) noexcept {
    return kind == AxisKind::rotary ? ScalarKeys<Axis>(kRotaryKeys) : ScalarKeys<Axis>(kLinearKeys);
}
ScalarKeys<Joint> joint_keys(AxisKind kind) noexcept {
    return ScalarKeys<Joint>(kJointKeys).first(kind == AxisKind::rotary ? 2 : 1);
}
ScalarKeys<Body> body_keys() noexcept {
    return kBodyKeys;
}
ScalarKeys<Tool> tool_keys() noexcept {
    return kToolKeys;
}
ScalarKeys<GuardRules> guard_keys() noexcept {
    return kGuardKeys;
}
ScalarKeys<JogRules> jog_keys() noexcept {
    return kJogKeys;
}
ScalarKeys<Capacities> capacity_keys() noexcept {
    return kCapacityKeys;
}
ScalarKeys<BatchCapacities> batch_keys() noexcept {
    return kBatchKeys;
}
ScalarKeys<CycleRules> cycle_keys() noexcept {
    return kCycleKeys;
}
ScalarKeys<WorkLists> list_keys() noexcept {
    return kListKeys;
}

}  // namespace axg
