// SPDX-License-Identifier: Apache-2.0
// A socket in the file system that sends each client one text and reads nothing. A text fits the
// kernel's buffer for a reader, so it is sent at once and the connection closed: no reader, slow or
// hostile, can make the guard wait or store its state.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include <sys/types.h>

namespace axg {

class StatusSocket {
  public:
    static constexpr int kBacklog = 16;     // waiting clients; others get an error
    static constexpr int kServedATurn = 8;  // connections, then the caller pauses
    static constexpr std::size_t kTextMax = 4096;

    StatusSocket() = default;
    ~StatusSocket();
    StatusSocket(StatusSocket&& other) noexcept;
    StatusSocket& operator=(StatusSocket&& other) noexcept;

    /// Readable for everyone. A socket without a process behind it is replaced; anything else is
    /// not. Nobody is served before `listen`.
    /// @param fault  what is wrong, and what to do; empty: nothing is
    [[nodiscard]] static StatusSocket open(const std::string& path, std::string& fault);
    [[nodiscard]] bool is_open() const noexcept { return socket_ >= 0; }
    /// False: the reason is in errno.
    [[nodiscard]] bool listen() const noexcept;

    /// Waits so long for a connection. False: there is none.
    [[nodiscard]] bool await(int wait_ms) const noexcept;
    /// Sends a text to the waiting clients, kServedATurn at most. Never waits itself.
    /// @param make_text  called once, after they have connected; not without a client
    /// @return  how many connections were closed, with the text or without
    template <class MakeText>
    int serve(const MakeText& make_text) const {
        Readers readers{};
        const int count = accept_waiting(readers);
        if (count != 0) {
            hand_over({readers.data(), static_cast<std::size_t>(count)}, make_text());
        }
        return count;
    }

  private:
    using Readers = std::array<int, kServedATurn>;
    int accept_waiting(Readers& readers) const noexcept;
    static void hand_over(std::span<const int> readers, std::span<const char> text) noexcept;

    int socket_ = -1;
    std::string path_;
    dev_t device_ = 0;  // of the file, so that nobody else's is removed
    ino_t inode_ = 0;
};

/// The given socket; without one, that of the service on this bus.
[[nodiscard]] std::string status_path(const std::string& bus, const std::string& socket);

/// Reply of a guard on its socket.
/// @param fault  why there is nothing, and what to do; empty: there is
[[nodiscard]] std::string read_status(const std::string& path, std::string& fault);

}  // namespace axg
