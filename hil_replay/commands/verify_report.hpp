// SPDX-License-Identifier: Apache-2.0
// Results of axguard verify: one screen for a program, a table for several, and the document.
#pragma once

#include <cstdint>
#include <cstdio>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace axg {

inline constexpr int kOverrideLeast = 30, kOverrideMost = 150;  // %

/// The overrides that a word requests, rising: "80" is one; "30..150" is both ends, and 100 between
/// them. Empty: the word is neither.
[[nodiscard]] std::vector<int> read_overrides(std::string_view word);

/// An event of a run, or the nearest pair with a tool.
struct VerifyEvent {
    std::string what;   // "cutter-c", or the reason and the pair of a stop
    double time_s = 0;  // since the start of the program
    std::uint32_t line = 0;
    std::string block{};
    std::uint16_t tool = 0;
    double clearance_mm = 0;  // of an approach; not finite: beyond the range of the search
};

/// A program with its feeds at one override.
struct VerifyRun {
    int override_percent = 100;
    int exit_code = 0;
    double program_s = 0, path_mm = 0;
    std::uint64_t samples = 0, permits = 0, stop_count = 0;
    std::vector<VerifyEvent> contacts{}, stops{}, nearest{};
    bool is_unproven = false;  // a permit withheld or never given, or a trace with faults
};

struct VerifiedProgram {
    std::string file, read_as{};
    int exit_code = 0;  // of its runs, the largest
    std::vector<VerifyRun> runs{};
};

struct VerifyReport {
    std::string machine{}, version;
    std::vector<int> overrides;
    std::string not_obeyed{};  // why nothing obeys the permits; empty: the board obeys them
    double cut_mm_min = 0;     // feeds above it were simulated at it; 0: none was
    std::vector<VerifiedProgram> programs{};

    [[nodiscard]] int exit_code() const;  // of its programs, the largest
};

/// Prints one program, contacts first.
void print_program(const VerifyReport& report, const VerifiedProgram& program, std::FILE* words);
/// Print the table of several programs: a row can be printed as soon as its program is verified.
void print_table_head(std::FILE* words);
void print_table_row(const VerifiedProgram& program, std::FILE* words);
void print_table_end(const VerifyReport& report, std::FILE* words);

[[nodiscard]] std::string describe_verify(const VerifyReport& report);

}  // namespace axg
