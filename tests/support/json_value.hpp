// SPDX-License-Identifier: Apache-2.0
// JSON for tests, instead of nlohmann/json.hpp, which takes seconds to compile. A missing key, an
// index beyond the end and a value of another type throw, in every function: a test of a missing
// value fails.
#pragma once

#include <compare>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <iosfwd>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace axg::test {

class Json {
  public:
    using List = std::vector<Json>;
    using Map = std::vector<std::pair<std::string, Json>>;  // sorted by key

    // Not explicit: a test compares values with literals.
    Json() = default;  // null
    Json(std::nullptr_t) {}
    Json(const char* text) : value_(std::string(text)) {}
    Json(std::string text) : value_(std::move(text)) {}
    template <class T>
    requires std::is_arithmetic_v<T> Json(T value) {
        if constexpr (std::same_as<T, bool>) {
            value_ = value;
        } else if constexpr (std::floating_point<T>) {
            value_ = static_cast<double>(value);
        } else if (std::cmp_less(value, 0)) {
            value_ = static_cast<std::int64_t>(value);
        } else {
            value_ = static_cast<std::uint64_t>(value);
        }
    }
    [[nodiscard]] static Json array(std::initializer_list<Json> values);
    [[nodiscard]] static Json object(std::initializer_list<Map::value_type> members = {});

    [[nodiscard]] static bool accept(std::string_view text);
    /// Throws for a text that is not JSON.
    [[nodiscard]] static Json parse(std::string_view text);
    /// Throws for an unreadable file, too.
    [[nodiscard]] static Json parse_file(const std::string& path);
    /// On one line, or indented by this many spaces a level.
    [[nodiscard]] std::string dump(int indent = -1) const;

    [[nodiscard]] bool is_null() const { return is<std::nullptr_t>(); }
    [[nodiscard]] bool is_array() const { return is<List>(); }
    [[nodiscard]] bool is_object() const { return is<Map>(); }
    [[nodiscard]] bool is_number() const;

    /// @tparam T  bool, std::string, a floating-point type or an integer type; for an integer type,
    ///            a number with a point and one out of range throw
    template <class T>
    [[nodiscard]] T get() const;

    /// The value of a key of an object, and an element of an array.
    [[nodiscard]] const Json& at(std::string_view key) const;
    template <std::integral T>
    [[nodiscard]] const Json& at(T index) const {
        return element(std::in_range<std::size_t>(index) ? static_cast<std::size_t>(index)
                                                         : SIZE_MAX);
    }
    template <class Place>
    [[nodiscard]] const Json& operator[](const Place& place) const {
        return at(place);
    }

    /// Of an array or object.
    [[nodiscard]] std::size_t size() const;
    [[nodiscard]] bool empty() const { return size() == 0; }
    /// Of an object.
    [[nodiscard]] bool contains(std::string_view key) const;
    [[nodiscard]] const Map& items() const;
    /// Adds the key or replaces its value.
    void set(std::string_view key, Json value);
    /// Throws for a missing key.
    void erase(std::string_view key);
    /// Of an array.
    [[nodiscard]] List::const_iterator begin() const { return elements().begin(); }
    [[nodiscard]] List::const_iterator end() const { return elements().end(); }
    [[nodiscard]] const Json& back() const { return at(size() - 1); }

    /// Numbers are equal by value, whatever their type.
    friend bool operator==(const Json& a, const Json& b);
    /// Of two numbers; of anything else it throws.
    friend std::partial_ordering operator<=>(const Json& a, const Json& b);
    /// Prints the JSON text; GoogleTest uses it.
    friend std::ostream& operator<<(std::ostream& out, const Json& value);

  private:
    friend struct JsonConversion;
    template <class T>
    [[nodiscard]] bool is() const {
        return std::holds_alternative<T>(value_);
    }
    [[nodiscard]] const List& elements() const;
    [[nodiscard]] const Json& element(std::size_t index) const;

    // A whole number is std::int64_t where it is negative, and only there.
    std::variant<std::nullptr_t, bool, std::int64_t, std::uint64_t, double, std::string, List, Map>
        value_;
};

}  // namespace axg::test
