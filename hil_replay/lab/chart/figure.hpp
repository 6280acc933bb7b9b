// SPDX-License-Identifier: Apache-2.0
// A figure of `axguard-lab chart` before it is written: tables, a gnuplot script over them, and
// what to say about it. Measuring a figure touches no file.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace axg::chart {

/// What the figures are measured on.
struct Request {
    std::uint64_t seed = 1;
    bool is_quick = false;
    std::string data;    // holds config/machines/, see AXG_DATA_DIR
    std::string tritri;  // meshes.bin and mesh_answers.csv of exact cases; empty: there are none
};

struct Table {
    std::string file;  // NAME.csv
    std::string text;  // a head line, then rows
};

struct Figure {
    std::string name{};           // NAME.gp draws NAME.svg and NAME.png
    std::vector<Table> tables{};  // what the script reads
    std::string script{};
    std::string summary{};  // counts and times, for --json; empty: none
    std::string words{};    // for people; lines, each with its end
    std::string fault{};    // not empty: nothing was measured, and why
};

}  // namespace axg::chart
