// SPDX-License-Identifier: Apache-2.0
// Whatever byte of a compiled machine is changed, it is refused; and where nobody looks at the
// sums, whatever passes is a machine that an engine can be made of and queried. AXG_COUNT changes.
#include <gtest/gtest.h>

#include <random>

#include "firmware_if/setup/guard_engine.hpp"
#include "firmware_if/setup/surface_list.hpp"
#include "tests/support/count.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/small_compiled.hpp"

namespace axg::test {
namespace {

TEST(Compiled, EveryByteChangedIsRefused) {
    std::mt19937_64 dice(printed_seed(31));
    const std::string bytes = compile_machine(small_compiled());
    const std::uint64_t count = count_from_environment(bytes.size());
    for (std::uint64_t i = 0; i < count; ++i) {
        const std::size_t at = count < bytes.size() ? dice() % bytes.size() : i % bytes.size();
        std::string changed = bytes;
        changed[at] = static_cast<char>(changed[at] ^ static_cast<char>(1 + dice() % 255));
        ASSERT_NE(compiled_faults(changed), "") << "byte " << at;
    }
    std::printf("%llu changes of %zu bytes\n", static_cast<unsigned long long>(count),
                bytes.size());
}

/// Every surface against every other, containment too, at one pose.
std::uint32_t run_all(const CompiledMachine& compiled) {
    std::optional<CpuEngine> engine = make_engine(compiled);
    const std::optional<ContainmentTest> containment_test =
        engine ? make_containment_test(compiled, *engine) : std::nullopt;
    if (!containment_test) {
        return 0;
    }
    const auto surfaces = static_cast<std::uint32_t>(surface_list(compiled).engines.size());
    std::uint32_t answered = 0;
    for (std::uint32_t a = 0; a < surfaces; ++a) {
        for (std::uint32_t b = 0; b < surfaces; ++b) {
            Query query;
            query.mesh_a = a;
            query.mesh_b = b;
            query.pose.t[0] = 60;
            query.pose_error_mm = 0x1p-20;
            QueryResult result;
            ContainmentResult inside;
            engine->run({&query, 1}, {&result, 1});
            containment_test->run({&query, 1}, {&result, 1}, {&inside, 1});
            answered += result.status == QueryStatus::ok ? 1 : 0;
        }
    }
    return answered;
}

TEST(Compiled, WhatPassesWithoutSumsIsAMachine) {
    std::mt19937_64 dice(printed_seed(32));
    const std::string bytes = compile_machine(small_compiled());
    const std::uint64_t count = count_from_environment(20000);
    std::uint64_t passed = 0, answered = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
        std::string changed = bytes;
        for (std::uint64_t k = 1 + dice() % 3; k-- > 0;) {
            const std::size_t at = dice() % changed.size();
            changed[at] = dice() % 2 == 0 ? static_cast<char>(dice())
                                          : static_cast<char>(changed[at] ^ (1 << dice() % 8));
        }
        CompiledMachine read;
        if (parse_compiled(changed, "m.axg", read, Sums::ignored).empty()) {
            ++passed;
            answered += i % 16 == 0 ? run_all(read) : 0;
        }
    }
    std::printf("%llu of %llu passed\n", static_cast<unsigned long long>(passed),
                static_cast<unsigned long long>(count));
    EXPECT_LT(passed, count);
    if (count >= 20000) {  // fewer may all be refused
        EXPECT_GT(answered, 0U);
    }
}

}  // namespace
}  // namespace axg::test
