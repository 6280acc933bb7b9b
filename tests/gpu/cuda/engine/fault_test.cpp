// SPDX-License-Identifier: Apache-2.0
// A CUDA engine that is broken on purpose never calls anything far that is not: kernels left out,
// bits of the meshes and of the results turned over, lists too short, a kernel that does not end.
// AXG_COUNT: how often each soft fault is tried.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "cuda/engine/engine_parts.hpp"
#include "tests/gpu/fault_kernels.hpp"
#include "tests/support/cuda_fixture.hpp"
#include "tests/support/engine_fixture.hpp"
#include "tests/support/engine_parity.hpp"
#include "tests/support/random_queries.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kBatch = 12, kPool = 128;

std::uint32_t fault_count() {
    return test::number_from("AXG_COUNT", 300);
}

CudaOptions few_queries() {
    CudaOptions options;
    options.queries_max = 64;
    options.deadline_us = 20'000;
    return options;
}

enum class BatchKind : std::uint8_t { proofs, clearances, stages, float_stages, parts };
constexpr const char* kNames[] = {"proofs", "clearances", "stages", "stages in float", "parts"};

struct Batch {
    std::vector<Query> queries{kBatch};
    std::vector<QueryResult> wanted{kBatch}, found{kBatch};
    bool is_stage = false;
    std::vector<QueryTree> trees{};  // posed by the GPU: one for two queries that are the same
    std::vector<TreeRoot> roots{};

    void draw(test::Draw& draw, std::uint32_t mesh_count, CpuEngine& cpu,
              BatchKind kind = BatchKind::clearances) {
        const bool is_float = kind == BatchKind::float_stages || kind == BatchKind::parts;
        for (Query& q : queries) {
            q = test::random_query(draw, mesh_count);
            if (is_float || (kind != BatchKind::clearances && q.kind == QueryKind::clearance)) {
                q.r_mm = q.kind == QueryKind::farther ? q.r_mm : 0;
                q.kind = QueryKind::farther;
            }
            q.is_float_only = is_float;
        }
        is_stage = is_float || kind == BatchKind::stages;
        trees.clear();
        roots.clear();
        for (std::size_t i = 0; kind == BatchKind::parts && i < queries.size() / 2; ++i) {
            const Query& q = queries[2 * i + 1] = queries[2 * i];
            QueryTree& tree = trees.emplace_back();
            tree.is_float_only = true;
            tree.r_mm = q.r_mm;
            tree.pose_error_mm = q.pose_error_mm;
            tree.fixed[0] = q.pose;
            TreeRoot& root = roots.emplace_back();
            root.mesh_a = q.mesh_a;
            root.mesh_b = q.mesh_b;
            root.tree = static_cast<std::uint16_t>(i);
        }
        cpu.run(queries, wanted);
    }
    void run(CudaEngine& gpu) {
        constexpr std::uint32_t kAmple = 1U << 30U;
        GroupWork group{.share = {kAmple, kAmple, kAmple, kAmple, kAmple}};
        if (trees.empty()) {
            gpu.run(queries, found, {&group, is_stage ? 1U : 0U});
        } else {
            gpu.run({trees, roots}, {}, found, {&group, 1});
        }
    }
    /// Results that claim more than the CPU engine proves; 0 is what every fault must leave.
    [[nodiscard]] int wrong_claims() const {
        int wrong = 0;
        for (std::size_t i = 0; i < queries.size(); ++i) {
            const bool overflow = test::is_overflow(wanted[i]);
            wrong += found[i].proof == Proof::far && wanted[i].proof != Proof::far && !overflow;
            wrong += found[i].proof == Proof::far && !overflow &&
                     found[i].clearance_mm > wanted[i].clearance_mm;
        }
        return wrong;
    }
    [[nodiscard]] bool is_all_not_run() const {
        return std::all_of(found.begin(), found.end(), [](const QueryResult& a) {
            return a.status == QueryStatus::not_run && a.proof == Proof::not_proven;
        });
    }
};

/// Puts a dead engine back to work, which nothing but a test may do.
void revive(CudaEngine::Parts& parts) {
    ASSERT_EQ(cudaStreamSynchronize(parts.partition.stream), cudaSuccess);
    parts.fault = nullptr;
    ASSERT_EQ(cudaMemset(parts.buffers.sums.found, 0, 2 * sizeof(unsigned long long)), cudaSuccess);
}

std::vector<cudaGraphNode_t> nodes_of(cudaGraph_t graph) {
    std::size_t count = 0;
    EXPECT_EQ(cudaGraphGetNodes(graph, nullptr, &count), cudaSuccess);
    std::vector<cudaGraphNode_t> nodes(count);
    EXPECT_EQ(cudaGraphGetNodes(graph, nodes.data(), &count), cudaSuccess);
    return nodes;
}

TEST(CudaFault, AKernelLeftOut) {
    test::Draw draw{test::printed_seed(21)};
    const std::vector<Mesh> meshes = test::random_surfaces(draw);
    AXG_CUDA_ENGINE_OR_SKIP(gpu, meshes, test::ample(), few_queries());
    std::optional<CpuEngine> cpu = test::engine_over(meshes);
    ASSERT_TRUE(cpu);
    CudaEngine::Parts& parts = gpu.parts();
    const auto mesh_count = static_cast<std::uint32_t>(meshes.size());
    const cuda::BatchGraph graphs[] = {parts.proofs, parts.clearances, parts.stages,
                                       parts.float_stages, parts.part_stages};
    for (std::size_t kind = 0; kind < std::size(graphs); ++kind) {
        // Drawn and run by the CPU once, queried over and over: its time is not what is tested.
        // What runs whole has the kernels that are left out later.
        std::vector<Batch> whole(kPool), broken(kPool);
        for (std::uint32_t i = 0; i < kPool; ++i) {
            const bool is_stage = kind >= 2;
            whole[i].draw(draw, mesh_count, *cpu,
                          is_stage ? static_cast<BatchKind>(kind) : BatchKind::clearances);
            broken[i].draw(draw, mesh_count, *cpu, static_cast<BatchKind>(kind));
        }
        const cuda::BatchGraph& graph = graphs[kind];
        const std::vector<cudaGraphNode_t> nodes = nodes_of(graph.graph);
        ASSERT_GE(nodes.size(), kind >= 3 ? 4U : 5U);
        for (std::size_t n = 0; n < nodes.size(); ++n) {
            std::uint32_t dead = 0, differing = 0;
            const std::uint32_t count = fault_count();
            for (std::uint32_t i = 0; i < count; ++i) {
                Batch& before = whole[draw.below(kPool)];
                before.run(gpu);  // leaves everything as after work
                ASSERT_EQ(gpu.fault(), nullptr) << gpu.fault();
                ASSERT_EQ(before.wrong_claims(), 0);
                Batch& batch = broken[draw.below(kPool)];
                ASSERT_EQ(cudaGraphNodeSetEnabled(graph.exec, nodes[n], 0), cudaSuccess);
                batch.run(gpu);
                ASSERT_EQ(cudaGraphNodeSetEnabled(graph.exec, nodes[n], 1), cudaSuccess);
                ASSERT_EQ(batch.wrong_claims(), 0) << kNames[kind] << ", node " << n;
                for (std::size_t q = 0; q < batch.queries.size(); ++q) {
                    differing +=
                        test::difference(batch.queries[q].kind, batch.wanted[q], batch.found[q])
                                .empty()
                            ? 0
                            : 1;
                }
                if (gpu.fault() != nullptr) {
                    ASSERT_TRUE(batch.is_all_not_run());
                    ++dead;
                    revive(parts);
                }
            }
            std::printf("%s, kernel %zu left out %u times: found out %u times, %u answers differ\n",
                        kNames[kind], n, count, dead, differing);
        }
    }
}

TEST(CudaFault, ABitOfTheTreesTurnedOver) {
    test::Draw draw{test::printed_seed(22)};
    std::vector<Mesh> meshes = test::random_surfaces(draw);
    AXG_CUDA_ENGINE_OR_SKIP(gpu, meshes, test::ample(), few_queries());
    std::optional<CpuEngine> cpu = test::engine_over(meshes);
    ASSERT_TRUE(cpu);
    CudaEngine::Parts& parts = gpu.parts();
    const std::uint32_t slices = parts.buffers.sums.slices;
    Batch batch;
    for (std::uint32_t i = 0; i < fault_count(); ++i) {
        const std::size_t place = draw.bits() % gpu.memory().trees_bytes;
        const auto mask = static_cast<unsigned char>(1U << draw.below(8));
        unsigned char byte = 0;
        ASSERT_EQ(cudaMemcpy(&byte, parts.device_memory + place, 1, cudaMemcpyDeviceToHost),
                  cudaSuccess);
        const unsigned char turned = byte ^ mask;
        // Not the pointers of the table of trees: those lead a kernel out of its memory.
        if (place < meshes.size() * sizeof(cuda::DeviceTree)) {
            continue;
        }
        ASSERT_EQ(cudaMemcpy(parts.device_memory + place, &turned, 1, cudaMemcpyHostToDevice),
                  cudaSuccess);
        // Queries that are refused: a damaged tree is not traversed here, only summed up.
        Query refused;
        refused.r_mm = -1;
        QueryResult result;
        for (std::uint32_t n = 0; n < slices && gpu.fault() == nullptr; ++n) {
            gpu.run({&refused, 1}, {&result, 1});
        }
        ASSERT_NE(gpu.fault(), nullptr) << "byte " << place << " of " << gpu.memory().trees_bytes;
        ASSERT_EQ(result.status, QueryStatus::not_run);
        revive(parts);
        ASSERT_EQ(cudaMemcpy(parts.device_memory + place, &byte, 1, cudaMemcpyHostToDevice),
                  cudaSuccess);
        batch.draw(draw, static_cast<std::uint32_t>(meshes.size()), *cpu);
        gpu.run(batch.queries, batch.found);
        ASSERT_EQ(gpu.fault(), nullptr) << gpu.fault();
        ASSERT_EQ(batch.wrong_claims(), 0);
    }
    std::printf("%u slices of %u bytes\n", slices, cuda::kSliceWords * 16);
}

TEST(CudaFault, ABitOfAVertexTurnedOverSpoilsTheSameBatch) {
    test::Draw draw{test::printed_seed(23)};
    const std::vector<Mesh> meshes = {test::lumpy_ball(draw, 4, 30, 0.2)};
    AXG_CUDA_ENGINE_OR_SKIP(gpu, meshes, test::ample(), few_queries());
    CudaEngine::Parts& parts = gpu.parts();
    ASSERT_EQ(parts.buffers.sums.slices, 1U);
    cuda::DeviceTree tree;
    ASSERT_EQ(cudaMemcpy(&tree, parts.buffers.trees, sizeof tree, cudaMemcpyDeviceToHost),
              cudaSuccess);
    Batch batch;
    for (std::uint32_t i = 0; i < fault_count(); ++i) {
        TreeLeaf leaf;
        ASSERT_EQ(cudaMemcpy(&leaf, tree.leaves, sizeof leaf, cudaMemcpyDeviceToHost), cudaSuccess);
        TreeLeaf turned = leaf;
        float& coordinate = turned.v[draw.below(9)][draw.below(kNodeWidth)];
        coordinate = __builtin_bit_cast(
            float, __builtin_bit_cast(std::uint32_t, coordinate) ^ 1U << draw.below(32));
        void* const place = const_cast<TreeLeaf*>(tree.leaves);
        ASSERT_EQ(cudaMemcpy(place, &turned, sizeof leaf, cudaMemcpyHostToDevice), cudaSuccess);
        for (Query& q : batch.queries) {
            q = test::random_query(draw, 1);
        }
        gpu.run(batch.queries, batch.found);
        ASSERT_NE(gpu.fault(), nullptr);
        ASSERT_TRUE(batch.is_all_not_run());
        revive(parts);
        ASSERT_EQ(cudaMemcpy(place, &leaf, sizeof leaf, cudaMemcpyHostToDevice), cudaSuccess);
    }
}

// The check word of a result finds every single bit and every word that was not written. No GPU.
TEST(CudaFault, ADamagedResultIsFoundOut) {
    test::Draw draw{test::printed_seed(24)};
    for (std::uint32_t i = 0; i < fault_count(); ++i) {
        cuda::DeviceResult result{};
        result.sequence = static_cast<std::uint32_t>(draw.bits());
        result.proof = draw.below(2);
        result.status = 1;
        result.clearance_mm = draw.between(0, 50);
        result.nearest_a = draw.below(1000);
        result.check = cuda::check_of(result);
        std::uint32_t words[sizeof result / 4];
        static_assert(sizeof words == sizeof result);
        __builtin_memcpy(words, &result, sizeof result);
        for (std::size_t w = 0; w < std::size(words); ++w) {
            for (unsigned bit = 0; bit <= 32; ++bit) {  // 32: the whole word still poisoned
                std::uint32_t damaged[std::size(words)];
                __builtin_memcpy(damaged, words, sizeof words);
                damaged[w] = bit == 32 ? 0xa5a5a5a5U : words[w] ^ 1U << bit;
                cuda::DeviceResult found;
                __builtin_memcpy(&found, damaged, sizeof found);
                ASSERT_NE(found.check, cuda::check_of(found)) << "word " << w << " bit " << bit;
            }
        }
    }
}

TEST(CudaFault, ListsTooShortForTheBatch) {
    test::Draw draw{test::printed_seed(25)};
    const std::vector<Mesh> meshes = test::random_surfaces(draw);
    std::optional<CpuEngine> cpu = test::engine_over(meshes);
    ASSERT_TRUE(cpu);
    for (const std::uint32_t places : {1U, 7U, 64U, 300U}) {
        CudaOptions options = few_queries();
        options.level_pairs = options.leaf_pairs = places;
        options.candidates = places;
        Capacities few;
        few.batch = {places, places, 16 * places, 64 * places, 4 * places};
        AXG_CUDA_ENGINE_OR_SKIP(gpu, meshes, few, options);
        Batch batch;
        std::uint32_t overflows = 0, far = 0;
        for (std::uint32_t i = 0; i < fault_count(); ++i) {
            batch.draw(draw, static_cast<std::uint32_t>(meshes.size()), *cpu);
            gpu.run(batch.queries, batch.found);
            ASSERT_EQ(gpu.fault(), nullptr) << gpu.fault();
            ASSERT_EQ(batch.wrong_claims(), 0) << "places " << places;
            const std::vector<QueryResult> first = batch.found;
            gpu.run(batch.queries, batch.found);  // whatever the order of work
            for (std::size_t q = 0; q < first.size(); ++q) {
                ASSERT_EQ(first[q].status, batch.found[q].status) << places;
                ASSERT_EQ(first[q].proof, batch.found[q].proof) << places;
                ASSERT_TRUE(test::equal_bits(first[q].clearance_mm, batch.found[q].clearance_mm));
                ASSERT_EQ(first[q].nearest, batch.found[q].nearest) << places;
                overflows += test::is_overflow(first[q]) ? 1 : 0;
                far += first[q].proof == Proof::far ? 1 : 0;
            }
        }
        std::printf("%u places: %u overflows, %u far\n", places, overflows, far);
        EXPECT_GT(overflows, 0U);
    }
}

TEST(CudaFault, AKernelThatDoesNotEnd) {
    test::Draw draw{test::printed_seed(26)};
    const std::vector<Mesh> meshes = test::random_surfaces(draw);
    std::uint32_t* stop = nullptr;
    Batch batch;
    {
        AXG_CUDA_ENGINE_OR_SKIP(gpu, meshes, test::ample(), few_queries());
        for (Query& q : batch.queries) {
            q = Query{};
            q.pose.t[0] = 1000;  // far, if only it were run
        }
        gpu.run(batch.queries, batch.found);
        ASSERT_EQ(batch.found[0].proof, Proof::far);
        ASSERT_EQ(cudaHostAlloc(&stop, sizeof *stop, cudaHostAllocMapped), cudaSuccess);
        *stop = 0;
        ASSERT_EQ(test::launch_endless(stop, gpu.parts().partition.stream), cudaSuccess);
        gpu.run(batch.queries, batch.found);
        EXPECT_TRUE(batch.is_all_not_run());
        ASSERT_NE(gpu.fault(), nullptr);
        std::printf("%s\n", gpu.fault());
        *static_cast<volatile std::uint32_t*>(stop) = 1;
        ASSERT_EQ(cudaDeviceSynchronize(), cudaSuccess);
        gpu.run(batch.queries, batch.found);  // the late batch is done now: it does not count
        EXPECT_TRUE(batch.is_all_not_run()) << "nothing revives a dead engine";
    }
    ASSERT_EQ(cudaFreeHost(stop), cudaSuccess);
}

}  // namespace
}  // namespace axg
