// SPDX-License-Identifier: Apache-2.0
// Counts every call of malloc and its kin in this process, whoever makes it; operator new ends
// there too.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <cstdint>

namespace axg::test {
extern std::atomic<std::uint64_t> allocations;
}

// Sanitizers bring a malloc of their own, which must stay.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define AXG_COUNTS_MALLOC 0
#elif defined(__has_feature)
#define AXG_COUNTS_MALLOC (!__has_feature(address_sanitizer) && !__has_feature(thread_sanitizer))
#else
#define AXG_COUNTS_MALLOC 1
#endif

namespace axg::test {

class NoAllocation : public testing::Test {
  protected:
    void SetUp() override {
        if (!AXG_COUNTS_MALLOC) {
            GTEST_SKIP() << "built with a sanitizer, which has an allocator of its own";
        }
    }
};

}  // namespace axg::test
