// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <utility>

#include "hil_replay/trace/candump_log.hpp"

namespace axg {
namespace {

constexpr std::size_t kFlushBytes = std::size_t{1} << 18U;
constexpr char kHex[] = "0123456789ABCDEF";

void append_hex(std::string& text, std::uint32_t value, unsigned digits) {
    for (unsigned i = digits; i-- > 0;) {
        text.push_back(kHex[(value >> (4U * i)) & 15U]);
    }
}

void append_padded(std::string& text, std::int64_t value, std::size_t width) {
    char digits[24];
    const char* end = std::to_chars(digits, digits + sizeof digits, value).ptr;
    const auto length = static_cast<std::size_t>(end - digits);
    text.append(length < width ? width - length : 0, '0');
    text.append(digits, length);
}

}  // namespace

void append_candump(std::string& text, const CanFrame& frame, std::string_view device,
                    bool directions) {
    const std::int64_t time_us = frame.time_us < 0 ? 0 : frame.time_us;
    text.push_back('(');
    append_padded(text, time_us / 1'000'000, 10);
    text.push_back('.');
    append_padded(text, time_us % 1'000'000, 6);
    text.append(") ").append(device).push_back(' ');
    if (frame.error) {
        append_hex(text, (frame.id & 0x1FFFFFFFU) | 0x20000000U, 8);
    } else {
        append_hex(text, frame.id, frame.extended ? 8 : 3);
    }
    text.push_back('#');
    if (frame.remote) {
        text.push_back('R');
        if (frame.length_bytes != 0) {
            text.push_back(static_cast<char>('0' + (frame.length_bytes & 15U)));
        }
    } else {
        if (frame.fd) {
            text.push_back('#');
            append_hex(text, (frame.bit_rate_switch ? 1U : 0U) | (frame.error_state ? 2U : 0U), 1);
        }
        for (std::size_t i = 0; i < frame.length_bytes && i < frame.data.size(); ++i) {
            append_hex(text, frame.data[i], 2);
        }
    }
    if (directions) {
        text.append(frame.sent_by_host ? " T" : " R");
    }
    text.push_back('\n');
}

CandumpWriter::CandumpWriter(std::string path, std::string device, bool directions)
    : path_(std::move(path)), device_(std::move(device)), directions_(directions) {
    temporary_ = path_ + ".part-XXXXXX";
    buffer_.reserve(kFlushBytes + 256);
    const int descriptor = mkostemp(temporary_.data(), O_CLOEXEC);
    if (descriptor < 0) {
        temporary_.clear();
        fail("cannot create a file beside it");
        return;
    }
    (void)fchmod(descriptor, 0644);  // mkostemp gives 0600: a log is for other programs to read
    file_ = fdopen(descriptor, "wb");
    if (file_ == nullptr) {
        close(descriptor);
        fail("cannot open");
    }
}

CandumpWriter::~CandumpWriter() {
    if (file_ != nullptr) {
        std::fclose(file_);
    }
    if (!temporary_.empty()) {
        unlink(temporary_.c_str());
    }
}

bool CandumpWriter::write(const CanFrame& frame) {
    if (file_ == nullptr) {
        if (error_.empty()) {
            error_ = path_ + ": the log is already finished";
        }
        return false;
    }
    append_candump(buffer_, frame, device_, directions_);
    ++frame_count_;
    return buffer_.size() < kFlushBytes || flush();
}

bool CandumpWriter::flush() {
    if (std::fwrite(buffer_.data(), 1, buffer_.size(), file_) != buffer_.size()) {
        return fail("cannot write");
    }
    buffer_.clear();
    return true;
}

bool CandumpWriter::finish() {
    if (file_ == nullptr || !flush()) {
        return false;
    }
    const bool is_closed = std::fclose(std::exchange(file_, nullptr)) == 0;
    if (!is_closed) {
        return fail("cannot write");
    }
    if (std::rename(temporary_.c_str(), path_.c_str()) != 0) {
        return fail("cannot rename the finished log to it");
    }
    temporary_.clear();
    return true;
}

bool CandumpWriter::fail(const char* action) {
    error_ = path_ + ": " + action + ": " + std::strerror(errno) +
             "; free some space or choose another folder";
    if (file_ != nullptr) {
        std::fclose(std::exchange(file_, nullptr));
    }
    return false;
}

}  // namespace axg
