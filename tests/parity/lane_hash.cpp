// SPDX-License-Identifier: Apache-2.0
// Prints a hash over every bit of the answers to N random questions: builds and processors whose
// hashes are equal agree bit for bit. Usage: lane_hash COUNT SEED [avx512|avx2|neon]
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "core/cpu_engine.hpp"
#include "tests/support/random_questions.hpp"

namespace {

using namespace axg;

LaneSet lanes_named(const std::string& name) {
    return name == "avx512" ? LaneSet::avx512
           : name == "avx2" ? LaneSet::avx2
           : name == "neon" ? LaneSet::neon
                            : LaneSet::widest;
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
    // Every third question meets the end of a list somewhere.
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
        Question question = test::random_question(draw, static_cast<std::uint32_t>(meshes.size()));
        list.assign(list.size(), TriangleIds{});
        question.list = list;
        Answer answer;
        (i % 3 == 0 ? *few : *ample).ask({&question, 1}, {&answer, 1});
        hash.add(answer, list);
        far += answer.proof == Proof::far ? 1 : 0;
        overflows += answer.status != AnswerStatus::ok ? 1 : 0;
    }
    std::printf("%016llx %llu far, %llu overflows\n", static_cast<unsigned long long>(hash.value()),
                static_cast<unsigned long long>(far), static_cast<unsigned long long>(overflows));
    std::fprintf(stderr, "%s\n", std::string(ample->lanes()).c_str());
    return 0;
}
