// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/axguardd/board_test_record.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "firmware_if/cli/document_json.hpp"

namespace axg {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kRecordBytesMax = 16'384, kTextBytesMax = 400;

bool is_plain(std::string_view text) {
    return std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~'; });
}

/// The whole file, or why there is none. A pipe or a device could hold the start up.
std::string content_of(const std::string& path, std::string& text) {
    const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (file < 0) {
        return errno == ELOOP ? "is not a regular file" : std::strerror(errno);
    }
    struct stat status {};
    const bool is_file = fstat(file, &status) == 0 && S_ISREG(status.st_mode);
    text.resize(kRecordBytesMax + 1);
    const ssize_t size = is_file ? read(file, text.data(), text.size()) : 0;
    const int error = errno;
    close(file);
    if (!is_file) {
        return "is not a regular file";
    }
    if (size < 0) {
        return std::strerror(error);
    }
    text.resize(static_cast<std::size_t>(size));
    return text.size() > kRecordBytesMax ? "is too long" : "";
}

std::optional<std::string> text_in(const Json& json, const char* key) {
    const auto found = json.find(key);
    if (found == json.end() || !found->is_string()) {
        return std::nullopt;
    }
    auto text = found->get<std::string>();
    return text.size() <= kTextBytesMax ? std::optional(std::move(text)) : std::nullopt;
}

std::optional<ConfigurationHashes> hashes_in(const Json& json) {
    const auto of = json.find("hashes");
    if (of == json.end() || !of->is_object()) {
        return std::nullopt;
    }
    ConfigurationHashes out;
    for (std::uint32_t i = 0; i < kHashParts; ++i) {
        const std::optional<std::string> text = text_in(*of, kHashPartNames[i]);
        if (!text || text->size() != 8) {
            return std::nullopt;
        }
        const char* const end = text->data() + text->size();
        const auto read = std::from_chars(text->data(), end, out.of[i], 16);
        if (read.ec != std::errc() || read.ptr != end) {
            return std::nullopt;
        }
    }
    return out;
}

bool take_counts(const Json& json, BoardTestCounts& out) {
    const std::array<std::pair<const char*, std::size_t*>, 4> counts{
        {{"passed", &out.passed},
         {"failed", &out.failed},
         {"unclear", &out.unclear},
         {"not_tested", &out.not_tested}}};
    for (const auto& [key, count] : counts) {
        const auto found = json.find(key);
        if (found == json.end() || !found->is_number_unsigned()) {
            return false;
        }
        *count = found->get<std::size_t>();
    }
    return true;
}

std::optional<BoardTestRecord> record_in(const std::string& text) {
    const Json json = Json::parse(text, nullptr, false);
    if (!json.is_object()) {
        return std::nullopt;
    }
    const auto machine = text_in(json, "machine"), bus = text_in(json, "bus"),
               serial = text_in(json, "serial"), date = text_in(json, "date"),
               abandoned = text_in(json, "abandoned");
    const std::optional<ConfigurationHashes> hashes = hashes_in(json);
    BoardTestCounts counts;
    if (!machine || !bus || !serial || !serial_fault(*serial).empty() || !date ||
        !is_plain(*date) || date->size() > 32 || !abandoned || !hashes ||
        !take_counts(json, counts)) {
        return std::nullopt;
    }
    return BoardTestRecord{*machine, *bus, *serial, *date, *hashes, counts, *abandoned};
}

std::string joined(const std::vector<std::string>& names) {
    return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

std::string board_test_path(const std::string& state_dir, const std::string& bus) {
    return state_dir + "/" + bus + ".board-test.json";
}

std::string serial_fault(const std::string& serial) {
    const bool is_serial = !serial.empty() && serial.size() <= kSerialCharactersMax &&
                           is_plain(serial) && serial.find_first_not_of(' ') != std::string::npos;
    return is_serial ? ""
                     : fmt::format("no serial (expected 1 to {} printable ASCII characters)",
                                   kSerialCharactersMax);
}

std::string record_place_fault(const std::string& path) {
    struct stat found {};
    const bool is_free = lstat(path.c_str(), &found) != 0 || S_ISREG(found.st_mode);
    return is_free ? "" : path + ": is not a regular file. Remove it, or pass another --state-dir.";
}

std::string describe_record(const BoardTestRecord& record) {
    Json hashes = Json::object();
    for (std::uint32_t i = 0; i < kHashParts; ++i) {
        hashes[kHashPartNames[i]] = fmt::format("{:08x}", record.hashes.of[i]);
    }
    return text_of({{"serial", record.serial},
                    {"date", record.date},
                    {"machine", record.machine},
                    {"bus", record.bus},
                    {"hashes", std::move(hashes)},
                    {"passed", record.counts.passed},
                    {"failed", record.counts.failed},
                    {"unclear", record.counts.unclear},
                    {"not_tested", record.counts.not_tested},
                    {"abandoned", record.abandoned}});
}

TestedBoard tested_board(const FoundRecord& found) {
    return {found.state, found.record.serial, found.record.date, found.differs};
}

FoundRecord find_record(const std::string& path, const ConfigurationHashes& hashes) {
    FoundRecord out;
    struct stat status {};
    if (lstat(path.c_str(), &status) != 0 && errno == ENOENT) {
        return out;
    }
    out.state = RecordState::unreadable;
    std::string text;
    out.fault = content_of(path, text);
    if (!out.fault.empty()) {
        return out;
    }
    std::optional<BoardTestRecord> record = record_in(text);
    if (!record) {
        out.fault = "is no record of a board test";
        return out;
    }
    out.record = std::move(*record);
    for (std::uint32_t i = 0; i < kHashParts; ++i) {
        if (out.record.hashes.of[i] != hashes.of[i]) {
            out.differs.emplace_back(kHashPartNames[i]);
        }
    }
    out.state = out.differs.empty() ? RecordState::this_configuration : RecordState::another;
    return out;
}

std::string words_of(const FoundRecord& found, const std::string& path) {
    constexpr std::string_view kTest = "Test the board: axguardd board-test --write FILE";
    const BoardTestRecord& record = found.record;
    const std::string whose = fmt::format("serial {}, {}", record.serial, record.date);
    switch (found.state) {
        case RecordState::none:
            return fmt::format("board test: no record ({}). {}", path, kTest);
        case RecordState::unreadable:
            return fmt::format("board test: {}: {}. {}", path, found.fault, kTest);
        case RecordState::another:
            return fmt::format("board test: record of another configuration ({} differ{}): {}. {}",
                               joined(found.differs), found.differs.size() == 1 ? "s" : "", whose,
                               kTest);
        case RecordState::this_configuration:
            break;
    }
    return fmt::format(
        "board test: record for this configuration: {}; {} passed, {} FAILED, {} unclear, {} not "
        "tested{}",
        whose, record.counts.passed, record.counts.failed, record.counts.unclear,
        record.counts.not_tested, record.abandoned.empty() ? "" : "; ended early");
}

}  // namespace axg
