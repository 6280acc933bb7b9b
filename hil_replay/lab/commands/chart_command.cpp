// SPDX-License-Identifier: Apache-2.0
// axguard-lab chart: measures verdicts and times of the methods, writes tables and draws them.
#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "config/text/quote_text.hpp"
#include "core/machine/machine.hpp"
#include "firmware_if/cli/command_line.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/cli/json_output.hpp"
#include "firmware_if/cli/whole_file.hpp"
#include "hil_replay/lab/commands/lab_commands.hpp"
#include "hil_replay/lab/commands/lab_commands_json.hpp"
#ifdef AXG_EXACT
#include "hil_replay/lab/chart/figures.hpp"
#include "hil_replay/lab/chart/processor.hpp"
#include "hil_replay/plan/draw_figures.hpp"
#endif

namespace axg {
namespace {

struct ChartOptions {
    std::string out, data = AXG_DATA_DIR, tritri;
    std::uint64_t seed = 1;
    bool quick = false;
    JsonOutput json;
};

#ifdef AXG_EXACT

using chart::Figure;
using chart::Request;

struct Step {
    const char* name;
    std::vector<Figure> (*measure)(const Request& request);
};

template <Figure (*kMeasure)(const Request&)>
std::vector<Figure> one(const Request& request) {
    std::vector<Figure> figures;
    figures.push_back(kMeasure(request));
    return figures;
}

constexpr Step kSteps[] = {
    {"methods", &chart::method_figures},
    {"cycles", &one<&chart::cycle_figure>},
    {"models", &one<&chart::model_figure>},
    {"undecided gap", &one<&chart::undecided_gap_figure>},
    {"rechecks", &one<&chart::rechecks_figure>},
    {"clearance error", &one<&chart::clearance_error_figure>},
    {"flips", &one<&chart::flips_figure>},
};

/// Measures the figures of one step, writes their tables, and prints their text.
int take_step(const Step& step, const Request& request, const ChartOptions& options,
              ChartDocument& document, Conditions& conditions) {
    for (const Figure& figure : step.measure(request)) {
        if (!figure.fault.empty()) {
            fmt::print(stderr, "axguard-lab chart: {}\n", figure.fault);
            return kExitInput;
        }
        for (const chart::Table& table : figure.tables) {
            const std::filesystem::path path = std::filesystem::path(options.out) / table.file;
            if (!write_whole_file(path.string(), table.text, stderr)) {
                return kExitInternal;
            }
        }
        conditions.insert(conditions.end(), figure.conditions.begin(), figure.conditions.end());
        document.figures.push_back({figure.name, false, figure.summary});
        fmt::print(options.json.words(), "{}", figure.words);
    }
    return kExitClean;
}

/// Draws the tables of the folder.
int draw_all(const ChartOptions& options, const Conditions& conditions, ChartDocument& document) {
    const std::filesystem::path path = std::filesystem::path(options.out) / "conditions.csv";
    if (!write_whole_file(path.string(), conditions_table(conditions), stderr)) {
        return kExitInternal;
    }
    const Drawn drawn = draw_figures("lab/chart/draw_figures.py", options.out);
    if (drawn == Drawn::failed) {
        return kExitInternal;
    }
    for (auto& figure : document.figures) {
        figure.is_drawn = drawn == Drawn::yes;
    }
    fmt::print(options.json.words(), "{}: tables (.csv){}\n", options.out,
               drawn == Drawn::yes ? " and figures (.svg, .png)" : "");
    return kExitClean;
}

/// Checks the input files before measurements of minutes. Returns a fault, or empty.
std::string missing_input(const ChartOptions& options) {
    namespace fs = std::filesystem;
    const fs::path machine = fs::path(options.data) / "config/machines/paper-trunnion.yaml";
    std::error_code error;
    if (!fs::exists(machine, error)) {
        return escaped(machine.string(), 4096) +
               ": file not found. Pass the folder that contains config/ with --data FOLDER.";
    }
    for (const char* const file : {"meshes.bin", "mesh_answers.csv"}) {
        const fs::path path = fs::path(options.tritri) / file;
        if (!options.tritri.empty() && !fs::exists(path, error)) {
            return escaped(path.string(), 4096) +
                   ": file not found. Pass the folder of meshes.bin and mesh_answers.csv with "
                   "--tritri FOLDER, or leave the option out to measure only the machine.";
        }
    }
    return {};
}

int chart_all(const ChartOptions& options) {
    std::error_code error;
    std::filesystem::create_directories(options.out, error);
    if (error) {
        fmt::print(stderr, "{}: {}. Pass another folder with -o FOLDER.\n",
                   escaped(options.out, 4096), error.message());
        return kExitInput;
    }
    if (const std::string fault = missing_input(options); !fault.empty()) {
        fmt::print(stderr, "{}\n", fault);
        return kExitInput;
    }
    const Request request{.seed = options.seed,
                          .is_quick = options.quick,
                          .data = options.data,
                          .tritri = options.tritri};
    ChartDocument document{.seed = options.seed, .is_quick = options.quick, .figures = {}};
    const bool is_terminal = isatty(STDERR_FILENO) == 1;
    Conditions conditions{{"seed", std::to_string(options.seed)},
                          {"deadline_us", std::to_string(Machine{}.deadline_us)},
                          {"processor", chart::format_processor()}};
    std::size_t number = 0;
    for (const Step& step : kSteps) {
        if (is_terminal) {
            fmt::print(stderr, "\rstep {} of {}: {}{:20}\r", ++number, std::size(kSteps), step.name,
                       "");
        }
        const int exit_code = take_step(step, request, options, document, conditions);
        if (exit_code != kExitClean) {
            return exit_code;
        }
    }
    if (const int exit_code = draw_all(options, conditions, document); exit_code != kExitClean) {
        return exit_code;
    }
    return write_json(options.json, describe_chart(document)) ? kExitClean : kExitInternal;
}

#else

int chart_all(const ChartOptions&) {
    fmt::print(stderr,
               "axguard-lab chart: this build has no exact judge. Install GMP (Debian: apt-get "
               "install libgmp-dev) and build again.\n");
    return kExitInput;
}

#endif

}  // namespace

void add_chart(CommandLine& line) {
    auto options = std::make_shared<ChartOptions>();
    const Command command = line.add_command(
        "chart", "Measure speed and accuracy of many methods and draw the figures");
    command.set_example("axguard-lab chart -o figures/");
    command.add_output_folder("-o,--output", options->out, "folder for tables and figures")
        .required();
    command.add_option("--seed", options->seed, "seed of all random values");
    command.add_flag("--quick", options->quick, "use few cases: seconds instead of minutes");
    command.add_option(
        "--tritri", options->tritri,
        "folder with meshes.bin and mesh_answers.csv, the exact distances of meshes");
    command.add_option("--data", options->data,
                       "folder that contains config/ [default: source tree]");
    add_json_option(command, options->json);
    command.set_action([options] { return chart_all(*options); });
}

}  // namespace axg
