// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/certify/certificate_file.hpp"

#include <algorithm>

#include "hil_replay/certify/witness_walk.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kCertificateFormat = 1;
constexpr std::uint64_t kBytesOfDirection = 3 * sizeof(float);

std::string head_of(const Machine& machine, const ChordPath& path, bool is_partial,
                    const std::string& version) {
    SectionBytes out;
    out.put(kCertificateFormat);
    out.put_text(version);
    out.put(static_cast<std::uint8_t>(machine.guard.promise));
    out.put(static_cast<std::uint8_t>(is_partial));
    out.put(path.axis_count);
    for (std::uint32_t i = 0; i < path.axis_count; ++i) {
        out.put(path.delta[i]);
        out.put(path.following[i]);
    }
    return out.bytes;
}

std::string sources_of(const CertificateSources& sources) {
    SectionBytes out;
    out.put(static_cast<std::uint32_t>(sources.size()));
    for (const auto& [name, sum] : sources) {
        out.put_text(name);
        out.bytes.append(reinterpret_cast<const char*>(sum.data()), sum.size());
    }
    return out.bytes;
}

std::string lines_of(const ChordPath& path) {
    SectionBytes out;
    std::int64_t before = 0;
    for (std::size_t i = 0; i < path.lines.size();) {
        std::size_t end = i;
        while (end < path.lines.size() && path.lines[end] == path.lines[i]) {
            ++end;
        }
        out.put_varint(end - i);
        out.put_zigzag(static_cast<std::int64_t>(path.lines[i]) - before);
        before = path.lines[i];
        i = end;
    }
    return out.bytes;
}

std::string path_of(const ChordPath& path) {
    SectionBytes out;
    out.put(static_cast<std::uint32_t>(path.runs.size()));
    for (const PathRun& run : path.runs) {
        out.put(run.tool == kNoIndex ? std::int32_t{-1} : static_cast<std::int32_t>(run.tool));
        out.put_varint(run.segments);
        out.put_varint(run.first);
        out.put_varint(run.last);
    }
    for (std::size_t i = 0; i < path.nodes.size(); ++i) {
        const std::int64_t before = i < path.axis_count ? 0 : path.nodes[i - path.axis_count];
        out.put_zigzag(path.nodes[i] - before);
    }
    out.bytes.append(reinterpret_cast<const char*>(path.speeds.data()), path.speeds.size());
    return out.bytes;
}

std::string stretches_of(std::uint32_t task, const std::vector<ProvenStretch>& stretches) {
    SectionBytes out;
    out.put(task);
    for (const ProvenStretch& stretch : stretches) {
        out.put_varint(stretch.at.end - stretch.at.begin);
        if (stretch.is_hole) {
            out.put(kHoleTag);
        } else {
            out.bytes += stretch.tree;
        }
    }
    return out.bytes;
}

bool read_head(std::string_view contents, ReadCertificate& out) {
    SectionReader reader(contents);
    const bool is_known = reader.get<std::uint32_t>() == kCertificateFormat;
    out.version = reader.get_text();
    const auto promise = reader.get<std::uint8_t>();
    const auto partial = reader.get<std::uint8_t>();
    out.promise = static_cast<StopPromise>(promise);
    out.is_partial = partial != 0;
    out.path.axis_count = reader.get<std::uint32_t>();
    if (!is_known || promise > 1 || partial > 1 || out.path.axis_count == 0 ||
        out.path.axis_count > kAxesMax) {
        return false;
    }
    for (std::uint32_t i = 0; i < out.path.axis_count; ++i) {
        out.path.delta[i] = reader.get<std::int64_t>();
        out.path.following[i] = reader.get<std::int64_t>();
    }
    return reader.is_at_end();
}

bool read_sources(std::string_view contents, CertificateSources& out) {
    SectionReader reader(contents);
    const auto count = reader.get<std::uint32_t>();
    for (std::uint32_t i = 0; i < count && reader.ok(); ++i) {
        std::string name = reader.get_text();
        Sha256 sum{};
        const std::string_view bytes = reader.take(sum.size());
        std::copy(bytes.begin(), bytes.end(), sum.begin());
        out.emplace_back(std::move(name), sum);
    }
    return reader.is_at_end();
}

/// @param bytes  of the whole file: a segment has a byte or more
bool read_lines(std::string_view contents, std::size_t bytes, ChordPath& path) {
    SectionReader reader(contents);
    std::int64_t line = 0;
    while (reader.ok() && !reader.is_at_end()) {
        const std::uint64_t count = reader.get_varint();
        line += reader.get_zigzag();
        if (!reader.ok() || count == 0 || count > bytes - path.lines.size() || line < 0 ||
            line > UINT32_MAX) {
            return false;
        }
        path.lines.insert(path.lines.end(), count, static_cast<std::uint32_t>(line));
    }
    return reader.ok();
}

bool read_path(std::string_view contents, StopPromise promise, ChordPath& path) {
    SectionReader reader(contents);
    std::uint64_t segments = 0;
    const auto runs = reader.get<std::uint32_t>();
    for (std::uint32_t i = 0; i < runs && reader.ok(); ++i) {
        const auto tool = reader.get<std::int32_t>();
        PathRun run{.tool = static_cast<std::uint32_t>(tool)};
        run.segments = reader.get_varint();
        run.first = reader.get_varint();
        run.last = reader.get_varint();
        segments += run.segments;
        path.runs.push_back(run);
    }
    if (!reader.ok() || segments == 0 || segments != path.segment_count()) {
        return false;
    }
    for (std::uint64_t i = 0; i < (segments + 1) * path.axis_count && reader.ok(); ++i) {
        const std::int64_t before = i < path.axis_count ? 0 : path.nodes[i - path.axis_count];
        path.nodes.push_back(before + reader.get_zigzag());
    }
    if (promise == StopPromise::independent) {
        const std::string_view speeds = reader.take(segments * path.axis_count * 2);
        path.speeds.assign(speeds.begin(), speeds.end());
    }
    return reader.is_at_end();
}

/// Reads one tree. False: the bytes end first, or a tag is unknown.
bool take_tree(SectionReader& reader, ProvenStretch& out) {
    for (std::uint32_t open = 1; open > 0; --open) {
        const auto tag = reader.get<std::uint8_t>();
        if (!reader.ok()) {
            return false;
        }
        if (tag == kHoleTag && out.tree.empty()) {
            out.is_hole = true;
            return true;
        }
        out.tree += static_cast<char>(tag);
        if (tag <= kDirectionsMax) {
            out.tree += reader.take(tag * kBytesOfDirection);
        } else if (tag >= kCutTag && tag < kCutTag + kAxesMax) {
            open += 2;
        } else {
            return false;
        }
    }
    return reader.ok();
}

bool read_stretches(std::string_view contents, std::uint32_t task, ReadCertificate& out) {
    SectionReader reader(contents);
    if (reader.get<std::uint32_t>() != task) {
        return false;
    }
    std::vector<ProvenStretch>& to = out.tasks.emplace_back();
    while (reader.ok() && !reader.is_at_end()) {
        ProvenStretch stretch;
        stretch.at.end = reader.get_varint();  // its length; its place depends on the pieces
        if (!take_tree(reader, stretch)) {
            return false;
        }
        to.push_back(std::move(stretch));
    }
    return reader.ok();
}

}  // namespace

std::string certificate_file(const Machine& machine, const ChordPath& path,
                             const ProgramProof& proof, const CertificateSources& sources,
                             const std::string& version) {
    SectionFile file;
    file.add("HEAD", head_of(machine, path, !proof.open.empty(), version));
    file.add("REFS", sources_of(sources));
    file.add("LINE", lines_of(path));
    file.add("PATH", path_of(path));
    for (std::uint32_t i = 0; i < proof.tasks.size(); ++i) {
        file.add("PAIR", stretches_of(i, proof.tasks[i]));
    }
    return file.finish();
}

std::optional<ReadCertificate> read_certificate(std::string_view file) {
    const std::optional<std::vector<Section>> sections = read_sections(file);
    constexpr std::string_view kLetters[] = {"HEAD", "REFS", "LINE", "PATH"};
    if (!sections || sections->size() < std::size(kLetters)) {
        return std::nullopt;
    }
    for (std::size_t i = 0; i < sections->size(); ++i) {
        const std::string_view wanted = i < std::size(kLetters) ? kLetters[i] : "PAIR";
        if ((*sections)[i].letters != wanted) {
            return std::nullopt;
        }
    }
    const auto contents = [&](std::size_t i) { return (*sections)[i].contents; };
    ReadCertificate out;
    bool is_right = read_head(contents(0), out) && read_sources(contents(1), out.sources) &&
                    read_lines(contents(2), file.size(), out.path) &&
                    read_path(contents(3), out.promise, out.path);
    for (std::size_t i = std::size(kLetters); is_right && i < sections->size(); ++i) {
        is_right =
            read_stretches(contents(i), static_cast<std::uint32_t>(i - std::size(kLetters)), out);
    }
    return is_right ? std::optional(std::move(out)) : std::nullopt;
}

}  // namespace axg
