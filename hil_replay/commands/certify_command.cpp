// SPDX-License-Identifier: Apache-2.0
// axguard certify: a certificate for all of a program, and the model that it is about.
// docs/guide/certify.md.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "config/machine/effective_text.hpp"
#include "config/text/quote_text.hpp"
#include "firmware_if/cli/command_line.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/cli/json_output.hpp"
#include "firmware_if/cli/machine_options.hpp"
#include "firmware_if/cli/progress.hpp"
#include "firmware_if/cli/whole_file.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "hil_replay/certify/certificate_file.hpp"
#include "hil_replay/certify/certify_report.hpp"
#include "hil_replay/certify/model_file.hpp"
#include "hil_replay/commands/commands.hpp"
#include "hil_replay/gcode/gcode_arguments.hpp"

namespace axg {
namespace {

constexpr const char* kCertifyExample =
    "axguard certify config/machines/spindle-tilting.yaml "
    "hil_replay/programs/spindle-tilting.ngc -o part.cert";
constexpr const char* kCertifyPurpose =
    "Prove a whole program clear of contact, stops included (docs/guide/certify.md)";
constexpr double kNoCapMmS = 1e6;
constexpr double kPathShare = 0.4;  // of the time, about; for the line of progress

struct CertifyArguments {
    MachineOptions machine;
    GcodeArguments gcode;
    std::string output, model, rapid_cap = "off";
    bool is_partial = false;
    std::uint32_t threads = 0, override_percent = 100;
    double blend_mm = 0;
    JsonOutput json;
};

/// The settings that decide what a program means, one a line.
std::string arguments_text(const CertifyArguments& arguments, const GcodeResult& reading) {
    const GcodeArguments& gcode = arguments.gcode;
    std::string out = fmt::format(
        "start = {}\npart = {}\nblock_delete = {}\nrotary = {}\nrapid_cap = {}\nblend_mm = {}\n"
        "override = {}\n",
        gcode.start, gcode.part, gcode.block_delete, gcode.rotary, arguments.rapid_cap,
        arguments.blend_mm, arguments.override_percent);
    for (const std::string& offset : gcode.work_offsets) {
        out += "work_offset = " + offset + '\n';
    }
    for (const std::string& tool : gcode.tools) {
        out += "tool = " + tool + '\n';
    }
    for (const std::string& word : gcode.ignored) {
        out += "ignored = " + word + '\n';
    }
    if (!reading.subroutines.empty()) {
        out += "subroutines = " + hex_of(sha256_of(reading.subroutines)) + '\n';
    }
    return out + read_as_text(reading.read_as) + '\n';
}

/// Beside the certificate, with the machine file's name.
std::string model_name(const CertifyArguments& arguments) {
    if (!arguments.model.empty()) {
        return arguments.model;
    }
    const std::filesystem::path stem = std::filesystem::path(arguments.machine.file).stem();
    return (std::filesystem::path(arguments.output).parent_path() / stem).string() + ".model";
}

/// With --rapid-cap on the planner cuts feeds, too: a certificate of slower ones is not meant.
bool are_feeds_reached(const CertifyArguments& arguments, const Machine& machine,
                       const Program& program) {
    const double cap_mm_min = 60 * machine.program_speed_mm_s;
    for (const Move& move : program.moves) {
        if (arguments.rapid_cap == "on" && move.feed_kind == FeedKind::per_minute &&
            move.feed > cap_mm_min) {
            fmt::print(stderr,
                       "{}:{}: feed {:g} with the override is above program_speed_mm_min ({:g}). "
                       "State a larger one in the machine file, or leave out --rapid-cap on.\n",
                       escaped(arguments.gcode.program, 4096), move.line, move.feed, cap_mm_min);
            return false;
        }
    }
    return true;
}

/// Whether the planner rounds a corner: a lower feed then takes another path there.
bool rounds_corners(const CertifyArguments& arguments, const Program& program) {
    return arguments.blend_mm > 0 ||
           std::any_of(program.moves.begin(), program.moves.end(),
                       [](const Move& move) { return move.blend_mm > 0; });
}

/// The default name of the model is checked here, for no option names it.
bool is_model_apart(const CertifyArguments& arguments) {
    const std::string model = model_name(arguments);
    std::vector<std::string> others{arguments.machine.file, arguments.gcode.program,
                                    arguments.output};
    if (arguments.json.files && arguments.json.files->json != nullptr) {
        others.push_back(*arguments.json.files->json);
    }
    for (const std::string& other : others) {
        if (std::filesystem::weakly_canonical(model) == std::filesystem::weakly_canonical(other)) {
            fmt::print(stderr,
                       "{}: the model would replace this file. Name another with --model.\n",
                       escaped(model, 4096));
            return false;
        }
    }
    return true;
}

/// The program's moves. False: `code` is the exit code, and what is wrong is printed.
bool read_moves(const CertifyArguments& arguments, const LoadedMachine& loaded,
                GcodeResult& reading, int& code) {
    const Machine& machine = loaded.machine;
    GcodeOptions options;
    code = kExitUsage;
    if (!make_gcode_options(arguments.gcode, machine, program_settings(loaded.source, machine),
                            options)) {
        return false;
    }
    code = kExitInput;
    if (!is_start_inside(machine, options.start) ||
        !read_program(arguments.gcode, machine, options, reading)) {
        return false;
    }
    if (!reading.faults.empty()) {
        fmt::print(stderr,
                   "{}: nothing certified. Correct the program, or see docs/reference/gcode.md.\n",
                   escaped(arguments.gcode.program, 4096));
        return false;
    }
    scale_feeds(reading.program, static_cast<int>(arguments.override_percent));
    return are_feeds_reached(arguments, machine, reading.program);
}

/// The path of the program; empty after a fault, which is printed.
ChordPath plan_path(const CertifyArguments& arguments, const Machine& machine,
                    const GcodeResult& reading, Progress& progress) {
    MotionOptions motion;
    motion.blend_mm = arguments.blend_mm;
    motion.cap_rapids = arguments.rapid_cap == "on";
    Machine unlimited = machine;  // no control has to keep a cap of feeds
    unlimited.program_speed_mm_s = motion.cap_rapids ? machine.program_speed_mm_s : kNoCapMmS;
    PlannedPath planned = plan_chord_path(
        unlimited, reading.program, motion, {}, [&](double program_s, std::uint32_t line) {
            if (progress.is_due()) {
                progress.show(program_s, kPathShare * line / std::max(reading.line_count, 1U),
                              fmt::format("line {}", line));
            }
        });
    const std::string program = escaped(arguments.gcode.program, 4096);
    if (planned.unknown_tool != 0) {
        fmt::print(stderr,
                   "{}:{}: tool {}: the machine file has no such tool. Add it under tools, or "
                   "map its number with --tool.\n",
                   program, planned.unknown_line, planned.unknown_tool);
        return {};
    }
    if (planned.path.segment_count() == 0) {
        fmt::print(stderr, "{}: no axis moves: there is nothing to certify.\n", program);
    }
    return std::move(planned.path);
}

std::uint32_t thread_count(const CertifyArguments& arguments) {
    return arguments.threads != 0 ? arguments.threads
                                  : std::max(1U, std::thread::hardware_concurrency());
}

/// The proof of the whole path. Empty: memory or the processor does not allow it; prints the
/// reason.
std::optional<ProgramProof> prove(const CertifyArguments& arguments, const LoadedMachine& loaded,
                                  const CertifyTasks& tasks, const ChordPath& path,
                                  Progress& progress) {
    std::optional<CpuEngine> engine = make_engine(loaded);
    if (!engine) {
        fmt::print(stderr, "{}\n", kNoLaneSet);
        return std::nullopt;
    }
    const std::optional<ContainmentTest> containment = make_containment_test(loaded, *engine);
    if (!containment) {
        fmt::print(stderr, "{}\n", kNoMemoryForContainment);
        return std::nullopt;
    }
    ProveOptions options{.threads = thread_count(arguments)};
    if (progress.is_terminal()) {
        options.progress = [&progress](double share) {
            if (progress.is_due()) {
                progress.show(kPathShare + (1 - kPathShare) * share, "of the proofs");
            }
        };
    }
    ProgramProof proof = prove_program(loaded, tasks, path, *engine, *containment, options);
    if (proof.tasks.size() != tasks.tasks.size()) {
        fmt::print(stderr, "out of memory for the proofs. Close other programs.\n");
        return std::nullopt;
    }
    return proof;
}

/// Writes both files. Names that are not written stay empty in the report.
bool write_files(const CertifyArguments& arguments, const LoadedMachine& loaded,
                 const GcodeResult& reading, CertifyReport& report) {
    const std::string model = model_file(loaded, report.tasks);
    const Sha256 model_sum = sha256_of(model);
    report.model_sha256 = hex_of(model_sum);
    if (!report.proof.open.empty() && !arguments.is_partial) {
        return true;
    }
    const CertificateSources sources{{"model", model_sum},
                                     {"machine", sha256_of(effective_text(loaded.machine))},
                                     {"program", sha256_of(reading.text)},
                                     {"arguments", sha256_of(arguments_text(arguments, reading))}};
    const std::string certificate =
        certificate_file(loaded.machine, report.path, report.proof, sources, AXG_VERSION);
    const std::string name = model_name(arguments);
    if (!write_whole_file(name, model, stderr) ||
        !write_whole_file(arguments.output, certificate, stderr)) {
        return false;
    }
    report.certificate = arguments.output;
    report.certificate_bytes = certificate.size();
    report.model = name;
    return true;
}

int run_certify(const CertifyArguments& arguments) {
    const auto begin = std::chrono::steady_clock::now();
    if (!is_model_apart(arguments)) {
        return kExitUsage;
    }
    LoadedMachine loaded;
    if (const int code = load(arguments.machine, loaded); code != kExitClean) {
        return code;
    }
    GcodeResult reading;
    if (int code = kExitClean; !read_moves(arguments, loaded, reading, code)) {
        return code;
    }
    std::optional<Progress> progress(std::in_place);
    const ChordPath path = plan_path(arguments, loaded.machine, reading, *progress);
    if (path.segment_count() == 0) {
        return kExitInput;
    }
    const CertifyTasks tasks = certify_tasks(loaded);
    const std::optional<ProgramProof> proof = prove(arguments, loaded, tasks, path, *progress);
    progress.reset();
    if (!proof) {
        return kExitInternal;
    }
    CertifyReport report{.machine = loaded.machine,
                         .tasks = tasks,
                         .path = path,
                         .proof = *proof,
                         .program = escaped(arguments.gcode.program, 4096),
                         .override_percent = arguments.override_percent,
                         .covers_lower = !rounds_corners(arguments, reading.program)};
    if (!write_files(arguments, loaded, reading, report)) {
        return kExitInternal;
    }
    report.spent_s =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    print_certify(report, arguments.json.words());
    if (!write_json(arguments.json, describe_certify(report))) {
        return kExitInternal;
    }
    return proof->open.empty() ? kExitClean : kExitCollision;
}

}  // namespace

void add_certify(CommandLine& line) {
    const auto arguments = std::make_shared<CertifyArguments>();
    const Command command = line.add_command("certify", kCertifyPurpose);
    command.set_group("Try programs");
    command.set_example(kCertifyExample);
    add_machine_options(command, arguments->machine);
    add_gcode_options(command, arguments->gcode);
    command.add_output("-o,--output", arguments->output, "certificate to write").required();
    command.add_output("--model", arguments->model,
                       "model to write [default: MACHINE.model beside the certificate]");
    command.add_flag("--partial", arguments->is_partial,
                     "write a certificate with holes where some line is not proven");
    command
        .add_option("--override", arguments->override_percent,
                    "largest feed override that the certificate covers, %")
        .between(100, 150)
        .shows_default();
    command.add_option("--threads", arguments->threads, "threads [default: one per processor]")
        .between(1, 256);
    command
        .add_option("--rapid-cap", arguments->rapid_cap,
                    "on: limit G0 to program_speed_mm_min too; off: only to the axis limits")
        .one_of({"on", "off"})
        .shows_default();
    command
        .add_option("--blend-mm", arguments->blend_mm,
                    "corner tolerance where no G64 P states one, mm; 0 = stop at every corner")
        .between(0.0, 10.0)
        .shows_default();
    add_json_option(command, arguments->json);
    command.set_action([arguments] { return run_certify(*arguments); });
}

}  // namespace axg
