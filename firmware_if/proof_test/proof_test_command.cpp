// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/proof_test/proof_test_command.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <termios.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <ctime>
#include <iostream>
#include <memory>
#include <string>
#include <thread>

#include "config/text/quote_text.hpp"
#include "firmware_if/cli/command_line.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/proof_test/proof_steps.hpp"
#include "firmware_if/system/status_socket.hpp"

namespace axg {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kLook{100};

struct ProofArguments {
    std::string bus, socket, log_file, person, pair;
    double person_seconds = 120;
};

/// Result of one look at the socket.
struct Look {
    std::optional<GuardSight> sight;
    std::string fault;
    bool is_other_version = false;
};

Look look_at(const std::string& path) {
    Look out;
    const std::string line = read_status(path, out.fault);
    if (out.fault.empty()) {
        out.sight = sight_of(line);
        out.is_other_version = !out.sight;
    }
    return out;
}

/// The maintenance file: one line a step, added at its end, on the disk before the next step.
class ProofLog {
  public:
    explicit ProofLog(const std::string& path) : file_(std::fopen(path.c_str(), "a")) {}
    ~ProofLog() {
        if (file_ != nullptr) {
            (void)std::fclose(file_);
        }
    }
    ProofLog(const ProofLog&) = delete;
    ProofLog& operator=(const ProofLog&) = delete;

    [[nodiscard]] bool is_open() const noexcept { return file_ != nullptr; }
    /// False: this line, or one before, is not in the file.
    bool put(const GuardSight& guard, const std::string& text) {
        const std::string line =
            fmt::format("{:%Y-%m-%dT%H:%M:%SZ} {} {} {:.8} {}\n", fmt::gmtime(std::time(nullptr)),
                        guard.bus, guard.machine, guard.configuration, text);
        fmt::print("{}", line);
        is_whole_ = is_whole_ && std::fputs(line.c_str(), file_) >= 0 && std::fflush(file_) == 0;
        return is_whole_;
    }

  private:
    std::FILE* file_;
    bool is_whole_ = true;
};

/// An answer other than yes, or none, is no. A line typed before the question is no answer.
bool is_yes(const char* question) {
    if (isatty(STDIN_FILENO) == 1) {
        tcflush(STDIN_FILENO, TCIFLUSH);
        std::cin.ignore(std::cin.rdbuf()->in_avail());
    }
    fmt::print(stderr, "  {} Type yes or no: ", question);
    std::string word;
    std::getline(std::cin, word);
    return word == "yes";
}

/// How a step ended, and what it rests on.
struct Outcome {
    bool is_passed;
    std::string why;
    GuardSight last;  // seen of the guard
};

/// Waits until the guard shows what the step is about, or for the person's time.
Outcome watch_step(const ProofStep& step, const ProofArguments& arguments, const std::string& path,
                   const GuardSight& before) {
    Outcome out{.is_passed = false, .why = {}, .last = before};
    if (step.judge == nullptr) {
        return {.is_passed = true, .why = "answered", .last = before};
    }
    const auto end = Clock::now() + std::chrono::duration<double>(arguments.person_seconds);
    bool was_gone = false;
    for (std::string shown; Clock::now() < end; std::this_thread::sleep_for(kLook)) {
        const Look look = look_at(path);
        const std::string summary = look.sight ? summary_of(*look.sight) : "no reply";
        if (summary != shown) {
            fmt::print(stderr, "  {}\n", summary);
            shown = summary;
        }
        was_gone = was_gone || !look.fault.empty();
        if (!look.sight) {
            continue;
        }
        out.last = *look.sight;
        if (out.last.configuration != before.configuration) {
            return {.is_passed = false, .why = "another configuration", .last = out.last};
        }
        const StepEnd end_of_step = step.judge(
            {.now = out.last, .before = before, .was_gone = was_gone, .pair = arguments.pair});
        if (end_of_step != StepEnd::waiting) {
            out.is_passed = end_of_step == StepEnd::passed;
            out.why = "seen: " + summary;
            return out;
        }
    }
    out.why =
        fmt::format("not seen within {:g} s: {}", arguments.person_seconds, summary_of(out.last));
    return out;
}

Outcome play(const ProofStep& step, const ProofArguments& arguments, const std::string& path,
             const GuardSight& before) {
    fmt::print(stderr, "{}: {}\n", step.name, *step.task == '\0' ? "Wait." : step.task);
    Outcome out = watch_step(step, arguments, path, before);
    if (out.is_passed && *step.question != '\0') {
        out.is_passed = is_yes(step.question);
        out.why += fmt::format("; {} {}", step.question, out.is_passed ? "yes" : "no");
    }
    return out;
}

void explain(const ProofArguments& arguments) {
    fmt::print(
        stderr,
        "proof-test: about five minutes. It sends nothing; you move the machine.\n"
        "  - Put the soft block in its place, clear the travel, a low override.\n"
        "  - A hand on the wired emergency stop.\n"
        "It covers: the stop before a known place, rest, the way out, the end of the permit\n"
        "without a bus and without a guard, the stop kept over a restart, the wired stop.\n"
        "It does not cover: braking at full speed (measure it: axguard inspect --limits),\n"
        "meshes and tools elsewhere, each rule of the board (axguardd board-test).\n"
        "Each step has {:g} s. Ctrl-C ends the test; its last line is then missing.\n",
        arguments.person_seconds);
}

int run_steps(const ProofArguments& arguments, const std::string& path, GuardSight guard,
              ProofLog& log) {
    const std::span<const ProofStep> steps = proof_steps();
    const std::string person = arguments.person.empty() ? "" : " by " + escaped(arguments.person);
    std::size_t passed = 0;
    bool is_written = true;
    for (const ProofStep& step : steps) {
        const Outcome out = play(step, arguments, path, guard);
        guard = out.last;
        is_written = log.put(guard, fmt::format("proof-test {}: {}, {}", step.name,
                                                out.is_passed ? "passed" : "FAILED", out.why));
        if (!out.is_passed) {
            break;
        }
        ++passed;
    }
    const bool is_passed = passed == steps.size();
    is_written =
        log.put(guard, fmt::format("proof-test {}: {} of {} steps passed{}",
                                   is_passed ? "PASSED" : "FAILED", passed, steps.size(), person));
    fmt::print(stderr, "{}",
               is_passed ? "Release the emergency stop, reset and arm to work.\n"
                         : "Do not work with this machine before the cause is found.\n");
    if (!is_written) {
        fmt::print(stderr, "axguardd: {}: could not be written\n", arguments.log_file);
        return kExitInternal;
    }
    return is_passed ? kExitClean : kExitUnfit;
}

int run_proof_test(const ProofArguments& arguments) {
    if (arguments.bus.empty() == arguments.socket.empty()) {
        fmt::print(stderr, "axguardd: missing option. Pass either --bus IF or --socket PATH.\n");
        return kExitUsage;
    }
    const std::string path = status_path(arguments.bus, arguments.socket);
    const Look look = look_at(path);
    if (!look.sight) {
        fmt::print(stderr, "axguardd: {}\n",
                   look.is_other_version
                       ? path + ": incompatible status: the guard runs another axguardd version"
                       : look.fault);
        return kExitInput;
    }
    ProofLog log(arguments.log_file);
    if (!log.is_open()) {
        fmt::print(stderr, "axguardd: {}: cannot be opened for writing. Pass another file.\n",
                   arguments.log_file);
        return kExitUsage;
    }
    explain(arguments);
    return run_steps(arguments, path, *look.sight, log);
}

}  // namespace

void add_proof_test(CommandLine& line) {
    const auto arguments = std::make_shared<ProofArguments>();
    const Command command = line.add_command(
        "proof-test", "Prove with a person at the machine that a running guard still stops it");
    command.set_example("axguardd proof-test --bus can0 --log maintenance.log");
    command.add_option("--bus", arguments->bus, "CAN interface of a guard that runs as a service");
    command.add_option("--socket", arguments->socket,
                       "socket of the guard, if started with --status-socket");
    command.add_option("--log", arguments->log_file, "add a line for each step to this text file")
        .required();
    command.add_option("--by", arguments->person, "name of the person, for the log");
    command.add_option("--pair", arguments->pair,
                       "pair at the known place, as the guard prints it: \"a - b\" [default: any]");
    command
        .add_option("--person-seconds", arguments->person_seconds, "time allowed for each step, s")
        .between(0.1, 86400.0)
        .shows_default();
    command.set_action([arguments] { return run_proof_test(*arguments); });
}

}  // namespace axg
