// SPDX-License-Identifier: Apache-2.0
// A figure of `axguard-lab chart` before it is written: tables, and a summary. Measuring a figure
// writes no file.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hil_replay/plan/draw_figures.hpp"

namespace axg::chart {

/// Inputs of the measurements.
struct Request {
    std::uint64_t seed = 1;
    bool is_quick = false;
    std::string data;    // holds config/machines/, see AXG_DATA_DIR
    std::string tritri;  // meshes.bin and mesh_answers.csv of exact cases; empty: none
};

struct Table {
    std::string file;  // NAME.csv
    std::string text;  // a head line, then rows
};

struct Figure {
    std::string name{};           // drawn as NAME.svg and NAME.png
    std::vector<Table> tables{};  // what draw_figures.py draws
    Conditions conditions{};      // what its captions state and no table contains
    std::string summary{};        // counts and times, for --json; empty: none
    std::string words{};          // readable text; each line ends with \n
    std::string fault{};          // why the measurement failed; empty: success
};

}  // namespace axg::chart
