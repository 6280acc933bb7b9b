// SPDX-License-Identifier: Apache-2.0
// main of every test program. GoogleTest ends with 0 when tests were skipped; ctest must know.
#include <gtest/gtest.h>

int main(int argc, char** argv) {
    testing::InitGoogleTest(&argc, argv);
    const int failures = RUN_ALL_TESTS();
    if (failures != 0) {
        return failures;
    }
    constexpr int kSkippedReturnCode = 77;  // SKIP_RETURN_CODE in tests/CMakeLists.txt
    return testing::UnitTest::GetInstance()->skipped_test_count() > 0 ? kSkippedReturnCode : 0;
}
