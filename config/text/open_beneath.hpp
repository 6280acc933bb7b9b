// SPDX-License-Identifier: Apache-2.0
// Reads a whole regular file inside a folder, and nothing else.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace axg {

struct FileRead {
    std::vector<std::byte> bytes;
    std::string got;     // empty: read; otherwise what is wrong
    std::string wanted;  // and what to do next
};

/// How a path is followed: by the kernel's openat2, or a part at a time where that call is missing.
enum class PathLookup : std::uint8_t { kernel_or_walk, walk };

/// @param root       folder; empty means the current one
/// @param file       relative path; may not leave root, through .. or through a symbolic link
/// @param bytes_max  a larger file is refused before memory is reserved for it
/// @param lookup     `walk` is for tests of the code for old kernels
/// Never blocks: a FIFO, socket, device or folder is refused without being opened for reading. On a
/// kernel without openat2 (before 5.6) every symbolic link and every .. is refused.
[[nodiscard]] FileRead read_beneath(const std::string& root, const std::string& file,
                                    std::uint64_t bytes_max,
                                    PathLookup lookup = PathLookup::kernel_or_walk);

}  // namespace axg
