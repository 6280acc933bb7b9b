// SPDX-License-Identifier: Apache-2.0
// Pages of docs/ as tests read them: the whole text, its fenced blocks, and frames in candump's
// notation with words beside them.
#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "hil_replay/trace/candump_line.hpp"
#include "hil_replay/trace/candump_log.hpp"

namespace axg::test {

inline std::string page_of(const std::string& name) {
    std::ifstream file(std::string(AXG_SOURCE_DIR) + "/docs/" + name);
    EXPECT_TRUE(file.good()) << name;
    return {std::istreambuf_iterator<char>(file), {}};
}

/// The contents of all blocks fenced as ```tag.
inline std::vector<std::string> blocks_of(const std::string& page, const std::string& tag) {
    const std::string open = "```" + tag + "\n";
    std::vector<std::string> blocks;
    for (std::size_t at = page.find(open); at != std::string::npos; at = page.find(open, at)) {
        at += open.size();
        const std::size_t end = page.find("```", at);
        blocks.push_back(page.substr(at, end - at));
    }
    return blocks;
}

/// `ID#BYTES` as candump writes it, and the words beside it.
struct FrameLine {
    std::string bytes, words;
    CanFrame frame;
};

/// A line that begins with a blank goes on with the words of the one before.
inline std::vector<FrameLine> frame_lines(const std::string& block) {
    std::vector<FrameLine> lines;
    std::istringstream text(block);
    for (std::string line; std::getline(text, line);) {
        const std::size_t word = line.find_first_not_of(' ', std::min(line.find(' '), line.size()));
        const std::string words = word == std::string::npos ? "" : line.substr(word);
        if (line.starts_with(' ')) {
            EXPECT_FALSE(lines.empty()) << line;
            lines.back().words += (lines.back().words.empty() ? "" : " ") + words;
            continue;
        }
        FrameLine& made = lines.emplace_back();
        made.bytes = line.substr(0, line.find(' '));
        made.words = words;
        const std::string log = "(0.000000) can0 " + made.bytes;
        std::string_view device;
        EXPECT_FALSE(parse_candump_line(log, made.frame, device)) << line;
    }
    return lines;
}

/// As the pages write frames: without time and interface, a dot between bytes of a classical frame.
inline std::string page_bytes(const CanFrame& frame) {
    std::string line;
    append_candump(line, frame, "can0");
    line = line.substr(line.rfind(' ') + 1);
    line.pop_back();
    const std::size_t data = line.rfind('#') + 1;
    for (std::size_t i = data + 2; !frame.fd && i < line.size(); i += 3) {
        line.insert(i, ".");
    }
    return line;
}

}  // namespace axg::test
