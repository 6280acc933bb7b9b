// SPDX-License-Identifier: Apache-2.0
// A file as a row of sections, whose chain of sums is checked before anything is read.
#pragma once

#include <vector>

#include "hil_replay/certcheck/byte_reader.hpp"
#include "hil_replay/certcheck/sha256.hpp"

namespace axg::certcheck {

class Sections {
  public:
    /// @throws Refusal 12 for a file that is no row of sections, 10 for sums that do not fit
    Sections(const std::string& file, std::span<const std::uint8_t> bytes);

    /// The next section, which has these letters.
    ByteReader open(const std::string& letters);
    /// Demands that the next section is the last.
    void end() { open("DONE"); }

  private:
    struct Section {
        std::string letters;
        ByteReader reader;
    };
    std::string file_;
    std::vector<Section> sections_;
    std::size_t next_ = 0;
};

}  // namespace axg::certcheck
