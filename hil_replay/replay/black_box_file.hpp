// SPDX-License-Identifier: Apache-2.0
// Reads a dump of the black box record by record, up to its end or the first damaged record. The
// records before that are valid.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "firmware_if/guard/black_box_record.hpp"

namespace axg {

class BlackBoxFile {
  public:
    /// @param name  for messages
    BlackBoxFile(std::string name, std::vector<std::uint8_t> bytes);
    /// Reads the whole file; error() describes a failure.
    [[nodiscard]] static BlackBoxFile open(const std::string& path);

    /// The next record. False: the end, or damage; error() is then `FILE:OFFSET: message`.
    [[nodiscard]] bool next(BlackBoxRecord& out);
    [[nodiscard]] const std::string& error() const noexcept { return error_; }
    [[nodiscard]] const BlackBoxHeader& header() const noexcept { return header_; }

  private:
    bool fail(const char* what);

    std::string name_, error_;
    std::vector<std::uint8_t> bytes_;
    BlackBoxHeader header_;
    std::size_t at_ = 0;
    std::uint32_t sequence_ = 0;
    bool has_sequence_ = false, is_at_end_ = false;
};

}  // namespace axg
