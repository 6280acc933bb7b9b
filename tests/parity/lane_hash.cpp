// SPDX-License-Identifier: Apache-2.0
// Prints a hash over every bit of the results to N random queries, and one over the generated
// pairs of triangles with all that the certified test says of them: builds and processors whose
// hashes are equal agree bit for bit. Usage: lane_hash COUNT SEED [avx512|avx2|neon]
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "core/collision/cpu_engine.hpp"
#include "core/collision/lane_kernels.hpp"
#include "core/collision/pair_test.hpp"
#include "hil_replay/lab/cases/pair_cases.hpp"
#include "tests/support/random_queries.hpp"

namespace {

using namespace axg;

LaneSet lanes_named(const std::string& name) {
    return name == "avx512" ? LaneSet::avx512
           : name == "avx2" ? LaneSet::avx2
           : name == "neon" ? LaneSet::neon
                            : LaneSet::widest;
}

/// Less a's first vertex; the vertices are exact.
template <class T>
sat::TrianglePair<T> local_pair(const lab::Pair<T>& pair) {
    sat::V3<T> a[3], b[3];
    const Vec3<T> o = pair.a[0];
    for (int i = 0; i < 3; ++i) {
        a[i] = {pair.a[i].x - o.x, pair.a[i].y - o.y, pair.a[i].z - o.z};
        b[i] = {pair.b[i].x - o.x, pair.b[i].y - o.y, pair.b[i].z - o.z};
    }
    return sat::scaled_pair(a, b, sizeof(T) == sizeof(float) ? static_cast<T>(0x1p-90) : T{0});
}

/// A tile of pairs of one category: the pairs themselves, float verdicts and proven distances, and
/// verdicts in double.
std::uint32_t hash_tile(const LaneKernels& kernels, std::size_t category, std::uint64_t seed,
                        std::uint64_t first, test::Hash& hash) {
    PairTile tile{};
    TileResult tested{}, measured{};
    for (unsigned i = 0; i < kTilePairs; ++i) {
        const auto p = local_pair(lab::make_pair_case<float>(category, seed, first + i));
        for (unsigned c = 0; c < 18; ++c) {
            const sat::V3<float>& v = c < 9 ? p.a[c / 3] : p.b[c / 3 - 3];
            tile.v[c][i] = c % 3 == 0 ? v.x : c % 3 == 1 ? v.y : v.z;
            hash.add(__builtin_bit_cast(std::uint32_t, tile.v[c][i]));
        }
        tile.d[i] = 0x1p-90F;
        const auto wide = local_pair(lab::make_pair_case<double>(category, seed, first + i));
        hash.add(__builtin_bit_cast(std::uint64_t, wide.b[i % 3].z));
        hash.add(kernels.apart_in_double(wide) ? 1 : 0);
    }
    kernels.test_tiles(&tile, 1, &tested);
    kernels.measure_tiles(&tile, 1, &measured);
    hash.add(tested.apart);
    hash.add(measured.apart);
    for (const float distance_mm : measured.distance_mm) {
        hash.add(__builtin_bit_cast(std::uint32_t, distance_mm));
    }
    return static_cast<std::uint32_t>(__builtin_popcount(tested.apart));
}

/// One pair for each query, at least a tile of each category.
void print_pairs(const LaneKernels& kernels, std::uint64_t count, std::uint64_t seed) {
    const std::uint64_t categories = lab::pair_category_count();
    const std::uint64_t tiles = 1 + count / (kTilePairs * categories);
    test::Hash hash;
    std::uint64_t apart = 0;
    for (std::uint64_t c = 0; c < categories; ++c) {
        for (std::uint64_t t = 0; t < tiles; ++t) {
            apart += hash_tile(kernels, c, seed, t * kTilePairs, hash);
        }
    }
    std::printf(", pairs %016llx %llu of %llu apart\n",
                static_cast<unsigned long long>(hash.value()),
                static_cast<unsigned long long>(apart),
                static_cast<unsigned long long>(tiles * kTilePairs * categories));
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 3) {
        std::fprintf(stderr, "usage: lane_hash COUNT SEED [avx512|avx2|neon]\n");
        return 2;
    }
    const std::uint64_t count = std::strtoull(argv[1], nullptr, 10);
    test::Draw draw(std::strtoull(argv[2], nullptr, 10));
    const std::vector<Mesh> meshes = test::random_surfaces(draw);
    std::vector<const Mesh*> pointers;
    for (const Mesh& mesh : meshes) {
        pointers.push_back(&mesh);
    }
    // Every third query meets the end of a list somewhere.
    const LaneSet lanes = argc > 3 ? lanes_named(argv[3]) : LaneSet::widest;
    auto ample = CpuEngine::create(pointers, Capacities{}, lanes);
    auto few = CpuEngine::create(pointers, Capacities{200, 2000, 20}, lanes);
    if (!ample || !few) {
        std::printf("no such lanes here\n");
        return 77;
    }
    test::Hash hash;
    std::vector<TriangleIds> list(32);
    std::uint64_t far = 0, overflows = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
        Query query = test::random_query(draw, static_cast<std::uint32_t>(meshes.size()));
        list.assign(list.size(), TriangleIds{});
        query.list = list;
        QueryResult result;
        (i % 3 == 0 ? *few : *ample).run({&query, 1}, {&result, 1});
        hash.add(result, list);
        far += result.proof == Proof::far ? 1 : 0;
        overflows += result.status != QueryStatus::ok ? 1 : 0;
    }
    std::printf("%016llx %llu far, %llu overflows", static_cast<unsigned long long>(hash.value()),
                static_cast<unsigned long long>(far), static_cast<unsigned long long>(overflows));
    for (const LaneSet set : {LaneSet::avx512, LaneSet::avx2, LaneSet::neon}) {
        if (has_lane_set(set) && (lanes == set || lanes == LaneSet::widest)) {
            print_pairs(*lane_kernels(set), count, std::strtoull(argv[2], nullptr, 10));
            break;
        }
    }
    std::fprintf(stderr, "%s\n", std::string(ample->lanes()).c_str());
    return 0;
}
