// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/page/page_parts.hpp"

#include <fmt/format.h>

#include <fstream>
#include <iterator>

namespace axg {
namespace {

constexpr const char* kScripts = "/usr/share/javascript/";  // where Debian has them

std::optional<std::string> read_part(const std::string& path, const char* what_next,
                                     std::FILE* messages) {
    std::ifstream file(path, std::ios::binary);
    std::string text(std::istreambuf_iterator<char>(file), {});
    if (!file.is_open() || file.bad() || text.empty()) {
        fmt::print(messages, "{}: cannot be read; {}\n", path, what_next);
        return std::nullopt;
    }
    return text;
}

}  // namespace

std::optional<std::string> own_part(const char* name, std::FILE* messages) {
    return read_part(std::string(AXG_DATA_DIR) + "/hil_replay/page/" + name,
                     "it is part of axguard: install axguard again", messages);
}

std::optional<std::string> library_part(const char* name, const char* what_next,
                                        std::FILE* messages) {
    return read_part(std::string(kScripts) + name, what_next, messages);
}

}  // namespace axg
