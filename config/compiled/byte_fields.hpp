// SPDX-License-Identifier: Apache-2.0
// Numbers, texts and arrays as bytes, one after the other, and back. Little endian, as every
// processor is that the guard runs on. The reader never looks beyond its bytes, and reserves
// nothing that they do not hold.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace axg {

static_assert(std::endian::native == std::endian::little);

class ByteWriter {
  public:
    std::string bytes;

    template <class T>
    void put(const T& value) {
        put_items(std::span<const T>(&value, 1));
    }
    /// Without their count.
    template <class T>
    void put_items(std::span<const T> items) {
        static_assert(std::has_unique_object_representations_v<T> || std::is_floating_point_v<T> ||
                          sizeof(T) % sizeof(float) == 0,
                      "padding has no bytes that could be written twice alike");
        bytes.append(reinterpret_cast<const char*>(items.data()), items.size_bytes());
    }
    template <class T>
    void put_array(const std::vector<T>& items) {
        put(static_cast<std::uint32_t>(items.size()));
        put_items(std::span<const T>(items));
    }
    void put_text(std::string_view text) {
        put(static_cast<std::uint32_t>(text.size()));
        bytes += text;
    }
};

class ByteReader {
  public:
    explicit ByteReader(std::string_view bytes) noexcept : rest_(bytes) {}

    /// False after a read beyond the end; from then on every read returns zero or an empty value.
    [[nodiscard]] bool ok() const noexcept { return ok_; }
    /// ok(), and every byte has been read.
    [[nodiscard]] bool is_at_end() const noexcept { return ok_ && rest_.empty(); }

    template <class T>
    [[nodiscard]] T get() noexcept {
        static_assert(std::is_trivially_copyable_v<T>);
        T value{};
        if (const std::string_view bytes = take(sizeof(T), 1); ok_) {
            std::memcpy(&value, bytes.data(), sizeof(T));
        }
        return value;
    }
    template <class T>
    [[nodiscard]] std::vector<T> get_items(std::uint64_t count) {
        static_assert(std::is_trivially_copyable_v<T>);
        std::vector<T> items;
        if (const std::string_view bytes = take(sizeof(T), count); !bytes.empty()) {
            items.resize(static_cast<std::size_t>(count));
            std::memcpy(items.data(), bytes.data(), bytes.size());
        }
        return items;
    }
    template <class T>
    [[nodiscard]] std::vector<T> get_array() {
        return get_items<T>(get<std::uint32_t>());
    }
    [[nodiscard]] std::string get_text() { return std::string(take(1, get<std::uint32_t>())); }

  private:
    std::string_view take(std::size_t item_bytes, std::uint64_t count) noexcept {
        ok_ = ok_ && count <= rest_.size() / item_bytes;
        if (!ok_) {
            return {};
        }
        const std::string_view taken = rest_.substr(0, item_bytes * count);
        rest_.remove_prefix(taken.size());
        return taken;
    }

    std::string_view rest_;
    bool ok_ = true;
};

}  // namespace axg
