// SPDX-License-Identifier: Apache-2.0
// A line of the status socket in words.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace axg {

/// A line as a person reads it.
struct StatusWords {
    std::string text;  // without a character that steers a terminal
    std::string json;  // the line, in ASCII
    // Sentences of `text`, of a stop: what leads out of it.
    std::vector<std::string> ways_out = {};
    int exit_code =
        0;  // as of `axguardd run`: that of the stop's cause; 11: the guard shows nothing
};
/// @return  empty if a key is missing or has another type, or the name of phase or cause is unknown
[[nodiscard]] std::optional<StatusWords> words_of_status(std::string_view line);

}  // namespace axg
