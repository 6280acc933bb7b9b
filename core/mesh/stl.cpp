// SPDX-License-Identifier: Apache-2.0
#include "core/mesh/stl.hpp"

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <string_view>
#include <system_error>

#include "core/base/finite.hpp"

namespace axg {
namespace {

constexpr std::size_t kNumberCharsMax =
    64;  // longest number read: one out of range is too small exactly if its exponent is negative

static_assert(std::endian::native == std::endian::little,
              "STL is little endian and copied as it is");

std::uint32_t load_u32(std::span<const std::byte> bytes, std::uint64_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
}

void add_fault(StlResult& result, const StlFault& fault) {
    ++result.fault_count;
    if (result.faults.size() < kStlFaultsMax) {
        result.faults.push_back(fault);
    }
}

/// Scales and rounds one coordinate; false, with the fault's kind, when it is not usable.
bool to_mm(double value, double unit_mm, float& out_mm, StlFault& fault) {
    const double scaled = value * unit_mm;
    fault.value = scaled;
    if (!is_finite(value)) {
        fault.kind = StlFaultKind::not_finite;
        return false;
    }
    if (!(std::fabs(scaled) <= kCoordinateMmMax)) {
        fault.kind = StlFaultKind::out_of_range;
        return false;
    }
    const float rounded = static_cast<float>(scaled);
    // Subnormals cost time on one processor and are flushed on another: equal bits need one rule.
    const bool is_tiny = std::fabs(rounded) < std::numeric_limits<float>::min();
    out_mm = is_tiny ? 0.0F : rounded;
    return true;
}

void read_binary(std::span<const std::byte> bytes, double unit_mm, StlResult& result) {
    const std::uint32_t count = load_u32(bytes, 80);
    if (count == 0) {
        add_fault(result, {.kind = StlFaultKind::no_facets, .byte = 80});
        return;
    }
    if (count > kTrianglesMax) {
        add_fault(result, {.kind = StlFaultKind::too_many_facets,
                           .byte = 80,
                           .got = count,
                           .wanted = kTrianglesMax});
        return;
    }
    result.triangles.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        std::array<float, 9> raw;
        const std::uint64_t at = kStlHeaderBytes + kStlFacetBytes * i + 12;
        std::memcpy(raw.data(), bytes.data() + at, sizeof raw);
        std::array<float, 9> mm{};
        for (std::size_t k = 0; k < raw.size(); ++k) {
            StlFault fault{.byte = at + 4 * k, .facet = i};
            if (!to_mm(static_cast<double>(raw[k]), unit_mm, mm[k], fault)) {
                add_fault(result, fault);
            }
        }
        result.triangles[i] = {{mm[0], mm[1], mm[2]}, {mm[3], mm[4], mm[5]}, {mm[6], mm[7], mm[8]}};
    }
}

/// Words of a text with their place. Any byte outside printable ASCII and white space ends it.
class Words {
  public:
    explicit Words(std::span<const std::byte> bytes)
        : text_(reinterpret_cast<const char*>(bytes.data()), bytes.size()) {
        constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";  // editors put it first
        at_ = text_.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0;
    }

    /// The next word, empty at the end of the text or before an unprintable byte.
    std::string_view next() {
        while (at_ < text_.size() && is_space(text_[at_])) {
            const bool is_pair =
                text_[at_] == '\r' && at_ + 1 < text_.size() && text_[at_ + 1] == '\n';
            line_ += is_line_end(text_[at_]) && !is_pair ? 1 : 0;
            ++at_;
        }
        start_ = at_;
        while (at_ < text_.size() && text_[at_] > ' ' && text_[at_] <= '~') {
            ++at_;
        }
        return text_.substr(start_, at_ - start_);
    }
    /// Skips the rest of the line: names may contain anything.
    void skip_line() {
        while (at_ < text_.size() && !is_line_end(text_[at_])) {
            ++at_;
        }
    }
    [[nodiscard]] bool at_end() const { return at_ >= text_.size(); }
    [[nodiscard]] std::uint64_t byte() const { return start_; }
    [[nodiscard]] std::uint64_t line() const { return line_; }
    [[nodiscard]] std::uint8_t byte_here() const { return static_cast<std::uint8_t>(text_[at_]); }

  private:
    /// LF, CR LF, or CR alone, as old programs write it.
    static bool is_line_end(char c) { return c == '\n' || c == '\r'; }
    static bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

    std::string_view text_;
    std::size_t at_ = 0, start_ = 0;
    std::uint64_t line_ = 1;
};

bool is_word(std::string_view got, std::string_view wanted) {
    if (got.size() != wanted.size()) {
        return false;
    }
    for (std::size_t i = 0; i < got.size(); ++i) {
        const char lower = got[i] >= 'A' && got[i] <= 'Z' ? static_cast<char>(got[i] + 32) : got[i];
        if (lower != wanted[i]) {
            return false;
        }
    }
    return true;
}

/// Decimal number, whole word. Values too small for double are zero, too large ones infinite: the
/// caller judges.
bool parse_number(std::string_view word, double& value) {
    if (word.size() > kNumberCharsMax) {
        return false;
    }
    if (word.size() > 1 && word[0] == '+' && word[1] != '-') {
        word.remove_prefix(1);  // printf("%+e") writes it, std::from_chars does not read it
    }
    const char* const end = word.data() + word.size();
    const std::from_chars_result read =
        std::from_chars(word.data(), end, value, std::chars_format::general);
    if (read.ptr != end || word.empty()) {
        return false;
    }
    if (read.ec == std::errc::result_out_of_range) {
        const bool is_small = word.find("e-") != word.npos || word.find("E-") != word.npos;
        value = is_small ? 0.0 : std::numeric_limits<double>::infinity();
        return true;
    }
    return read.ec == std::errc{};
}

StlFault fault_here(StlFaultKind kind, const Words& words, const StlResult& result) {
    return {
        .kind = kind, .byte = words.byte(), .line = words.line(), .facet = result.triangles.size()};
}

/// Reports that the text has no expected word: the end, an unprintable byte or another word.
void add_word_fault(StlResult& result, const Words& words, std::string_view word,
                    StlFaultKind otherwise, const char* wanted) {
    StlFault fault = fault_here(otherwise, words, result);
    fault.wanted_word = wanted;
    if (word.empty() && words.at_end()) {
        fault.kind = StlFaultKind::unexpected_end;
    } else if (word.empty()) {
        fault.kind = StlFaultKind::unprintable_byte;
        fault.got = words.byte_here();
    }
    add_fault(result, fault);
}

/// One keyword; false after a fault.
bool expect(Words& words, const char* wanted, StlResult& result) {
    const std::string_view word = words.next();
    if (is_word(word, wanted)) {
        return true;
    }
    add_word_fault(result, words, word, StlFaultKind::unexpected_word, wanted);
    return false;
}

/// Three numbers; a value out of range is a fault but reading goes on, a word that is no number
/// ends it.
bool read_vector(Words& words, bool is_vertex, double unit_mm, StlResult& result, Vec3f& out) {
    std::array<float, 3> mm{};
    for (float& coordinate : mm) {
        double value = 0;
        const std::string_view word = words.next();
        if (!parse_number(word, value)) {
            add_word_fault(result, words, word, StlFaultKind::bad_number, "a number");
            return false;
        }
        StlFault fault = fault_here(StlFaultKind::bad_number, words, result);
        if (is_vertex && !to_mm(value, unit_mm, coordinate, fault)) {
            add_fault(result, fault);
        }
    }
    out = {mm[0], mm[1], mm[2]};
    return true;
}

/// The words of one facet after `facet`.
bool read_facet(Words& words, double unit_mm, StlResult& result) {
    Vec3f normal;
    Triangle t;
    if (!expect(words, "normal", result) || !read_vector(words, false, 1.0, result, normal) ||
        !expect(words, "outer", result) || !expect(words, "loop", result)) {
        return false;
    }
    for (Vec3f* vertex : {&t.a, &t.b, &t.c}) {
        if (!expect(words, "vertex", result) ||
            !read_vector(words, true, unit_mm, result, *vertex)) {
            return false;
        }
    }
    if (!expect(words, "endloop", result) || !expect(words, "endfacet", result)) {
        return false;
    }
    if (result.triangles.size() == kTrianglesMax) {
        StlFault fault = fault_here(StlFaultKind::too_many_facets, words, result);
        fault.got = kTrianglesMax + 1ULL;
        fault.wanted = kTrianglesMax;
        add_fault(result, fault);
        return false;
    }
    result.triangles.push_back(t);
    return true;
}

void read_text(std::span<const std::byte> bytes, double unit_mm, StlResult& result) {
    Words words(bytes);
    bool inside = false;
    for (;;) {
        const std::string_view word = words.next();
        if (word.empty() && words.at_end() && !inside) {
            break;
        }
        if (!inside && is_word(word, "solid")) {
            inside = true;
            words.skip_line();
        } else if (inside && is_word(word, "endsolid")) {
            inside = false;
            words.skip_line();
        } else if (inside && is_word(word, "facet")) {
            if (!read_facet(words, unit_mm, result)) {
                return;
            }
        } else {
            add_word_fault(result, words, word, StlFaultKind::unexpected_word,
                           inside ? "facet or endsolid" : "solid or the end of the file");
            return;
        }
    }
    if (result.triangles.empty() && result.fault_count == 0) {
        add_fault(result, fault_here(StlFaultKind::no_facets, words, result));
    }
}

/// Only chooses the message for a file that is not binary: does it start like a text?
bool looks_like_text(std::span<const std::byte> bytes) {
    Words words(bytes);
    if (!is_word(words.next(), "solid")) {
        return false;
    }
    for (std::size_t i = 0; i < bytes.size() && i < kStlHeaderBytes; ++i) {
        if (bytes[i] == std::byte{0}) {
            return false;  // a binary header that begins with solid, padded with zeros
        }
    }
    return true;
}

}  // namespace

StlResult read_stl(std::span<const std::byte> bytes, double unit_mm) {
    StlResult result;
    const std::uint64_t size = bytes.size();
    if (size > kStlBytesMax) {
        add_fault(result, {.kind = StlFaultKind::too_large, .got = size, .wanted = kStlBytesMax});
        return result;
    }
    std::uint64_t wanted = 0;
    if (size >= kStlHeaderBytes) {
        wanted = kStlHeaderBytes + kStlFacetBytes * load_u32(bytes, 80);
    }
    result.is_binary = wanted == size && size != 0;
    if (result.is_binary) {
        read_binary(bytes, unit_mm, result);
    } else if (looks_like_text(bytes)) {
        read_text(bytes, unit_mm, result);
    } else if (wanted == 0) {
        add_fault(result, {.kind = StlFaultKind::too_short, .got = size});
    } else {
        add_fault(result,
                  {.kind = StlFaultKind::wrong_size, .byte = 80, .got = size, .wanted = wanted});
    }
    if (result.fault_count != 0) {
        result.triangles = {};
    }
    return result;
}

std::vector<std::byte> write_stl(std::span<const Triangle> triangles) {
    if (triangles.size() > kTrianglesMax) {
        return {};
    }
    std::vector<std::byte> bytes(kStlHeaderBytes + kStlFacetBytes * triangles.size());
    constexpr std::string_view kHeader = "axguard binary STL, mm";  // does not begin with solid
    std::memcpy(bytes.data(), kHeader.data(), kHeader.size());
    const auto count = static_cast<std::uint32_t>(triangles.size());
    std::memcpy(bytes.data() + 80, &count, sizeof count);
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const Triangle& t = triangles[i];
        const Vec3d n = cross(widen(t.b) - widen(t.a), widen(t.c) - widen(t.a));
        const double length = std::sqrt(dot(n, n));
        const double scale = length > 0 ? 1.0 / length : 0.0;
        const std::array<float, 12> values{static_cast<float>(n.x * scale),
                                           static_cast<float>(n.y * scale),
                                           static_cast<float>(n.z * scale),
                                           t.a.x,
                                           t.a.y,
                                           t.a.z,
                                           t.b.x,
                                           t.b.y,
                                           t.b.z,
                                           t.c.x,
                                           t.c.y,
                                           t.c.z};
        std::memcpy(bytes.data() + kStlHeaderBytes + kStlFacetBytes * i, values.data(),
                    sizeof values);
    }
    return bytes;
}

}  // namespace axg
