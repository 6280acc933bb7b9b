// SPDX-License-Identifier: Apache-2.0
// A GPIO line of this computer, through the kernel's character device: one call to set it, the call
// that libgpiod would make. Source: linux/gpio.h, version 2 of its interface (kernel 5.10).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "firmware_if/guard/pulse_line.hpp"

namespace axg {

class GpioLine final : public PulseLine {
  public:
    /// Requests the line exclusively, as an output, low.
    /// @return  empty: `fault` has the failure and the next step
    [[nodiscard]] static std::optional<GpioLine> open(const std::string& chip, std::uint32_t line,
                                                      std::string& fault);
    ~GpioLine() override;
    GpioLine(GpioLine&& other) noexcept;
    GpioLine& operator=(GpioLine&& other) noexcept;

    [[nodiscard]] bool set(bool is_high) noexcept override;

  private:
    explicit GpioLine(int descriptor) noexcept : descriptor_(descriptor) {}

    int descriptor_;
};

}  // namespace axg
