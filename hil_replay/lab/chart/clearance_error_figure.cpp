// SPDX-License-Identifier: Apache-2.0
// Reported clearance less the true distance: above zero, a method claims more than the distance.
// Measures the engine on the paper's machine near contact. With the exact cases of the folder
// tritri, also measures the engine and the methods that compute a distance on its meshes.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "hil_replay/lab/bench/csv_table.hpp"
#include "hil_replay/lab/cases/tritri_file.hpp"
#include "hil_replay/lab/chart/exact_clearance.hpp"
#include "hil_replay/lab/chart/figures.hpp"
#include "hil_replay/lab/chart/figures_json.hpp"
#include "hil_replay/lab/chart/posed_machine.hpp"
#include "hil_replay/lab/methods/mesh_cases.hpp"
#include "hil_replay/lab/methods/method.hpp"

namespace axg::chart {
namespace {

using lab::Draw;

constexpr double kWithinMm = 50;
constexpr const char* kEngine = "axguard engine";

struct Reported {
    std::string method;  // or kEngine
    bool is_certified = false;
    const char* bodies = "";
    double truth_mm = 0, error_um = 0;
};

Reported reported(std::string method, bool is_certified, const char* bodies, double truth_mm,
                  double clearance_mm) {
    return {std::move(method), is_certified, bodies, truth_mm, 1e3 * (clearance_mm - truth_mm)};
}

/// A position 2^-20 to 2^6 mm (1 nm to 64 mm) back from first contact, within travel.
AxisSnapshot near_contact(PosedMachine& posed, Draw& draw) {
    for (;;) {
        const std::size_t axis = posed.some_linear_axis(draw);
        const bool upwards = draw.sign() > 0;
        auto snapshot = posed.last_clear(posed.anywhere(draw), axis, upwards);
        if (!snapshot) {
            continue;
        }
        const double back_mm = std::exp2(draw.between(-20, 6));
        double& q = snapshot->position[axis];
        q = posed.within_travel(axis, upwards ? q - back_mm : q + back_mm);
        return *snapshot;
    }
}

void query_machine(PosedMachine& posed, const Request& request, std::vector<Reported>& out) {
    Draw draw(request.seed);
    const int poses = request.is_quick ? 12 : 400;
    for (int i = 0; i < poses; ++i) {
        PairQueries& pair_queries = posed.pair_queries(near_contact(posed, draw));
        for (std::uint32_t k = 0; k < pair_queries.count; ++k) {
            Query& query = pair_queries.queries[k];
            query.kind = QueryKind::clearance;
            query.r_mm = kWithinMm;
            QueryResult result;
            posed.engine().run({&query, 1}, {&result, 1});
            if (result.status != QueryStatus::ok || result.clearance_mm >= kWithinMm) {
                continue;
            }
            const double truth_mm =
                exact_clearance_mm(posed.mesh(query.mesh_a).triangles, query.pose,
                                   posed.mesh(query.mesh_b).triangles, kWithinMm);
            out.push_back(reported(kEngine, true, "paper-trunnion", truth_mm, result.clearance_mm));
        }
    }
}

std::optional<CpuEngine> engine_for(const std::vector<Mesh>& meshes) {
    std::vector<const Mesh*> pointers;
    for (const Mesh& mesh : meshes) {
        pointers.push_back(&mesh);
    }
    return CpuEngine::create(pointers, Capacities{});
}

/// mesh_answers.csv: the distance of every case that is apart, by its index in the file of cases.
std::string read_truth(const std::string& folder, const lab::TritriFile& file,
                       std::vector<double>& truth_mm) {
    CsvTable table;
    constexpr std::array<std::string_view, 3> kColumns = {"case_id", "expected", "distance"};
    if (!table.read(folder + "/mesh_answers.csv", kColumns)) {
        return table.error();
    }
    truth_mm.assign(file.ids.size(), -1);
    for (std::size_t row = 0; row < table.row_count(); ++row) {
        const auto at =
            std::find(file.ids.begin(), file.ids.end(),
                      std::strtoul(std::string(table.cell(row, 0)).c_str(), nullptr, 10));
        double distance = 0;
        if (at != file.ids.end() && table.cell(row, 1) == "0" &&
            read_number(table.cell(row, 2), distance)) {
            truth_mm[static_cast<std::size_t>(at - file.ids.begin())] = distance;
        }
    }
    return {};
}

void query_meshes(const lab::TritriFile& file, const std::vector<double>& truth_mm,
                  CpuEngine& engine, std::vector<Reported>& out) {
    for (std::size_t i = 0; i < file.mesh_cases.size(); ++i) {
        if (truth_mm[i] < 0 || truth_mm[i] >= kMarginMmMax) {
            continue;
        }
        // A case places b in the frame of a; a query places its a in the frame of its b.
        const lab::MeshCase& at = file.mesh_cases[i];
        const Query query{.kind = QueryKind::clearance,
                          .mesh_a = at.b,
                          .mesh_b = at.a,
                          .r_mm = kMarginMmMax,
                          .pose = at.pose};
        QueryResult result;
        engine.run({&query, 1}, {&result, 1});
        if (result.status == QueryStatus::ok) {
            out.push_back(reported(kEngine, true, "tritri", truth_mm[i], result.clearance_mm));
        }
    }
    for (const lab::Method& method : lab::methods()) {
        if (!method.gives_distance || method.fused || method.bounding_volume ||
            method.scalar == lab::Scalar::exact) {
            continue;
        }
        const lab::Judged judged = lab::judge_meshes(method, file.meshes, file.mesh_cases);
        for (std::size_t i = 0; i < truth_mm.size(); ++i) {
            if (truth_mm[i] >= 0 && i < judged.distances_mm.size()) {
                out.push_back(reported(std::string(method.name), method.certified, "tritri",
                                       truth_mm[i], judged.distances_mm[i]));
            }
        }
    }
}

void query_tritri(const Request& request, std::vector<Reported>& out, Figure& figure) {
    lab::TritriFile file;
    std::vector<double> truth_mm;
    figure.fault = lab::read_tritri(request.tritri + "/meshes.bin", file);
    if (figure.fault.empty()) {
        figure.fault = read_truth(request.tritri, file, truth_mm);
    }
    if (!figure.fault.empty()) {
        return;
    }
    if (std::optional<CpuEngine> engine = engine_for(file.meshes)) {
        query_meshes(file, truth_mm, *engine, out);
    }
}

std::vector<ClearanceErrors> series_of(const std::vector<Reported>& all) {
    std::vector<ClearanceErrors> out;
    for (const Reported& r : all) {
        auto at = std::find_if(out.begin(), out.end(),
                               [&r](const ClearanceErrors& s) { return s.method == r.method; });
        if (at == out.end()) {
            at = out.insert(out.end(), {.method = r.method, .is_certified = r.is_certified});
        }
        ++at->count;
        at->above += r.error_um > 0 ? 1 : 0;
        at->most_above_um = std::max(at->most_above_um, r.error_um);
        at->most_below_um = std::max(at->most_below_um, -r.error_um);
    }
    return out;
}

std::string table_of(const std::vector<Reported>& all) {
    std::string out = "method,bodies,distance_mm,error_um\n";
    for (const Reported& r : all) {
        out += fmt::format("{},{},{:.9g},{:.4g}\n", r.method, r.bodies, r.truth_mm, r.error_um);
    }
    return out;
}

}  // namespace

Figure clearance_error_figure(const Request& request) {
    Figure out{.name = "clearance-error"};
    const auto posed = PosedMachine::load(request.data + "/config/machines/paper-trunnion.yaml",
                                          Capacities{}, out.fault);
    if (posed == nullptr) {
        return out;
    }
    std::vector<Reported> all;
    query_machine(*posed, request, all);
    if (!request.tritri.empty()) {
        query_tritri(request, all, out);
    }
    const std::vector<ClearanceErrors> series = series_of(all);
    out.summary = describe_clearance_errors(series);
    for (const ClearanceErrors& s : series) {
        out.words += fmt::format(
            "{}: {} of {} clearances above the distance, most {:.3g} um "
            "above, {:.3g} um below\n",
            s.method, s.above, s.count, s.most_above_um, s.most_below_um);
    }
    out.tables = {{"clearance-error.csv", table_of(all)}};
    return out;
}

}  // namespace axg::chart
