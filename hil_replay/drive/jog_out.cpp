// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/drive/jog_out.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "core/base/sincos.hpp"
#include "core/certificate/pair_queries.hpp"
#include "core/guard/escape.hpp"
#include "firmware_if/explain/format_escapes.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "hil_replay/board/jog_driver.hpp"

namespace axg {

namespace {

bool is_rotary(const Machine& machine, const JogMove& move) {
    return machine.axes[move.axis].kind == AxisKind::rotary;
}

/// Whether every pair is farther apart than its margin.
bool has_margins(const Machine& machine, const Engine& engine, const AxisSnapshot& snapshot) {
    const auto pair_queries = std::make_unique<PairQueries>();
    make_contact_queries(machine, snapshot, *pair_queries);
    std::vector<QueryResult> query_results(pair_queries->count);
    const std::span<const Query> queries{pair_queries->queries.data(), pair_queries->count};
    engine(queries, query_results);
    return pair_queries->status == SnapshotStatus::ok &&
           std::all_of(query_results.begin(), query_results.end(),
                       [](const QueryResult& query_result) {
                           return query_result.status == QueryStatus::ok &&
                                  query_result.proof == Proof::far;
                       });
}

/// Whether any motion from rest there would be permitted. With path_keeping, which also needs a
/// look-ahead path: whether every pair has its margin.
bool is_free(const LoadedMachine& loaded, const Engine& engine,
             const ContainmentTest& containment_test, AxisSnapshot snapshot) {
    if (loaded.machine.guard.promise == StopPromise::path_keeping) {
        return has_margins(loaded.machine, engine, snapshot);
    }
    std::optional<StopCertificate> certificate = make_stop_certificate(loaded);
    for (std::uint32_t i = 0; certificate && i < kSamplesKept; ++i) {
        snapshot.sample = i + 1;
        certificate->note(snapshot, i == 0);
    }
    if (!certificate) {
        return false;
    }
    certificate->prove(engine, containment_test);
    const StopCycle cycle = certificate->cycle();
    return cycle.status == SnapshotStatus::ok &&
           std::all_of(cycle.proofs.begin(), cycle.proofs.end(), [](const PairProof& proof) {
               return proof.surfaces.proof == JointBoxProof::proven &&
                      proof.containment_result.containment == Containment::none;
           });
}

/// One jog; empty: memory ran out.
std::optional<DriveResult> jog_once(const LoadedMachine& loaded, const Engine& engine,
                                    const ContainmentTest& containment_test,
                                    const AxisSnapshot& from, const DriveOptions& before,
                                    const JogMove& move) {
    const Machine& machine = loaded.machine;
    std::optional<StopCertificate> certificate = make_stop_certificate(loaded);
    if (!certificate) {
        return std::nullopt;
    }
    GuardChain chain(machine, engine, containment_test, {&*certificate});
    DriveOptions options;
    options.board = before.board;
    options.board.jog = move;
    options.board.tool = from.tool;
    options.response_us = before.response_us;
    const JogMotionPlan jog{
        .move = move,
        .distance = kJogSteps * (is_rotary(machine, move) ? kEscapeStepRad : kEscapeStepMm),
        .tick_s = static_cast<double>(options.board.tick_us) * 1e-6,
        .tool = from.tool};
    return drive(machine, chain, {from.position.data(), machine.axes.size()},
                 make_jog(machine, jog), options);
}

}  // namespace

JogOut jog_out(const LoadedMachine& loaded, const Engine& engine,
               const ContainmentTest& containment_test, const AxisSnapshot& from,
               const DriveOptions& options) {
    const Machine& machine = loaded.machine;
    JogOut out;
    out.rest = from;
    out.rest.tool = from.tool == 0 ? machine.first_tool : from.tool;
    Escapes ways = find_escapes(loaded, engine, containment_test, out.rest);
    out.is_out = is_free(loaded, engine, containment_test, out.rest);
    while (!out.is_out && ways.count != 0 && out.jogs.size() < kJogsMax) {
        const JogMove move{ways.jogs[0].axis, ways.jogs[0].is_negative};
        const auto result = jog_once(loaded, engine, containment_test, out.rest, options, move);
        if (!result || result->state == BoardState::waiting) {
            break;  // no permit: no axis moved
        }
        const double before = out.rest.position[move.axis];
        for (std::size_t i = 0; i < machine.axes.size(); ++i) {
            out.rest.position[i] = result->rest[i].position;
        }
        ways = find_escapes(loaded, engine, containment_test, out.rest);
        out.is_out = is_free(loaded, engine, containment_test, out.rest);
        out.jogs.push_back({move, out.rest.position[move.axis] - before, ways.clearance_mm,
                            result->state == BoardState::stopped});
    }
    return out;
}

std::string jog_out_text(const Machine& machine, const JogOut& out) {
    std::string text;
    for (const JogDone& jog : out.jogs) {
        const bool rotary = is_rotary(machine, jog.move);
        text += fmt::format(
            "{} {}{} {:.4f} {} (clearance at least {:.4f} mm{})", text.empty() ? "jogged" : ",",
            machine.axes[jog.move.axis].name, jog.move.is_negative ? '-' : '+',
            std::abs(jog.moved) * (rotary ? 180.0 / kPi : 1.0), rotary ? "deg" : "mm",
            jog.clearance_mm, jog.is_stopped ? ", stopped by the guard" : "");
    }
    if (text.empty()) {
        return out.is_out ? "no jog needed: other motion is permitted" : "no jog is permitted";
    }
    return text +
           (out.is_out ? ": other motion is permitted" : "; other motion is not permitted yet");
}

}  // namespace axg
