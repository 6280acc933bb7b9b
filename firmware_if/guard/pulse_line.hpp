// SPDX-License-Identifier: Apache-2.0
// One output wire in addition to the bus. Its receiver requires edges: no level of it is a permit.
#pragma once

namespace axg {

class PulseLine {
  public:
    virtual ~PulseLine() = default;
    /// At most one system call; never waits. False: it could not be set.
    [[nodiscard]] virtual bool set(bool is_high) noexcept = 0;
};

}  // namespace axg
