// SPDX-License-Identifier: Apache-2.0
// axguard-lab accuracy: one method judges a file of cases, one line each. Does not check the
// verdicts: that needs the exact results.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "config/text/nearest_word.hpp"
#include "config/text/quote_text.hpp"
#include "firmware_if/cli/command_line.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/cli/json_output.hpp"
#include "firmware_if/cli/whole_file.hpp"
#include "hil_replay/lab/cases/tritri_file.hpp"
#include "hil_replay/lab/commands/lab_commands.hpp"
#include "hil_replay/lab/commands/lab_commands_json.hpp"
#include "hil_replay/lab/methods/mesh_cases.hpp"
#include "hil_replay/lab/methods/method.hpp"
#include "hil_replay/lab/methods/throughput.hpp"

namespace axg {
namespace {

struct AccuracyOptions {
    std::string cases, method, out;
    bool list = false, time = false;
    unsigned passes = 25;
    JsonOutput json;
};

int list_methods(const AccuracyOptions& options) {
    for (const lab::Method& method : lab::methods()) {
        fmt::print(options.json.words(), "{:26} {}{}\n", method.name,
                   method.certified ? "certified. " : "", method.source);
    }
    return write_json(options.json, describe_methods()) ? kExitClean : kExitInternal;
}

const lab::Method* method_of(const std::string& name) {
    const lab::Method* const found = lab::find_method(name);
    if (found == nullptr) {
        std::vector<std::string_view> names;
        for (const lab::Method& method : lab::methods()) {
            names.push_back(method.name);
        }
        const std::string_view near = nearest_word(name, names);
        fmt::print(
            stderr,
            "axguard-lab accuracy: --method: unknown method (found {}, expected one of: {}).{}\n",
            axg::quoted(name), listed(names),
            near.empty() ? std::string() : fmt::format(" Did you mean {}?", near));
    }
    return found;
}

constexpr std::size_t kTimedPairs = 16384;
constexpr std::uint64_t kTimedSeed = 20261121;

/// Measures ns per pair of one method or of all, on the same random pairs.
int time_them(const AccuracyOptions& options) {
    std::vector<const lab::Method*> timed;
    for (const lab::Method& method : lab::methods()) {
        if (options.method.empty() || options.method == method.name) {
            timed.push_back(&method);
        }
    }
    const auto mixed =
        lab::time_methods(timed, lab::overlapping_pairs(kTimedPairs, kTimedSeed), options.passes);
    const auto hits =
        lab::time_methods(timed, lab::intersecting_pairs(kTimedPairs, kTimedSeed), options.passes);
    fmt::print(options.json.words(),
               "ns per pair, minimum and median of {} passes over {} pairs whose boxes overlap, "
               "and over {} that intersect\n{:28}{:>9}{:>9}{:>9}{:>9}{:>12}\n",
               options.passes, kTimedPairs, kTimedPairs, "", "overlap", "median", "hits", "median",
               "pairs/s");
    for (std::size_t i = 0; i < timed.size(); ++i) {
        fmt::print(options.json.words(), "{:28}{:9.1f}{:9.1f}{:9.1f}{:9.1f}{:12.3g}\n",
                   timed[i]->name, mixed[i].least_ns, mixed[i].median_ns, hits[i].least_ns,
                   hits[i].median_ns, 1e9 / mixed[i].least_ns);
    }
    const TimedMethods times{kTimedPairs, options.passes, timed, mixed, hits};
    return write_json(options.json, describe_times(times)) ? kExitClean : kExitInternal;
}

/// Shortest text that reads back as the same double: a lower bound stays one.
std::string table_text(const lab::TritriFile& file, const lab::Judged& judged) {
    std::string text;
    for (std::size_t i = 0; i < file.ids.size(); ++i) {
        text += fmt::format("{},{}", file.ids[i], lab::letter_of(judged.verdicts[i]));
        if (!judged.distances_mm.empty() && judged.verdicts[i] != lab::Verdict::rejected) {
            text += fmt::format(",{}", judged.distances_mm[i]);
        }
        text += '\n';
    }
    return text;
}

int accuracy(const AccuracyOptions& options) {
    if (options.list) {
        return list_methods(options);
    }
    if (!options.method.empty() && method_of(options.method) == nullptr) {
        return kExitUsage;
    }
    if (options.time) {
        return time_them(options);
    }
    if (options.cases.empty() || options.method.empty() || options.out.empty()) {
        fmt::print(stderr,
                   "axguard-lab accuracy: missing options (expected --cases FILE.bin, --method "
                   "NAME and --output RESULT.csv). List the methods with --list.\n");
        return kExitUsage;
    }
    const lab::Method* const method = method_of(options.method);
    lab::TritriFile file;
    if (const std::string fault = lab::read_tritri(options.cases, file); !fault.empty()) {
        fmt::print(stderr, "{}\n", fault);
        return kExitInput;
    }
    const lab::Judged judged = file.holds_meshes()
                                   ? lab::judge_meshes(*method, file.meshes, file.mesh_cases)
                                   : lab::judge(*method, file.pairs, true);
    if (!write_whole_file(options.out, table_text(file, judged), stderr)) {
        return kExitInternal;
    }
    const auto count = [&judged](lab::Verdict verdict) {
        return static_cast<std::size_t>(
            std::count(judged.verdicts.begin(), judged.verdicts.end(), verdict));
    };
    const AccuracyCounts counts{count(lab::Verdict::separated), count(lab::Verdict::intersecting),
                                count(lab::Verdict::undecided), count(lab::Verdict::rejected)};
    fmt::print(options.json.words(),
               "{} cases by {}: {} separated, {} intersecting, {} undecided, {} rejected\n",
               judged.verdicts.size(), method->name, counts.separated, counts.intersecting,
               counts.undecided, counts.rejected);
    const std::string document =
        describe_accuracy(options.cases, *method, judged.verdicts.size(), counts);
    return write_json(options.json, document) ? kExitClean : kExitInternal;
}

}  // namespace

void add_accuracy(CommandLine& line) {
    auto options = std::make_shared<AccuracyOptions>();
    const Command command = line.add_command(
        "accuracy", "Test a file of triangle pairs with one of many methods, for comparison");
    command.set_example(
        "axguard-lab accuracy --cases pairs_f32.bin --method certified-f32 --output r.csv");
    command.add_input("--cases", options->cases, "input file of pairs (TTP1) or meshes (TTM1)");
    command.add_option("--method", options->method, "method to use, one of --list");
    command.add_output("-o,--output", options->out,
                       "CSV file to write: case_id,answer[,distance_mm]");
    command.add_flag("--list", options->list, "print the methods and their sources");
    command.add_flag("--time", options->time,
                     "measure only the time per random pair, ns, of the method or of all methods");
    command
        .add_option("--passes", options->passes,
                    "with --time: report the minimum and median of N passes")
        .between(1U, 1000U)
        .shows_default();
    add_json_option(command, options->json);
    command.set_action([options] { return accuracy(*options); });
}

}  // namespace axg
