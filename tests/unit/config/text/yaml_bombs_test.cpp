// SPDX-License-Identifier: Apache-2.0
// No text is too clever to be refused, and no refusal too long to be read.
#include <gtest/gtest.h>

#include "tests/support/machine_text.hpp"
#include "tests/support/yaml_bombs.hpp"

namespace axg::test {
namespace {

TEST(YamlBombs, EveryOneIsRefusedInFewWords) {
    constexpr std::size_t kMessageBytesMax = 1U << 19U;  // a thousand faults of one line each
    for (const YamlBomb& bomb : yaml_bombs()) {
        const std::string faults = faults_of(bomb.text());
        EXPECT_NE(faults, "") << bomb.name;
        EXPECT_LE(faults.size(), kMessageBytesMax) << bomb.name;
    }
}

}  // namespace
}  // namespace axg::test
