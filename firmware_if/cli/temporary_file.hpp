// SPDX-License-Identifier: Apache-2.0
// Files that exist while a result is written, and no longer: neither after a failure nor after a
// signal that ends the program (Ctrl-C, SIGTERM, SIGHUP, a closed pipe).
#pragma once

#include <cstddef>
#include <string>

namespace axg {

/// Owns the name of a temporary file. The destructor removes the file, and so does a signal whose
/// action is the default one: a handler of the program's own, or an ignored signal, stays as it is.
class TemporaryFile {
  public:
    TemporaryFile() = default;
    /// Owns a name that another program writes to. The file need not exist.
    explicit TemporaryFile(std::string path);
    ~TemporaryFile();
    TemporaryFile(TemporaryFile&& other) noexcept;
    TemporaryFile& operator=(TemporaryFile&& other) noexcept;

    /// Creates and opens a new file in a folder, with the rights that the user's umask leaves.
    /// @return  its descriptor; -1: errno has the reason
    [[nodiscard]] int create(const std::string& folder);
    [[nodiscard]] const std::string& path() const noexcept { return path_; }
    /// Renames the file, and owns it no longer. Replaces regular files only. False: errno has the
    /// reason.
    [[nodiscard]] bool take_name(const std::string& target);

  private:
    void enrol();
    void forget() noexcept;

    std::string path_;
    std::size_t slot_ = 0;  // what a signal removes; kNoSlot: nothing
};

}  // namespace axg
