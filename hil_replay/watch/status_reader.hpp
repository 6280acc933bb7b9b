// SPDX-License-Identifier: Apache-2.0
// Reads a guard's status socket again and again in a thread of its own: a guard that is held may
// reply after two seconds, or never. It connects and reads; it writes nothing.
#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "hil_replay/watch/watch_state.hpp"

namespace axg {

class StatusReader {
  public:
    /// @param path  of the socket; empty: nothing is ever read
    explicit StatusReader(std::string path);
    ~StatusReader();
    StatusReader(const StatusReader&) = delete;
    StatusReader& operator=(const StatusReader&) = delete;

    struct Reading {
        std::optional<GuardLine> line;  // of the last one that was read
        std::int64_t time_us = kNeverSeen;
        std::string fault;  // of the last try; empty: none
    };
    [[nodiscard]] Reading last() const;

  private:
    void run();
    void read();

    std::string path_;
    mutable std::mutex mutex_;
    std::condition_variable ending_;
    bool is_ending_ = false;
    Reading last_;
    std::thread thread_;
};

}  // namespace axg
