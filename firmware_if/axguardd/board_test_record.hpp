// SPDX-License-Identifier: Apache-2.0
// Which board was tested for which configuration: one file per interface next to the latch. It
// names hashes of the machine file, and the serial that a person typed, for no frame names a board.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/machine/configuration_hashes.hpp"
#include "firmware_if/board_test/board_report.hpp"
#include "firmware_if/live/status_line.hpp"

namespace axg {

inline constexpr std::size_t kSerialCharactersMax = 64;

struct BoardTestRecord {
    std::string machine, bus, serial;
    std::string date;            // UTC, ISO 8601
    ConfigurationHashes hashes;  // of the machine file with the measured keys
    BoardTestCounts counts;
    std::string abandoned;  // why the test ended early; empty: it did not
};

[[nodiscard]] std::string board_test_path(const std::string& state_dir, const std::string& bus);

/// Why a text is no serial: it is empty, too long, or has characters other than printable ASCII.
[[nodiscard]] std::string serial_fault(const std::string& serial);

/// Why no record can be written here: something else than a regular file has the name.
[[nodiscard]] std::string record_place_fault(const std::string& path);

[[nodiscard]] std::string describe_record(const BoardTestRecord& record);

struct FoundRecord {
    RecordState state = RecordState::none;
    BoardTestRecord record;            // where it could be read
    std::vector<std::string> differs;  // names of the hashes; another configuration
    std::string fault;                 // unreadable: why
};
/// @param hashes  of the configuration that is about to run
[[nodiscard]] FoundRecord find_record(const std::string& path, const ConfigurationHashes& hashes);

[[nodiscard]] TestedBoard tested_board(const FoundRecord& found);

/// One line for a person, without a line feed.
[[nodiscard]] std::string words_of(const FoundRecord& found, const std::string& path);

}  // namespace axg
