// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/commands/captured_stdout.hpp"

#include <unistd.h>

#include <array>
#include <cstdio>
#include <memory>

namespace axg {

std::string captured_stdout(const std::function<void()>& print) {
    const std::unique_ptr<std::FILE, decltype(&std::fclose)> file(std::tmpfile(), &std::fclose);
    std::fflush(stdout);
    const int terminal = file ? dup(STDOUT_FILENO) : -1;
    if (terminal < 0 || dup2(fileno(file.get()), STDOUT_FILENO) < 0) {
        print();
        return {};
    }
    print();
    std::fflush(stdout);
    (void)dup2(terminal, STDOUT_FILENO);
    (void)close(terminal);
    std::rewind(file.get());
    std::string text;
    std::array<char, 4096> part{};
    while (const std::size_t size = std::fread(part.data(), 1, part.size(), file.get())) {
        text.append(part.data(), size);
    }
    return text;
}

}  // namespace axg
