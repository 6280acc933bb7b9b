// SPDX-License-Identifier: Apache-2.0
// The results of a program. A file appears under its name when it is complete, or not at all; a
// name of no regular file (a pipe, /dev/null) is written to and never replaced. "-" is stdout.
#pragma once

#include <cstdio>
#include <string>
#include <string_view>

#include "firmware_if/cli/temporary_file.hpp"

namespace axg {

/// Why a result cannot be written under this name: it is empty, a folder, or not writable.
/// Empty: it can. Creates nothing.
[[nodiscard]] std::string output_fault(const std::string& path);
/// The same of a folder for results, which need not exist.
[[nodiscard]] std::string output_folder_fault(const std::string& path);

/// Whether "-" or another name of stdout, such as /dev/stdout.
[[nodiscard]] bool is_stdout(const std::string& path);
/// Whether both names lead to one file, through links and hard links too. False for /dev/null and
/// other character devices, which have no content to destroy.
[[nodiscard]] bool is_same_file(const std::string& a, const std::string& b);

class WholeFile {
  public:
    WholeFile() = default;
    ~WholeFile();  // removes what was written, unless finish() succeeded
    WholeFile(const WholeFile&) = delete;
    WholeFile& operator=(const WholeFile&) = delete;

    // Each is false after the first failure; error() has the reason.
    [[nodiscard]] bool open(const std::string& path);
    [[nodiscard]] bool write(std::string_view text);
    /// Closes, and gives the file its name. False: the file of that name is the one before.
    [[nodiscard]] bool finish();
    /// With the name of the file.
    [[nodiscard]] const std::string& error() const noexcept { return error_; }

  private:
    bool fail(const char* what, int error);

    std::string path_, target_, error_;
    TemporaryFile temporary_;
    std::FILE* file_ = nullptr;
};

/// Writes all of it. On failure false, and the reason on `messages`.
[[nodiscard]] bool write_whole_file(const std::string& path, std::string_view text,
                                    std::FILE* messages);

}  // namespace axg
