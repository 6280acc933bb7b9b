// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/certcheck/look_up.hpp"

#include <charconv>
#include <sstream>

namespace axg::certcheck {
namespace {

std::vector<std::string> cells_of(const std::string& line) {
    std::vector<std::string> cells;
    std::istringstream in(line);
    for (std::string cell; std::getline(in, cell, ',');) {
        cell.erase(cell.find_last_not_of(" \r\t") + 1);
        cell.erase(0, cell.find_first_not_of(" \t"));
        cells.push_back(cell);
    }
    return cells;
}

/// The position in units, or nothing.
bool read_units(const std::string& cell, const Axis& axis, double& units) {
    constexpr double kDegree = 3.14159265358979323846 / 180;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), units);
    units = units * (axis.is_rotary ? kDegree : 1) / axis.unit;
    return error == std::errc() && end == cell.data() + cell.size();
}

bool contains(const AxisBox& box, const std::vector<double>& units) {
    for (std::size_t i = 0; i < units.size(); ++i) {
        if (!(units[i] >= static_cast<double>(box.low[i]) &&
              units[i] <= static_cast<double>(box.high[i]))) {
            return false;
        }
    }
    return true;
}

}  // namespace

LookUp look_up(const std::string& name, const std::string& table, const Model& model,
               const Certificate& certificate, const std::vector<bool>& is_hole) {
    std::istringstream lines(table);
    std::string line;
    std::getline(lines, line);
    const std::vector<std::string> head = cells_of(line);
    std::vector<std::size_t> columns;
    for (const Axis& axis : model.axes) {
        columns.push_back(std::ranges::find(head, axis.name) - head.begin());
        if (columns.back() == head.size()) {
            throw Refusal{12, name + ":1: no column " + axis.name + ". Name every axis."};
        }
    }
    std::vector<AxisBox> tubes;
    for (std::uint64_t i = 0; i < certificate.segments(); ++i) {
        if (!is_hole[i]) {
            tubes.push_back(certificate.tube(i * kParts, (i + 1) * kParts));
        }
    }
    LookUp found;
    std::vector<double> units(columns.size());
    std::size_t at = 0;  // the tube of the position before
    for (std::uint64_t number = 2; std::getline(lines, line); ++number) {
        const std::vector<std::string> cells = cells_of(line);
        for (std::size_t i = 0; i < columns.size(); ++i) {
            if (columns[i] >= cells.size() ||
                !read_units(cells[columns[i]], model.axes[i], units[i])) {
                throw Refusal{12, name + ":" + std::to_string(number) + ": no number for axis " +
                                      model.axes[i].name};
            }
        }
        bool is_inside = false;
        for (std::size_t i = 0; i < tubes.size() && !is_inside; ++i) {
            const std::size_t tried = (at + i) % tubes.size();
            is_inside = contains(tubes[tried], units);
            at = is_inside ? tried : at;
        }
        ++found.positions;
        if (!is_inside && found.outside++ == 0) {
            found.first_outside = number;
        }
    }
    return found;
}

}  // namespace axg::certcheck
