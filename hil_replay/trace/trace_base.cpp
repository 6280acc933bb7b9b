// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/trace/trace_base.hpp"

#include <sys/stat.h>
#include <unistd.h>

#ifdef AXG_HAS_ZLIB
#include <zlib.h>
#endif

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "hil_replay/trace/candump_log.hpp"
#include "hil_replay/trace/vector_asc.hpp"

namespace axg {

std::string quoted(std::string_view text) {
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

bool TextTrace::next(CanFrame& frame) {
    if (!error_.empty()) {
        return false;
    }
    std::string_view text;
    while (lines_.next(text)) {
        LineFault fault;
        std::string_view device;
        const Line kind = parse(text, frame, device, fault);
        line_ = lines_.line_number();
        if (kind == Line::nothing) {
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

/// Keeps the message: the error, or in lenient mode the first of those counted. Always true.
bool TextTrace::complain(const LineFault& fault) {
    if (options_.lenient && ++skipped_ > 1) {
        return true;
    }
    std::string message = name_ + ":" + std::to_string(line_) + ": ";
    message.append(fault.what).append(": got ").append(quoted(fault.got));
    message.append(", wanted ").append(fault.wanted);
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
                {"interface", device, "one interface in the whole trace: name the one to read"});
            return false;
        }
        device_ = device;
    }
    if (has_time_ && last_time_us_ - frame.time_us > options_.backwards_us_max) {
        char text[64];
        std::snprintf(text, sizeof text, "%.6f s after %.6f s",
                      static_cast<double>(frame.time_us) * 1e-6,
                      static_cast<double>(last_time_us_) * 1e-6);
        complain({"time", text, "a time that does not run backwards: sort the trace"});
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
/// A stream of what is packed in `file`, which it takes over. A damaged file is a read error.
std::FILE* unpack(std::FILE* file, const std::string& path, std::string& error) {
    const int descriptor = dup(fileno(file));
    std::fclose(file);
    if (descriptor >= 0) {
        lseek(descriptor, 0, SEEK_SET);
    }
    gzFile packed = descriptor < 0 ? nullptr : gzdopen(descriptor, "rb");
    cookie_io_functions_t functions{};
    functions.read = [](void* cookie, char* buffer, std::size_t size) -> ssize_t {
        const int count = gzread(static_cast<gzFile>(cookie), buffer, static_cast<unsigned>(size));
        int status = Z_OK;
        gzerror(static_cast<gzFile>(cookie), &status);
        const bool is_cut = count >= 0 && status == Z_BUF_ERROR;  // it ends in the middle
        errno = count < 0 || is_cut ? EBADMSG : errno;
        return is_cut ? -1 : count;
    };
    functions.close = [](void* cookie) { return gzclose(static_cast<gzFile>(cookie)); };
    std::FILE* stream = packed == nullptr ? nullptr : fopencookie(packed, "rb", functions);
    if (stream == nullptr) {
        error = path + ": cannot be unpacked: " + std::strerror(errno);
    }
    return stream;
}
#else
std::FILE* unpack(std::FILE* file, const std::string& path, std::string& error) {
    std::fclose(file);
    error = path +
            ": is packed by gzip, and this axguard was built without zlib; unpack it: gunzip -k " +
            path + ", or install zlib1g-dev and build anew";
    return nullptr;
}
#endif

}  // namespace

std::FILE* open_text(const std::string& path, std::string& error) {
    std::FILE* file = std::fopen(path.c_str(), "rb");
    struct stat status {};
    if (file == nullptr || fstat(fileno(file), &status) != 0) {
        error = path + ": cannot be opened: " + std::strerror(errno) + "; check the name";
    } else if (S_ISDIR(status.st_mode)) {
        error = path + ": is a folder, wanted a trace file";
    }
    if (!error.empty() && file != nullptr) {
        std::fclose(file);
        file = nullptr;
    }
    return file == nullptr || !is_packed(file) ? file : unpack(file, path, error);
}

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
            const std::size_t at = line.find_first_not_of(" \t");
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
            error = path + ":" + std::to_string(lines.line_number()) + ": got " + quoted(line) +
                    ", wanted a candump log or a Vector ASC file; convert others with "
                    "can_logconvert (Debian: python3-can)";
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
