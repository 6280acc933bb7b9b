// SPDX-License-Identifier: Apache-2.0
// The date line of an ASC header, in the languages in which Vector's tools write it.
#pragma once

#include <cstdint>
#include <string_view>

namespace axg {

/// Reads `Sam Sep 30 15:06:13.191 2017`, also with ` pm` after the time, also with German month
/// names (`Mrz`, `Okt`).
/// @return false if it is no such date; else microseconds since 1970, read as UTC, in `time_us`
[[nodiscard]] bool parse_asc_date(std::string_view text, std::int64_t& time_us) noexcept;

}  // namespace axg
