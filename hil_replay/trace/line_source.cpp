// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/trace/line_source.hpp"

#include <sys/stat.h>

#include <cerrno>
#include <cstring>

namespace axg {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 19U;
static_assert(kBufferBytes >= 2 * kLineBytesMax, "a line and the read that completes it");

}  // namespace

LineSource::LineSource(std::FILE* file) : file_(file), buffer_(kBufferBytes) {
    rest_ = std::string_view(buffer_.data(), std::size_t{});
    struct stat status {};
    const int descriptor = fileno(file);  // -1: a stream that unpacks
    if (descriptor >= 0 && fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode)) {
        file_bytes_ = static_cast<std::uint64_t>(status.st_size);
    }
}

LineSource::~LineSource() {
    if (file_ != nullptr) {
        std::fclose(file_);
    }
}

/// Moves what is left to the front and reads behind it.
bool LineSource::refill() {
    std::memmove(buffer_.data(), rest_.data(), rest_.size());
    const std::size_t room = buffer_.size() - rest_.size();
    const std::size_t count = std::fread(buffer_.data() + rest_.size(), 1, room, file_);
    rest_ = std::string_view(buffer_.data(), rest_.size() + count);
    read_bytes_ += count;
    if (count < room) {
        at_end_ = true;
        if (std::ferror(file_) != 0) {
            error_ = errno == EBADMSG
                         ? "cannot be unpacked to its end: damaged, or cut short; copy it anew"
                         : std::string("cannot be read: ") + std::strerror(errno);
            return false;
        }
    }
    return true;
}

double LineSource::share() const noexcept {
    return file_bytes_ == 0
               ? 0
               : static_cast<double>(read_bytes_ - rest_.size()) / static_cast<double>(file_bytes_);
}

bool LineSource::next(std::string_view& line) {
    if (!error_.empty()) {
        return false;
    }
    for (;;) {
        const void* found = rest_.empty() ? nullptr : std::memchr(rest_.data(), '\n', rest_.size());
        const bool is_last = found == nullptr && at_end_;
        if (is_last && rest_.empty()) {
            return false;
        }
        if (found != nullptr || is_last) {
            const std::size_t length =
                is_last ? rest_.size()
                        : static_cast<std::size_t>(static_cast<const char*>(found) - rest_.data());
            ++line_number_;
            line = rest_.substr(0, length);
            rest_.remove_prefix(is_last ? length : length + 1);
            if (length > kLineBytesMax) {
                error_ = "a line of more than 65536 bytes: not a trace in text form";
                return false;
            }
            if (!line.empty() && line.back() == '\r') {
                line.remove_suffix(1);
            }
            return true;
        }
        if (rest_.size() > kLineBytesMax) {
            ++line_number_;
            error_ = "a line of more than 65536 bytes: not a trace in text form";
            return false;
        }
        if (!refill()) {
            return false;
        }
    }
}

}  // namespace axg
