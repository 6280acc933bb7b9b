// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/trace/line_source.hpp"

#include <sys/stat.h>

#include <cerrno>
#include <cstring>

namespace axg {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 19U;
constexpr std::size_t kBeginBytes = 64;
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

/// Moves the unread bytes to the front and reads more behind them.
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
                         ? "cannot be unpacked to its end: damaged or truncated. Copy it again."
                     : errno == EILSEQ ? "has trailing bytes after the gzip data. Copy it again."
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
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (!error_.empty() || !take(line)) {
        return false;
    }
    ++line_number_;
    if (line_number_ == 1 && line.starts_with(kByteOrderMark)) {
        line.remove_prefix(kByteOrderMark.size());
    }
    if (!line.empty() && line.back() == '\r') {
        line.remove_suffix(1);
    }
    return true;
}

/// Returns a line with its line end, or only the beginning of one that is too long.
bool LineSource::take(std::string_view& line) {
    is_too_long_ = false;
    for (;;) {
        const void* found = rest_.empty() ? nullptr : std::memchr(rest_.data(), '\n', rest_.size());
        const bool is_last = found == nullptr && at_end_;
        if (is_last && rest_.empty()) {
            return false;
        }
        const std::size_t length =
            found != nullptr
                ? static_cast<std::size_t>(static_cast<const char*>(found) - rest_.data())
                : rest_.size();
        if (length > kLineBytesMax) {
            begin_ = rest_.substr(0, kBeginBytes);
            line = begin_;
            is_too_long_ = true;
            pass_rest_of_line();
            return error_.empty();
        }
        if (found != nullptr || is_last) {
            line = rest_.substr(0, length);
            rest_.remove_prefix(is_last ? length : length + 1);
            return true;
        }
        if (!refill()) {
            return false;
        }
    }
}

/// With fixed memory, however long it is.
void LineSource::pass_rest_of_line() {
    for (;;) {
        const std::size_t end = rest_.find('\n');
        if (end != std::string_view::npos) {
            rest_.remove_prefix(end + 1);
            return;
        }
        rest_ = rest_.substr(rest_.size());
        if (at_end_ || !refill()) {
            return;
        }
    }
}

}  // namespace axg
