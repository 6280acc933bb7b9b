// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/commands/start_lab.hpp"

#include <fmt/format.h>
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
    fmt::print(stderr, "axguard: {0} is now axguard-lab {0}; starting axguard-lab\n",
               words.front());
    std::vector<std::string> owned = words;
    std::vector<char*> arguments = {program.data()};
    for (std::string& word : owned) {
        arguments.push_back(word.data());
    }
    arguments.push_back(nullptr);
    std::fflush(nullptr);
    // In the place of this process: signals and exit codes are the laboratory's own.
    execvp(program.c_str(), arguments.data());
    fmt::print(stderr, "axguard: {}: {}. Install axguard-lab in the folder of axguard.\n", program,
               std::strerror(errno));
    return kExitInput;
}

}  // namespace axg
