// SPDX-License-Identifier: Apache-2.0
// main of every test program. `unit_tests stl_test tree_test` runs the tests of these two files;
// with no name all tests run. GoogleTest exits with 0 after skipped tests: ctest must see those.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>
#include <string_view>

namespace {

std::string_view stem_of(std::string_view path) {
    const std::size_t slash = path.rfind('/');
    path.remove_prefix(slash == std::string_view::npos ? 0 : slash + 1);
    return path.substr(0, path.rfind('.'));
}

/// Every test that stands in the file, as GoogleTest's filter takes them.
std::string tests_of(std::string_view file) {
    const testing::UnitTest& all = *testing::UnitTest::GetInstance();
    std::string filter;
    for (int i = 0; i < all.total_test_suite_count(); ++i) {
        const testing::TestSuite& suite = *all.GetTestSuite(i);
        for (int k = 0; k < suite.total_test_count(); ++k) {
            const testing::TestInfo& test = *suite.GetTestInfo(k);
            if (test.file() != nullptr && stem_of(test.file()) == file) {
                filter += std::string(suite.name()) + '.' + test.name() + ':';
            }
        }
    }
    return filter;
}

/// False when a file has no test: a case that ran nothing must not pass.
bool choose_files(int count, char** names) {
    std::string filter;
    for (int i = 0; i < count; ++i) {
        const std::string found = tests_of(names[i]);
        if (found.empty()) {
            std::fprintf(stderr, "%s: no test in a file of that name\n", names[i]);
            return false;
        }
        filter += found;
    }
    // What the user's own filter leaves out stays out; what it names alone wins.
    const std::string wanted = testing::GTEST_FLAG(filter);
    if (wanted == "*") {
        testing::GTEST_FLAG(filter) = filter;
    } else if (wanted.starts_with('-')) {
        testing::GTEST_FLAG(filter) = filter + wanted;
    }
    return true;
}

}  // namespace

int main(int argc, char** argv) {
    testing::InitGoogleTest(&argc, argv);
    if (argc > 1 && !choose_files(argc - 1, argv + 1)) {
        return 2;
    }
    const int failures = RUN_ALL_TESTS();
    if (failures != 0) {
        return failures;
    }
    if (testing::UnitTest::GetInstance()->test_to_run_count() == 0) {
        std::fprintf(stderr, "no test matches\n");
        return 2;
    }
    constexpr int kSkippedReturnCode = 77;  // SKIP_RETURN_CODE in tests/CMakeLists.txt
    return testing::UnitTest::GetInstance()->skipped_test_count() > 0 ? kSkippedReturnCode : 0;
}
