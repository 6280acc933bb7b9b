// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/commands/shell_text.hpp"

#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string_view>
#include <system_error>

namespace axg {
namespace {

namespace fs = std::filesystem;

/// Whether a shell starts this file when a person types its name.
bool is_in_path(const fs::path& program) {
    const char* const path = std::getenv("PATH");
    std::istringstream folders(path == nullptr ? "" : path);
    std::error_code code;
    for (std::string folder; std::getline(folders, folder, ':');) {
        const fs::path found = fs::path(folder) / program.filename();
        if (fs::exists(found, code)) {
            return fs::equivalent(found, program, code);  // the shell starts the first
        }
    }
    return false;
}

}  // namespace

std::string shell_word(const std::string& word) {
    bool is_plain = !word.empty();
    for (const char c : word) {
        is_plain = is_plain && (std::isalnum(static_cast<unsigned char>(c)) != 0 ||
                                std::string_view("./:_-").find(c) != std::string_view::npos);
    }
    if (is_plain) {
        return word;
    }
    std::string out = "'";
    for (const char c : word) {
        out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    }
    return out + "'";
}

std::string shell_command(const std::vector<std::string>& words, std::size_t indent,
                          std::size_t columns) {
    const std::string next = " \\\n" + std::string(indent + 2, ' ');
    std::string text;
    std::size_t used = indent;
    for (std::size_t i = 0; i < words.size(); ++i) {
        std::string shown = shell_word(words[i]);
        if (shown.front() == '-' && i + 1 < words.size()) {  // an option and its value: one line
            shown += " " + shell_word(words[++i]);
        }
        const bool is_first = text.empty();
        if (!is_first && used + 1 + shown.size() + 2 > columns) {  // with the backslash
            text += next + shown;
            used = indent + 2 + shown.size();
        } else {
            text += (is_first ? "" : " ") + shown;
            used += (is_first ? 0 : 1) + shown.size();
        }
    }
    return text;
}

std::string shorter_path(const std::string& path) {
    std::error_code code;
    const std::string near = fs::proximate(path, code).string();
    return code || near.size() >= path.size() ? path : near;
}

std::string own_command() {
    std::error_code code;
    const fs::path self = fs::read_symlink("/proc/self/exe", code);
    if (code || is_in_path(self)) {
        return "axguard";  // without /proc: whatever the shell finds
    }
    const std::string path = shorter_path(self.string());
    return path.find('/') == std::string::npos ? "./" + path : path;
}

}  // namespace axg
