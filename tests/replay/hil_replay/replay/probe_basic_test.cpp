// SPDX-License-Identifier: Apache-2.0
// ctest-labels: data long
// A real five-axis machine, against what was measured on its meshes independently of this code
// (the README beside them): where the head first meets the trunnion on its way down, which bodies
// overlap by construction, and that real programs run clear of it.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/limits.hpp"
#include "core/base/sincos.hpp"
#include "core/machine/kinematics.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/setup/guard_engine.hpp"

namespace axg {
namespace {

const std::string kProbeBasic =
    std::string(AXG_SOURCE_DIR) + "/config/machines/probe-basic-xyzac.yaml";
const std::string kMeshes = std::string(AXG_SHARED_DATA) + "/machines/probe-basic-xyzac";
const std::string kPrograms = std::string(AXG_SHARED_DATA) + "/gcode/";

struct Place {
    double x_in, y_in, z_in, a_deg;
};

class ProbeBasic : public testing::Test {
  protected:
    void SetUp() override {
        if (!std::filesystem::exists(kMeshes)) {
            GTEST_SKIP() << "no " << kMeshes << ": set AXG_SHARED_DATA";
        }
        ASSERT_TRUE(load(kProbeBasic, kMeshes, loaded, stderr));
        // Faces that coincide need many rechecks; with the file's capacity the result would be the
        // same, not proven, and the count cut short.
        loaded.machine.capacities.rechecks = 1U << 20U;
        std::optional<CpuEngine> made = make_engine(loaded);
        ASSERT_TRUE(made.has_value());
        engine = std::make_unique<CpuEngine>(std::move(*made));
    }

    [[nodiscard]] std::uint32_t body(const std::string& name) const {
        for (std::uint32_t i = 0; i < loaded.machine.bodies.size(); ++i) {
            if (loaded.machine.bodies[i].name == name) {
                return i;
            }
        }
        ADD_FAILURE() << "no body " << name;
        return 0;
    }

    /// Both bodies' meshes alone, whatever the file says of the pair.
    [[nodiscard]] QueryResult run_query(const std::string& a, const std::string& b,
                                        const Place& at) {
        std::array<double, kAxesMax> axes{};
        axes[0] = at.x_in * 25.4;
        axes[1] = at.y_in * 25.4;
        axes[2] = at.z_in * 25.4;
        axes[3] = at.a_deg * kPi / 180;
        std::vector<Pose> placed(loaded.machine.bodies.size());
        place_bodies(loaded.machine, {axes.data(), loaded.machine.axes.size()}, placed);
        Query query;
        query.kind = QueryKind::touching;
        query.mesh_a = body(a);
        query.mesh_b = body(b);
        query.pose = relative_pose(placed[query.mesh_a], placed[query.mesh_b]);
        QueryResult result;
        engine->run({&query, 1}, {&result, 1});
        EXPECT_EQ(result.status, QueryStatus::ok);
        return result;
    }

    [[nodiscard]] bool touches(const std::string& a, const std::string& b, const Place& at) {
        return run_query(a, b, at).proof != Proof::far;
    }

    LoadedMachine loaded;
    std::unique_ptr<CpuEngine> engine;
};

struct Descent {
    Place at;
    double contact_in;  // of the steps of 0.5 in from +3 down, the first with contact
    const char* with;
};

// At X0 A0 the measurement, which does not count mere touch, found none: at -18 in the nose lies
// in the plane of the plate. Touch is contact here.
constexpr Descent kDescents[] = {
    {{0, 0, 0, 0}, -18, "c_axis"},     {{12.5, 0, 0, 0}, -14, "a_axis"},
    {{-12.5, 0, 0, 0}, -14, "a_axis"}, {{10, 0, 0, 0}, -15.5, "a_axis"},
    {{8, 0, 0, 0}, -17, "a_axis"},     {{0, 0, 0, 30}, -17.5, "c_axis"},
    {{0, 0, 0, 60}, -15, "c_axis"},    {{0, 0, 0, 90}, -14, "a_axis"},
    {{0, 0, 0, -90}, -14, "a_axis"},
};

TEST_F(ProbeBasic, TheHeadMeetsTheTrunnionWhereItWasMeasured) {
    for (const Descent& descent : kDescents) {
        SCOPED_TRACE(testing::Message() << "X" << descent.at.x_in << " A" << descent.at.a_deg);
        for (int step = 0; step <= 42; ++step) {
            Place at = descent.at;
            at.z_in = 3 - 0.5 * step;
            std::string met;
            for (const char* name : {"saddle", "table", "a_axis", "c_axis"}) {
                met += touches("headstock", name, at) ? name : "";
            }
            if (at.z_in > descent.contact_in) {
                EXPECT_EQ(met, "") << "at Z " << at.z_in << " in";
            } else {
                EXPECT_EQ(met, descent.with) << "at Z " << at.z_in << " in";
                break;
            }
        }
    }
}

// A micrometre above the plane of the plate the proof still holds.
TEST_F(ProbeBasic, TheNoseIsClearOfThePlateUntilItLiesOnIt) {
    const double micrometre = 0.001 / 25.4;
    EXPECT_FALSE(touches("headstock", "c_axis", {0, 0, -18 + micrometre, 0}));
    EXPECT_TRUE(touches("headstock", "c_axis", {0, 0, -18, 0}));
}

TEST_F(ProbeBasic, BearingAndSeatOverlapAtEveryPosition) {
    for (const double a_deg : {-90.0, -30.0, 0.0, 45.0, 100.0}) {
        const Place at{0, 0, 0, a_deg};
        const std::uint32_t bearing = run_query("table", "a_axis", at).touching;
        EXPECT_GE(bearing, 1694U) << "A" << a_deg;  // measured: 1694 to 1696 without mere touch
        EXPECT_GE(run_query("a_axis", "c_axis", at).touching, 570U) << "A" << a_deg;
    }
}

TEST_F(ProbeBasic, TheTrunnionStaysOffTheFrame) {
    for (const double y_in : {-8.0, 0.0, 8.0}) {
        for (const double a_deg : {-100.0, 0.0, 100.0}) {
            for (const char* name : {"table", "a_axis", "c_axis"}) {
                EXPECT_FALSE(touches("frame", name, {0, y_in, 0, a_deg})) << name << " Y" << y_in;
            }
        }
    }
}

struct RealProgram {
    const char* file;
    const char* options;  // what the control would have known
    int exit_code;
};

class ProbeBasicProgram : public testing::TestWithParam<RealProgram> {};

// Simulated and replayed by the program as a person would, every pair with its margin.
TEST_P(ProbeBasicProgram, EndsAsExpected) {
    const std::string program = kPrograms + GetParam().file;
    if (!std::filesystem::exists(program) || !std::filesystem::exists(AXG_PROGRAM)) {
        GTEST_SKIP() << "no " << program << " or no " << AXG_PROGRAM;
    }
    const std::string trace =
        testing::TempDir() + "axg_probe_basic_" + std::to_string(::getpid()) + ".log";
    const auto run = [](const std::string& arguments) {
        const std::string line = std::string(AXG_PROGRAM) + " " + arguments + " >/dev/null";
        const int status = std::system(line.c_str());
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    };
    EXPECT_EQ(
        run("simulate " + kProbeBasic + " " + program + " -o " + trace + " " + GetParam().options),
        0);
    // The deadline is not the point here: a shared machine may be late.
    EXPECT_EQ(run("replay " + kProbeBasic + " " + trace + " --mesh-root " + kMeshes +
                  " --mode contact --deadline-us 10000000"),
              GetParam().exit_code);
    std::filesystem::remove(trace);
}

INSTANTIATE_TEST_SUITE_P(
    Real, ProbeBasicProgram,
    testing::Values(RealProgram{"impeller_xyzac.ngc",
                                "--ignore M428,M429 --work-offset 'G54 Z-100'", kExitClean},
                    RealProgram{"boat-xyzac.ngc",
                                "--ignore M428,M429 --tool 1=150 --sample-us 5000", kExitClean},
                    RealProgram{"xyz_box_inscribed_face_circles_test.ngc",
                                "--tool 8=150 --work-offset 'G54 Z-140'", kExitClean},
                    // The same program with the part clamped too low: the cutter meets the plate.
                    RealProgram{"impeller_xyzac.ngc",
                                "--ignore M428,M429 --work-offset 'G54 Z-430'", kExitCollision}));

}  // namespace
}  // namespace axg
