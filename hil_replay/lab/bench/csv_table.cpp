// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/bench/csv_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <system_error>

#include "config/text/quote_text.hpp"
#include "core/base/finite.hpp"

namespace axg {
namespace {

std::vector<std::string_view> cut(std::string_view line) {
    std::vector<std::string_view> cells;
    for (std::size_t at = 0;; ++at) {
        const std::size_t comma = std::min(line.find(',', at), line.size());
        std::string_view cell = line.substr(at, comma - at);
        while (!cell.empty() && (cell.front() == ' ' || cell.front() == '\t')) {
            cell.remove_prefix(1);
        }
        while (!cell.empty() && (cell.back() == ' ' || cell.back() == '\t')) {
            cell.remove_suffix(1);
        }
        if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"') {
            cell = cell.substr(1, cell.size() - 2);
        }
        cells.push_back(cell);
        if (comma == line.size()) {
            return cells;
        }
        at = comma;
    }
}

/// Uses stdio because a stream throws when it reads a folder.
bool read_file(const std::string& path, std::string& out) {
    std::FILE* const file = std::fopen(path.c_str(), "rb");
    if (file == nullptr) {
        return false;
    }
    std::array<char, 65536> room;
    while (const std::size_t got = std::fread(room.data(), 1, room.size(), file)) {
        out.append(room.data(), got);
    }
    const bool is_good = std::ferror(file) == 0;
    std::fclose(file);
    return is_good;
}

}  // namespace

bool CsvTable::refuse(std::uint64_t line, const std::string& message) {
    error_ =
        fmt::format("{}:{}: {}", escaped(path_, 4096), std::max<std::uint64_t>(line, 1), message);
    return false;
}

std::string CsvTable::where(std::size_t row) const {
    return fmt::format("{}:{}", escaped(path_, 4096), lines_[row]);
}

bool CsvTable::read(const std::string& path, std::span<const std::string_view> columns) {
    path_ = path;
    text_.clear();
    if (!read_file(path, text_)) {
        error_ = fmt::format(
            "{}: cannot be read. A scene folder contains bodies.csv, pairs.csv, poses.csv and the "
            "STL files.",
            escaped(path, 4096));
        return false;
    }
    column_count_ = columns.size();
    std::vector<std::size_t> place;
    std::size_t head_size = 0;
    std::uint64_t number = 0;
    std::string_view rest = text_;
    if (constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
        rest.starts_with(kByteOrderMark)) {
        rest.remove_prefix(kByteOrderMark.size());
    }
    while (!rest.empty()) {
        ++number;
        const std::size_t end = std::min(rest.find('\n'), rest.size());
        std::string_view line = rest.substr(0, end);
        rest.remove_prefix(std::min(end + 1, rest.size()));
        if (!line.empty() && line.back() == '\r') {
            line.remove_suffix(1);
        }
        if (line.empty()) {
            continue;
        }
        const std::vector<std::string_view> cells = cut(line);
        if (place.empty()) {
            head_size = cells.size();
            for (const std::string_view column : columns) {
                const auto found = std::find(cells.begin(), cells.end(), column);
                if (found == cells.end()) {
                    return refuse(number, fmt::format("no column '{}' (expected the head {})",
                                                      column, fmt::join(columns, ",")));
                }
                place.push_back(static_cast<std::size_t>(found - cells.begin()));
            }
            continue;
        }
        if (cells.size() != head_size) {
            return refuse(number, fmt::format("{} cells (expected {}, as in the head)",
                                              cells.size(), head_size));
        }
        for (const std::size_t at : place) {
            cells_.push_back(cells[at]);
        }
        lines_.push_back(number);
    }
    return !lines_.empty() || refuse(number, "no rows (expected at least one below the head)");
}

bool read_number(std::string_view text, double& out) noexcept {
    const char* const end = text.data() + text.size();
    const auto [stop, code] = std::from_chars(text.data(), end, out);
    return code == std::errc{} && stop == end && is_finite(out);
}

}  // namespace axg
