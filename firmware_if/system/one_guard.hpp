// SPDX-License-Identifier: Apache-2.0
// One guard an interface: a name that the kernel gives away once in each network, as interfaces
// are, and takes back whatever way the process ends.
#pragma once

#include <string>

namespace axg {

class OneGuard {
  public:
    explicit OneGuard(const std::string& bus);
    ~OneGuard();
    OneGuard(const OneGuard&) = delete;
    OneGuard& operator=(const OneGuard&) = delete;

    /// False: `fault` says why not.
    [[nodiscard]] bool is_mine() const noexcept { return socket_ >= 0; }
    [[nodiscard]] const std::string& fault() const noexcept { return fault_; }

  private:
    int socket_;
    std::string fault_;
};

}  // namespace axg
