// SPDX-License-Identifier: Apache-2.0
// Reads a small text file whole, or returns the reason why not. Refuses pipes and devices without
// waiting for them.
#pragma once

#include <cstddef>
#include <string>

namespace axg {

struct SmallFileFault {
    std::string got, wanted;  // both empty: read
};

/// @param size_bytes_max  larger files are refused, also those that report a smaller size
/// @param out             the file's bytes; untouched on failure
[[nodiscard]] SmallFileFault read_small_file(const std::string& path, std::size_t size_bytes_max,
                                             std::string& out);

}  // namespace axg
