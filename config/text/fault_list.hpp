// SPDX-License-Identifier: Apache-2.0
// Collects the faults of one file and returns them in the order of the lines.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "config/text/config_fault.hpp"

namespace axg {

/// Faults shown at once: a person repairs no more at a time.
inline constexpr std::size_t kFaultsShownMax = 20;

class FaultList {
  public:
    /// @param file  the name shown before each line number
    explicit FaultList(const std::string& file);

    /// Beyond a thousand faults the rest is only counted: memory must stay bounded.
    void add(int line, std::string key, std::string got, std::string wanted);

    /// Adds the faults of another file, sorted at `line` of this one, with their own file and line.
    void add_all(int line, const std::vector<ConfigFault>& faults);

    [[nodiscard]] bool empty() const noexcept { return faults_.empty(); }
    [[nodiscard]] std::size_t count() const noexcept { return faults_.size() + dropped_; }
    [[nodiscard]] std::string where(int line) const;
    /// The first kFaultsShownMax by their lines, and how many more there are.
    [[nodiscard]] std::vector<ConfigFault> in_order() const;

  private:
    struct Entry {
        int line;
        ConfigFault fault;
    };
    std::string file_;
    std::vector<Entry> faults_;
    std::size_t dropped_ = 0;
};

}  // namespace axg
