// SPDX-License-Identifier: Apache-2.0
// Asks the kernels of this build many questions and writes every answer that the interface promises
// (core/collision/engine.hpp), each floating-point number as its bits: two builds, by two
// compilers, write the same bytes (tests/device/compare_compilers.sh).
//   axg_kernel_answers engine|paper FILE [COUNT]    COUNT questions of a scene; 20000, paper 200
#include <algorithm>
#include <chrono>
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "cuda/paper/paper_gpu.hpp"
#include "tests/support/awkward_triangles.hpp"
#include "tests/support/cuda_fixture.hpp"
#include "tests/support/engine_parity.hpp"
#include "tests/support/random_queries.hpp"

namespace axg {
namespace {

[[noreturn]] void fail(const char* what, const std::string& why) {
    std::fprintf(stderr, "axg_kernel_answers: %s: %s\n", what, why.c_str());
    std::exit(1);
}

/// What came of one scene: the file's lines, and what they say in all.
struct Answers {
    std::FILE* file;
    std::uint64_t questions = 0, far = 0, touching = 0, full = 0, nearer = 0;
    double seconds = 0;  // of the engine's calls, all together

    void write(const Query& q, const QueryResult& a, std::vector<TriangleIds> list) {
        ++questions;
        far += a.proof == Proof::far ? 1 : 0;
        touching += a.touching != 0 ? 1 : 0;
        full += test::is_overflow(a) ? 1 : 0;
        std::fprintf(file, "%d", static_cast<int>(q.kind));
        if (q.kind == QueryKind::clearance) {
            // The order of work differs from run to run, and so does what is too much.
            const bool told = !test::is_overflow(a);
            nearer += told && a.clearance_mm > 0 && a.clearance_mm < q.r_mm ? 1 : 0;
            std::fprintf(file, " %d %d %016" PRIx64 "\n", told ? static_cast<int>(a.status) : -1,
                         told ? static_cast<int>(a.proof) : -1,
                         told ? __builtin_bit_cast(std::uint64_t, a.clearance_mm) : 0);
            return;
        }
        std::fprintf(file, " %d %d", test::is_overflow(a) ? -1 : static_cast<int>(a.status),
                     static_cast<int>(a.proof));
        if (!test::is_overflow(a)) {
            std::fprintf(file, " %u %u %u %u", a.touching, a.node_pairs, a.triangle_pairs,
                         a.rechecks);
        }
        if (a.status == QueryStatus::ok && a.touching <= list.size()) {
            list.resize(a.touching);
            std::sort(list.begin(), list.end());
            for (const TriangleIds& ids : list) {
                std::fprintf(file, " %u/%u", ids.a, ids.b);
            }
        }
        std::fputc('\n', file);
    }
};

/// Batches of all sizes of `count` questions about `meshes`.
void ask(test::Draw& draw, const std::vector<Mesh>& meshes, const Capacities& capacities,
         std::uint32_t count, Answers& answers) {
    std::string fault;
    auto gpu = test::cuda_engine_over(meshes, test::ample(capacities), CudaOptions{}, fault);
    if (!gpu) {
        fail("no engine", fault);
    }
    constexpr std::uint32_t kList = 24, kBatches[] = {512, 1, 700, 31, 8, 512};
    std::uint32_t done = 0;
    for (std::uint32_t batch = 0; done < count; ++batch) {
        const std::uint32_t size = std::min(kBatches[batch % 6], count - done);
        std::vector<Query> queries(size);
        std::vector<QueryResult> results(size);
        std::vector<std::vector<TriangleIds>> lists(size);
        for (std::uint32_t i = 0; i < size; ++i) {
            queries[i] = test::random_query(draw, static_cast<std::uint32_t>(meshes.size()));
            queries[i].is_float_only = i % 4 == 1;
            lists[i].resize(queries[i].kind == QueryKind::touching && i % 3 == 0 ? kList : 0);
            queries[i].list = lists[i];
        }
        const auto start = std::chrono::steady_clock::now();
        gpu->run(queries, results);
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
        answers.seconds += took.count();
        if (gpu->fault() != nullptr) {
            fail("the engine gave up", gpu->fault());
        }
        for (std::uint32_t i = 0; i < size; ++i) {
            answers.write(queries[i], results[i], lists[i]);
        }
        done += size;
    }
}

void ask_engine(std::FILE* file, std::uint32_t count) {
    Answers answers{file};
    for (const Capacities& capacities : {Capacities{}, Capacities{200, 2000, 20}}) {
        test::Draw draw{11};
        const std::vector<Mesh> meshes = test::random_surfaces(draw);
        ask(draw, meshes, capacities, count, answers);
    }
    constexpr std::uint32_t kScenes = 8;
    test::Draw draw{13};
    for (std::uint32_t scene = 0; scene < kScenes; ++scene) {
        std::vector<Mesh> meshes;
        for (std::uint32_t i = 0; i < 6; ++i) {
            meshes.push_back(test::awkward_triangles(draw, i % 3));
        }
        ask(draw, meshes, Capacities{}, count / kScenes, answers);
    }
    std::printf("engine: %" PRIu64 " questions: %" PRIu64 " far, %" PRIu64 " touching, %" PRIu64
                " too much, %" PRIu64 " clearances in range; %.3f s\n",
                answers.questions, answers.far, answers.touching, answers.full, answers.nearer,
                answers.seconds);
}

void ask_paper(std::FILE* file, std::uint32_t count) {
    test::Draw draw{11};
    paper::Scene scene;
    for (const Mesh& mesh :
         {test::lumpy_ball(draw, 7, 60, 0.1), test::lumpy_ball(draw, 12, 50, 0.4),
          test::plate(8, 8, 64), test::lumpy_ball(draw, 1, 20, 0.3)}) {
        scene.bodies.push_back(paper::make_body(mesh.triangles));
    }
    scene.pairs = {{0, 1}, {1, 2}, {2, 0}, {3, 1}};
    std::vector<paper::PairPose> queries;
    for (std::uint32_t i = 0; i < count / 8 * 8; ++i) {  // whole launches of eight
        const Query query = test::random_query(draw, 1);
        queries.push_back({i % 4, query.pose});
    }
    std::string fault;
    auto gpu = paper::Gpu::create(scene, 0, fault);
    if (!gpu) {
        fail("no kernels", fault);
    }
    std::vector<paper::Found> found(queries.size());
    std::vector<double> us(queries.size());
    std::uint64_t touching = 0;
    unsigned compiled = 0;
    double seconds = 0;
    const auto write = [&](unsigned name) {
        ++compiled;
        for (const double each : us) {
            seconds += each * 1e-6;
        }
        for (const paper::Found& a : found) {
            touching += a.touching != 0 ? 1 : 0;
            std::fprintf(file, "%u %u %u %u\n", name, a.touching, a.tested, a.left);
        }
    };
    for (unsigned bits = 0; bits < 64; ++bits) {
        const paper::Techniques t{(bits & 1U) != 0, (bits & 2U) != 0,  (bits & 4U) != 0,
                                  (bits & 8U) != 0, (bits & 16U) != 0, (bits & 32U) != 0};
        if (gpu->run_paper(t, paper::Timing::each, 1, queries, found, us)) {
            write(bits);
        } else if (gpu->fault().find("not compiled") == std::string::npos) {
            fail("a kernel failed", gpu->fault());
        }
    }
    if (!gpu->run_certified(paper::Timing::each, 8, queries, found, us)) {
        fail("the certified test failed", gpu->fault());
    }
    write(64);
    std::printf("paper: %zu questions to %u kernels, %" PRIu64 " answers touch; %.3f s\n",
                queries.size(), compiled, touching, seconds);
}

}  // namespace
}  // namespace axg

int main(int count, char** words) {
    const std::string_view what = count >= 3 ? words[1] : "";
    if (what != "engine" && what != "paper") {
        std::fprintf(stderr, "usage: axg_kernel_answers engine|paper FILE [COUNT]\n");
        return 2;
    }
    std::FILE* const file = std::fopen(words[2], "w");
    if (file == nullptr) {
        axg::fail("cannot write", words[2]);
    }
    const std::string asked = count > 3 ? words[3] : what == "paper" ? "200" : "20000";
    const auto questions = static_cast<std::uint32_t>(std::strtoul(asked.c_str(), nullptr, 10));
    what == "paper" ? axg::ask_paper(file, questions) : axg::ask_engine(file, questions);
    return std::fclose(file) == 0 ? 0 : 1;
}
