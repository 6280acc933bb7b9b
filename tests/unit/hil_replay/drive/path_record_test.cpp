// SPDX-License-Identifier: Apache-2.0
// A path that is judged afterwards has the contact of one that is judged on the way.
#include "hil_replay/drive/path_record.hpp"

#include <gtest/gtest.h>

#include "core/base/sincos.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "firmware_if/setup/loaded_machine.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg::test {
namespace {

TEST(PathRecord, AContactIsFoundAfterwardsWhereItWas) {
    LoadedMachine loaded;
    ASSERT_TRUE(load(kPaperMachine, "", loaded, stderr));
    std::optional<CpuEngine> engine = make_engine(loaded);
    ASSERT_TRUE(engine);
    const auto containment_test = make_containment_test(loaded, *engine);
    ASSERT_TRUE(containment_test);
    PathJudge at_once(loaded.machine, engine->engine(), *containment_test);
    PathJudge afterwards(loaded.machine, engine->engine(), *containment_test);
    PathRecord record;
    record.show(afterwards);
    EXPECT_EQ(afterwards.instants(), 0U) << "nothing was recorded";
    AxisMotions axes{};
    axes[1].position = 107.132;
    axes[3].position = -19.2 * kPi / 180;
    axes[4].position = 97 * kPi / 180;
    for (int i = 0; i < 60; ++i) {  // the cutter goes down into the table, 1 mm an instant
        axes[2].position = -180.0 - i;
        const std::span<const AxisMotion> now{axes.data(), loaded.machine.axes.size()};
        at_once.look(1000 + 500 * i, now, 1);
        record.add(1000 + 500 * i, now, 1);
    }
    record.show(afterwards);
    ASSERT_TRUE(at_once.contact().has_value());
    ASSERT_TRUE(afterwards.contact().has_value());
    EXPECT_EQ(afterwards.contact()->pair, at_once.contact()->pair);
    EXPECT_EQ(afterwards.contact()->time_us, at_once.contact()->time_us);
    EXPECT_EQ(afterwards.contact()->snapshot.position, at_once.contact()->snapshot.position);
    EXPECT_EQ(afterwards.contact()->snapshot.tool, 1);
    EXPECT_GT(afterwards.instants(), 10U) << "the first ones touch nothing";
    EXPECT_LT(afterwards.instants(), 60U) << "the first contact is enough";
}

}  // namespace
}  // namespace axg::test
