// SPDX-License-Identifier: Apache-2.0
// STL, binary and text, from bytes to triangles and back. Pure: no file is opened here.
// Source: the format as 3D Systems published it (80 bytes of header, a 32-bit count, 50 bytes a
// facet; or the words solid, facet, outer loop, vertex); the rules for bad files are those of
// docs/reference/meshes.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/limits.hpp"
#include "core/mesh/mesh.hpp"

namespace axg {

inline constexpr std::uint64_t kStlHeaderBytes = 84;  // header and count
inline constexpr std::uint64_t kStlFacetBytes = 50;   // normal, three vertices, attribute
/// The largest file that is read at all: a binary one with kTrianglesMax facets. A larger text is
/// written as binary.
inline constexpr std::uint64_t kStlBytesMax = kStlHeaderBytes + kStlFacetBytes * kTrianglesMax;
inline constexpr std::size_t kStlFaultsMax = 16;  // listed one by one; the rest is counted

enum class StlFaultKind : std::uint8_t {
    too_large,         // got = bytes; expected at most kStlBytesMax
    too_short,         // got = bytes: neither a binary header nor a text
    wrong_size,        // got = bytes; expected: the bytes for the count at 80 (neither kind fits)
    no_facets,         // well formed, but nothing in it
    too_many_facets,   // expected at most kTrianglesMax
    not_finite,        // NaN or infinity in a vertex
    out_of_range,      // |coordinate| above kCoordinateMmMax once in mm
    bad_number,        // text: not a decimal number, or one of more than kNumberCharsMax characters
    unexpected_word,   // text: the grammar requires `wanted_word` here
    unexpected_end,    // text: truncated; the grammar requires `wanted_word`
    unprintable_byte,  // text: got = the byte
};

struct StlFault {
    StlFaultKind kind{};
    std::uint64_t byte = 0;             // offset in the file
    std::uint64_t line = 0;             // from 1 in a text; 0: the file is not read as text
    std::uint64_t facet = 0;            // index of the facet, where one is meant
    std::uint64_t got = 0, wanted = 0;  // found and expected value
    double value = 0;                   // the coordinate in mm, for not_finite and out_of_range
    const char* wanted_word = "";       // static storage
};

struct StlResult {
    std::vector<StlFault> faults;   // empty: the triangles are complete
    std::uint64_t fault_count = 0;  // all, the unlisted ones included
    bool is_binary = false;
    std::vector<Triangle> triangles;  // mm; empty when there is a fault
};

/// Reads one STL file.
///
/// A file is binary exactly if 84 + 50 * count equals its size (64-bit), whatever its header
/// contains. A text cannot meet that below 7.5 GB: four printable bytes make a count of at least
/// 151 million. Stated normals and attribute bytes are ignored: the order of the vertices is
/// the facet's orientation.
///
/// @param bytes     the whole file
/// @param unit_mm   length of the file's unit in mm, above 0
/// @return          coordinates scaled in double, rounded once to float32, subnormals become zero
/// Cost: linear in the size; allocates only after checking the count against the size and
/// kTrianglesMax.
[[nodiscard]] StlResult read_stl(std::span<const std::byte> bytes, double unit_mm);

/// Writes a binary STL: fixed header, unit normals (zero for a facet without area), attribute 0.
/// Equal input, equal bytes. Fails (empty result) above kTrianglesMax.
[[nodiscard]] std::vector<std::byte> write_stl(std::span<const Triangle> triangles);

}  // namespace axg
