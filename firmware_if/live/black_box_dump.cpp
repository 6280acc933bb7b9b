// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/live/black_box_dump.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <system_error>
#include <vector>

#include "config/machine/effective_text.hpp"
#include "core/machine/cycle_plan.hpp"

namespace axg {
namespace {

constexpr std::int64_t kAfterStopUs = 500'000;
constexpr const char* kEnding = ".axgbox";

/// Writes all bytes, in as many calls as needed.
bool write_all(int file, std::span<const std::uint8_t> bytes) noexcept {
    while (!bytes.empty()) {
        const ssize_t written = ::write(file, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) {
            continue;
        }
        if (written <= 0) {
            return false;
        }
        bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
    return true;
}

bool write_parts(const std::string& path, const BlackBox& black_box, const BlackBoxHeader& header) {
    const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
    if (file < 0) {
        return false;
    }
    std::array<std::uint8_t, kBlackBoxHeaderBytes> head;
    encode_black_box_header(header, head);
    std::array<std::uint8_t, kBlackBoxRecordBytesMax> end;
    const BlackBoxEntry last{header.time_us, BlackBoxEnd{}};
    const std::size_t end_bytes = encode_black_box_record(last, black_box.sequence(), end);
    const auto records = black_box.records();
    const bool is_written = write_all(file, head) && write_all(file, records[0]) &&
                            write_all(file, records[1]) &&
                            write_all(file, std::span(end).first(end_bytes)) && fsync(file) == 0;
    const int error = errno;
    close(file);
    errno = error;
    return is_written;
}

std::string name_of(const BlackBoxFolder& folder, std::int64_t unix_us) {
    const std::time_t seconds = unix_us / 1'000'000;
    std::tm utc{};
    gmtime_r(&seconds, &utc);
    std::array<char, 32> text{};
    std::strftime(text.data(), text.size(), "%Y%m%dT%H%M%SZ", &utc);
    return folder.bus + "-" + text.data() + kEnding;
}

/// Names begin with the time, so the oldest come first.
void remove_oldest(const BlackBoxFolder& folder) {
    std::error_code error;
    std::vector<std::string> dumps;
    for (const auto& entry : std::filesystem::directory_iterator(folder.folder, error)) {
        const std::string name = entry.path().filename().string();
        if (name.starts_with(folder.bus + "-") && name.ends_with(kEnding)) {
            dumps.push_back(entry.path().string());
        }
    }
    std::sort(dumps.begin(), dumps.end());
    for (std::size_t i = 0; i + folder.dumps_max < dumps.size(); ++i) {
        std::filesystem::remove(dumps[i], error);
    }
}

}  // namespace

BlackBoxHeader black_box_header(const LoadedMachine& loaded, bool is_stoppable,
                                bool accepts_local) {
    BlackBoxHeader header;
    const std::string hash = configuration_hash(loaded.machine, loaded.meshes);
    std::copy_n(hash.begin(), std::min(hash.size(), header.configuration.size()),
                header.configuration.begin());
    header.is_stoppable = is_stoppable;
    header.accepts_local = accepts_local;
    header.plan = cycle_plan(loaded.machine, stop_tasks(loaded.machine));
    return header;
}

std::string write_black_box(const BlackBox& black_box, const BlackBoxHeader& header,
                            const BlackBoxFolder& folder, std::string& fault) {
    std::string path = folder.folder + "/" + name_of(folder, header.unix_us);
    const std::string part = path + ".part";
    if (!write_parts(part, black_box, header) || std::rename(part.c_str(), path.c_str()) != 0) {
        fault = path + ": cannot write the black box: " + std::strerror(errno) +
                ". Check that the folder exists, is writable and is not full.";
        unlink(part.c_str());
        return {};
    }
    remove_oldest(folder);
    return path;
}

void BlackBoxDump::on_note(const LiveNote& note) noexcept {
    const bool is_stop = note.kind == LiveNote::Kind::phase && note.phase == GuardPhase::stopped &&
                         note.cause != GuardFault::latched;  // that one was written by its own run
    if (is_stop && folder_.dumps_max != 0) {
        is_due_ = true;
        due_us_ = note.time_us + kAfterStopUs;
    }
}

void BlackBoxDump::serve(std::int64_t now_us) {
    if (is_due_ && now_us >= due_us_) {
        finish(now_us);
    }
}

void BlackBoxDump::finish(std::int64_t now_us) {
    if (!is_due_) {
        return;
    }
    is_due_ = false;
    header_.time_us = now_us;
    header_.unix_us = std::chrono::duration_cast<std::chrono::microseconds>(
                          std::chrono::system_clock::now().time_since_epoch())
                          .count();
    std::string fault;
    const std::string path = write_black_box(black_box_, header_, folder_, fault);
    path_ = path.empty() ? path_ : path;
    std::fprintf(stderr, "%s: %s%s\n", program_invocation_short_name,
                 path.empty() ? fault.c_str() : "black box: ", path.c_str());
}

}  // namespace axg
