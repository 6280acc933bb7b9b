// SPDX-License-Identifier: Apache-2.0
// A key of the machine file that holds one number, switch or word. A row states once what the
// reader, the canonical text and the effective file need of it. Tables: machine_keys.hpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include "config/text/map_reader.hpp"
#include "core/machine/machine.hpp"

namespace axg {

/// The member is value * times / by; the value is member * back.
struct KeyUnit {
    double times = 1, by = 1, back = 1;
};

/// When the canonical text has a line for a key. An infinite number never has one.
enum class KeyLine : std::uint8_t {
    always,
    unless_first,  // a word other than the first, a switch that is on, a number other than 0
};

/// Has the switches for keys that the file states.
template <class Owner>
using StatesOf = std::conditional_t<std::is_same_v<Owner, Axis>, Axis, StatedPromises>;

template <class Owner>
struct ScalarKey {
    const char* key;   // in the file
    const char* line;  // in the canonical text, below the name of the section
    // The member is one of these; a word has functions, and its place among `words`.
    double Owner::*number = nullptr;
    std::uint32_t Owner::*whole = nullptr;
    bool Owner::*is_on = nullptr;
    std::size_t (*place)(const Owner& owner) = nullptr;
    void (*set_place)(Owner& owner, std::size_t place) = nullptr;
    std::span<const std::string_view> words{};
    bool is_text = false;  // the canonical text has the word, not its place
    Range range{};         // of a number, whole or not
    KeyUnit unit{};
    double none = 0;  // the number after the word `none`; 0: the key takes numbers only
    Need need = Need::optional;
    KeyLine when = KeyLine::always;
    bool Owner::*only_with = nullptr;  // its line is only there with this switch on
    bool StatesOf<Owner>::*is_stated = nullptr;
    bool is_read_apart = false;  // the section checks more before it takes the value
};

template <class Owner>
using ScalarKeys = std::span<const ScalarKey<Owner>>;

/// The keys of a map: those of the table, between others.
template <class Owner>
[[nodiscard]] std::vector<std::string_view> keys_of(
    ScalarKeys<Owner> table, std::initializer_list<std::string_view> after = {},
    std::initializer_list<std::string_view> before = {}) {
    std::vector<std::string_view> keys = before;
    for (const ScalarKey<Owner>& row : table) {
        keys.emplace_back(row.key);
    }
    keys.insert(keys.end(), after);
    return keys;
}

/// True: the member was set.
template <class Owner>
bool read_number(MapReader& reader, const ScalarKey<Owner>& row, Owner& out) {
    const YamlNode* const value =
        row.none == 0 ? nullptr : reader.find(row.key, row.need, "a number, or none");
    if (row.none != 0 && value == nullptr) {
        return false;
    }
    if (value != nullptr && value->kind == YamlNode::Kind::scalar && value->text == "none") {
        out.*row.number = row.none;
        return true;
    }
    double number = 0;
    const bool is_read = reader.number(row.key, row.need, row.range, number);
    if (is_read) {
        out.*row.number = number * row.unit.times / row.unit.by;
    }
    return is_read;
}

template <class Owner>
bool read_scalar(MapReader& reader, const ScalarKey<Owner>& row, Owner& out) {
    if (row.number != nullptr) {
        return read_number(reader, row, out);
    }
    if (row.whole != nullptr) {
        const auto [min, max] = row.range;
        return reader.whole(row.key, row.need,
                            {static_cast<std::uint32_t>(min), static_cast<std::uint32_t>(max)},
                            out.*row.whole);
    }
    if (row.is_on != nullptr) {
        return reader.boolean(row.key, row.need, out.*row.is_on);
    }
    std::size_t place = 0;
    const bool is_read = reader.choice(row.key, row.need, row.words, place);
    if (is_read) {
        row.set_place(out, place);
    }
    return is_read;
}

/// Reads every key of a table that is not read apart.
template <class Owner>
void read_scalars(MapReader& reader, ScalarKeys<Owner> table, Owner& out, StatesOf<Owner>& states) {
    for (const ScalarKey<Owner>& row : table) {
        const bool is_read = !row.is_read_apart && read_scalar(reader, row, out);
        if (row.is_stated != nullptr) {
            states.*row.is_stated = is_read;
        }
    }
}

}  // namespace axg
