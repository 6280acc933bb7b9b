// SPDX-License-Identifier: Apache-2.0
// axguard demo: the main job on an example machine, each step as the command a person would type.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "firmware_if/cli/command_line.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "hil_replay/commands/axguard.hpp"
#include "hil_replay/commands/commands.hpp"

namespace axg {
namespace {

namespace fs = std::filesystem;

struct DemoOptions {
    std::string data = AXG_DATA_DIR, out = "axguard-demo";
};

/// Prints the command, runs it. True when it ended with the exit code this demo is about.
bool type(const std::vector<std::string>& words, int wanted) {
    fmt::print("\n$ axguard {}\n", fmt::join(words, " "));
    std::fflush(stdout);
    const int exit_code = run_axguard(words);
    std::fflush(stdout);
    if (exit_code != wanted && exit_code != kExitDeadline) {
        fmt::print(stderr, "axguard demo: the command failed (exit code {}, expected {}).\n",
                   exit_code, wanted);
        return false;
    }
    return true;
}

int demo(const DemoOptions& options) {
    const fs::path data = options.data, out = options.out;
    const std::string machine = data / "config/machines/paper-trunnion.yaml";
    const std::string programs = data / "hil_replay/programs/paper-trunnion-";
    std::error_code code;
    if (!fs::exists(machine, code)) {
        fmt::print(stderr,
                   "{}: file not found. Pass the folder that contains config/ and hil_replay/ with "
                   "--data FOLDER.\n",
                   machine);
        return kExitInput;
    }
    fs::create_directories(out, code);
    if (code) {
        fmt::print(stderr, "{}: {}. Pass another folder with --out FOLDER.\n", out.string(),
                   code.message());
        return kExitInput;
    }
    const std::string trace = out / "collision.log", clean = out / "clean.log",
                      page = out / "collision.html";
    fmt::print("A five-axis mill with a tilting cradle, two programs, no GPU, no CAN.\n");
    const bool as_told =
        type({"simulate", machine, programs + "clean.ngc", "-o", clean}, kExitClean) &&
        type({"replay", machine, clean}, kExitClean) &&
        type({"simulate", machine, programs + "demo.ngc", "-o", trace}, kExitClean) &&
        type({"replay", machine, trace, "--frames-out", out / "guard.log", "--report", page},
             kExitCollision) &&
        type({"replay", machine, trace, "--mode", "contact"}, kExitCollision);
    if (!as_told) {
        return kExitInternal;
    }
    fmt::print(
        "\nThe first program ran to its end: every sample had a stop certificate. The second "
        "drives the cutter\ninto the plate: the guard stopped it while a stop still ends clear of "
        "the plate. Mode contact, as in\nthe seed paper, checks only the sampled poses and detects "
        "the collision at contact.\n  {}: the machine in motion, up to the stop; open it in a "
        "browser\n  {}: every permit, then the stop\n",
        page, (out / "guard.log").string());
    return kExitClean;
}

}  // namespace

void add_demo(CommandLine& line) {
    auto options = std::make_shared<DemoOptions>();
    const Command command = line.add_command(
        "demo", "Simulate and replay two programs and report the collision in one of them");
    command.set_group("Set up a machine");
    command.set_example("axguard demo");
    command.add_option("--data", options->data, "folder that contains config/ and hil_replay/");
    command.add_output_folder("--out", options->out, "folder for traces and report")
        .shows_default();
    command.set_action([options] { return demo(*options); });
}

}  // namespace axg
