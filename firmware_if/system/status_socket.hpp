// SPDX-License-Identifier: Apache-2.0
// A socket in the file system that gives everyone who connects one text and takes nothing. A text
// fits what the kernel keeps for a reader, so it is handed over at once and the connection closed:
// no reader, slow or hostile, can make the guard wait or remember it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include <sys/types.h>

namespace axg {

class StatusSocket {
  public:
    static constexpr int kBacklog = 16;     // that wait to be served; others are told so
    static constexpr int kServedATurn = 8;  // connections, then whoever serves rests
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
    /// Hands a text to those who wait, kServedATurn at most. Itself it never waits.
    /// @param make_text  called once, after they have connected; not where nobody waits
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

/// Reply of a guard on its socket.
/// @param fault  why there is nothing, and what to do; empty: there is
[[nodiscard]] std::string read_status(const std::string& path, std::string& fault);

}  // namespace axg
