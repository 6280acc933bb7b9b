// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/check/check_json.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/base/sincos.hpp"
#include "core/certificate/stop_certificate.hpp"
#include "core/machine/can_id.hpp"
#include "firmware_if/cli/document_json.hpp"
#include "firmware_if/cli/limit_text.hpp"
#include "firmware_if/cli/plan_json.hpp"
#include "firmware_if/guard/live_refusal.hpp"
#include "firmware_if/protocol/axis_frames.hpp"
#include "firmware_if/protocol/obeyed_by.hpp"

namespace axg {
namespace {

using Json = nlohmann::ordered_json;

const char* unit_of(const Axis& axis) {
    return axis.kind == AxisKind::rotary ? "deg" : "mm";
}

Json describe_axis(const Axis& axis, double blind_speed) {
    const bool rotary = axis.kind == AxisKind::rotary;
    const double unit = rotary ? 180.0 / kPi : 1.0;
    return {{"name", axis.name},
            {"kind", rotary ? "rotary" : "linear"},
            {"unit", unit_of(axis)},
            {"unlimited", axis.unlimited},
            {"travel", axis.unlimited ? Json{} : Json{axis.min * unit, axis.max * unit}},
            {"speed_per_s", axis.speed_max * unit},
            {"acceleration_per_s2", axis.acceleration_max * unit},
            {"jerk_per_s3", has_jerk_limit(axis) ? Json(axis.jerk_max * unit) : Json(nullptr)},
            {"stopping_per_s2", axis.stopping_min * unit},
            {"stopping_distance", stopping_distance(axis) * unit},
            {"stopping_time_s", stopping_time_s(axis)},
            {"blind_speed_per_s",
             blind_speed < axis.speed_max ? Json(blind_speed * unit) : Json(nullptr)}};
}

/// One value: page. Otherwise pages: a list for each multiplexor, the outermost first, of ranges.
void add_pages(Json& facts, const SignalSelector& selector) {
    const SignalSelector::Range& first = selector.ranges[0];
    if (selector.level_count == 1 && selector.levels[0].range_count == 1 &&
        first.least == first.most) {
        facts["page"] = first.least;
        return;
    }
    std::uint32_t range = 0;
    for (std::uint32_t level = 0; level < selector.level_count; ++level) {
        auto values = Json::array();
        for (std::uint32_t i = 0; i < selector.levels[level].range_count; ++i, ++range) {
            values.push_back({selector.ranges[range].least, selector.ranges[range].most});
        }
        facts["pages"].push_back(std::move(values));
    }
}

Json facts_of(const Machine& machine, const CanSignal& signal, std::uint8_t frame_bytes) {
    Json facts{{"says", to_text(signal.role)}};
    if (has_axis(signal.role)) {
        facts["axis"] = machine.axes[signal.axis].name;
    }
    facts["id"] = id_number(signal.id);
    facts["extended"] = is_extended_id(signal.id);
    facts["frame_bytes"] = frame_bytes;
    facts["start"] = signal.start_bit;
    facts["length"] = signal.length_bits;
    facts["order"] = signal.order == ByteOrder::little ? "little" : "big";
    facts["signed"] = signal.is_signed;
    facts["type"] = to_text(signal.type);
    if (is_number(signal.role)) {
        facts["factor"] = signal.factor;
        facts["offset"] = signal.offset;
    } else if (signal.role != SignalRole::tool) {
        facts["mark"] = signal.mark;
    }
    add_pages(facts, signal.selector);
    return facts;
}

Json describe_frames(const Machine& machine) {
    const AxisFrameSet set = make_frame_set(machine);
    Json out{{"format", wire_of(machine.can).name},
             {"sample_us", machine.can.sample_us},
             {"frames_a_sample", set.frame_count}};
    for (std::uint32_t i = 0; i < set.signal_count; ++i) {
        out["signals"].push_back(
            facts_of(machine, set.signals[i], set.frame_bytes[set.signal_slots[i]]));
    }
    return out;
}

Json facts_of(const MeshReport& mesh) {
    const Vec3d size = widen(mesh.max_mm) - widen(mesh.min_mm);
    return {{"triangles", mesh.facet_count}, {"size_mm", {size.x, size.y, size.z}},
            {"shells", mesh.shells},         {"cavities", mesh.cavities},
            {"open", mesh.open_shells != 0}, {"open_shells", mesh.open_shells},
            {"volume_mm3", mesh.volume_mm3}};
}

Json describe_bodies(const Machine& machine, const CheckFacts& facts) {
    Json out = Json::array();
    for (std::size_t i = 0; i < machine.bodies.size(); ++i) {
        const Body& body = machine.bodies[i];
        const std::uint32_t axis = body.joint.axis;
        out.push_back(
            {{"name", body.name},
             {"parent", body.parent == kNoIndex ? Json{} : Json(machine.bodies[body.parent].name)},
             {"axis", axis == kNoIndex ? Json{} : Json(machine.axes[axis].name)},
             {"tool", body.is_tool},
             {"stock", body.is_stock}});
        if (!body.is_tool && body.has_mesh) {
            out.back()["mesh"] = facts_of(facts.bodies[i]);
        }
    }
    return out;
}

Json describe_tools(const Machine& machine, const CheckFacts& facts) {
    Json out = Json::array();
    std::size_t next = 0;
    for (std::size_t i = 0; i < machine.tools.size(); ++i) {
        const Tool& tool = machine.tools[i];
        Json sections = Json::array();
        for (const Shape& section : tool.mesh.shapes) {
            if (section.name.empty()) {
                continue;  // a profile alone
            }
            const MeshReport& mesh = facts.sections[next++];
            sections.push_back({{"name", section.name},
                                {"cutting", section.is_cutting},
                                {"z_mm", {widen(mesh.min_mm).z, widen(mesh.max_mm).z}},
                                {"triangles", mesh.facet_count}});
        }
        out.push_back({{"number", tool.number},
                       {"name", tool.name},
                       {"length_mm", tool.length_mm},
                       {"mesh", facts_of(facts.tools[i])},
                       {"sections", sections}});
    }
    return out;
}

Json describe_pairs(const Machine& machine) {
    Json out = Json::array();
    for (const Pair& pair : machine.pairs) {
        out.push_back({{"a", machine.bodies[pair.a].name},
                       {"b", machine.bodies[pair.b].name},
                       {"margin_mm", pair.margin_mm},
                       {"slow_mm", pair.slow_mm},
                       {"warn_mm", pair.warn_mm}});
    }
    return out;
}

/// The axes between the bodies, by name.
Json describe_place(const Machine& machine, const Exclusion& one, const TravelWitness& at) {
    Json out = Json::object();
    for (const std::uint32_t axis : axes_between(machine, one)) {
        out[machine.axes[axis].name] = in_axis_units(machine.axes[axis], at.position[axis]);
    }
    if (at.tool != kNoIndex) {
        out["tool"] = machine.tools[at.tool].number;
    }
    return out;
}

Json describe_pose_errors(const Machine& machine, const WorstPoseError& worst) {
    const Pair& pair = machine.pairs[worst.pair];
    Json parts = Json::array();
    for (const PoseErrorPart& part : worst.parts) {
        parts.push_back({{"key", part.key}, {"mm", part.mm}});
    }
    return {{"a", machine.bodies[pair.a].name},
            {"b", machine.bodies[pair.b].name},
            {"mm", worst.mm},
            {"parts", std::move(parts)}};
}

Json describe_exclusions(const Machine& machine, const std::vector<PairOverTravel>& found) {
    Json out = Json::array();
    for (std::size_t i = 0; i < machine.exclusions.size(); ++i) {
        const Exclusion& one = machine.exclusions[i];
        Json& item = out.emplace_back(Json{{"a", machine.bodies[one.a].name},
                                           {"b", machine.bodies[one.b].name},
                                           {"reason", one.reason}});
        if (!one.because.empty()) {
            item["because"] = one.because;
        }
        if (i >= found.size()) {
            continue;
        }
        item["over_travel"] = to_text(found[i].verdict);
        item["queries"] = found[i].queries;
        if (found[i].verdict == TravelVerdict::never_near) {
            item["never_nearer_mm"] = found[i].apart_mm;
        } else if (found[i].verdict == TravelVerdict::both) {
            item["meets_at"] = describe_place(machine, one, found[i].near);
            item["apart_at"] = describe_place(machine, one, found[i].apart);
        }
    }
    return out;
}

Json describe_guard(const Machine& machine, const CheckFacts& facts) {
    const PermitSamples samples = machine.can.permit_samples;
    Json out{
        {"horizon_ms", free_seconds(machine, samples.least) * 1e3},
        {"horizon_longest_ms", free_seconds(machine, samples.most) * 1e3},
        {"permit_samples", {samples.least, samples.most}},
        {"latched_age_us", {machine.can.latched_age.least_us, machine.can.latched_age.most_us}},
        {"promise", to_text(machine.guard.promise)},
        {"obeyed_by", to_text(machine.guard.obeyed_by)},
        {"free_jerk", machine.guard.free_jerk_limited ? "limited" : "any"},
        {"axes", Json::array()}};
    if (const std::string refusal = obeyed_by_refusal(machine); !refusal.empty()) {
        out["not_obeyed"] = refusal;
    }
    if (const std::vector<std::string> refusals = live_refusals(machine); !refusals.empty()) {
        out["refusals"] = refusals;
    }
    if (machine.guard.promise == StopPromise::path_keeping) {
        out["ahead_ms"] = facts.look_ahead_s * 1e3;
        out["ahead_needed_ms"] = facts.look_ahead_needed_s * 1e3;
        out["ahead_longest_ms"] = facts.look_ahead_longest_s * 1e3;
    }
    out["not_stated"] = Json::array();
    for (const UnstatedPromise& promise : facts.unstated) {
        const Axis& axis = machine.axes[promise.axis];
        out["not_stated"].push_back({{"key", promise.key},
                                     {"assumed", promise.assumed},
                                     {"cautious", promise.cautious},
                                     {"axis", axis.name},
                                     {"unit", unit_of(axis)},
                                     {"cost", promise.cost}});
    }
    for (std::size_t i = 0; i < facts.reaches.size(); ++i) {
        out["axes"].push_back({{"name", machine.axes[i].name},
                               {"unit", unit_of(machine.axes[i])},
                               {"reach_at_full_speed", facts.reaches[i].at_full_speed},
                               {"reach_at_rest", facts.reaches[i].at_rest}});
    }
    for (std::size_t i = 0; i < facts.jog_reaches.size(); ++i) {
        out["single_jog"].push_back({{"name", machine.axes[i].name},
                                     {"unit", unit_of(machine.axes[i])},
                                     {"reach", facts.jog_reaches[i]}});
    }
    return out;
}

Json describe_engine(const EngineFacts& facts, const Capacities& capacities) {
    Json out{{"name", "cpu"},
             {"lanes", facts.lanes},
             {"trees_bytes", facts.trees_bytes},
             {"lists_bytes", facts.lists_bytes},
             {"solids_bytes", facts.solids_bytes},
             {"node_pairs", capacities.node_pairs},
             {"triangle_pairs", capacities.triangle_pairs},
             {"rechecks", capacities.rechecks}};
    if (!facts.choice_words.empty()) {
        out["choice"] = {
            {"engine", facts.choice}, {"gpu", facts.gpu}, {"words", facts.choice_words}};
    }
    return out;
}

Json describe_contacts(const std::vector<PairContacts>& contacts) {
    Json out = Json::array();
    for (const PairContacts& pair : contacts) {
        out.push_back({{"pair", pair.name},
                       {"checked", true},
                       {"positions", pair.positions},
                       {"in_contact", pair.touching},
                       {"contained", pair.contained},
                       {"containment_not_known", pair.not_known}});
    }
    return out;
}

}  // namespace

std::string describe_check(const CheckedFile& checked, const CheckReport& report) {
    const Machine& machine = report.loaded.machine;
    const CheckFacts& facts = report.facts;
    Json out{{"file", checked.file},
             {"name", machine.name},
             {"configuration_sha256", checked.configuration_sha256}};
    for (std::uint32_t i = 0; i < kHashParts; ++i) {
        out["hashes"][kHashPartNames[i]] = fmt::format("{:08x}", checked.hashes.of[i]);
    }
    if (checked.is_compiled) {
        out["compiled_from"] = report.loaded.source.file;
    }
    out["axes"] = Json::array();
    const std::vector<double> blind = blind_speeds(machine);
    for (std::size_t i = 0; i < blind.size(); ++i) {
        out["axes"].push_back(describe_axis(machine.axes[i], blind[i]));
    }
    out["frames"] = describe_frames(machine);
    out["bodies"] = describe_bodies(machine, facts);
    out["notes"] = report.loaded.meshes.notes;
    out["tools"] = describe_tools(machine, facts);
    out["first_tool"] = machine.first_tool;
    out["pairs"] = describe_pairs(machine);
    out["exclusions"] = describe_exclusions(machine, facts.exclusions);
    if (facts.pose_errors) {
        out["pose_errors"] = describe_pose_errors(machine, *facts.pose_errors);
    }
    out["guard"] = describe_guard(machine, facts);
    if (facts.engine) {
        out["engine"] = describe_engine(*facts.engine, machine.capacities);
        out["contacts"] = describe_contacts(facts.contacts);
    }
    if (facts.admitted) {
        const AdmittedPlan& admitted = facts.admitted->admitted;
        out["admitted"] = {{"host", admitted.host},
                           {"date", admitted.date},
                           {"engine", admitted.engine},
                           {"fit", admitted.is_fit},
                           {"longest_us", admitted.longest_us},
                           {"plan", plan_json(admitted.plan)},
                           {"has_file_plan", facts.admitted->has_file_plan}};
    }
    if (!facts.plan.empty()) {
        out["plan"] = Json::parse(facts.plan);
    }
    out["warnings"] = report.warnings;
    return text_of(out);
}

}  // namespace axg
