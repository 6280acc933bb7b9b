// SPDX-License-Identifier: Apache-2.0
// Files that a machine file names, such as a DBC: how they are read is the caller's choice.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace axg {

/// A file that a machine file names: its text, or what is wrong and what to do next.
struct NamedFile {
    std::string text, got, wanted;  // got empty: read
};
using NamedFiles = std::function<NamedFile(const std::string& name, std::size_t size_bytes_max)>;

}  // namespace axg
