// SPDX-License-Identifier: Apache-2.0
#include "tests/support/json_value.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <ostream>
#include <stdexcept>

namespace axg::test {

/// Between this and the library's own values.
struct JsonConversion {
    static Json from(const nlohmann::json& source) {
        Json out;
        switch (source.type()) {
            case nlohmann::json::value_t::boolean:
                return source.get<bool>();
            case nlohmann::json::value_t::number_integer:
                return source.get<std::int64_t>();
            case nlohmann::json::value_t::number_unsigned:
                return source.get<std::uint64_t>();
            case nlohmann::json::value_t::number_float:
                return source.get<double>();
            case nlohmann::json::value_t::string:
                return source.get<std::string>();
            case nlohmann::json::value_t::array:
                out.value_ = Json::List{};
                for (const nlohmann::json& value : source) {
                    std::get<Json::List>(out.value_).push_back(from(value));
                }
                return out;
            case nlohmann::json::value_t::object:
                out.value_ = Json::Map{};
                for (const auto& [key, value] : source.items()) {
                    std::get<Json::Map>(out.value_).emplace_back(key, from(value));
                }
                return out;
            default:
                return nullptr;
        }
    }

    static nlohmann::json to(const Json& source) {
        if (source.is_array()) {
            nlohmann::json out = nlohmann::json::array();
            for (const Json& value : source) {
                out.push_back(to(value));
            }
            return out;
        }
        if (source.is_object()) {
            nlohmann::json out = nlohmann::json::object();
            for (const auto& [key, value] : source.items()) {
                out[key] = to(value);
            }
            return out;
        }
        return std::visit(
            [](const auto& value) -> nlohmann::json {
                using T = std::decay_t<decltype(value)>;
                if constexpr (std::same_as<T, Json::List> || std::same_as<T, Json::Map>) {
                    return nullptr;  // seen to above
                } else {
                    return value;
                }
            },
            source.value_);
    }
};

namespace {

[[noreturn]] void refuse(const std::string& what, const Json& value) {
    std::string text = value.dump();
    if (text.size() > 300) {
        text = text.substr(0, 300) + "...";
    }
    throw std::runtime_error("JSON: " + what + ": " + text);
}

/// The place of a key in the sorted members of an object, or where it would be.
auto place_of(auto& members, std::string_view key) {
    return std::lower_bound(
        members.begin(), members.end(), key,
        [](const auto& member, std::string_view k) { return member.first < k; });
}

}  // namespace

Json Json::array(std::initializer_list<Json> values) {
    Json out;
    out.value_ = List(values);
    return out;
}

Json Json::object(std::initializer_list<Map::value_type> members) {
    Json out;
    out.value_ = Map{};
    for (const auto& [key, value] : members) {
        out.set(key, value);
    }
    return out;
}

bool Json::accept(std::string_view text) {
    return nlohmann::json::accept(text);
}

Json Json::parse(std::string_view text) {
    return JsonConversion::from(nlohmann::json::parse(text));
}

Json Json::parse_file(const std::string& path) {
    std::ifstream file(path);
    if (!file) {
        throw std::runtime_error("JSON: cannot read " + path);
    }
    return parse(std::string{std::istreambuf_iterator<char>(file), {}});
}

std::string Json::dump(int indent) const {
    return JsonConversion::to(*this).dump(indent);
}

bool Json::is_number() const {
    return is<std::int64_t>() || is<std::uint64_t>() || is<double>();
}

template <class T>
T Json::get() const {
    return std::visit(
        [this](const auto& value) -> T {
            using Held = std::decay_t<decltype(value)>;
            constexpr bool kIsNumber = std::is_arithmetic_v<Held> && !std::same_as<Held, bool>;
            if constexpr (std::same_as<T, Held>) {
                return value;
            } else if constexpr (!kIsNumber || std::same_as<T, bool> || !std::is_arithmetic_v<T> ||
                                 (std::integral<T> && std::floating_point<Held>)) {
                refuse("wanted another type", *this);
            } else if constexpr (std::floating_point<T>) {
                return static_cast<T>(value);
            } else {
                if (!std::in_range<T>(value)) {
                    refuse("the type wanted does not hold this number", *this);
                }
                return static_cast<T>(value);
            }
        },
        value_);
}

const Json& Json::at(std::string_view key) const {
    const Map& members = items();
    const auto found = place_of(members, key);
    if (found == members.end() || found->first != key) {
        refuse("no key " + std::string(key), *this);
    }
    return found->second;
}

const Json& Json::element(std::size_t index) const {
    if (index >= elements().size()) {
        refuse("no such index", *this);
    }
    return elements()[index];
}

std::size_t Json::size() const {
    return is_object() ? items().size() : elements().size();
}

bool Json::contains(std::string_view key) const {
    const auto found = place_of(items(), key);
    return found != items().end() && found->first == key;
}

const Json::Map& Json::items() const {
    if (!is_object()) {
        refuse("wanted an object", *this);
    }
    return std::get<Map>(value_);
}

const Json::List& Json::elements() const {
    if (!is_array()) {
        refuse("wanted an array", *this);
    }
    return std::get<List>(value_);
}

void Json::set(std::string_view key, Json value) {
    (void)items();  // or throws
    Map& members = std::get<Map>(value_);
    const auto place = place_of(members, key);
    if (place != members.end() && place->first == key) {
        place->second = std::move(value);
    } else {
        members.emplace(place, key, std::move(value));
    }
}

void Json::erase(std::string_view key) {
    (void)at(key);  // or throws
    Map& members = std::get<Map>(value_);
    members.erase(place_of(members, key));
}

bool operator==(const Json& a, const Json& b) {
    if (a.is_number() && b.is_number()) {
        return (a <=> b) == 0;
    }
    return a.value_ == b.value_;
}

std::partial_ordering operator<=>(const Json& a, const Json& b) {
    return std::visit(
        [&](const auto& x, const auto& y) -> std::partial_ordering {
            using X = std::decay_t<decltype(x)>;
            using Y = std::decay_t<decltype(y)>;
            constexpr bool kAreNumbers = std::is_arithmetic_v<X> && std::is_arithmetic_v<Y> &&
                                         !std::same_as<X, bool> && !std::same_as<Y, bool>;
            if constexpr (!kAreNumbers) {
                refuse("not two numbers, in a comparison with " + b.dump(), a);
            } else if constexpr (std::integral<X> && std::integral<Y>) {
                return std::cmp_less(x, y)   ? std::partial_ordering::less
                       : std::cmp_less(y, x) ? std::partial_ordering::greater
                                             : std::partial_ordering::equivalent;
            } else {
                return static_cast<double>(x) <=> static_cast<double>(y);
            }
        },
        a.value_, b.value_);
}

std::ostream& operator<<(std::ostream& out, const Json& value) {
    return out << value.dump();
}

template bool Json::get<bool>() const;
template std::string Json::get<std::string>() const;
template float Json::get<float>() const;
template double Json::get<double>() const;
template unsigned char Json::get<unsigned char>() const;
template unsigned short Json::get<unsigned short>() const;
template int Json::get<int>() const;
template unsigned Json::get<unsigned>() const;
template long Json::get<long>() const;
template unsigned long Json::get<unsigned long>() const;

}  // namespace axg::test
