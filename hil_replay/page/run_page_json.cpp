// SPDX-License-Identifier: Apache-2.0
// The data of a page.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <span>
#include <unordered_map>

#include "config/text/quote_text.hpp"
#include "core/base/sincos.hpp"
#include "firmware_if/setup/surface_list.hpp"
#include "hil_replay/page/page_parts.hpp"
#include "hil_replay/page/page_program_json.hpp"
#include "hil_replay/page/run_page.hpp"
#include "hil_replay/replay/replay_csv.hpp"

namespace axg {
namespace {

constexpr std::size_t kTitleCharactersMax = 4096;

nlohmann::ordered_json pose_json(const Pose& pose) {
    auto rows = nlohmann::ordered_json::array();
    for (int i = 0; i < 3; ++i) {
        rows.push_back({pose.r[i][0], pose.r[i][1], pose.r[i][2], pose.t[i]});
    }
    return rows;
}

nlohmann::ordered_json machine_json(const LoadedMachine& loaded) {
    const Machine& machine = loaded.machine;
    auto axes = nlohmann::ordered_json::array(), bodies = axes, tools = axes, pairs = axes;
    for (const Axis& axis : machine.axes) {
        const bool is_rotary = axis.kind == AxisKind::rotary;
        const double unit = is_rotary ? 180.0 / kPi : 1.0;
        axes.push_back({{"name", axis.name},
                        {"unit", is_rotary ? "deg" : "mm"},
                        {"unlimited", axis.unlimited},
                        {"speed_max", axis.speed_max * unit}});
    }
    for (const Body& body : machine.bodies) {
        const auto index = [](std::uint32_t i) {
            return i == kNoIndex ? nlohmann::ordered_json() : nlohmann::ordered_json(i);
        };
        const Joint& joint = body.joint;
        bodies.push_back({{"name", body.name},
                          {"parent", index(body.parent)},
                          {"axis", index(joint.axis)},
                          {"direction", {joint.direction.x, joint.direction.y, joint.direction.z}},
                          {"pivot_mm", {joint.pivot_mm.x, joint.pivot_mm.y, joint.pivot_mm.z}},
                          {"at", pose_json(body.at)},
                          {"is_tool", body.is_tool}});
    }
    for (const Tool& tool : machine.tools) {
        tools.push_back({{"number", tool.number}, {"name", tool.name}, {"at", pose_json(tool.at)}});
    }
    for (std::uint32_t i = 0; i < machine.pairs.size(); ++i) {
        const Pair& pair = machine.pairs[i];
        pairs.push_back({{"name", pair_name(machine, i)},
                         {"a", pair.a},
                         {"b", pair.b},
                         {"margin_mm", pair.margin_mm}});
    }
    return {{"name", machine.name},
            {"axes", std::move(axes)},
            {"bodies", std::move(bodies)},
            {"tools", std::move(tools)},
            {"first_tool", machine.first_tool},
            {"pairs", std::move(pairs)}};
}

/// {"points":[x,y,z,...],"corners":[i,j,k,...]}: every point once, triangles in their order. Each
/// float as the shortest text that reads back as it.
void append_mesh(const Mesh& mesh, std::string& text) {
    struct Hash {
        std::size_t operator()(const std::array<float, 3>& p) const noexcept {
            const std::hash<float> one;
            return (one(p[0]) * 31 + one(p[1])) * 31 + one(p[2]);
        }
    };
    std::unordered_map<std::array<float, 3>, std::size_t, Hash> places;
    std::string corners;
    text += "{\"points\":[";
    for (const Triangle& triangle : mesh.triangles) {
        for (const Vec3f& corner : {triangle.a, triangle.b, triangle.c}) {
            const auto [at, is_new] =
                places.try_emplace({corner.x, corner.y, corner.z}, places.size());
            if (is_new) {
                fmt::format_to(std::back_inserter(text), "{}{},{},{}", at->second == 0 ? "" : ",",
                               corner.x, corner.y, corner.z);
            }
            fmt::format_to(std::back_inserter(corners), "{}{}", corners.empty() ? "" : ",",
                           at->second);
        }
    }
    text += "],\"corners\":[" + corners + "]}";
}

void append_meshes(std::span<const Mesh* const> meshes, std::string& text) {
    text += '[';
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        text += i == 0 ? "" : ",";
        append_mesh(*meshes[i], text);
    }
    text += ']';
}

/// Appends column by column, to seven digits; null for a value that is not finite.
void append_samples(const PageSamples& samples, std::string& text) {
    fmt::format_to(std::back_inserter(text), "{{\"count\":{},\"stride\":{},\"rows\":{}",
                   samples.samples(), samples.stride(), samples.rows());
    for (std::size_t column = 0; column < samples.columns().size(); ++column) {
        const nlohmann::ordered_json name(samples.columns()[column].name);
        text += fmt::format(",{}:[", name.dump());
        for (std::size_t i = 0; i < samples.rows(); ++i) {
            text += i == 0 ? "" : ",";
            const double value = samples.row(i)[column];
            if (column == 0) {
                fmt::format_to(std::back_inserter(text), "{:.6f}", value);
            } else if (std::isfinite(value)) {
                fmt::format_to(std::back_inserter(text), "{:.7g}", value);
            } else {
                text += "null";
            }
        }
        text += ']';
    }
    text += '}';
}

nlohmann::ordered_json times_json(const TimeHistogram* cycles) {
    auto bars = nlohmann::ordered_json::array();
    if (cycles != nullptr) {
        cycles->for_each_bucket([&bars](std::int64_t end_ns, std::uint64_t count) {
            bars.push_back({static_cast<double>(end_ns) * 1e-3, count});
        });
    }
    return bars;
}

/// Escapes each '<' for a script of a page, so that no name can close the script.
std::string safe_in_script(const std::string& text) {
    std::string safe;
    safe.reserve(text.size());
    for (const char c : text) {
        c == '<' ? void(safe += "\\u003c") : void(safe += c);
    }
    return safe;
}

/// The surfaces that triangles are found in.
void append_surfaces(const LoadedMachine& loaded, std::string& text) {
    const SurfaceList surfaces = surface_list(loaded);
    text += ",\"body_meshes\":";
    append_meshes(surfaces.bodies(), text);
    text += ",\"tool_meshes\":";
    append_meshes(surfaces.tools(), text);
}

}  // namespace

std::string machine_data(const LoadedMachine& loaded) {
    const nlohmann::ordered_json head{{"machine", machine_json(loaded)}};
    std::string text = head.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
    text.pop_back();  // its closing brace
    append_surfaces(loaded, text);
    text += '}';
    return safe_in_script(text);
}

std::string page_data(const RunPage& page) {
    nlohmann::ordered_json head{
        {"title", escaped(page.title, kTitleCharactersMax)},
        {"words", page.words},
        {"within_mm", kPageWithinMm},
        {"deadline_us", page.deadline_us},
        {"machine", machine_json(page.loaded)},
        {"shows_axes", !page.guessed_axes.empty()},
    };
    for (std::size_t i = 0; i < page.guessed_axes.size(); ++i) {
        head["machine"]["bodies"][i]["is_guess"] = static_cast<bool>(page.guessed_axes[i]);
    }
    // A name may hold any bytes; a page holds UTF-8 alone.
    std::string text = head.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
    text.pop_back();  // its closing brace: what is long follows, without a tree of numbers
    text += ",\"stops\":" + page.stops;
    text += ",\"cycle_times_us\":" + times_json(page.cycles).dump();
    append_surfaces(page.loaded, text);
    text += ",\"samples\":";
    append_samples(page.samples, text);
    if (const std::string program = program_data(page); !program.empty()) {
        text += ",\"program\":" + program;
    }
    text += '}';
    return safe_in_script(text);
}

}  // namespace axg
