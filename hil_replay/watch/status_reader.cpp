// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/watch/status_reader.hpp"

#include <chrono>
#include <utility>

#include "firmware_if/can/socket_can.hpp"
#include "firmware_if/system/status_socket.hpp"

namespace axg {

StatusReader::StatusReader(std::string path) : path_(std::move(path)) {
    if (!path_.empty()) {
        thread_ = std::thread([this] { run(); });
    }
}

StatusReader::~StatusReader() {
    {
        const std::lock_guard lock(mutex_);
        is_ending_ = true;
    }
    ending_.notify_all();
    if (thread_.joinable()) {
        thread_.join();
    }
}

StatusReader::Reading StatusReader::last() const {
    const std::lock_guard lock(mutex_);
    return last_;
}

void StatusReader::run() {
    for (;;) {
        read();
        std::unique_lock lock(mutex_);
        if (ending_.wait_for(lock, std::chrono::microseconds(kStatusEveryUs),
                             [this] { return is_ending_; })) {
            return;
        }
    }
}

void StatusReader::read() {
    std::string fault;
    const std::string text = read_status(path_, fault);
    std::optional<GuardLine> line = fault.empty() ? read_guard_line(text) : std::nullopt;
    if (fault.empty() && !line) {
        fault = path_ + ": no status of this version. Use axguard and axguardd of one version.";
    }
    const std::int64_t now_us = monotonic_us();
    const std::lock_guard lock(mutex_);
    last_.fault = std::move(fault);
    if (line) {
        last_.line = std::move(line);
        last_.time_us = now_us;
    }
}

}  // namespace axg
