// SPDX-License-Identifier: Apache-2.0
// The latch that outlives the process: one page of a file, mapped, so that a stop is stored by two
// writes to memory and no call. Anything but the exact page of "clear" is latched: another length,
// or a byte behind the cell, as well. Power loss before the page was written needs no latch: the
// board has lost its permit as well.
#pragma once

#include <memory>
#include <string>

#include "firmware_if/guard/guard_node.hpp"

namespace axg {

struct UnmapLatch {
    void operator()(LatchCell* cell) const noexcept;
};
using LatchFile = std::unique_ptr<LatchCell, UnmapLatch>;

/// Null: see `fault`. A file that is not there yet is made, and is clear. One that another
/// user owns or can open is refused, as the lock is.
[[nodiscard]] LatchFile open_latch(const std::string& path, std::string& fault);

/// Writes it to the disk. Slow.
void keep_latch(LatchCell& cell) noexcept;

}  // namespace axg
