// SPDX-License-Identifier: Apache-2.0
// A compiled machine comes back as it was, bit by bit, without any other file; and each thing that
// can be wrong with one, its sums made right again, is refused by the name of its section.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <tuple>

#include "config/compiled/byte_fields.hpp"
#include "config/machine/effective_text.hpp"
#include "config/machine/load_machine.hpp"
#include "core/collision/tree.hpp"
#include "core/mesh/surface_parts.hpp"
#include "tests/support/dbc_text.hpp"
#include "tests/support/replay_fixture.hpp"
#include "tests/support/small_compiled.hpp"

namespace axg::test {
namespace {

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() &&
           (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

void expect_same(const std::vector<Mesh>& read, const std::vector<Mesh>& wanted) {
    ASSERT_EQ(read.size(), wanted.size());
    for (std::size_t i = 0; i < read.size(); ++i) {
        SCOPED_TRACE(wanted[i].name);
        EXPECT_EQ(read[i].name, wanted[i].name);
        EXPECT_TRUE(same_bits(read[i].triangles, wanted[i].triangles));
        if (read[i].triangles.empty()) {
            continue;
        }
        const TreeShape shape = group_triangles(wanted[i].triangles);
        EXPECT_TRUE(same_bits(read[i].shape.nodes, shape.nodes));
        EXPECT_TRUE(same_bits(read[i].shape.triangles, shape.triangles));
        const SurfaceParts parts = take_apart(wanted[i].triangles);
        EXPECT_TRUE(same_bits(read[i].parts.parts, parts.parts));
        EXPECT_TRUE(same_bits(read[i].parts.is_closed, parts.is_closed));
    }
}

TEST(CompiledMachine, ComesBackAsItWas) {
    CompiledMachine wanted = small_compiled();
    wanted.meshes.bodies[0].triangles[0].a.x = -0.0F;  // as it is, not as it compares
    CompiledMachine read;
    const auto faults = parse_compiled(compile_machine(wanted), "m.axg", read);
    ASSERT_TRUE(faults.empty()) << to_string(faults.front());
    EXPECT_EQ(read.source.file, "small.yaml");
    EXPECT_EQ(read.source.text, wanted.source.text);
    EXPECT_EQ(effective_text(read.machine), effective_text(wanted.machine));
    EXPECT_EQ(read.machine.bodies[1].mesh.deviation_mm, 0.0625);
    EXPECT_EQ(read.machine.bodies[0].mesh.deviation_mm, 0);
    EXPECT_EQ(read.meshes.notes, wanted.meshes.notes);
    expect_same(read.meshes.bodies, wanted.meshes.bodies);
    expect_same(read.meshes.tools, wanted.meshes.tools);
    expect_same(read.meshes.simple_bodies, wanted.meshes.simple_bodies);
    expect_same(read.meshes.simple_tools, wanted.meshes.simple_tools);
    expect_same(read.meshes.of_pairs, wanted.meshes.of_pairs);
    ASSERT_EQ(read.machine.pair_surfaces.size(), 1U);
    const PairSurface &own = read.machine.pair_surfaces[0], &was = wanted.machine.pair_surfaces[0];
    EXPECT_EQ(std::tie(own.body, own.against, own.tool, own.surface, own.is_whole),
              std::tie(was.body, was.against, was.tool, was.surface, was.is_whole));
    const Travel &travel = read.machine.travel, &went = wanted.machine.travel;
    EXPECT_EQ(travel.low, went.low);
    EXPECT_EQ(travel.high, went.high);
    ASSERT_EQ(travel.proofs.size(), went.proofs.size());
    for (std::size_t i = 0; i < went.proofs.size(); ++i) {
        const TravelProof &a = travel.proofs[i], &b = went.proofs[i];
        EXPECT_EQ(std::tie(a.distance_mm, a.is_apart, a.surface_a, a.surface_b),
                  std::tie(b.distance_mm, b.is_apart, b.surface_a, b.surface_b));
    }
}

// The hash that board and guard compare is made anew from what the file carries, and is that of the
// machine file.
TEST(CompiledMachine, HasTheHashesOfItsContents) {
    const CompiledMachine wanted = small_compiled();
    CompiledMachine read;
    ASSERT_TRUE(parse_compiled(compile_machine(wanted), "m.axg", read).empty());
    EXPECT_EQ(configuration_hash(read.machine, read.meshes),
              configuration_hash(wanted.machine, wanted.meshes));
    EXPECT_EQ(configuration_hashes(read.machine, read.meshes),
              configuration_hashes(wanted.machine, wanted.meshes));
    const std::string before = configuration_hash(read.machine, read.meshes);
    read.meshes.bodies[0].triangles[0].a.x += 1;
    EXPECT_NE(configuration_hash(read.machine, read.meshes), before);
}

TEST(CompiledMachine, IsTheSameBytesEachTime) {
    const std::string once = compile_machine(small_compiled());
    EXPECT_EQ(compile_machine(small_compiled()), once);
    CompiledMachine read;
    ASSERT_TRUE(parse_compiled(once, "m.axg", read).empty());
    EXPECT_EQ(compile_machine(read), once) << "and from what was read";
}

TEST(CompiledMachine, HoldsTheFilesThatTheMachineFileNames) {
    const Workshop shop;
    const std::string board = shop.write("board.dbc", kBoardDbc);
    CompiledMachine from_files;
    const std::string path = shop.write("dbc.yaml", dbc_machine());
    const auto faults = load_machine(path, from_files.machine, from_files.source);
    ASSERT_TRUE(faults.empty()) << to_string(faults.front());
    ASSERT_EQ(from_files.source.named.size(), 1U);
    std::filesystem::remove(board);
    Machine again;
    ASSERT_TRUE(parse_machine(from_files.source, again).empty());
    EXPECT_EQ(effective_text(again), effective_text(from_files.machine));
    from_files.source.named.clear();
    EXPECT_FALSE(parse_machine(from_files.source, again).empty()) << "read from somewhere else";
}

TEST(CompiledMachine, AFileCutAnywhereIsRefused) {
    const std::string bytes = compile_machine(small_compiled());
    for (std::size_t size = 0; size < bytes.size(); size += 1 + size / 64) {
        ASSERT_NE(compiled_faults(std::string_view(bytes).substr(0, size)), "") << size;
    }
    EXPECT_NE(compiled_faults(bytes + '\0').find("1 bytes after the last section"),
              std::string::npos);
}

/// The sections of sound bytes, to be changed and put together again.
std::vector<CompiledSection> sections_of(std::string_view bytes) {
    std::vector<SectionView> views;
    EXPECT_EQ(take_sections(bytes, Sums::checked, views).got, "");
    std::vector<CompiledSection> out;
    for (const SectionView& view : views) {
        out.push_back({view.tag, std::string(view.payload)});
    }
    return out;
}

/// The simplified surface.
CompiledSection& of_slide(std::vector<CompiledSection>& sections) {
    return *std::find_if(sections.begin(), sections.end(), [](const CompiledSection& one) {
        return one.tag == "MESH" && one.payload[0] == 2;
    });
}

struct Damage {
    const char* what;
    std::function<void(std::vector<CompiledSection>&)> make;
    const char* said;
};

CompiledSection& first(std::vector<CompiledSection>& sections, std::string_view tag) {
    return *std::find_if(sections.begin(), sections.end(),
                         [tag](const CompiledSection& s) { return s.tag == tag; });
}

template <class T>
void put_at(std::string& payload, std::size_t at, T value) {
    ASSERT_LE(at + sizeof(T), payload.size());
    std::memcpy(payload.data() + at, &value, sizeof(T));
}

// The first surface: 8 corners and 12 triangles of a box; where each part of its section begins.
constexpr std::size_t kListAt = 0, kIndexAt = 4, kDeviationAt = 8, kCornersAt = 20,
                      kIndicesAt = kCornersAt + 8 * 12 + 4,
                      kNodesAt = kIndicesAt + 36 * 4 + 4 + 4 + 4, kOrderAt = kNodesAt + 1,
                      kPartsAt = kOrderAt + 12 * 4 + 4, kClosedAt = kPartsAt + 72;
// The first surface of a pair, and the first proof.
constexpr std::size_t kOwnAt = 8, kProofsAt = kOwnAt + 17 + 4;

const std::vector<Damage> kDamages{
    {"no machine file", [](auto& s) { s.clear(); },
     "section end: invalid value (found no machine file"},
    {"unknown section", [](auto& s) { s[0].tag = "WHAT"; },
     "section WHAT: invalid value (found an unknown section"},
    {"twice the machine file", [](auto& s) { s.insert(s.begin(), s[0]); }, "section TEXT"},
    {"no hashes", [](auto& s) { s.erase(s.begin() + 1); },
     "section PAIR: invalid value (found a section out of order"},
    {"another axguard", [](auto& s) { ++s[0].payload[4]; }, "found a file of axguard"},
    {"a machine file that means something else",
     [](auto& s) {
         std::string& text = s[0].payload;
         text[text.find("10000,") + 1] = '1';
     },
     "section HASH: invalid value (found a file compiled by an incompatible axguard"},
    {"a machine file with a fault",
     [](auto& s) {
         std::string& text = s[0].payload;
         text[text.find("version")] = 'w';
     },
     "section HASH: invalid value (found a machine file that this axguard rejects: small.yaml:1: "
     "wersion"},
    {"a missing surface", [](auto& s) { s.erase(s.begin() + 4); }, "body base: a missing"},
    {"a missing tool",
     [](auto& s) {
         const auto tool = std::find_if(s.begin(), s.end(), [](const CompiledSection& one) {
             return one.tag == "MESH" && one.payload[kListAt] == 1;
         });
         s.erase(tool);
     },
     "tool 1: a missing surface"},
    {"a surface twice", [](auto& s) { s.push_back(first(s, "MESH")); },
     "surface base: a second section of this kind"},
    {"a body that is not there", [](auto& s) { put_at(first(s, "MESH").payload, kIndexAt, 5U); },
     "section MESH"},
    {"a list that is not there", [](auto& s) { put_at(first(s, "MESH").payload, kListAt, 4U); },
     "section MESH"},
    {"a whole surface that deviates",
     [](auto& s) { put_at(first(s, "MESH").payload, kDeviationAt, 0.01); },
     "a deviation above the limit"},
    {"more than may be", [](auto& s) { put_at(of_slide(s).payload, kDeviationAt, 0.1000001); },
     "a deviation above the limit"},
    {"no deviation", [](auto& s) { put_at(of_slide(s).payload, kDeviationAt, 0.0); },
     "a deviation above the limit"},
    {"a deviation that is none",
     [](auto& s) {
         put_at(of_slide(s).payload, kDeviationAt, std::numeric_limits<double>::quiet_NaN());
     },
     "a deviation above the limit"},
    {"a corner that is not there",
     [](auto& s) { put_at(first(s, "MESH").payload, kIndicesAt + 4, 8U); }, "an unknown vertex"},
    {"a coordinate that is none",
     [](auto& s) {
         put_at(first(s, "MESH").payload, kCornersAt, std::numeric_limits<float>::infinity());
     },
     "a coordinate that is not finite"},
    {"a coordinate too large",
     [](auto& s) { put_at(first(s, "MESH").payload, kCornersAt, 1.00001e5F); }, "a coordinate"},
    {"a triangle in two leaves", [](auto& s) { put_at(first(s, "MESH").payload, kOrderAt, 1U); },
     "contain each triangle once"},
    {"a leaf too large", [](auto& s) { ++first(s, "MESH").payload[kNodesAt]; },
     "contain each triangle once"},
    {"a part that is none",
     [](auto& s) {
         put_at(first(s, "MESH").payload, kPartsAt, std::numeric_limits<float>::quiet_NaN());
     },
     "invalid connected parts"},
    {"a facet more than closed", [](auto& s) { first(s, "MESH").payload[kClosedAt] = 2; },
     "invalid connected parts"},
    {"more corners than bytes",
     [](auto& s) { put_at(first(s, "MESH").payload, kCornersAt - 4, ~0U); },
     "inconsistent lengths"},
    {"a byte too many", [](auto& s) { first(s, "MESH").payload += 'x'; }, "inconsistent lengths"},
    {"a pair's surface missing", [](auto& s) { s.pop_back(); }, "a missing surface of a pair"},
    {"a pair's surface that is none",
     [](auto& s) { put_at(first(s, "PAIR").payload, kOwnAt + 12, 1U); }, "section PAIR"},
    {"a pair's body that is none", [](auto& s) { put_at(first(s, "PAIR").payload, kOwnAt, 5U); },
     "section PAIR"},
    {"a pair's other body that is none",
     [](auto& s) { put_at(first(s, "PAIR").payload, kOwnAt + 4, 5U); }, "section PAIR"},
    {"a pair's tool that is none",
     [](auto& s) { put_at(first(s, "PAIR").payload, kOwnAt + 8, 2U); }, "section PAIR"},
    {"what is left is none", [](auto& s) { put_at(first(s, "PAIR").payload, kProofsAt + 9, 1U); },
     "section PAIR"},
    {"what is left before a pair's own surface",
     [](auto& s) {
         std::string& payload = first(s, "PAIR").payload;
         put_at(payload, 0, 2U);            // two surfaces, the pair's own the second,
         put_at(payload, kOwnAt + 12, 1U);  // and what is left of it the first
     },
     "section PAIR"},
    {"a distance that is none",
     [](auto& s) {
         put_at(first(s, "PAIR").payload, kProofsAt, std::numeric_limits<double>::quiet_NaN());
     },
     "section PAIR"},
    {"a proof too few",
     [](auto& s) {
         std::string& payload = first(s, "PAIR").payload;
         payload.resize(payload.size() - 17);
         payload[kProofsAt - 4] -= 1;
     },
     "section PAIR"},
    {"no pairs",
     [](auto& s) {
         s.erase(std::find_if(s.begin(), s.end(), [](auto& one) { return one.tag == "PAIR"; }));
     },
     "section MESH"},
    {"more notes than bytes", [](auto& s) { put_at(first(s, "NOTE").payload, 0, ~0U); },
     "section NOTE: invalid value (found inconsistent lengths"},
};

TEST(CompiledMachine, EachDamageIsNamedThoughAllSumsAreRight) {
    const std::string bytes = compile_machine(small_compiled());
    ASSERT_EQ(put_sections(sections_of(bytes)), bytes);
    for (const Damage& damage : kDamages) {
        std::vector<CompiledSection> sections = sections_of(bytes);
        damage.make(sections);
        const std::string said = compiled_faults(put_sections(sections));
        EXPECT_NE(said.find(damage.said), std::string::npos) << damage.what << ": " << said;
        EXPECT_TRUE(said.starts_with("m.axg:")) << damage.what << ": " << said;
        EXPECT_NE(said.find("Run axguard compile "), std::string::npos) << said;
    }
}

// Sums are no signature: whoever moves a surface can write them anew. The hash would go on saying
// what the board expects.
TEST(CompiledMachine, AMovedSurfaceUnderTheOldHashIsRefused) {
    const std::string bytes = compile_machine(small_compiled());
    for (const char* const list : {"body", "tool"}) {
        std::vector<CompiledSection> sections = sections_of(bytes);
        const auto mesh =
            std::find_if(sections.begin(), sections.end(), [list](const CompiledSection& one) {
                return one.tag == "MESH" && one.payload[0] == (list[0] == 'b' ? 0 : 1);
            });
        ASSERT_NE(mesh, sections.end());
        put_at(mesh->payload, kCornersAt, 0.25F);
        const std::string said = compiled_faults(put_sections(sections));
        EXPECT_NE(said.find("surfaces that do not match the configuration hash"), std::string::npos)
            << list << ": " << said;
    }
}

TEST(CompiledMachine, ADamagedByteIsNamedByItsSection) {
    const std::string bytes = compile_machine(small_compiled());
    std::vector<SectionView> views;
    ASSERT_EQ(take_sections(bytes, Sums::checked, views).got, "");
    for (const SectionView& view : views) {
        std::string damaged = bytes;
        damaged[view.at + kTagBytes + 8] ^= 1;
        EXPECT_NE(compiled_faults(damaged).find("section " + std::string(view.tag) +
                                                ": invalid value (found a wrong checksum"),
                  std::string::npos)
            << view.tag;
    }
    std::string last = bytes;
    last.back() ^= 1;
    EXPECT_NE(compiled_faults(last).find("section DONE"), std::string::npos);
    EXPECT_NE(
        compiled_faults("version: 1\nname: small\n").find("a file that is not a compiled machine"),
        std::string::npos);
}

}  // namespace
}  // namespace axg::test
