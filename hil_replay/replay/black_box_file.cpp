// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/replay/black_box_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <utility>

#include "config/text/quote_text.hpp"
#include "hil_replay/trace/kept_input.hpp"

namespace axg {
namespace {

constexpr std::size_t kFileBytesMax = std::size_t{1} << 30U;  // far above the ring of any machine

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

/// Reads up to `bytes_max`.
std::vector<std::uint8_t> read(std::FILE* file, std::size_t bytes_max) {
    std::vector<std::uint8_t> bytes;
    std::size_t got = 1;
    while (got != 0 && bytes.size() < bytes_max) {
        const std::size_t at = bytes.size();
        bytes.resize(std::min(bytes_max, at + (std::size_t{1} << 20U)));
        got = std::fread(bytes.data() + at, 1, bytes.size() - at, file);
        bytes.resize(at + got);
    }
    return bytes;
}

}  // namespace

BlackBoxFile::BlackBoxFile(std::string name, std::vector<std::uint8_t> bytes)
    : name_(std::move(name)), bytes_(std::move(bytes)) {
    const BlackBoxStatus status = decode_black_box_header(bytes_, header_);
    if (status == BlackBoxStatus::bad_version) {
        error_ = escaped(name_, 4096) + ":0: invalid file (found a black box of version " +
                 std::to_string(bytes_[kBlackBoxMagic.size()]) + ", expected version " +
                 std::to_string(kBlackBoxVersion) +
                 "). Use the axguard version of the axguardd that wrote it.";
        return;
    }
    if (status != BlackBoxStatus::ok) {
        fail(to_text(status));
        return;
    }
    at_ = kBlackBoxHeaderBytes;
}

BlackBoxFile BlackBoxFile::open(const std::string& path) {
    const File file(open_input(path), &std::fclose);
    BlackBoxFile black_box(path,
                           file ? read(file.get(), kFileBytesMax) : std::vector<std::uint8_t>{});
    if (!file || std::ferror(file.get()) != 0) {
        black_box.error_ = escaped(path, 4096) + ": cannot be read: " + std::strerror(errno);
    }
    return black_box;
}

bool BlackBoxFile::fail(const char* what) {
    error_ = escaped(name_, 4096) + ":" + std::to_string(at_) + ": " + what +
             (at_ == 0 ? " (expected a dump of axguardd)" : ". Earlier records are used.");
    return false;
}

bool BlackBoxFile::next(BlackBoxRecord& out) {
    if (!error_.empty() || is_at_end_) {
        return false;
    }
    const std::span<const std::uint8_t> rest = std::span(bytes_).subspan(at_);
    const BlackBoxStatus status = decode_black_box_record(rest, out);
    if (status != BlackBoxStatus::ok) {
        return fail(to_text(status));
    }
    if (has_sequence_ && out.sequence != sequence_) {
        return fail("a record is missing before this one");
    }
    at_ += out.size_bytes;
    sequence_ = out.sequence + 1;
    has_sequence_ = true;
    if (std::holds_alternative<BlackBoxEnd>(out.entry.content)) {
        is_at_end_ = true;
        return at_ == bytes_.size() ? false : fail("something behind the end");
    }
    return true;
}

}  // namespace axg
