// SPDX-License-Identifier: Apache-2.0
// ctest-labels: data long
// The same of a real machine (config/machines/probe-basic-xyzac.yaml), whose meshes are not ours.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/support/travel_fixture.hpp"

namespace axg::test {
namespace {

TEST(TravelProof, NothingPrunedFromARealMachineComesNear) {
    const std::string root = AXG_SHARED_DATA;
    if (!std::filesystem::exists(root + "/machines/probe-basic-xyzac")) {
        GTEST_SKIP() << "no " << root << "/machines: set AXG_SHARED_DATA";
    }
    judge_travel(load_or_fail(source_file("config/machines/probe-basic-xyzac.yaml"),
                              root + "/machines/probe-basic-xyzac"),
                 count_from_environment(2'000));
}

}  // namespace
}  // namespace axg::test
