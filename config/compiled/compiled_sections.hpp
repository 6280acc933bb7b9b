// SPDX-License-Identifier: Apache-2.0
// The sections of a compiled machine's file, with their checksums, whatever they hold. Little
// endian. Bytes: docs/reference/compiled.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace axg {

/// Raised with any change of the bytes or of what they mean.
inline constexpr std::uint32_t kCompiledVersion = 6;
/// Length of a tag, such as TEXT or MESH.
inline constexpr std::size_t kTagBytes = 4;

struct CompiledSection {
    std::string_view tag;  // kTagBytes
    std::string payload;
};
/// Head, sections, and the hash over all of them behind.
[[nodiscard]] std::string put_sections(const std::vector<CompiledSection>& sections);

/// Whether the checksums of a file are verified. `ignored` is for fuzzing of the content.
enum class Sums : std::uint8_t { checked, ignored };

/// A section of a file that is there.
struct SectionView {
    std::string_view tag, payload;
    std::size_t at = 0;  // byte of the file at which it begins
};
/// A fault of a file; `got` empty: none.
struct SectionFault {
    std::string section;
    std::size_t at = 0;
    std::string got;
};
/// @param out  in order, without the last one; they point into `bytes`. After a fault: those before
[[nodiscard]] SectionFault take_sections(std::string_view bytes, Sums sums,
                                         std::vector<SectionView>& out);

}  // namespace axg
