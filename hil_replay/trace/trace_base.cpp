// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/trace/trace_base.hpp"

#include <sys/stat.h>

#ifdef AXG_HAS_ZLIB
#include <zlib.h>
#endif

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>

#include "config/text/fault_text.hpp"
#include "hil_replay/trace/candump_line.hpp"
#include "hil_replay/trace/candump_log.hpp"
#include "hil_replay/trace/kept_input.hpp"
#include "hil_replay/trace/vector_asc.hpp"

namespace axg {
namespace {

/// Text from a file, for a message: at most 40 bytes, control characters and bytes beyond ASCII as
/// \xNN.
std::string quoted_bytes(std::string_view text) {
    constexpr std::size_t kShown = 40;
    constexpr char kHex[] = "0123456789ABCDEF";
    std::string out = "\"";
    for (const char c : text.substr(0, kShown)) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x20 || byte > 0x7E || byte == '"' || byte == '\\') {
            out.append("\\x").push_back(kHex[byte >> 4U]);
            out.push_back(kHex[byte & 15U]);
        } else {
            out.push_back(c);
        }
    }
    return out + (text.size() > kShown ? "...\"" : "\"");
}

}  // namespace

bool TextTrace::next(CanFrame& frame) {
    if (!error_.empty()) {
        return false;
    }
    std::string_view text;
    while (lines_.next(text)) {
        LineFault fault;
        std::string_view device;
        const Line kind = read_line(text, frame, device, fault);
        line_ = lines_.line_number();
        if (kind == Line::nothing || kind == Line::event) {
            events_ += kind == Line::event ? 1 : 0;
            continue;
        }
        if (kind == Line::fault ? complain(fault) : !accept(frame, device)) {
            if (!error_.empty()) {
                return false;
            }
            continue;
        }
        if (kind == Line::frame) {
            return true;
        }
    }
    if (!lines_.error().empty()) {
        error_ = name_ + ":" + std::to_string(lines_.line_number()) + ": " + lines_.error();
    }
    return false;
}

TextTrace::Line TextTrace::read_line(std::string_view text, CanFrame& frame,
                                     std::string_view& device, LineFault& fault) {
    if (lines_.is_too_long()) {
        fault = {"line", text, "at most 65536 bytes (a trace in text form)"};
        return Line::fault;
    }
    const bool is_blank = text.find_first_not_of(" \t\v\f\r") == std::string_view::npos;
    return is_blank ? Line::nothing : parse(text, frame, device, fault);
}

/// Stores the message: the error, or in lenient mode the first of those counted. Always true.
bool TextTrace::complain(const LineFault& fault) {
    if (options_.lenient && ++skipped_ > 1) {
        return true;
    }
    std::string message = name_ + ":" + std::to_string(line_) + ": ";
    message.append(fault.what).append(": ");
    std::string wanted(fault.wanted);
    if (fault.is_skippable && !options_.lenient) {
        wanted += "; pass over such lines with --lenient";
    }
    message.append(fault_text("invalid value", quoted_bytes(fault.got), wanted));
    (options_.lenient ? first_skipped_ : error_) = std::move(message);
    return true;
}

/// Interface and time of a frame that could be read; false if it is not for the caller.
bool TextTrace::accept(const CanFrame& frame, std::string_view device) {
    if (device != device_) {
        if (!options_.device.empty() && device != options_.device) {
            return false;
        }
        if (!device_.empty()) {
            complain(
                {"interface", device, "one interface in the whole trace; select it with --device"});
            return false;
        }
        device_ = device;
    }
    if (has_time_ && last_time_us_ - frame.time_us > options_.backwards_us_max) {
        char text[64];
        std::snprintf(text, sizeof text, "%.6f s after %.6f s",
                      static_cast<double>(frame.time_us) * 1e-6,
                      static_cast<double>(last_time_us_) * 1e-6);
        complain({"time", text, when_time_decreases()});
        return false;
    }
    last_time_us_ = has_time_ ? std::max(last_time_us_, frame.time_us) : frame.time_us;
    has_time_ = true;
    return true;
}

namespace {

/// Whether gzip wrote it; the file is at its beginning again.
bool is_packed(std::FILE* file) {
    unsigned char magic[2] = {};
    const bool is_gzip = std::fread(magic, 1, 2, file) == 2 && magic[0] == 0x1F && magic[1] == 0x8B;
    std::rewind(file);
    return is_gzip;
}

#ifdef AXG_HAS_ZLIB
/// Unpacks members of gzip, one behind the other. Not by gzread(), which silently skips bytes after
/// the last member.
class Unpacker {
  public:
    explicit Unpacker(std::FILE* file) noexcept : file_(file) {
        constexpr int kGzip = 16 + MAX_WBITS;  // zlib.h: with gzip's head and sum
        is_ready_ = inflateInit2(&stream_, kGzip) == Z_OK;
    }
    ~Unpacker() {
        inflateEnd(&stream_);
        std::fclose(file_);
    }
    Unpacker(const Unpacker&) = delete;
    Unpacker& operator=(const Unpacker&) = delete;

    [[nodiscard]] bool is_ready() const noexcept { return is_ready_; }

    /// Bytes unpacked, 0 at the end; -1 with errno: EBADMSG damaged or cut short, EILSEQ bytes that
    /// no gzip packed.
    ssize_t read(char* buffer, std::size_t size) {
        stream_.next_out = reinterpret_cast<Bytef*>(buffer);
        stream_.avail_out = static_cast<uInt>(std::min(size, kPackedBytes));
        const uInt room = stream_.avail_out;
        while (stream_.avail_out == room) {
            if (stream_.avail_in == 0 && !fill()) {
                return -1;
            }
            if (stream_.avail_in == 0) {
                return is_between_members_ ? 0 : fail(EBADMSG);
            }
            const bool is_head = is_between_members_;
            is_between_members_ = false;
            const int status = inflate(&stream_, Z_NO_FLUSH);
            if (status == Z_STREAM_END) {
                is_between_members_ = true;
                inflateReset(&stream_);
            } else if (status != Z_OK) {
                return fail(is_head && stream_.total_out == 0 ? EILSEQ : EBADMSG);
            }
        }
        return static_cast<ssize_t>(room - stream_.avail_out);
    }

  private:
    static constexpr std::size_t kPackedBytes = std::size_t{1} << 16U;

    bool fill() {
        const std::size_t count = std::fread(packed_.data(), 1, packed_.size(), file_);
        stream_.next_in = packed_.data();
        stream_.avail_in = static_cast<uInt>(count);
        return count != 0 || std::ferror(file_) == 0;
    }

    static ssize_t fail(int error) {
        errno = error;
        return -1;
    }

    std::FILE* file_;
    z_stream stream_{};
    std::array<Bytef, kPackedBytes> packed_{};
    bool is_ready_ = false, is_between_members_ = true;
};

/// A stream of the unpacked bytes of `file`, which it owns. A damaged file is a read error.
std::FILE* unpack(std::FILE* file, const std::string& path, std::string& error) {
    auto unpacker = std::make_unique<Unpacker>(file);
    cookie_io_functions_t functions{};
    functions.read = [](void* cookie, char* buffer, std::size_t size) {
        return static_cast<Unpacker*>(cookie)->read(buffer, size);
    };
    functions.close = [](void* cookie) {
        const std::unique_ptr<Unpacker> owned(static_cast<Unpacker*>(cookie));
        return 0;
    };
    std::FILE* const stream =
        unpacker->is_ready() ? fopencookie(unpacker.get(), "rb", functions) : nullptr;
    if (stream == nullptr) {
        error = path + ": cannot be unpacked: " + std::strerror(errno);
        return nullptr;
    }
    (void)unpacker.release();  // the stream closes it
    return stream;
}
#else
std::FILE* unpack(std::FILE* file, const std::string& path, std::string& error) {
    std::fclose(file);
    error = path +
            ": is compressed with gzip, and this axguard was built without zlib. Unpack it: gunzip "
            "-k " +
            path + ", or install zlib1g-dev and build again";
    return nullptr;
}
#endif

}  // namespace

std::FILE* open_text(const std::string& path, std::string& error) {
    std::FILE* file = open_input(path);
    struct stat status {};
    if (file == nullptr || fstat(fileno(file), &status) != 0) {
        error = path + ": cannot be opened: " + std::strerror(errno) + ". Check the name.";
    } else if (S_ISDIR(status.st_mode)) {
        error = path + ": invalid file (found a folder, expected a trace file).";
    }
    if (!error.empty() && file != nullptr) {
        std::fclose(file);
        file = nullptr;
    }
    return file == nullptr || !is_packed(file) ? file : unpack(file, path, error);
}

namespace {

/// candump without -t or -L: an interface and a frame.
bool is_without_time(std::string_view line) {
    CanFrame frame;
    std::string_view device;
    const std::string stamped = "(0.000000) " + std::string(line);
    return !parse_candump_line(stamped, frame, device);
}

/// What was expected of a file that is no trace, and how to get there.
const char* wanted_of(std::string_view line) {
    if (line.starts_with("MDF     ")) {  // the first bytes of MF4; Debian 12's python3-can is older
        return "a candump log or a Vector ASC file; convert MF4 with can_logconvert of PyPI's "
               "python-can and asammdf";
    }
    return is_without_time(line)
               ? "a time before each frame; record with candump -L or -ta"
               : "a candump log or a Vector ASC file; convert other formats with can_logconvert "
                 "(Debian: python3-can)";
}

}  // namespace

std::unique_ptr<TraceReader> open_trace(const std::string& path, const TraceOptions& options,
                                        std::string& error) {
    error.clear();
    std::FILE* file = open_text(path, error);
    if (file == nullptr) {
        return nullptr;
    }
    std::string_view line;
    char kind = 0;
    {
        LineSource lines(file);
        while (kind == 0 && lines.next(line)) {
            const std::size_t at = line.find_first_not_of(" \t\v\f\r");
            if (at == std::string_view::npos) {
                continue;
            }
            const std::string_view word = line.substr(at);
            const bool is_asc =
                word.starts_with("date ") || word.starts_with("base ") || word.starts_with("//");
            const bool is_candump =
                word[0] == '(' || word[0] == '#' || word.starts_with("DROPCOUNT");
            kind = is_asc ? 'a' : is_candump ? 'c' : '?';
        }
        if (kind == '?') {
            error = path + ":" + std::to_string(lines.line_number()) + ": " +
                    fault_text("invalid file", quoted_bytes(line), wanted_of(line));
        } else if (kind == 0) {
            error = path + ": " + (lines.error().empty() ? "the trace is empty" : lines.error());
        }
    }
    if (!error.empty()) {
        return nullptr;
    }
    return kind == 'a' ? open_asc(path, options, error) : open_candump(path, options, error);
}

}  // namespace axg
