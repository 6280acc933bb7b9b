// SPDX-License-Identifier: Apache-2.0
// Any file of the permitted size is read or refused within a second (machine files,
// docs/reference/machine-file.md).
#include <gtest/gtest.h>

#include <ctime>

#include "tests/support/machine_text.hpp"
#include "tests/support/yaml_bombs.hpp"

namespace axg::test {
namespace {

TEST(MachineFileTime, NoBombTakesASecond) {
    double worst_s = 0;
    const char* worst = "";
    for (const YamlBomb& bomb : yaml_bombs()) {
        const std::string text = bomb.text();
        Machine machine;
        const std::clock_t begin = std::clock();  // processor time: other programs are not our bomb
        const bool refused = !parse_machine(text, "m", machine).empty();
        const double took_s = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
        EXPECT_TRUE(refused) << bomb.name;
        EXPECT_LT(took_s, 1.0) << bomb.name;
        if (took_s > worst_s) {
            worst_s = took_s;
            worst = bomb.name;
        }
    }
    std::printf("longest of %zu: %.0f ms (%s)\n", yaml_bombs().size(), worst_s * 1000, worst);
}

}  // namespace
}  // namespace axg::test
