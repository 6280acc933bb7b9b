// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/advice/trace_run.hpp"

#include <memory>

#include "config/machine/effective_text.hpp"
#include "firmware_if/setup/cycle_parts.hpp"
#include "hil_replay/replay/replay_run.hpp"
#include "hil_replay/trace/added_session.hpp"

namespace axg {

double distance_left(const Machine& machine, const Engine& engine, const AxisSnapshot& snapshot,
                     std::uint32_t pair, const UnprovenPair& unproven) {
    if (unproven.is_known && !unproven.is_blind) {
        return pair_distances(machine, engine, unproven).available_mm;
    }
    const auto room = std::make_unique<PairQueries>();
    const std::optional<Query> query = pose_query(machine, snapshot, pair, *room);
    return query ? pose_distances(engine, *query).available_mm : 0;
}

std::optional<RunEnd> run_trace(const LoadedMachine& loaded, const TraceRun& run) {
    std::string fault;
    const std::unique_ptr<TraceReader> trace = open_trace(run.path, run.options, fault);
    CycleParts parts(loaded, true);
    if (!trace || !parts.has_memory()) {
        return std::nullopt;
    }
    const Machine& machine = loaded.machine;
    ReplayOptions options;
    options.parts.stop_certificate = parts.stop_certificate();
    options.deadline_us = machine.deadline_us;
    options.hashes = configuration_hashes(machine, loaded.meshes);
    const auto replay =
        std::make_unique<ReplayRun>(machine, run.engine, run.containment_test, options, nullptr);
    std::optional<AddedSession> session;
    if (run.lacks_session) {
        session.emplace(machine.can);
    }
    RunEnd end;
    CanFrame frame;
    while (trace->next(frame) && frame.time_us <= run.until_us) {
        if (frame.time_us < run.from_us) {
            continue;
        }
        end.ended_us = frame.time_us;
        if (!replay->on_frame(frame)) {
            break;
        }
        const std::optional<CanFrame> added = session ? session->behind(frame) : std::nullopt;
        if (added && !replay->on_added(*added)) {
            break;
        }
    }
    end.is_complete = trace->error().empty();
    const StopEvent* const stop = !replay->stops().empty()          ? &replay->stops().front()
                                  : replay->withheld().samples != 0 ? &replay->withheld()
                                                                    : nullptr;
    if (stop != nullptr) {
        end.is_stopped = true;
        end.pair = stop->pair;
        end.snapshot = stop->snapshot;
        end.left_mm = stop->pair == kNoIndex ? 0
                                             : distance_left(machine, run.engine, stop->snapshot,
                                                             stop->pair, stop->unproven);
    }
    return end;
}

}  // namespace axg
