// SPDX-License-Identifier: Apache-2.0
// axguard demo: the main job on an example machine. It runs the commands that a person would type,
// shows the result on one screen and writes all that they print to a log.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "config/text/quote_text.hpp"
#include "firmware_if/cli/command_line.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/cli/whole_file.hpp"
#include "hil_replay/commands/axguard.hpp"
#include "hil_replay/commands/captured_stdout.hpp"
#include "hil_replay/commands/commands.hpp"
#include "hil_replay/commands/commands_json.hpp"
#include "hil_replay/commands/details_option.hpp"
#include "hil_replay/commands/shell_text.hpp"
#include "hil_replay/replay/replay_brief.hpp"

namespace axg {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kColumns = 100;
constexpr std::size_t kBlockBytesMax = 60;  // of a line of the program

struct DemoOptions {
    std::string data = AXG_DATA_DIR, out = "axguard-demo";
    bool has_details = false;
};

/// The results of a replay for the screen.
struct DemoReplay {
    std::string proven, cycle, stop, why;  // lines; stop and why: of the first stop
    double stop_s = 0;
    std::string reason;
};

/// A replay is not in real time: if other programs delayed a cycle, the longest time is no property
/// of the guard, and only the log contains it.
std::string demo_cycle_text(const ReplayReport& report) {
    const ReplayRun& run = report.run;
    const TimeHistogram& times = run.cycles();
    const std::string usual =
        fmt::format("time of a cycle: median {:.1f} us, p99 {:.1f} us",
                    us_of(times.at_share_ns(0.5)), us_of(times.at_share_ns(0.99)));
    return run.overruns() == 0 ? fmt::format("{}, longest {:.1f} us; deadline {} us", usual,
                                             us_of(times.most_ns()), report.deadline_us)
                               : fmt::format("{}; deadline {} us ({} late: no real-time priority)",
                                             usual, report.deadline_us, run.overruns());
}

DemoReplay demo_replay(const ReplayReport& report) {
    DemoReplay out;
    out.proven = proven_text(report);
    out.cycle = demo_cycle_text(report);
    if (report.run.stops().empty()) {
        return out;
    }
    const StopEvent& stop = report.run.stops().front();
    out.stop_s = static_cast<double>(stop.time_us) * 1e-6;
    out.reason = reason_text(stop);
    out.stop = fmt::format("stop at {:.3f} s", out.stop_s);
    if (const ProgramStep* step = step_at(report.lines, stop.snapshot.arrived_us)) {
        out.stop += fmt::format(", line {}: {}", step->line, escaped(step->block, kBlockBytesMax));
    }
    if (const auto why = report.whys.find(&stop); why != report.whys.end()) {
        for (const std::string& sentence : why_sentences(report.loaded.machine, why->second)) {
            out.why += fmt::format("   {}\n", sentence);
        }
    }
    return out;
}

/// Runs commands, one after the other, and writes their output to a log.
class DemoRun {
  public:
    explicit DemoRun(bool has_details) : has_details_(has_details) {}

    /// False: it did not end with the exit code that the demo expects; the reason is printed.
    bool type(std::vector<std::string> words, int wanted, DemoReplay* seen = nullptr) {
        if (seen != nullptr) {
            words.emplace_back("--details");
        }
        const std::string command = fmt::format("$ axguard {}\n", fmt::join(words, " "));
        int exit_code = kExitInternal;
        const ReplayObserver observer = [seen](const ReplayReport& report) {
            *seen = demo_replay(report);
        };
        const std::string said = captured_stdout(
            [&] { exit_code = run_axguard(words, seen == nullptr ? nullptr : observer); });
        log_ += command + said + "\n";
        const bool is_as_told = exit_code == wanted;
        if (has_details_ || !is_as_told) {
            fmt::print(is_as_told ? stdout : stderr, "\n{}{}", command, said);
        }
        if (!is_as_told) {
            fmt::print(stderr, "axguard demo: the command failed (exit code {}, expected {}).\n",
                       exit_code, wanted);
        }
        std::fflush(stdout);
        return is_as_told;
    }
    [[nodiscard]] const std::string& log() const noexcept { return log_; }

  private:
    bool has_details_;
    std::string log_;
};

struct DemoFiles {
    std::string machine, machines, meshes, clean_program, program;  // as commands are given them
    std::string clean_trace, trace, frames, page, capped, capped_result, log;  // written
};

DemoFiles demo_files(const DemoOptions& options) {
    const fs::path data = options.data, out = options.out;
    const auto given = [&data](const char* name) { return shorter_path((data / name).string()); };
    return {.machine = given("config/machines/paper-trunnion.yaml"),
            .machines = given("config/machines"),
            .meshes = given("config/machines/meshes/paper-trunnion"),
            .clean_program = given("hil_replay/programs/paper-trunnion-clean.ngc"),
            .program = given("hil_replay/programs/paper-trunnion-demo.ngc"),
            .clean_trace = out / "clean.log",
            .trace = out / "collision.log",
            .frames = out / "guard.log",
            .page = out / "collision.html",
            .capped = out / "capped.yaml",
            .capped_result = out / "capped.json",
            .log = out / "details.txt"};
}

/// Both programs, each shown when it is done. False: a command failed.
bool run_programs(const DemoFiles& files, DemoRun& run) {
    DemoReplay clean, stopped, contact;
    if (!run.type({"simulate", files.machine, files.clean_program, "-o", files.clean_trace},
                  kExitClean) ||
        !run.type({"replay", files.machine, files.clean_trace}, kExitClean, &clean)) {
        return false;
    }
    fmt::print("\n1  {} runs to its end\n   {}\n   {}\n",
               fs::path(files.clean_program).filename().string(), clean.proven, clean.cycle);
    std::fflush(stdout);
    if (!run.type({"simulate", files.machine, files.program, "-o", files.trace}, kExitClean) ||
        !run.type({"replay", files.machine, files.trace, "--frames-out", files.frames, "--report",
                   files.page},
                  kExitCollision, &stopped) ||
        !run.type({"replay", files.machine, files.trace, "--mode", "contact"}, kExitCollision,
                  &contact)) {
        return false;
    }
    fmt::print(
        "\n2  {} drives the cutter into the plate: the guard stops it before\n"
        "   {}\n   {}\n   {}\n{}"
        "   without the guard, cutter and plate are in {} {:.3f} s later (replay --mode contact)\n",
        fs::path(files.program).filename().string(), stopped.proven, stopped.cycle, stopped.stop,
        stopped.why, contact.reason, contact.stop_s - stopped.stop_s);
    return true;
}

std::string text_of(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// The second program once more, on a board that keeps a cap. False: a file or a command failed.
bool run_capped(const DemoFiles& files, DemoRun& run) {
    std::string machine = text_of(files.machine);
    const std::string guard = "\nguard:\n";
    if (const std::size_t at = machine.find(guard); at != std::string::npos) {
        machine.insert(at + guard.size(), "  cap: per_axis\n");
    }
    if (!write_whole_file(files.capped, machine, stderr) ||
        !run.type({"drive", files.capped, files.program, "--mesh-root", files.machines,
                   "--advice-s", "0", "--json=" + files.capped_result},
                  kExitCollision)) {
        return false;
    }
    const double rest_mm = number_at(text_of(files.capped_result), "/pairs/0/clearance_mm");
    fmt::print(
        "\n3  as 2 with guard: {{cap: per_axis}}: permits cap speeds, the board rests {:.2f} mm "
        "above the plate\n",
        rest_mm);
    return true;
}

/// Prints the files written, and the next commands.
void print_next(const DemoFiles& files) {
    fmt::print("\npage  {}: the machine in motion up to the stop; open it in a browser\n",
               files.page);
    fmt::print("logs  {}: all that the commands print; {}: every permit, then the stop\n",
               files.log, fs::path(files.frames).filename().string());
    const std::string program = own_command();
    struct Step {
        const char* what;
        std::vector<std::string> words;
    };
    const Step steps[] = {
        {"what the guard knows of it", {program, "check", files.machine}},
        {"a simulated board brakes", {program, "drive", files.machine, files.program}},
        {"your machine, from STL files",
         {program, "init", files.meshes, "-o", "my-machine.yaml", "--unit", "mm"}}};
    const char* head = "next";
    for (const Step& step : steps) {
        const std::string command = shell_command(step.words, 6, kColumns);
        const std::size_t last = command.rfind('\n');
        const std::size_t used =
            last == std::string::npos ? 6 + command.size() : command.size() - last - 1;
        const std::string note = std::string("  # ") + step.what;
        fmt::print("{:<6}{}{}\n", head, command, used + note.size() <= kColumns ? note : "");
        head = "";
    }
}

int demo(const DemoOptions& options) {
    const DemoFiles files = demo_files(options);
    std::error_code code;
    if (!fs::exists(files.machine, code)) {
        fmt::print(stderr,
                   "{}: file not found. Pass the folder that contains config/ and hil_replay/ with "
                   "--data FOLDER.\n",
                   files.machine);
        return kExitInput;
    }
    fs::create_directories(options.out, code);
    if (code) {
        fmt::print(stderr, "{}: {}. Pass another folder with --output FOLDER.\n", options.out,
                   code.message());
        return kExitInput;
    }
    fmt::print(
        "axguard demo: a simulated five-axis mill; its plate is the body c. No GPU, no CAN, no "
        "motion\n"
        "proven: at that sample the machine can still stop before two of its bodies touch\n");
    std::fflush(stdout);
    DemoRun run(options.has_details);
    const bool is_done = run_programs(files, run) && run_capped(files, run);
    const bool is_logged = write_whole_file(files.log, run.log(), stderr);
    if (!is_done || !is_logged) {
        return kExitInternal;
    }
    print_next(files);
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
    command.add_output_folder("-o,--output", options->out, "folder for traces, report and log")
        .shows_default();
    add_details_option(command, options->has_details);
    command.set_action([options] { return demo(*options); });
}

}  // namespace axg
