// SPDX-License-Identifier: Apache-2.0
// axguard compile: a machine file, its meshes and all that is slow to compute of them, in one file.
// docs/reference/compiled.md.
#include <fmt/format.h>

#include <memory>
#include <string>

#include "config/compiled/compiled_machine.hpp"
#include "config/text/quote_text.hpp"
#include "firmware_if/cli/command_line.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/cli/json_output.hpp"
#include "firmware_if/cli/machine_options.hpp"
#include "firmware_if/cli/whole_file.hpp"
#include "hil_replay/commands/commands.hpp"
#include "hil_replay/commands/commands_json.hpp"

namespace axg {
namespace {

struct CompileArguments {
    MachineOptions machine;
    std::string output;
    JsonOutput json;
};

std::size_t triangles_of(const MachineMeshes& meshes) {
    std::size_t count = 0;
    for (const auto* list : {&meshes.bodies, &meshes.tools}) {
        for (const Mesh& mesh : *list) {
            count += mesh.triangles.size();
        }
    }
    return count;
}

int compile(const CompileArguments& arguments) {
    if (!is_compiled_name(arguments.output)) {
        fmt::print(stderr, "-o: invalid file name (found {}, expected a name that ends in .axg).\n",
                   quoted(arguments.output, 4096));
        return kExitUsage;
    }
    if (is_compiled_name(arguments.machine.file)) {
        fmt::print(stderr,
                   "{}: invalid file (found a compiled machine, expected a machine file).\n",
                   escaped(arguments.machine.file, 4096));
        return kExitUsage;
    }
    LoadedMachine loaded;
    if (const int code = load(arguments.machine, loaded); code != kExitClean) {
        return code;
    }
    const std::string bytes = compile_machine(loaded);
    if (!write_whole_file(arguments.output, bytes, stderr)) {
        return kExitInternal;
    }
    const std::size_t triangles = triangles_of(loaded.meshes);
    fmt::print(arguments.json.words(), "{}: {}, {} triangles, {} bytes\n",
               escaped(arguments.output, 4096), escaped(loaded.machine.name), triangles,
               bytes.size());
    const CompileReport report{arguments.output, loaded.source.file, loaded.machine.name, triangles,
                               bytes.size()};
    return write_json(arguments.json, describe_compile(report)) ? kExitClean : kExitInternal;
}

}  // namespace

void add_compile(CommandLine& line) {
    auto arguments = std::make_shared<CompileArguments>();
    const Command command = line.add_command(
        "compile", "Compile a machine, its meshes and precomputed proofs into one .axg file");
    command.set_group("Set up a machine");
    command.set_example("axguard compile config/machines/paper-trunnion.yaml -o paper.axg");
    add_machine_options(command, arguments->machine);
    command
        .add_output("-o,--output", arguments->output,
                    "compiled machine to write (name ends in .axg)")
        .required();
    add_json_option(command, arguments->json);
    command.set_action([arguments] { return compile(*arguments); });
}

}  // namespace axg
