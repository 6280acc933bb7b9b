// SPDX-License-Identifier: Apache-2.0
// One wire out, beside the bus. Whoever watches it wants edges, so no level of it is a permit.
#pragma once

namespace axg {

class PulseLine {
  public:
    virtual ~PulseLine() = default;
    /// At most one system call; never waits. False: it could not be set.
    [[nodiscard]] virtual bool set(bool is_high) noexcept = 0;
};

}  // namespace axg
