// SPDX-License-Identifier: Apache-2.0
#include "config/machine/effective_text.hpp"

#include <sha2.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <initializer_list>
#include <vector>

#include "config/machine/machine_keys.hpp"
#include "config/mesh/load_meshes.hpp"
#include "config/text/quote_text.hpp"
#include "core/base/finite.hpp"
#include "core/machine/frame_ids.hpp"

namespace axg {
namespace {

std::string text_of(double value) {
    std::array<char, 40> buffer{};
    const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
    return {buffer.data(), end};
}

class Lines {
  public:
    std::string text;

    void add(const std::string& key, const std::string& value) {
        text += key + " = " + quoted(value, value.size() * 10 + 16) + '\n';
    }
    void add(const std::string& key, std::initializer_list<double> values) {
        text += key + " =";
        for (const double value : values) {
            text += ' ' + text_of(value);
        }
        text += '\n';
    }
    void add(const std::string& key, std::uint32_t value) {
        text += key + " = " + std::to_string(value) + '\n';
    }
};

template <class Owner>
void add_scalar(Lines& lines, const std::string& line, const ScalarKey<Owner>& row,
                const Owner& owner) {
    if (row.number != nullptr) {
        const double value = owner.*row.number;
        if (is_finite(value) && (value != 0 || row.when == KeyLine::always)) {
            lines.add(line, {value});
        }
        return;
    }
    if (row.whole != nullptr) {
        lines.add(line, owner.*row.whole);
        return;
    }
    const std::size_t place = row.is_on != nullptr ? owner.*row.is_on : row.place(owner);
    if (place == 0 && row.when == KeyLine::unless_first) {
        return;
    }
    if (row.is_text) {
        lines.add(line, std::string(row.words[place]));
    } else {
        lines.add(line, static_cast<std::uint32_t>(place));
    }
}

template <class Owner>
void add_scalars(Lines& lines, const std::string& section, ScalarKeys<Owner> table,
                 const Owner& owner) {
    for (const ScalarKey<Owner>& row : table) {
        if (row.only_with == nullptr || owner.*row.only_with) {
            add_scalar(lines, section + row.line, row, owner);
        }
    }
}

void add_pose(Lines& lines, const std::string& key, const Pose& pose) {
    for (std::size_t i = 0; i < 3; ++i) {
        lines.add(key + ".row" + std::to_string(i),
                  {pose.r[i][0], pose.r[i][1], pose.r[i][2], pose.t[i]});
    }
}

void add_surface(Lines& lines, const std::string& key, const MeshSource& source) {
    lines.add(key + ".allow_open", source.allow_open ? 1U : 0U);
    lines.add(key + ".allow_self_intersection", source.allow_self_intersection ? 1U : 0U);
    lines.add(key + ".allow_degenerate", source.allow_degenerate ? 1U : 0U);
    if (source.simplify_mm > 0) {
        lines.add(key + ".simplify_mm", {source.simplify_mm});
    }
}

void add_axes(Lines& lines, const Machine& machine) {
    for (const Axis& axis : machine.axes) {
        const std::string key = "axes." + axis.name;
        lines.add(key + ".kind", axis.kind == AxisKind::rotary ? "rotary" : "linear");
        lines.add(key + ".unlimited", axis.unlimited ? 1U : 0U);
        lines.add(key + ".travel", {axis.min, axis.max});
        add_scalars(lines, key + ".", axis_keys(axis.kind), axis);
    }
}

void add_bodies(Lines& lines, const Machine& machine) {
    for (const Body& body : machine.bodies) {
        const std::string key = "bodies." + body.name;
        lines.add(key + ".parent", body.parent);
        lines.add(key + ".axis", body.joint.axis);
        const Joint& joint = body.joint;
        lines.add(key + ".direction", {joint.direction.x, joint.direction.y, joint.direction.z});
        lines.add(key + ".pivot_mm", {joint.pivot_mm.x, joint.pivot_mm.y, joint.pivot_mm.z});
        add_scalars(lines, key + ".", joint_keys(AxisKind::rotary), joint);
        add_scalars(lines, key + ".", body_keys(), body);
        lines.add(key + ".tool", body.is_tool ? 1U : 0U);
        lines.add(key + ".mesh", body.has_mesh ? 1U : 0U);
        add_pose(lines, key + ".at", body.at);
        if (body.is_stock) {
            lines.add(key + ".stock", 1U);
        }
        add_surface(lines, key, body.mesh);
    }
}

void add_tools(Lines& lines, const Machine& machine) {
    for (const Tool& tool : machine.tools) {
        const std::string key = "tools." + std::to_string(tool.number);
        lines.add(key + ".name", tool.name);
        lines.add(key + ".length_mm", {tool.length_mm});
        add_scalars(lines, key + ".", tool_keys(), tool);
        if (tool.diameter_mm) {
            lines.add(key + ".diameter_mm", {*tool.diameter_mm});
        }
        add_pose(lines, key + ".at", tool.mesh.turns ? tool.mesh.at : tool.at);
        if (!tool.mesh.turns) {
            lines.add(key + ".turns", 0U);
        }
        add_surface(lines, key, tool.mesh);
        for (std::uint32_t i = 0; i < tool.mesh.shapes.size(); ++i) {
            if (tool.mesh.shapes[i].is_cutting) {
                lines.add(key + ".cutting", i);
            }
        }
    }
    lines.add("first_tool", machine.first_tool);
}

void add_pairs(Lines& lines, const Machine& machine) {
    for (const Pair& pair : machine.pairs) {
        lines.add("pair." + std::to_string(pair.a) + '.' + std::to_string(pair.b),
                  {pair.margin_mm, pair.slow_mm, pair.warn_mm});
    }
    for (const Exclusion& one : machine.exclusions) {
        const std::string key = "exclusion." + std::to_string(one.a) + '.' + std::to_string(one.b);
        lines.add(key, one.reason);
        if (!one.because.empty()) {
            lines.add(key + ".because", one.because);
        }
    }
}

/// One value has the key that it always had; further ranges and levels have keys of their own.
void add_selector(Lines& lines, const std::string& key, const SignalSelector& selector) {
    std::uint32_t range = 0;
    for (std::uint32_t i = 0; i < std::max<std::uint32_t>(selector.level_count, 1); ++i) {
        const SignalSelector::Level& level = selector.levels[i];
        const std::string at = i == 0 ? key : key + '.' + std::to_string(i);
        lines.add(at + ".start", level.start_bit);
        lines.add(at + ".length", level.length_bits);
        lines.add(at + ".order", static_cast<std::uint32_t>(level.order));
        lines.add(at + ".value", selector.ranges[range].least);
        for (std::uint32_t j = 0; j < level.range_count; ++j, ++range) {
            const SignalSelector::Range& one = selector.ranges[range];
            if (level.range_count > 1 || one.least != one.most) {
                const std::string values = at + ".values." + std::to_string(j);
                lines.add(values + ".least", one.least);
                lines.add(values + ".most", one.most);
            }
        }
    }
}

void add_signals(Lines& lines, const CanLayout& can) {
    for (const CanSignal& signal : can.signals) {
        const std::string key = "can.signals." + std::to_string(signal.axis) + '.' +
                                std::to_string(static_cast<unsigned>(signal.role));
        lines.add(key + ".id", signal.id);
        lines.add(key + ".start", signal.start_bit);
        lines.add(key + ".length", signal.length_bits);
        lines.add(key + ".order", static_cast<std::uint32_t>(signal.order));
        lines.add(key + ".signed", signal.is_signed ? 1U : 0U);
        lines.add(key + ".scale", {signal.factor, signal.offset});
        lines.add(key + ".type", static_cast<std::uint32_t>(signal.type));
        lines.add(key + ".frame_bytes", signal.frame_bytes);
        lines.add(key + ".flexible", signal.is_flexible ? 1U : 0U);
        lines.add(key + ".mark", signal.mark);
        add_selector(lines, key + ".selector", signal.selector);
    }
}

void add_can(Lines& lines, const CanLayout& can) {
    lines.add("can.format", static_cast<std::uint32_t>(can.format));
    lines.add("can.sample_us", can.sample_us);
    lines.add("can.sync", can.sync_id);
    for (std::size_t i = 0; i < can.axis_ids.size(); ++i) {
        lines.add("can.axes." + std::to_string(i), can.axis_ids[i]);
        lines.add("can.data_ids." + std::to_string(i), can.data_ids[i]);
    }
    add_signals(lines, can);
    lines.add("can.signal_frame_bytes", can.signal_frame_bytes);
    if (can.arrival_jitter_us != 0) {
        lines.add("can.arrival_jitter_us", can.arrival_jitter_us);
    }
    if (can.look_ahead_samples != 0) {
        lines.add("can.ahead.id", can.look_ahead_id);
        lines.add("can.ahead.data_id", can.look_ahead_data_id);
        lines.add("can.ahead.samples", can.look_ahead_samples);
    }
    if (wire_of(can).mark == SampleMark::sync) {
        lines.add("can.sync_counter", can.sync_counter_max);
        if (can.guard_sends_sync) {
            lines.add("can.guard_sends_sync", 1U);
        }
        lines.add("can.sync_window_us", can.sync_window_us);
    }
    lines.add("can.heartbeat_in", can.heartbeat_in_id);
    lines.add("can.permit", can.permit_id);
    lines.add("can.stop", can.stop_id);
    lines.add("can.emergency", can.emergency_id);
    lines.add("can.heartbeat_out", can.heartbeat_out_id);
    if (can.hashes_in_id != 0) {
        lines.add("can.hashes_in", can.hashes_in_id);
        lines.add("can.hashes_out", can.hashes_out_id);
    }
    if (has_sample_counter(can)) {
        lines.add("can.permit_version", 2U);
        for (const FrameId& row : kFrameIds) {
            if (row.use == FrameUse::counter) {
                lines.add(std::string("can.") + row.key, can.*row.id);
            }
        }
    }
    for (std::size_t i = 0; i < can.quick_stop_ids.size(); ++i) {
        lines.add("can.quick_stop[" + std::to_string(i) + "]", can.quick_stop_ids[i]);
    }
    lines.add("can.permit_samples", can.permit_samples.least);
    if (can.permit_samples.most != can.permit_samples.least) {
        lines.add("can.permit_samples_most", can.permit_samples.most);
    }
    if (can.latched_age != ValueAge{}) {
        lines.add("can.latched_age_us", can.latched_age.least_us);
        lines.add("can.latched_age_us_most", can.latched_age.most_us);
    }
    lines.add("can.counter_delta_max", can.counter_delta_max);
    lines.add("can.sync_counter_init", can.sync_counter_init);
    lines.add("can.stale_after_us", can.stale_after_us);
    lines.add("can.frozen_samples", can.frozen_samples);
    lines.add("can.heartbeat_timeout_us", can.heartbeat_timeout_us);
}

void add_guard(Lines& lines, const GuardRules& guard) {
    add_scalars(lines, "guard.", guard_keys(), guard);
    lines.add("guard.jog.is_promised", guard.jog.is_promised ? 1U : 0U);
    add_scalars(lines, "guard.jog.", jog_keys(), guard.jog);
}

/// Without a pinned cycle the program chooses stages and lists: they are no part of the machine.
void add_cycle(Lines& lines, const CycleRules& cycle) {
    lines.add("cycle.is_pinned", cycle.is_pinned ? 1U : 0U);
    lines.add("cycle.depth_max", kStageDepthMax);
    lines.add("cycle.queries", cycle.queries);
    if (!cycle.is_pinned) {
        return;
    }
    lines.add("cycle.stages", cycle.stages);
    add_scalars(lines, "cycle.lists.", list_keys(), cycle.lists);
}

/// Bits, least significant byte first: the hash travels between machines.
void update(SHA2_CTX& context, const Mesh& mesh) {
    static_assert(std::endian::native == std::endian::little);
    static_assert(sizeof(Triangle) == 9 * sizeof(float), "corners and nothing between them");
    const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
    SHA256Update(&context, reinterpret_cast<const std::uint8_t*>(&count), sizeof count);
    SHA256Update(&context, reinterpret_cast<const std::uint8_t*>(mesh.triangles.data()),
                 mesh.triangles.size() * sizeof(Triangle));
}

}  // namespace

std::string effective_text(const Machine& machine) {
    Lines lines;
    lines.add("version", 1U);
    lines.add("name", machine.name);
    add_scalars(lines, "", top_keys(), machine);
    add_axes(lines, machine);
    add_bodies(lines, machine);
    add_tools(lines, machine);
    add_pairs(lines, machine);
    add_can(lines, machine.can);
    add_guard(lines, machine.guard);
    if (!machine.output_line.chip.empty()) {
        lines.add("output_line.chip", machine.output_line.chip);
        lines.add("output_line.line", machine.output_line.line);
    }
    add_scalars(lines, "capacities.", capacity_keys(), machine.capacities);
    add_cycle(lines, machine.cycle);
    add_scalars(lines, "capacities.batch.", batch_keys(), machine.capacities.batch);
    return lines.text;
}

ConfigurationHashes configuration_hashes(const Machine& machine, const MachineMeshes& meshes) {
    struct Part {
        std::vector<std::string_view> keys;  // the beginning of a line
        const std::vector<Mesh>* surfaces = nullptr;
    };
    const std::array<Part, kHashParts> parts{
        Part{{"pair.", "exclusion."}, &meshes.bodies}, Part{{"bodies."}},
        Part{{"tools.", "first_tool "}, &meshes.tools},
        Part{{"axes.", "guard.", "can.sample_us ", "can.permit_samples", "can.latched_age_us"}}};
    const std::string text = effective_text(machine);
    ConfigurationHashes out;
    for (std::size_t i = 0; i < kHashParts; ++i) {
        SHA2_CTX context;
        SHA256Init(&context);
        std::size_t begin = 0;
        while (begin < text.size()) {
            const std::size_t end = text.find('\n', begin) + 1;
            const std::string_view line = std::string_view(text).substr(begin, end - begin);
            if (std::any_of(parts[i].keys.begin(), parts[i].keys.end(),
                            [line](std::string_view key) { return line.starts_with(key); })) {
                SHA256Update(&context, reinterpret_cast<const std::uint8_t*>(line.data()),
                             line.size());
            }
            begin = end;
        }
        if (parts[i].surfaces != nullptr) {
            for (const Mesh& mesh : *parts[i].surfaces) {
                update(context, mesh);
            }
        }
        std::array<std::uint8_t, SHA256_DIGEST_LENGTH> digest{};
        SHA256Final(digest.data(), &context);
        for (std::size_t byte = 0; byte < 4; ++byte) {
            out.of[i] = out.of[i] << 8U | digest[byte];
        }
    }
    return out;
}

std::string configuration_hash(const Machine& machine, const MachineMeshes& meshes) {
    const std::string text = effective_text(machine);
    SHA2_CTX context;
    SHA256Init(&context);
    SHA256Update(&context, reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
    for (const auto* list : {&meshes.bodies, &meshes.tools}) {
        for (const Mesh& mesh : *list) {
            update(context, mesh);
        }
    }
    std::array<std::uint8_t, SHA256_DIGEST_LENGTH> digest{};
    SHA256Final(digest.data(), &context);
    std::string hex;
    for (const std::uint8_t byte : digest) {
        constexpr std::string_view kDigits = "0123456789abcdef";
        hex += kDigits[byte >> 4U];
        hex += kDigits[byte & 15U];
    }
    return hex;
}

}  // namespace axg
