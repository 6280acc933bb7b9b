// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/system/gpio_line.hpp"

#include <fcntl.h>
#include <linux/gpio.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace axg {

std::optional<GpioLine> GpioLine::open(const std::string& chip, std::uint32_t line,
                                       std::string& fault) {
    const auto refuse = [&](const char* next) {
        fault = chip + ", line " + std::to_string(line) + ": " + std::strerror(errno) + ". " + next;
        return std::nullopt;
    };
    const int file = ::open(chip.c_str(), O_RDWR | O_CLOEXEC);
    if (file < 0) {
        return refuse("List the chips and their owners: ls -l /dev/gpiochip*");
    }
    gpio_v2_line_request request{};
    request.offsets[0] = line;
    request.num_lines = 1;
    request.config.flags = GPIO_V2_LINE_FLAG_OUTPUT;  // low by default
    std::strncpy(request.consumer, "axguardd", sizeof request.consumer - 1);
    const int status = ioctl(file, GPIO_V2_GET_LINE_IOCTL, &request);
    const int error = errno;
    close(file);
    if (status != 0) {
        errno = error;
        return refuse("List the lines and their users: gpioinfo (Debian: gpiod)");
    }
    return GpioLine(request.fd);
}

GpioLine::GpioLine(GpioLine&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

GpioLine& GpioLine::operator=(GpioLine&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    return *this;
}

GpioLine::~GpioLine() {
    if (descriptor_ >= 0) {
        // The line's driver determines its level without an owner.
        [[maybe_unused]] const bool is_low = set(false);
        close(descriptor_);
    }
}

bool GpioLine::set(bool is_high) noexcept {
    gpio_v2_line_values values{};
    values.bits = is_high ? 1 : 0;
    values.mask = 1;
    return ioctl(descriptor_, GPIO_V2_LINE_SET_VALUES_IOCTL, &values) == 0;
}

}  // namespace axg
