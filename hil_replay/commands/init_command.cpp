// SPDX-License-Identifier: Apache-2.0
// axguard init: from a folder of STL files to a machine file that can be checked at once and
// completed line by line.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <system_error>

#include "config/init/machine_tree.hpp"
#include "config/init/urdf.hpp"
#include "config/init/urdf_model.hpp"
#include "config/init/write_machine.hpp"
#include "config/machine/parse_machine.hpp"
#include "config/mesh/drawing_doubts.hpp"
#include "config/mesh/load_meshes.hpp"
#include "config/text/config_fault.hpp"
#include "config/text/fault_text.hpp"
#include "config/text/quote_text.hpp"
#include "config/text/small_file.hpp"
#include "config/text/yaml_tree.hpp"
#include "firmware_if/cli/command_line.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/cli/progress.hpp"
#include "firmware_if/cli/whole_file.hpp"
#include "firmware_if/setup/exclusion_proof.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "hil_replay/commands/commands.hpp"

namespace axg {
namespace {

namespace fs = std::filesystem;

struct InitOptions {
    std::string source;  // a folder, or an INI file
    std::string folder, tree, urdf, out, unit, pairs = "likely";
    bool force = false;
};

/// The inputs of a machine file, before the meshes are read.
struct MachineParts {
    std::vector<UrdfMesh> meshes;
    std::vector<RoleGuess> roles;
    IniAxes axes;
};

constexpr std::array<LengthUnit, 4> kUnits{LengthUnit::mm, LengthUnit::inch, LengthUnit::m,
                                           LengthUnit::um};

bool has_extension(const fs::path& path, const char* wanted) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(), [](char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    });
    return extension == wanted;
}

/// Axes and period of an INI file; false after a message.
bool read_ini(const std::string& path, IniAxes& ini) {
    constexpr std::size_t kBytesMax = 1U << 20U;
    std::string text;
    const SmallFileFault fault = read_small_file(path, kBytesMax, text);
    if (!fault.got.empty() || !fault.wanted.empty()) {
        fmt::print(stderr, "{}: {}\n", escaped(path, 4096),
                   fault_text("invalid file", fault.got, fault.wanted));
        return false;
    }
    const NamedFiles beside = [&path](const std::string& name, std::size_t size_bytes_max) {
        NamedFile out;
        const fs::path file = fs::path(path).parent_path() / name;
        SmallFileFault fault_of = read_small_file(file.string(), size_bytes_max, out.text);
        out.got = std::move(fault_of.got);
        out.wanted = std::move(fault_of.wanted);
        return out;
    };
    ini = read_linuxcnc_ini(text, escaped(path, 4096), beside);
    for (const std::string& one : ini.faults) {
        fmt::print(stderr, "{}\n", one);
    }
    return ini.faults.empty();
}

/// Roles of the meshes, from the tree that was passed or from their names; false after a message.
bool find_roles(const InitOptions& options, const std::vector<std::string>& files, LengthUnit unit,
                std::vector<RoleGuess>& roles) {
    if (options.tree.empty()) {
        roles = guess_roles(files);
        return true;
    }
    std::string text;
    const std::string shown = escaped(options.tree, 4096);
    if (const SmallFileFault fault = read_small_file(options.tree, kYamlSizeBytesMax, text);
        !fault.got.empty() || !fault.wanted.empty()) {
        fmt::print(stderr, "{}: {}\n", shown, fault_text("invalid file", fault.got, fault.wanted));
        return false;
    }
    MachineTree tree = read_machine_tree(text, shown, files, length_of(unit));
    for (const ConfigFault& fault : tree.faults) {
        fmt::print(stderr, "{}\n", to_string(fault));
    }
    for (std::uint32_t i = 0; tree.faults.empty() && i < files.size(); ++i) {
        if (std::none_of(tree.roles.begin(), tree.roles.end(),
                         [i](const RoleGuess& role) { return role.file == i; })) {
            fmt::print(stderr, "{}: left out: not in {}\n", escaped(files[i]), shown);
        }
    }
    roles = std::move(tree.roles);
    return tree.faults.empty();
}

/// The folder's STL files by name; false after a message.
bool list_meshes(const std::string& folder, std::vector<std::string>& out) {
    std::error_code error;
    for (auto entry = fs::directory_iterator(folder, error);
         !error && entry != fs::directory_iterator(); entry.increment(error)) {
        if (has_extension(entry->path(), ".stl")) {
            out.push_back(entry->path().filename().string());
        }
    }
    std::sort(out.begin(), out.end());
    const std::string shown = escaped(folder, 4096);
    if (error) {
        fmt::print(stderr, "{}: {}. Pass the folder of the STL files.\n", shown, error.message());
        return false;
    }
    if (out.size() < 2 || out.size() > kBodiesMax) {
        fmt::print(stderr,
                   "{}: invalid folder (found {} STL files, expected 2 to {}, one for each rigid "
                   "body). With an INI file, pass their folder with --meshes DIR.\n",
                   shown, out.size(), kBodiesMax);
        return false;
    }
    return true;
}

/// An STL file has no unit: prints the sizes, from which a person recognises the unit.
void show_units(const std::string& folder, const std::vector<std::string>& files) {
    fmt::print(stderr,
               "--unit: missing required option: an STL file has no unit. Sizes in mm would be\n");
    for (const std::string& file : files) {
        const SurveyedMesh mesh = survey_mesh(folder, file, LengthUnit::mm);
        if (!mesh.faults.empty() && mesh.source.expected_size_mm == Vec3d{}) {
            fmt::print(stderr, "  {}\n", escaped(mesh.faults.front(), 400));
            continue;
        }
        fmt::print(stderr, "  {}\n", escaped(file));
        for (const LengthUnit unit : kUnits) {
            const Vec3d size = length_of(unit) * mesh.source.expected_size_mm;
            fmt::print(stderr, "    --unit {:<5} {:.5g} x {:.5g} x {:.5g}\n", name_of(unit), size.x,
                       size.y, size.z);
        }
    }
}

/// Relative path from the machine file's folder to the meshes; empty if they are not below it.
std::string way_down(const fs::path& from, const fs::path& to) {
    std::error_code error;
    const fs::path base = fs::weakly_canonical(from.empty() ? fs::path(".") : from, error);
    const fs::path way = fs::weakly_canonical(to, error).lexically_relative(base);
    const bool is_below = !error && !way.empty() && *way.begin() != "..";
    return is_below ? way.generic_string() : "";
}

/// Checks that the text loads, with the loader itself. Its lines are those of no file.
bool is_sound(const std::string& text, const InitOptions& options) {
    Machine machine;
    std::vector<ConfigFault> faults = parse_machine(text, options.out, machine);
    bool is_of_names = false;
    for (ConfigFault& fault : faults) {
        fault.where = escaped(options.out, 4096);
        fmt::print(stderr, "{}\n", to_string(fault));
        is_of_names |= fault.key.ends_with(".file");
    }
    if (!faults.empty()) {
        fmt::print(
            stderr, "no file written. {}, then try again.\n",
            is_of_names ? "Rename the files or the folder" : "Correct the input of this key");
    }
    return faults.empty();
}

/// The pairs in contact everywhere in the travel of a file that checks all; false after a message.
/// @param text  sound (is_sound)
bool find_permanent(const std::string& text, const std::string& mesh_root,
                    std::vector<ProposedExclusion>& out) {
    LoadedMachine loaded;
    std::vector<ConfigFault> faults = parse_machine(text, "", loaded.machine);
    if (faults.empty()) {
        faults = load_meshes(loaded.machine, mesh_root, loaded.meshes);
    }
    for (const ConfigFault& fault : faults) {
        fmt::print(stderr, "{}\n", to_string(fault));
    }
    if (!faults.empty()) {
        return false;
    }
    const std::vector<Pair>& pairs = loaded.machine.pairs;
    Progress progress;
    const auto show = [&progress](double share) {
        if (progress.is_due()) {
            progress.show(share, "proving exclusions");
        }
    };
    const auto found = judge_over_travel(loaded, pairs, {.progress = show});
    if (!found) {
        fmt::print(stderr, "{}\n", kNoLaneSet);
        return false;
    }
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        if ((*found)[i].verdict == TravelVerdict::always_near) {
            out.push_back({pairs[i].a, pairs[i].b, "in contact at every place of this travel"});
        }
    }
    return true;
}

/// The file's text, which loads; empty after a message.
/// @param mesh_root  the folder that the names of the meshes begin from
std::string sound_text(const InitOptions& options, const std::string& mesh_root,
                       const std::vector<SurveyedMesh>& meshes, const MachineParts& parts) {
    const std::string name = escaped(fs::path(options.out).stem().string(), 100);
    std::vector<ProposedExclusion> permanent;
    const bool is_all = options.pairs == "all";
    const std::vector<ProposedExclusion>* const none = is_all ? &permanent : nullptr;
    std::string text = machine_file_text(name, meshes, parts.roles, parts.axes, none);
    if (!is_sound(text, options) || (is_all && !find_permanent(text, mesh_root, permanent))) {
        return {};
    }
    return is_all ? machine_file_text(name, meshes, parts.roles, parts.axes, &permanent) : text;
}

/// The extents of each body in the unit that was passed, one a line, and the doubts about them.
void show_sizes(const std::vector<RoleGuess>& roles, const std::vector<SurveyedMesh>& meshes,
                std::FILE* stream) {
    std::vector<BodySize> sizes;
    for (const RoleGuess& role : roles) {
        if (role.file == kNoFile) {  // no size, no doubt
            sizes.push_back({"", LengthUnit::mm, Vec3d{}, role.parent});
            continue;
        }
        const MeshSource& source = meshes[role.file].source;
        const Vec3d size = source.expected_size_mm;
        fmt::print(stream, "  {:<20} {:.5g} x {:.5g} x {:.5g} mm\n", role.name, size.x, size.y,
                   size.z);
        sizes.push_back({source.file, source.unit, role.is_tool ? Vec3d{} : size, role.parent});
    }
    const std::vector<std::string> doubts = doubt_units(sizes);
    for (std::size_t i = 0; i < roles.size(); ++i) {
        if (!doubts[i].empty()) {
            fmt::print(stream, "to review: bodies.{}.mesh: {}. Correct unit and size_mm.\n",
                       roles[i].name, doubts[i]);
        }
    }
}

/// Everything from a URDF file; another exit code after a message.
int read_urdf_file(const InitOptions& options, const CommandFiles& names, MachineParts& out) {
    std::string text;
    const std::string shown = escaped(options.urdf, 4096);
    if (const SmallFileFault fault = read_small_file(options.urdf, kUrdfBytesMax, text);
        !fault.got.empty() || !fault.wanted.empty()) {
        fmt::print(stderr, "{}: {}\n", shown, fault_text("invalid file", fault.got, fault.wanted));
        return kExitInput;
    }
    const auto has_file = [&options](const std::string& name) {
        std::error_code error;
        return fs::is_regular_file(fs::path(options.folder) / name, error);
    };
    UrdfMachine machine = read_urdf(text, shown, has_file);
    for (const ConfigFault& fault : machine.faults) {
        fmt::print(stderr, "{}\n", to_string(fault));
    }
    if (!machine.faults.empty()) {
        return kExitInput;
    }
    out = {std::move(machine.meshes), std::move(machine.roles), std::move(machine.axes)};
    std::vector<std::string> inputs;
    for (const UrdfMesh& mesh : out.meshes) {
        inputs.push_back((fs::path(options.folder) / mesh.file).string());
    }
    return are_apart(names, inputs, stderr) ? kExitClean : kExitUsage;
}

/// From the meshes of the folder and an INI file or a tree; another exit code after a message.
int read_folder(const InitOptions& options, const CommandFiles& names, MachineParts& out) {
    const bool is_ini = has_extension(options.source, ".ini");
    std::vector<std::string> files;
    if ((is_ini && !read_ini(options.source, out.axes)) || !list_meshes(options.folder, files)) {
        return kExitInput;
    }
    std::vector<std::string> inputs;
    for (const std::string& file : files) {
        inputs.push_back((fs::path(options.folder) / file).string());
    }
    if (!are_apart(names, inputs, stderr)) {
        return kExitUsage;
    }
    const auto unit = std::find_if(kUnits.begin(), kUnits.end(), [&options](LengthUnit one) {
        return options.unit == name_of(one);
    });
    if (unit == kUnits.end()) {
        show_units(options.folder, files);
        return kExitUsage;
    }
    for (const std::string& file : files) {
        out.meshes.push_back({file, *unit});
    }
    return find_roles(options, files, *unit, out.roles) ? kExitClean : kExitInput;
}

/// The folder of the meshes: as passed, else that of the file that names them.
std::string folder_of(const InitOptions& options) {
    if (!options.folder.empty()) {
        return options.folder;
    }
    const bool is_folder = options.urdf.empty() && !has_extension(options.source, ".ini");
    const std::string& file = options.urdf.empty() ? options.source : options.urdf;
    const std::string beside = fs::path(file).parent_path().string();
    return is_folder ? options.source : beside.empty() ? "." : beside;
}

/// Options that exclude each other; false after a message.
bool are_consistent(const InitOptions& options) {
    if (options.urdf.empty() == options.source.empty()) {
        fmt::print(stderr, "init: {}\n",
                   options.urdf.empty()
                       ? "missing input. Pass the folder of the STL files, an INI file, or --urdf "
                         "FILE."
                       : "two inputs. Pass --urdf FILE without a folder or an INI file; the folder "
                         "of its meshes with --meshes DIR.");
        return false;
    }
    if (!options.urdf.empty() && (!options.unit.empty() || !options.tree.empty())) {
        fmt::print(stderr, "--{}: conflicts with --urdf. Remove it: the URDF file states {}.\n",
                   options.tree.empty() ? "unit" : "tree",
                   options.tree.empty() ? "the scale of each mesh" : "the parents and axes");
        return false;
    }
    return true;
}

/// Surveys each mesh, and names it as the machine file shall contain it; false after a message.
bool survey(const MachineParts& parts, const InitOptions& options, const std::string& way,
            std::vector<SurveyedMesh>& out) {
    bool is_sound = true;
    for (const UrdfMesh& mesh : parts.meshes) {
        out.push_back(survey_mesh(options.folder, mesh.file, mesh.unit));
        for (const std::string& fault : out.back().faults) {
            fmt::print(stderr, "{}\n", fault);
            is_sound = false;
        }
        out.back().source.file = way.empty() || way == "." ? mesh.file : way + '/' + mesh.file;
    }
    if (!is_sound) {
        fmt::print(stderr, "no file written. Repair these meshes, or {}.\n",
                   options.urdf.empty() ? "move them out of the folder"
                                        : "remove the elements of the URDF file that name them");
    }
    return is_sound;
}

int init(InitOptions options, const CommandFiles& names) {
    if (!are_consistent(options)) {
        return kExitUsage;
    }
    options.folder = folder_of(options);
    std::error_code error;
    if (options.out != "-" && fs::exists(fs::symlink_status(options.out, error)) &&
        !options.force) {
        fmt::print(stderr, "{}: file exists. Overwrite it with --force.\n",
                   escaped(options.out, 4096));
        return kExitInput;
    }
    MachineParts parts;
    const int code = options.urdf.empty() ? read_folder(options, names, parts)
                                          : read_urdf_file(options, names, parts);
    if (code != kExitClean) {
        return code;
    }
    const std::vector<TableTool>& tools = parts.axes.tools.tools;
    if (std::any_of(tools.begin(), tools.end(), is_measured)) {
        add_tool_body(parts.roles);
    }
    const std::string folder_of_out = fs::path(options.out).parent_path().string();
    const std::string way = way_down(folder_of_out, options.folder);
    std::vector<SurveyedMesh> meshes;
    if (!survey(parts, options, way, meshes)) {
        return kExitInput;
    }
    if (options.urdf.empty()) {
        std::vector<Box> boxes;
        for (const SurveyedMesh& mesh : meshes) {
            boxes.push_back({mesh.min_mm, mesh.max_mm});
        }
        ride_in_boxes(parts.roles, boxes);
    }
    const std::string text =
        sound_text(options, way.empty() ? options.folder : folder_of_out, meshes, parts);
    if (text.empty()) {
        return kExitInput;
    }
    if (!write_whole_file(options.out, text, stderr)) {
        return kExitInternal;
    }
    const std::string root = way.empty() ? " --mesh-root " + options.folder : "";
    std::FILE* const stream = is_stdout(options.out) ? stderr : stdout;
    show_sizes(parts.roles, meshes, stream);
    fmt::print(
        stream,
        "{}: {} bodies written. Next: edit the lines marked GUESS, then\n  axguard check {}{}\n",
        escaped(options.out, 4096), parts.roles.size(), escaped(options.out, 4096),
        escaped(root, 4096));
    return kExitClean;
}

}  // namespace

void add_init(CommandLine& line) {
    auto options = std::make_shared<InitOptions>();
    const Command command = line.add_command(
        "init",
        "Write a commented machine file from STL files, a LinuxCNC INI file or a URDF file");
    command.set_group("Set up a machine");
    command.set_example("axguard init meshes -o machine.yaml --unit mm");
    command.add_input(
        "DIR|MACHINE.ini", options->source,
        "folder with one STL file per rigid body, or a LinuxCNC INI file in that folder "
        "(source of travel, speeds and accelerations)");
    command.add_option("--meshes", options->folder,
                       "folder of the STL files [default: folder of the INI or URDF file]");
    command.add_input(
        "--tree", options->tree,
        "machine.yml of a QtPyVCP screen (source of parents, axes, signs and pivots)");
    command.add_input("--urdf", options->urdf,
                      "URDF file (source of bodies, joints, travel and speeds)");
    command.add_output("-o,--output", options->out, "machine file to write").required();
    command
        .add_option(
            "--unit", options->unit,
            "unit of the STL files; without it, init prints the size of each file in every unit")
        .one_of({"mm", "inch", "m", "um"});
    command
        .add_option(
            "--pairs", options->pairs,
            "likely: check no carrier against what it carries; all: check every pair not in "
            "contact at every place of the travel")
        .one_of({"likely", "all"})
        .shows_default();
    command.add_flag("--force", options->force, "overwrite an existing file");
    command.set_action([options, files = command.files()] { return init(*options, *files); });
}

}  // namespace axg
