// SPDX-License-Identifier: Apache-2.0
// What travel proofs prune from a pair is far from its partner at any position of the travel,
// overrun included: random positions, many at the ends of axes, judged by an engine over the
// surfaces as they were. The same for half the travel must be found out. And cycles decide as they
// do without proofs.
#include "firmware_if/setup/travel_proof.hpp"

#include <gtest/gtest.h>

#include "tests/support/travel_fixture.hpp"

namespace axg::test {
namespace {

TEST(TravelProof, NothingPrunedFromThePapersMachineComesNear) {
    judge_travel(load_or_fail(kPaperMachine), count_from_environment(5'000));
}

}  // namespace
}  // namespace axg::test
