// SPDX-License-Identifier: Apache-2.0
#include "config/text/nearest_word.hpp"

#include <algorithm>
#include <array>

#include "config/text/quote_text.hpp"

namespace axg {
namespace {

constexpr std::size_t kWordMax = 64;

/// Lower case, and one mark in place of each character that is not ASCII.
std::string folded(std::string_view word) {
    std::string out;
    for (std::size_t at = 0; at < word.size();) {
        const CodePoint point = code_point_at(word, at);
        const bool plain = point.length_bytes == 1;
        const char c = word[at];
        out += !plain ? '\x01' : c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
        at += std::max(point.length_bytes, 1U);
    }
    return out;
}

/// Edits of one letter, swaps of neighbours included (optimal string alignment, Boytsov 2011).
std::size_t distance(std::string_view a, std::string_view b) {
    using Row = std::array<std::size_t, kWordMax + 1>;
    Row two_back{};
    Row back{};
    Row row{};
    for (std::size_t j = 0; j <= b.size(); ++j) {
        row[j] = j;
    }
    for (std::size_t i = 1; i <= a.size(); ++i) {
        two_back = back;
        back = row;
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t change = back[j - 1] + (a[i - 1] == b[j - 1] ? 0U : 1U);
            row[j] = std::min({change, back[j] + 1, row[j - 1] + 1});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
                row[j] = std::min(row[j], two_back[j - 2] + 1);
            }
        }
    }
    return row[b.size()];
}

}  // namespace

std::string_view nearest_word(std::string_view word, std::span<const std::string_view> known) {
    std::string_view best;
    if (word.empty() || word.size() > kWordMax) {
        return best;
    }
    const std::string wanted = folded(word);
    std::size_t best_distance = kWordMax;
    for (const std::string_view candidate : known) {
        if (candidate.size() > kWordMax) {
            continue;
        }
        const std::size_t far = distance(wanted, folded(candidate));
        if (far <= std::max<std::size_t>(1, candidate.size() / 3) && far < best_distance &&
            far < candidate.size()) {
            best = candidate;
            best_distance = far;
        }
    }
    return best;
}

std::string listed(std::span<const std::string_view> words) {
    std::string out;
    for (const std::string_view word : words) {
        out += out.empty() ? "" : ", ";
        out += word;
    }
    return out;
}

std::string wanted_name(std::string_view what, std::string_view got,
                        std::span<const std::string_view> names) {
    const std::string_view nearest = nearest_word(got, names);
    const std::string meant = nearest.empty() ? "" : "; did you mean " + quoted(nearest) + '?';
    return "the name of " + std::string{what} + " of this file: " + escaped(listed(names), 200) +
           meant;
}

}  // namespace axg
