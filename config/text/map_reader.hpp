// SPDX-License-Identifier: Apache-2.0
// Reads the keys of one YAML map, each by its own grammar and range, and reports all others. Never
// guesses: a value that cannot be read adds a fault and leaves its target untouched.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "config/text/yaml_tree.hpp"

namespace axg {

class FaultList;

enum class Need : std::uint8_t { optional, required };
struct Range {
    double min, max;  // both allowed
};
struct WholeRange {
    std::uint32_t min, max;  // both allowed
};

class MapReader {
  public:
    /// Reports at once a node that is no map and every key that is not among `keys`.
    /// @param path  dotted name of the map, empty at the top
    MapReader(const YamlNode& node, std::string path, std::span<const std::string_view> keys,
              FaultList& faults);
    MapReader(const YamlNode& node, std::string path, std::initializer_list<std::string_view> keys,
              FaultList& faults)
        : MapReader(node, std::move(path), std::span(keys.begin(), keys.size()), faults) {}

    /// The value of a key, or nullptr when it is absent, empty or refused. Reports an
    /// empty value, and an absent one if required, with `wanted`.
    const YamlNode* find(std::string_view key, Need need, std::string_view wanted);
    /// Whether the key is written at all, however badly.
    [[nodiscard]] bool has(std::string_view key) const noexcept;
    /// The line of the key, or of the map when the key is absent.
    [[nodiscard]] int line_of(std::string_view key) const noexcept;
    [[nodiscard]] std::string path_of(std::string_view key) const;
    [[nodiscard]] const YamlNode& node() const noexcept { return node_; }

    // Each returns true when the target was set.
    bool number(std::string_view key, Need need, Range range, double& out);
    bool whole(std::string_view key, Need need, WholeRange range, std::uint32_t& out);
    bool can_id(std::string_view key, Need need, WholeRange range, std::uint32_t& out);
    bool boolean(std::string_view key, Need need, bool& out);
    bool choice(std::string_view key, Need need, std::span<const std::string_view> words,
                std::size_t& out);
    /// Text for people: one line, no control characters, not blank.
    bool text(std::string_view key, Need need, std::size_t size_max, std::string& out);
    /// A name: ASCII letters, digits, _ - and . , a letter or digit first.
    bool name(std::string_view key, Need need, std::string& out);
    /// A list of exactly out.size() numbers.
    bool numbers(std::string_view key, Need need, Range range, std::span<double> out);

    void report(std::string_view key, std::string got, std::string wanted);

  private:
    bool missing_was_misspelt(std::string_view key) const noexcept;
    bool is_given(std::string_view key, Need need);
    bool whole_text(std::string_view key, Need need, WholeRange range, bool hex,
                    std::uint32_t& out);

    const YamlNode& node_;
    std::string path_;
    FaultList& faults_;
    std::vector<std::string_view> misspelt_;  // the nearest keys to those not allowed
};

/// Location and name of a value, for readers of single values.
struct ValueSite {
    const YamlNode& node;
    const std::string& path;
    FaultList& faults;
};
bool read_number(ValueSite site, Range range, double& out);
bool read_whole(ValueSite site, WholeRange range, bool hex, std::uint32_t& out);
bool read_numbers(ValueSite site, Range range, std::span<double> out);
bool read_name(ValueSite site, std::string& out);

/// Whether `text` is a name as MapReader::name requires it.
[[nodiscard]] bool is_name(std::string_view text) noexcept;
inline constexpr std::size_t kNameLengthMax = 64;

/// The value as the file shows it, for "got".
[[nodiscard]] std::string shown(const YamlNode& node);
/// A number as a person writes it.
[[nodiscard]] std::string shown(double value);

}  // namespace axg
