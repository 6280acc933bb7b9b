// SPDX-License-Identifier: Apache-2.0
// The bus thread's link to the engine: queries out, results back, and whether a result is overdue.
// Not every kind of query has a result, and one result covers all queries before it.
#pragma once

#include <cstdint>

#include "firmware_if/guard/black_box_recorder.hpp"
#include "firmware_if/guard/live_messages.hpp"
#include "firmware_if/guard/node_log.hpp"
#include "firmware_if/guard/spsc_queue.hpp"

namespace axg {

struct LiveQueues {
    SpscQueue<LiveQuery, 64> queries;
    SpscQueue<LiveResult, 64> results;
    NoteQueue notes;
};

class EngineLink {
  public:
    /// Both must outlive it.
    EngineLink(LiveQueues& queues, BlackBoxRecorder& recorder) noexcept
        : queues_(queues), recorder_(recorder) {}

    void begin_turn() noexcept { has_submitted_ = false; }
    [[nodiscard]] bool has_submitted() const noexcept { return has_submitted_; }
    /// After a reset: results of earlier queries are then of another epoch.
    void begin_epoch() noexcept { ++epoch_; }
    [[nodiscard]] bool is_of_epoch(const LiveResult& result) const noexcept {
        return result.epoch == epoch_;
    }

    /// Sets number and epoch. A full queue drops the query: `is_newly_silent` finds an engine that
    /// is so far behind.
    void submit(LiveQuery query, std::int64_t now_us) noexcept {
        query.number = submitted_ + 1;
        query.epoch = epoch_;
        if (!queues_.queries.push(query)) {
            return;
        }
        ++submitted_;
        recorder_.add(query);
        if (query.kind != LiveQuery::Kind::look_ahead) {
            waiting_since_us_ = is_idle() ? now_us : waiting_since_us_;
            owed_ = submitted_;
        }
        has_submitted_ = true;
    }

    [[nodiscard]] bool pop(LiveResult& out) noexcept { return queues_.results.pop(out); }
    void note(const LiveResult& result, std::int64_t now_us) noexcept {
        completed_ = result.number;
        recorder_.add(result);
        waiting_since_us_ = now_us;
    }
    /// No result is owed.
    [[nodiscard]] bool is_idle() const noexcept { return owed_ == completed_; }
    /// True once when a result is owed for longer than this, whatever the receiver does.
    [[nodiscard]] bool is_newly_silent(std::int64_t now_us, std::int64_t limit_us) noexcept {
        const bool is_silent = !is_idle() && now_us - waiting_since_us_ > limit_us;
        const bool is_new = is_silent && !was_silent_;
        was_silent_ = is_silent;
        return is_new;
    }

  private:
    LiveQueues& queues_;
    BlackBoxRecorder& recorder_;
    std::uint32_t submitted_ = 0, owed_ = 0, completed_ = 0, epoch_ = 0;
    std::int64_t waiting_since_us_ = 0;  // for the engine's next result
    bool has_submitted_ = false, was_silent_ = false;
};

}  // namespace axg
