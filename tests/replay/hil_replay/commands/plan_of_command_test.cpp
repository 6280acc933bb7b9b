// SPDX-License-Identifier: Apache-2.0
// Office and machine agree: 30 programs, replayed with the plan of a stored admission, have the
// verdicts of the guard that was admitted with it, sample by sample. The guard here is the deployed
// one behind the frames of the trace, with the plan that axguardd run gives it.
// ctest-labels: long
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "config/machine/effective_text.hpp"
#include "core/base/sincos.hpp"
#include "firmware_if/axguardd/admission_record.hpp"
#include "firmware_if/axguardd/axguardd_json.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/setup/choose_plan.hpp"
#include "hil_replay/guard/timed_guard.hpp"
#include "tests/support/dice.hpp"
#include "tests/support/example_programs.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg::test {
namespace {

constexpr std::uint32_t kGenerated = 8;  // programs of each machine
constexpr const char* kMachines[] = {"paper-trunnion", "spindle-tilting", "table-spindle-tilting"};

std::string machine_file(const std::string& name) {
    return source_file("config/machines/" + name + ".yaml");
}

CyclePlan plan_of_step(const Machine& machine, std::uint32_t step) {
    return plan_at(machine, stop_tasks(machine), step);
}

/// Stores the verdict of a computer that was admitted with this plan.
std::string store_admission(const Workshop& shop, const LoadedMachine& loaded,
                            const std::optional<CyclePlan>& plan) {
    AdmissionFigures figures;
    figures.times = time_limits(loaded.machine);
    figures.cycles = CycleFigures{.engine = "cpu, avx2 lanes",
                                  .count = 10,
                                  .proven_count = 10,
                                  .proven_us = 100,
                                  .longest_us = 100,
                                  .worst_case_us = 400,
                                  .plan = plan};
    const AdmissionSubject subject{loaded.machine.name,
                                   configuration_hash(loaded.machine, loaded.meshes), "can0",
                                   plan ? "stoppable" : "contact", shop.file(".")};
    return shop.write("can0.admission.json",
                      describe_admission(judge_admission(figures), figures, subject, {}));
}

/// Sample, permit, reason and pairs not proven of each cycle up to the stop, as --csv has them.
std::vector<std::string> guarded(LoadedMachine loaded, const CyclePlan& plan,
                                 const std::vector<CanFrame>& trace) {
    const ConfigurationHashes hashes = configuration_hashes(loaded.machine, loaded.meshes);
    loaded.machine.plan = plan;
    std::optional<CpuEngine> engine = make_engine(loaded);
    const auto containment_test = make_containment_test(loaded, *engine);
    auto certificate = make_stop_certificate(loaded, plan);
    GuardChain chain(loaded.machine, engine->engine(), *containment_test, {&*certificate});
    std::vector<std::string> out;
    TimedGuardOptions options;
    options.guard.accepts_local = options.guard.supposes_sync = true;
    options.guard.hashes = hashes;
    options.each = [&](const TimedCycle& cycle) {
        const CycleResult& result = cycle.result.result;
        out.push_back(fmt::format("{},{},{},{}", chain.snapshot().sample, cycle.sent_permit ? 1 : 0,
                                  to_text(result.reason), result.not_proven));
    };
    TimedGuard guard({.machine = loaded.machine, .chain = chain}, options, trace.front().time_us);
    for (const CanFrame& frame : trace) {
        guard.arrive({.frame = frame});
        if (guard.is_stopped()) {
            return out;
        }
    }
    guard.hear_result();
    return out;
}

/// The same columns of a table of cycles.
std::vector<std::string> replayed(const std::string& csv, std::size_t axes) {
    std::istringstream lines(csv);
    std::vector<std::string> out;
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) {
        std::vector<std::string> cells;
        std::istringstream row(line);
        for (std::string cell; std::getline(row, cell, ',');) {
            cells.push_back(cell);
        }
        const std::size_t permit = 3 + axes + 1;
        out.push_back(fmt::format("{},{},{},{}", cells.at(0), cells.at(permit),
                                  cells.at(permit + 1), cells.at(permit + 2)));
    }
    return out;
}

/// A few moves through the travel, most of which end near a body or in one.
std::string random_moves(const Machine& machine, Dice& dice) {
    std::string text = "G21 G90 G94\nG4 P0.05\n";
    for (int move = 0; move < 3; ++move) {
        text += fmt::format("G1 F{:.0f}", dice.magnitude(600, 10000));
        for (const Axis& axis : machine.axes) {
            const double unit = axis.kind == AxisKind::rotary ? 180 / kPi : 1;
            const double low = axis.unlimited ? 0 : axis.min,
                         high = axis.unlimited ? kPi : axis.max;
            text += fmt::format(" {}{:.3f}", axis.name, unit * dice.in(low, high));
        }
        text += '\n';
    }
    return text + "M2\n";
}

class PlanOf : public testing::Test {
  protected:
    void SetUp() override {
        if (!std::filesystem::exists(AXG_PROGRAM)) {
            GTEST_SKIP() << AXG_PROGRAM << " is not built";
        }
    }
    /// Both verdicts of a program, on the machine, with the plan of each step in turn.
    void compare(const std::string& name, const LoadedMachine& loaded, const std::string& program) {
        SCOPED_TRACE(name + " " + program);
        const std::string file = machine_file(name);
        ASSERT_EQ(shop_.run("simulate " + file + " " + program + " -o t.log"), 0) << shop_.err;
        const std::uint32_t step = programs_++ % kPlanSteps;
        const CyclePlan plan = plan_of_step(loaded.machine, step);
        (void)store_admission(shop_, loaded, plan);
        (void)shop_.run("replay " + file + " t.log --plan-of can0.admission.json --engine cpu " +
                        "--csv t.csv --within 0.001 --advice-s 0 --json=r.json");
        EXPECT_NE(shop_.out.find("plan of can0.admission.json"), std::string::npos) << shop_.err;
        const std::vector<std::string> live =
            guarded(loaded, plan, read_trace(shop_.file("t.log")));
        std::vector<std::string> office =
            replayed(content_of(shop_.file("t.csv")), loaded.machine.axes.size());
        office.resize(std::min(office.size(), live.size()));  // a table goes on behind the stop
        ASSERT_GT(live.size(), 50U);
        ASSERT_EQ(live.size(), office.size());
        const auto differs = std::mismatch(live.begin(), live.end(), office.begin());
        EXPECT_TRUE(differs.first == live.end())
            << "live: " << *differs.first << ", office: " << *differs.second;
        samples_ += live.size();
        stops_ += live.back().find("predicted") != std::string::npos ? 1 : 0;
        const Json stages = Json::parse(content_of(shop_.file("r.json"))).at("proofs").at("plan");
        EXPECT_EQ(stages.at("stages").at(0).at("box_rows"), plan.lists[0].box_rows);
    }

    Workshop shop_;
    std::uint32_t programs_ = 0, stops_ = 0;
    std::size_t samples_ = 0;
};

TEST_F(PlanOf, ThirtyProgramsHaveTheVerdictsOfTheAdmittedGuard) {
    for (const char* name : kMachines) {
        LoadedMachine loaded;
        ASSERT_TRUE(load_example(name, loaded));
        for (const Example& example : kExamples) {
            if (example.machine == std::string(name)) {
                compare(
                    name, loaded,
                    source_file(std::string("hil_replay/programs/") + example.program + ".ngc"));
            }
        }
        Dice dice(20261130);
        for (std::uint32_t i = 0; i < kGenerated; ++i) {
            compare(name, loaded, shop_.write("p.ngc", random_moves(loaded.machine, dice)));
        }
    }
    LoadedMachine paper;
    ASSERT_TRUE(load_example("paper-trunnion", paper));
    compare("paper-trunnion", paper, kDemoProgram);
    EXPECT_EQ(programs_, 30U);
    EXPECT_GT(samples_, 100'000U);
    EXPECT_GE(stops_, 10U);
}

/// A shorter plan stops the near program earlier: the verdicts above are the plan's.
TEST_F(PlanOf, AShorterPlanStopsEarlier) {
    const LoadedMachine loaded = load_paper_machine();
    const std::string near = source_file("hil_replay/programs/paper-trunnion-near.ngc");
    ASSERT_EQ(shop_.run("simulate " + kPaperMachine + " " + near + " -o t.log"), 0) << shop_.err;
    std::vector<std::int64_t> stops_us;
    for (const std::uint32_t step : {0U, kPlanSteps - 1}) {
        (void)store_admission(shop_, loaded, plan_of_step(loaded.machine, step));
        EXPECT_EQ(shop_.run("replay " + kPaperMachine +
                            " t.log --plan-of can0.admission.json --advice-s 0 --json=r.json"),
                  kExitCollision)
            << shop_.err;
        const Json report = Json::parse(content_of(shop_.file("r.json")));
        stops_us.push_back(report.at("stops").at(0).at("time_us").get<std::int64_t>());
    }
    EXPECT_LT(stops_us[0], stops_us[1]);
}

TEST_F(PlanOf, AVerdictThatIsNoneForThisMachineIsRefused) {
    const LoadedMachine loaded = load_paper_machine();
    const auto err_of = [this](const std::string& machine) {
        for (const std::string command : {"check ", "replay "}) {
            EXPECT_EQ(shop_.run(command + machine + (command == "check " ? "" : " t.log") +
                                " --plan-of can0.admission.json"),
                      kExitInput);
        }
        return shop_.err;
    };
    (void)shop_.write("t.log", "");
    (void)shop_.write("can0.admission.json", "{}");
    EXPECT_NE(err_of(kPaperMachine).find("no verdict of axguardd admit"), std::string::npos);
    (void)store_admission(shop_, loaded, std::nullopt);
    EXPECT_NE(err_of(kPaperMachine).find("contact mode"), std::string::npos);
    (void)store_admission(shop_, loaded, plan_of_step(loaded.machine, 0));
    EXPECT_NE(err_of(machine_file("spindle-tilting")).find("another machine file"),
              std::string::npos);
    std::string text = content_of(shop_.file("can0.admission.json"));
    // What only tells the reader may be anything.
    std::string odd = text;
    odd.replace(odd.find("\"fit\": false"), 12, "\"fit\": [12]")
        .replace(odd.find("\"cycles\""), 8, "\"bicycl\"");
    (void)shop_.write("odd.json", odd);
    EXPECT_EQ(shop_.run("check " + kPaperMachine + " --plan-of odd.json"), 0) << shop_.err;
    text.replace(text.find("\"box_rows\""), 10, "\"box_lows\"");
    (void)shop_.write("can0.admission.json", text);
    EXPECT_NE(err_of(kPaperMachine).find("no plan"), std::string::npos);
}

TEST_F(PlanOf, CheckSaysWhetherTheFilesPlanFitsTheGuardsComputer) {
    const LoadedMachine loaded = load_paper_machine();
    for (std::uint32_t step = 0; step < kPlanSteps; ++step) {
        (void)store_admission(shop_, loaded, plan_of_step(loaded.machine, step));
        EXPECT_EQ(
            shop_.run("check " + kPaperMachine + " --plan-of can0.admission.json --json=c.json"), 0)
            << shop_.err;
        const bool fits = step >= kPlanStepAsStated;
        EXPECT_EQ(shop_.out.find("it fits: no list") != std::string::npos, fits) << step;
        EXPECT_EQ(shop_.out.find("has shorter lists") != std::string::npos, !fits) << step;
        const Json admitted = Json::parse(content_of(shop_.file("c.json"))).at("admitted");
        EXPECT_EQ(admitted.at("has_file_plan"), fits);
        EXPECT_EQ(admitted.at("fit"), false) << "a verdict without latency is not fit";
    }
}

}  // namespace
}  // namespace axg::test
