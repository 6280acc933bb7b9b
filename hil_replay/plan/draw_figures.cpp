// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/plan/draw_figures.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>

namespace axg {
namespace {

constexpr int kNoMatplotlib = 9;  // exit status of figure_page.py
// Debian's packages belong to its own python3, which need not be the first in PATH.
constexpr std::array<const char*, 2> kPythons = {"python3", "/usr/bin/python3"};

/// Exit status of python3, or the negative error number when it could not be started.
int run_python(std::string program, std::string script, std::string folder) {
    std::string no_cache = "-B";
    const std::array<char*, 5> arguments = {program.data(), no_cache.data(), script.data(),
                                            folder.data(), nullptr};
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    pid_t child = 0;
    const int error =
        posix_spawnp(&child, program.c_str(), &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (error != 0) {
        return -error;
    }
    int status = 0;
    while (waitpid(child, &status, 0) < 0) {
        if (errno != EINTR) {
            return -errno;
        }
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

}  // namespace

std::string conditions_table(const Conditions& conditions) {
    std::string out = "name,value\n";
    for (const auto& [name, value] : conditions) {
        out += name + ",\"";
        for (const char c : value) {
            out += c;
            if (c == '"') {  // doubled inside quotes
                out += c;
            }
        }
        out += "\"\n";
    }
    return out;
}

Drawn draw_figures(const std::string& script, const std::string& folder) {
    const std::string path = AXG_DATA_DIR "/hil_replay/" + script;
    int status = -ENOENT;
    for (const char* const python : kPythons) {
        if (status == -ENOENT || status == kNoMatplotlib) {
            status = run_python(python, path, folder);
        }
    }
    if (status == -ENOENT || status == kNoMatplotlib) {
        fmt::print(stderr,
                   "{}: the tables are written, the figures are not drawn: matplotlib is not "
                   "installed. Install it (Debian: apt-get install python3-matplotlib), then run "
                   "python3 -B '{}' '{}'.\n",
                   folder, path, folder);
        return Drawn::not_installed;
    }
    if (status != 0) {
        fmt::print(stderr, "{}: python3 '{}' ended with {}; its message is printed above\n", folder,
                   path, status);
        return Drawn::failed;
    }
    return Drawn::yes;
}

}  // namespace axg
