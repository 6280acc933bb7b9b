// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/chart/posed_machine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/sincos.hpp"

namespace axg::chart {
namespace {

double low(const Axis& axis) {
    return axis.unlimited ? 0 : axis.min;
}
double high(const Axis& axis) {
    return axis.unlimited ? 2 * kPi : axis.max;
}

}  // namespace

std::unique_ptr<PosedMachine> PosedMachine::load(const std::string& file,
                                                 const Capacities& capacities, std::string& fault) {
    LoadedMachine loaded;
    if (!axg::load(file, "", loaded, stderr)) {
        fault = file + ": not usable; --data FOLDER names the folder that holds config/machines";
        return nullptr;
    }
    loaded.machine.capacities = capacities;
    std::optional<CpuEngine> engine = make_engine(loaded);
    if (!engine) {
        fault = kNoLaneSet;
        return nullptr;
    }
    return std::make_unique<PosedMachine>(std::move(loaded), std::move(*engine));
}

PairQueries& PosedMachine::pair_queries(const AxisSnapshot& snapshot) {
    make_contact_queries(loaded_.machine, snapshot, pair_queries_);
    return pair_queries_;
}

std::string PosedMachine::pair_name(std::uint32_t pair) const {
    const Pair& p = loaded_.machine.pairs[pair];
    return loaded_.machine.bodies[p.a].name + "-" + loaded_.machine.bodies[p.b].name;
}

AxisSnapshot PosedMachine::anywhere(lab::Draw& draw) const {
    AxisSnapshot snapshot;
    snapshot.axis_count = static_cast<std::uint32_t>(loaded_.machine.axes.size());
    for (std::size_t i = 0; i < snapshot.axis_count; ++i) {
        const Axis& axis = loaded_.machine.axes[i];
        snapshot.position[i] = draw.between(low(axis), high(axis));
    }
    return snapshot;
}

AxisSnapshot PosedMachine::square(lab::Draw& draw) const {
    AxisSnapshot snapshot = anywhere(draw);
    for (std::size_t i = 0; i < snapshot.axis_count; ++i) {
        const double step = loaded_.machine.axes[i].kind == AxisKind::rotary ? kPi / 2 : 1;
        const double turned = std::round(snapshot.position[i] / step) * step;
        snapshot.position[i] = within_travel(i, turned) == turned ? turned : 0;
    }
    return snapshot;
}

bool PosedMachine::is_clear(const AxisSnapshot& snapshot) {
    const PairQueries& cycle = pair_queries(snapshot);
    std::vector<QueryResult> results(cycle.count);
    engine_.run({cycle.queries.data(), cycle.count}, results);
    return cycle.status == SnapshotStatus::ok &&
           std::all_of(results.begin(), results.end(),
                       [](const QueryResult& a) { return a.proof == Proof::far; });
}

std::optional<AxisSnapshot> PosedMachine::last_clear(AxisSnapshot snapshot, std::size_t axis,
                                                     bool upwards) {
    constexpr double kStepMm = 4;  // may skip a thin body and find a later contact
    if (!is_clear(snapshot)) {
        return std::nullopt;
    }
    const double step = upwards ? kStepMm : -kStepMm;
    double clear = snapshot.position[axis];
    double blocked = within_travel(axis, clear + step);
    for (;; clear = blocked, blocked = within_travel(axis, clear + step)) {
        if (blocked == clear) {
            return std::nullopt;
        }
        snapshot.position[axis] = blocked;
        if (!is_clear(snapshot)) {
            break;
        }
    }
    for (double middle = clear + (blocked - clear) / 2; middle != clear && middle != blocked;
         middle = clear + (blocked - clear) / 2) {
        snapshot.position[axis] = middle;
        (is_clear(snapshot) ? clear : blocked) = middle;
    }
    snapshot.position[axis] = clear;
    return snapshot;
}

std::size_t PosedMachine::some_linear_axis(lab::Draw& draw) const {
    std::vector<std::size_t> linear;
    for (std::size_t i = 0; i < loaded_.machine.axes.size(); ++i) {
        if (loaded_.machine.axes[i].kind == AxisKind::linear) {
            linear.push_back(i);
        }
    }
    return linear[draw.below(static_cast<std::uint32_t>(linear.size()))];
}

double PosedMachine::within_travel(std::size_t axis, double position) const {
    return std::clamp(position, low(loaded_.machine.axes[axis]), high(loaded_.machine.axes[axis]));
}

std::string PosedMachine::format_position(const AxisSnapshot& snapshot) const {
    std::string out;
    for (std::size_t i = 0; i < snapshot.axis_count; ++i) {
        const Axis& axis = loaded_.machine.axes[i];
        const double unit = axis.kind == AxisKind::rotary ? 180 / kPi : 1;
        out +=
            fmt::format("{}{} {:.9g}", i == 0 ? "" : ", ", axis.name, snapshot.position[i] * unit);
    }
    return out;
}

}  // namespace axg::chart
