// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/cli/whole_file.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "config/text/quote_text.hpp"

namespace axg {
namespace {

bool complain(const std::string& path, const char* what, int error, std::FILE* messages) {
    std::fprintf(messages, "%s: %s: %s; is the folder there, writable and not full?\n",
                 escaped(path, 4096).c_str(), what, std::strerror(error));
    return false;
}

bool write_to(const std::string& path, std::string_view text, std::FILE* messages) {
    std::FILE* file = std::fopen(path.c_str(), "wb");
    if (file == nullptr) {
        return complain(path, "cannot be written", errno, messages);
    }
    const bool is_put = std::fwrite(text.data(), 1, text.size(), file) == text.size();
    int error = errno;
    const bool is_closed = std::fclose(file) == 0;  // what was buffered is written here
    error = is_put ? errno : error;
    return (is_put && is_closed) ||
           complain(path, "could not be written to its end", error, messages);
}

}  // namespace

bool write_whole_file(const std::string& path, std::string_view text, std::FILE* messages) {
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
        return write_to(path, text, messages);
    }
    const std::string temporary = path + ".part" + std::to_string(getpid());
    if (!write_to(temporary, text, messages)) {
        std::filesystem::remove(temporary, error);
        return false;
    }
    if (std::rename(temporary.c_str(), path.c_str()) != 0) {
        const int reason = errno;
        std::filesystem::remove(temporary, error);
        return complain(path, "cannot take its name", reason, messages);
    }
    return true;
}

}  // namespace axg
