// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/cases/tritri_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "config/text/fault_text.hpp"
#include "config/text/quote_text.hpp"
#include "config/text/small_file.hpp"

namespace axg::lab {
namespace {

static_assert(std::endian::native == std::endian::little, "bytes are taken as they stand");

constexpr std::size_t kFileBytesMax = std::size_t{1} << 29U;
constexpr std::size_t kNameBytes = 32, kTriangleBytes = 9 * sizeof(float),
                      kPoseBytes = 12 * sizeof(double);

/// Reads bytes from the front. Precondition of take: at least that many bytes are left.
class Bytes {
  public:
    explicit Bytes(std::string_view bytes) : bytes_(bytes) {}

    template <class T>
    T take() noexcept {
        T out;
        std::memcpy(&out, bytes_.data() + at_, sizeof(T));
        at_ += sizeof(T);
        return out;
    }
    std::string_view take_text(std::size_t count) noexcept {
        at_ += count;
        return bytes_.substr(at_ - count, count);
    }
    [[nodiscard]] std::size_t left() const noexcept { return bytes_.size() - at_; }

    /// "OFFSET: invalid file (found ..., expected ...).", the offset of the item read last.
    [[nodiscard]] std::string fault(std::size_t bytes_back, const std::string& got,
                                    std::string_view wanted) const {
        return fmt::format("{}: {}", at_ - bytes_back, fault_text("invalid file", got, wanted));
    }
    [[nodiscard]] std::string too_short(std::size_t needed, std::string_view what) const {
        return fault(0, fmt::format("{} bytes to the end of the file", left()),
                     fmt::format("{} bytes: {}", needed, what));
    }

  private:
    std::string_view bytes_;
    std::size_t at_ = 0;
};

template <class T>
Vec3<T> take_vertex(Bytes& bytes) noexcept {
    Vec3<T> v;
    v.x = bytes.take<T>();
    v.y = bytes.take<T>();
    v.z = bytes.take<T>();
    return v;
}

template <class T>
Pair<double> take_pair(Bytes& bytes) noexcept {
    Pair<double> pair;
    for (Vec3d* side : {pair.a, pair.b}) {
        for (int v = 0; v < 3; ++v) {
            const Vec3<T> read = take_vertex<T>(bytes);
            side[v] = {static_cast<double>(read.x), static_cast<double>(read.y),
                       static_cast<double>(read.z)};
        }
    }
    return pair;
}

Pose take_pose(Bytes& bytes) noexcept {
    Pose pose;
    for (auto& row : pose.r) {
        for (double& x : row) {
            x = bytes.take<double>();
        }
    }
    for (double& x : pose.t) {
        x = bytes.take<double>();
    }
    return pose;
}

std::string parse_pairs(Bytes& bytes, TritriFile& out) {
    if (bytes.left() < 12) {
        return bytes.too_short(12, "bytes of a scalar, pose flag and number of cases");
    }
    const auto scalar_bytes = bytes.take<std::uint32_t>();
    if (scalar_bytes != 4 && scalar_bytes != 8) {
        return bytes.fault(4, fmt::format("{} bytes of a scalar", scalar_bytes),
                           "4 (float) or 8 (double)");
    }
    const auto posed = bytes.take<std::uint32_t>();
    if (posed > 1) {
        return bytes.fault(4, fmt::format("a pose flag of {}", posed), "0 or 1");
    }
    const std::uint64_t count = bytes.take<std::uint32_t>();
    const std::uint64_t case_bytes = 4 + 18 * scalar_bytes + (posed != 0 ? kPoseBytes : 0);
    if (bytes.left() != count * case_bytes) {
        return bytes.fault(4,
                           fmt::format("{} cases of {} bytes and {} bytes behind", count,
                                       case_bytes, bytes.left()),
                           fmt::format("{} bytes to the end of the file", count * case_bytes));
    }
    out.ids.reserve(count);
    out.pairs.reserve(count);
    for (std::uint64_t i = 0; i < count; ++i) {
        out.ids.push_back(bytes.take<std::uint32_t>());
        const Pair<double> pair =
            scalar_bytes == 4 ? take_pair<float>(bytes) : take_pair<double>(bytes);
        if (posed != 0) {
            out.pairs.add(pair, take_pose(bytes));
        } else {
            out.pairs.add(pair);
        }
    }
    return {};
}

std::string parse_mesh(Bytes& bytes, Mesh& mesh) {
    if (bytes.left() < 4 + kNameBytes) {
        return bytes.too_short(4 + kNameBytes, "number of triangles and name of a mesh");
    }
    const std::uint64_t count = bytes.take<std::uint32_t>();
    const std::string_view name = bytes.take_text(kNameBytes);
    if (count == 0 || count * kTriangleBytes > bytes.left()) {
        return bytes.fault(
            4 + kNameBytes,
            fmt::format("a mesh of {} triangles and {} bytes behind", count, bytes.left()),
            "a number of triangles from 1 to what the file holds, 36 bytes each");
    }
    mesh.name = name.substr(0, name.find('\0'));
    mesh.triangles.reserve(count);
    for (std::uint64_t i = 0; i < count; ++i) {
        Triangle t;
        t.a = take_vertex<float>(bytes);
        t.b = take_vertex<float>(bytes);
        t.c = take_vertex<float>(bytes);
        mesh.triangles.push_back(t);
    }
    return {};
}

std::string parse_mesh_cases(Bytes& bytes, TritriFile& out) {
    constexpr std::uint64_t kCaseBytes = 12 + kPoseBytes;
    if (bytes.left() < 4) {
        return bytes.too_short(4, "number of cases");
    }
    const std::uint64_t count = bytes.take<std::uint32_t>();
    if (bytes.left() != count * kCaseBytes) {
        return bytes.fault(4, fmt::format("{} cases and {} bytes behind", count, bytes.left()),
                           fmt::format("{} bytes to the end of the file", count * kCaseBytes));
    }
    for (std::uint64_t i = 0; i < count; ++i) {
        out.ids.push_back(bytes.take<std::uint32_t>());
        MeshCase& at = out.mesh_cases.emplace_back();
        for (std::uint32_t* mesh : {&at.a, &at.b}) {
            *mesh = bytes.take<std::uint32_t>();
            if (*mesh >= out.meshes.size()) {
                return bytes.fault(4, fmt::format("mesh {}", *mesh),
                                   fmt::format("one of 0 to {}", out.meshes.size() - 1));
            }
        }
        at.pose = take_pose(bytes);
    }
    return {};
}

std::string parse_meshes(Bytes& bytes, TritriFile& out) {
    if (bytes.left() < 4) {
        return bytes.too_short(4, "number of meshes");
    }
    const std::uint64_t count = bytes.take<std::uint32_t>();
    if (count == 0 || count * (4 + kNameBytes + kTriangleBytes) > bytes.left()) {
        return bytes.fault(
            4, fmt::format("{} meshes and {} bytes behind", count, bytes.left()),
            "a number of meshes from 1 to what the file holds, 72 bytes each at least");
    }
    out.meshes.resize(count);
    for (Mesh& mesh : out.meshes) {
        if (std::string fault = parse_mesh(bytes, mesh); !fault.empty()) {
            return fault;
        }
    }
    return parse_mesh_cases(bytes, out);
}

}  // namespace

std::string parse_tritri(std::string_view bytes, TritriFile& out) {
    Bytes rest(bytes);
    if (rest.left() < 4) {
        return rest.too_short(4, "'TTP1' (pairs) or 'TTM1' (meshes)");
    }
    const std::string_view magic = rest.take_text(4);
    if (magic == "TTP1") {
        return parse_pairs(rest, out);
    }
    if (magic == "TTM1") {
        return parse_meshes(rest, out);
    }
    return rest.fault(4, quoted(magic), "'TTP1' (pairs) or 'TTM1' (meshes)");
}

std::string read_tritri(const std::string& path, TritriFile& out) {
    // Limits the read to the file's present size: refuses a file that grows meanwhile.
    std::error_code ignored;
    const std::uintmax_t size_bytes = std::filesystem::is_regular_file(path, ignored)
                                          ? std::filesystem::file_size(path, ignored)
                                          : 0;
    std::string bytes;
    if (const SmallFileFault fault =
            read_small_file(path, std::min<std::uintmax_t>(size_bytes, kFileBytesMax), bytes);
        !fault.got.empty()) {
        return fmt::format("{}: {}", escaped(path, 4096),
                           fault_text("invalid file", fault.got, fault.wanted));
    }
    const std::string fault = parse_tritri(bytes, out);
    return fault.empty() ? fault : fmt::format("{}:{}", escaped(path, 4096), fault);
}

}  // namespace axg::lab
