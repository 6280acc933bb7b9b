// SPDX-License-Identifier: Apache-2.0
// Explains a stop or a withheld permit for the report: the distance that the proof needed, the
// distance available, and the changes that would have proven it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/certificate/reach_bodies.hpp"
#include "core/collision/engine.hpp"
#include "core/guard/distance_need.hpp"
#include "core/guard/monitor.hpp"
#include "firmware_if/explain/why_sentences.hpp"
#include "firmware_if/setup/loaded_machine.hpp"
#include "hil_replay/trace/limit_survey.hpp"

namespace axg {

/// Other values of the machine file with which the motion of a stop was run again.
struct AdvisedSetting {
    std::vector<std::string> lines;  // YAML, a map each, to be merged into the machine file
    bool is_gone = false;            // no stop in what was run
    double after_s = 0;              // gone: how long that lasted beyond the stop
    double left_mm = 0;              // else: distance of the pair at the new stop
    double gain_mm = 0;              // how much nearer that is
    bool is_driven = false;          // on the simulated board, which runs the program
};
struct Advice {
    std::uint32_t tried = 0;               // settings that were run
    std::vector<AdvisedSetting> settings;  // that gain kAdviceGainMm; the best first
    bool was_driven = false;               // also those that change the motion
    bool is_of_trace = false;              // the stop is; what was driven is another motion
};
inline constexpr double kAdviceGainMm = 0.5;

struct StopWhy {
    WhyCause cause = WhyCause::margin;
    std::uint32_t pair = kNoIndex;
    std::uint32_t tool = kNoIndex;  // Machine::tools; kNoIndex: the one in the spindle, or none
    DistanceNeed need;
    bool is_whole = false;  // need.until_braking_mm is the whole reach
    bool is_jog = false;    // need.margin_mm is the floor of the jog
    bool is_list_full = false;
    QueryStatus full = QueryStatus::ok;  // an overflow: which list; ok: unknown, or none
    std::uint32_t queries = 0;           // of the proof that failed
    double available_mm = 0;             // certified at the sampled position
    double within_mm = 0;                // clearances were measured up to this
    double worst_mm = 0;                 // least clearance found in the reach
    std::optional<OpenPart> open;
    std::optional<WorkLists> whole;  // of the lists: by one query that proves the whole reach
    NeedRemedies remedies;
    std::string other_limits;  // the limits behind `are_other_limits`
    bool has_reach = false;
    JointBox reach;                 // every position of the axes that was to be proven
    std::vector<ReachBody> bodies;  // the pair's, in it
    std::optional<Advice> advice;   // empty: nothing was run again
};

/// The list's key in cycle.lists and capacities of the machine file; null: `status` is no overflow.
[[nodiscard]] const char* full_list(QueryStatus status) noexcept;

/// Data of a stop or a withheld permit after its cycle.
struct StopFacts {
    StopReason reason = StopReason::none;
    std::uint32_t pair = kNoIndex;
    const AxisSnapshot& snapshot;
    const UnprovenPair& unproven;  // !is_known: contact mode, or no certificate failed
};
/// Sources for new queries about the stop.
struct WhySources {
    const LoadedMachine& loaded;
    Engine engine;
    const LimitSurvey* limits = nullptr;  // null: the motion was not measured
};
/// Returns nullopt if the stop does not concern the distance of a pair.
/// Cost: as find_remedies; milliseconds to a second.
[[nodiscard]] std::optional<StopWhy> why_of(const WhySources& sources, const StopFacts& stop);
/// The plain sentences of a stop, without indent and end.
[[nodiscard]] std::vector<std::string> why_sentences(const Machine& machine, const StopWhy& why);
/// Lines of a report, each with its end: sentences and advice; in full lists and parts too.
[[nodiscard]] std::string format_why(const Machine& machine, const StopWhy& why, Detail detail);

}  // namespace axg
