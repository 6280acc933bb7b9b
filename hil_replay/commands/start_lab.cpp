// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/commands/start_lab.hpp"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "firmware_if/cli/exit_codes.hpp"

namespace axg {

int start_lab(const std::vector<std::string>& words) {
    std::error_code ignored;  // without /proc: whatever the shell would find
    const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", ignored);
    std::string program =
        self.empty() ? "axguard-lab" : (self.parent_path() / "axguard-lab").string();
    fmt::print(stderr, "axguard: {0} has moved to axguard-lab {0}; starting that\n", words.front());
    std::vector<std::string> owned = words;
    std::vector<char*> arguments = {program.data()};
    for (std::string& word : owned) {
        arguments.push_back(word.data());
    }
    arguments.push_back(nullptr);
    std::fflush(nullptr);
    pid_t child = 0;
    const int fault =
        posix_spawnp(&child, program.c_str(), nullptr, nullptr, arguments.data(), environ);
    if (fault != 0) {
        fmt::print(stderr, "axguard: cannot start {}: {}; install the package axguard-tools\n",
                   program, std::strerror(fault));
        return kExitInternal;
    }
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : kExitInternal;
}

}  // namespace axg
