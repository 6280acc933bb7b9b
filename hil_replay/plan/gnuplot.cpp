// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/plan/gnuplot.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <filesystem>

#include "firmware_if/cli/temporary_file.hpp"

namespace axg::chart {
namespace {

constexpr std::array<const char*, 2> kKinds = {"svg", "png"};

/// Exit status of gnuplot, or the negative error number when it could not be started.
int run_gnuplot(const std::string& folder, std::string settings, std::string script) {
    std::string program = "gnuplot", option = "-e";
    const std::array<char*, 5> arguments = {program.data(), option.data(), settings.data(),
                                            script.data(), nullptr};
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
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

std::string quoted_for_gnuplot(const std::string& text) {
    std::string out = "'";
    for (const char c : text) {
        out += c;
        if (c == '\'') {  // doubled inside single quotes
            out += c;
        }
    }
    return out + "'";
}

std::string gnuplot_script(const std::string& name, PictureSize size, const std::string& body) {
    return fmt::format(
        R"gp(# SPDX-License-Identifier: Apache-2.0
# gnuplot {0}.gp draws {0}.svg; gnuplot -e "kind='png'" {0}.gp draws {0}.png. gnuplot 5.4 or later.
if (!exists('kind')) kind = 'svg'
if (!exists('part')) part = ''
if (kind eq 'svg') set terminal svg size {1},{2} font 'Arial,14' background 'white'
if (kind eq 'png') set terminal pngcairo size {4},{5} font 'DejaVu Sans,10.5' background 'white'{6}
set output '{0}.' . kind . part
set encoding utf8
set datafile separator ','
# Okabe and Ito's colours, which people who see few colours tell apart; in grey they differ too.
ink = '#202020'; grey = '#8a8a8a'; pale = '#dddddd'
blue = '#0b5394'; red = '#d55e00'; green = '#009e73'; gold = '#e69f00'; sky = '#56b4e9'
set border 3 linecolor rgb grey
set tics nomirror textcolor rgb ink
set grid linecolor rgb pale linetype 1 linewidth 0.7
{3})gp",
        name, size.width, size.height, body, size.width * size.png_scale,
        size.height * size.png_scale,
        size.png_scale == 1
            ? std::string()
            : fmt::format(" fontscale {0} linewidth {0} pointscale {0}", size.png_scale));
}

Drawn draw(const std::string& folder, const std::string& name) {
    namespace fs = std::filesystem;
    for (const char* const kind : kKinds) {
        const std::string picture = (fs::path(folder) / (name + "." + kind)).string();
        TemporaryFile partial(picture + ".part");
        const int status =
            run_gnuplot(folder, fmt::format("kind='{}'; part='.part'", kind), name + ".gp");
        if (status == -ENOENT) {
            return Drawn::no_gnuplot;
        }
        if (status != 0 || !partial.take_name(picture)) {
            fmt::print(stderr, "{}.gp: gnuplot ended with {}; its message stands above\n",
                       (fs::path(folder) / name).string(), status);
            return Drawn::failed;
        }
    }
    return Drawn::yes;
}

}  // namespace axg::chart
