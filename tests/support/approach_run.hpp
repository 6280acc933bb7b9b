// SPDX-License-Identifier: Apache-2.0
// One random approach in closed loop: the deployed guard's chain, the simulated board with the
// library for boards in it, and a wire that does what it likes. Whether tool and plate touch is
// judged by a formula of the test's own. Ablations make one rule wrong.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "firmware_if/protocol/e2e.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "hil_replay/drive/drive_run.hpp"
#include "hil_replay/lab/ablations/ablations.hpp"
#include "tests/support/approach_machine.hpp"
#include "tests/support/frozen_axis.hpp"
#include "tests/support/lazy_motion.hpp"
#include "tests/support/wild_approach.hpp"
#include "tests/support/wild_wire.hpp"

namespace axg::test {

/// What is made wrong.
enum class Wrong : std::uint8_t {
    nothing,
    ignored,        // the board hears nothing of the guard once it moves, and moves on
    one_more,       // n is sent one too large
    n_of_before,    // a raised cap is sent with the n of the permit before
    tool_too_soon,  // the guard forgets the old tool H(n_max) - H(n_min) before it leaves
    unacked,        // an order is believed before its ack
    no_rule_iii,
    no_rule_iv,
    no_rule_iii_iv,
    late,  // CapFault
    half,
    ignores,
    reacts,          // caps of single axes are kept by a feed that reacts
    frozen,          // the count of one axis freezes in motion
    frozen_trusted,  // and the guard takes it for true
    aged,            // positions are up to two periods old, and the machine file does not say so
    aged_and_said,   // nothing: it does
    soft_stop,       // the board brakes with less than half of what it promises
    late_stop,       // it begins to brake later than it promises
};

struct ApproachScene {
    ApproachScene()
        : loaded(with_few_queries()),
          engine(make_engine(loaded)),
          containment_test(make_containment_test(loaded, *engine)) {}

    CompiledMachine loaded;
    std::optional<CpuEngine> engine;
    std::optional<ContainmentTest> containment_test;

  private:
    static CompiledMachine with_few_queries() {
        CompiledMachine out = approach_machine();
        out.machine.cycle.queries = 48;  // of one pair; with more it takes longer, and stops later
        return out;
    }
};

struct ApproachOutcome {
    BoardState state = BoardState::waiting;
    DriveStop stop;
    bool has_moved = false, touches = false, is_slowed = false, is_frozen = false;
    bool left_reach = false;  // at any time
    double least_mm = HUGE_VAL, rest_mm = HUGE_VAL;
    std::uint64_t breaches = 0;      // MotionBoard::cap_breaches
    std::uint64_t caught_after = 0;  // samples from the first of them to left_cap; 0: none
    std::uint64_t uncovered = 0;     // without rule (iii): permits that it would have refused
    std::uint64_t refused_cap = 0;   // with it: permits that it refused
    std::uint64_t samples = 0, refused = 0;
    WildCounts wire;
};

/// Some axes may be faster from the next permit on, as far as the next cycle proves it.
inline void raise_order(Dice& dice, CapPromise promise, const CapOrder& now, GuardChain& chain) {
    if (now.mask == 0 || now.cap >= kCapRapid) {
        return;
    }
    CapOrder order = now;
    order.cap =
        static_cast<std::uint8_t>(dice.chance(0.3) ? kCapRapid : dice.in(now.cap, kCapRapid + 1));
    if (promise == CapPromise::per_axis) {
        order.mask &= static_cast<std::uint8_t>(dice.in(0, 256));
        order.cap = order.mask != now.mask && dice.chance(0.5) ? now.cap : order.cap;
    }
    if (order.cap == kCapRapid || order.mask == 0) {
        order = {};
    }
    chain.set_cap_order(order);
}

/// Permits with another n, and the answer that belongs to it.
class OtherSamples {
  public:
    OtherSamples(std::uint32_t permit_id, std::uint8_t most, Wrong wrong)
        : permit_id_(permit_id), most_(most), wrong_(wrong) {}

    void operator()(CanFrame& frame) {
        if (frame.id == permit_id_ && (frame.data[7] >> 4U) != 0) {
            change(frame);
            plain_ = frame;
        } else if (frame.id == permit_id_ + 1 && frame.data[0] == (0xFFU ^ plain_.data[0]) &&
                   frame.data[2] == (0xFFU ^ plain_.data[2])) {
            for (std::size_t i = 0; i < 8; ++i) {
                frame.data[i] = static_cast<std::uint8_t>(~plain_.data[i]);
            }
        }
    }

  private:
    void change(CanFrame& frame) {
        const auto n = static_cast<std::uint8_t>(frame.data[7] >> 4U);
        const AxisCaps caps = caps_of_permit(frame.data[5], frame.data[6]);
        const bool is_raise = higher_caps(caps, caps_) != caps_;
        const std::uint8_t other = wrong_ == Wrong::one_more ? std::min<std::uint8_t>(n + 1, most_)
                                   : is_raise                ? std::max(n, n_)
                                                             : n;
        const std::uint16_t before = sum_of(frame);
        frame.data[7] = static_cast<std::uint8_t>(other << 4U | (frame.data[7] & 15U));
        const auto changed = static_cast<std::uint16_t>(before ^ sum_of(frame));
        frame.data[3] ^= static_cast<std::uint8_t>(changed & 0xFFU);
        frame.data[4] ^= static_cast<std::uint8_t>(changed >> 8U);
        caps_ = caps;
        n_ = other;
    }
    /// Sums are linear: nonce and lap behind these bytes change nothing in a difference.
    static std::uint16_t sum_of(const CanFrame& plain) {
        const auto& d = plain.data;
        const std::array<std::uint8_t, 11> covered{d[0], d[1], d[2], d[5], d[6], d[7]};
        return crc16_ccitt(covered);
    }

    std::uint32_t permit_id_;
    std::uint8_t most_;
    Wrong wrong_;
    CanFrame plain_;
    AxisCaps caps_{};
    std::uint8_t n_ = 0;
};

/// Samples that name the newest permit that was sent, whatever the board keeps.
class EarlyAck {
  public:
    explicit EarlyAck(const CanLayout& can) : can_(can) {}

    void of_guard(const CanFrame& frame) {
        if (frame.id == can_.permit_id && (frame.data[7] >> 4U) != 0) {
            live_ = frame.data[2];
            has_live_ = true;
        }
    }
    void of_board(CanFrame& frame) const {
        const bool is_fd = can_.format == CanFormat::fd;
        if (!has_live_ || frame.id != can_.axis_ids[is_fd ? 0 : 1]) {
            return;
        }
        std::uint8_t& flags = frame.data[is_fd ? 3 : 7];
        flags = static_cast<std::uint8_t>((flags & 0x0BU) | kFlagAck | (live_ & 15U) << 4U);
        if (is_fd) {
            p05_protect({frame.data.data(), frame.length_bytes}, can_.data_ids[0], frame.data[2]);
        } else {
            frame.data[0] = classical_crc(std::span<const std::uint8_t, 8>(frame.data.data(), 8),
                                          can_.data_ids[1]);
        }
    }

  private:
    const CanLayout& can_;
    std::uint8_t live_ = 0;
    bool has_live_ = false;
};

/// Rules of the cap taken out of the library, around each latch.
class WithoutRules {
  public:
    WithoutRules(Wrong wrong, std::int64_t period_us)
        : without_iii_(wrong == Wrong::no_rule_iii || wrong == Wrong::no_rule_iii_iv),
          without_iv_(wrong == Wrong::no_rule_iv || wrong == Wrong::no_rule_iii_iv),
          period_us_(period_us) {}

    std::uint64_t uncovered = 0;

    void latch(axg_board& board, const std::function<void()>& latch) {
        if (without_iii_) {
            look(board);
            for (std::size_t i = 0; i < AXG_BOARD_RECORDS; ++i) {
                board.records[i].highest = records_[i].highest;
            }
        }
        const std::uint64_t end_us =
            without_iv_ ? lab::forget_older_end(board, period_us_) : std::uint64_t{0};
        latch();
        lab::keep_end(board, end_us);
        if (without_iii_) {
            std::copy(std::begin(board.records), std::end(board.records), records_.begin());
            lab::forget_what_was_kept(board);
        }
    }

  private:
    /// Whether the newest permit that counted is one that rule (iii) refuses.
    void look(const axg_board& board) {
        const axg_board_record& of = records_[board.used_sample % AXG_BOARD_RECORDS];
        bool is_covered = true;
        for (std::size_t i = 0; i < AXG_BOARD_CAP_GROUPS; ++i) {
            is_covered =
                is_covered && of.highest.of[i] <= std::max(of.acked.of[i], board.last.caps.of[i]);
        }
        const bool is_new = board.is_newest_counted && board.used_sample != seen_;
        uncovered += is_new && !is_covered ? 1 : 0;
        seen_ = board.used_sample;
    }

    bool without_iii_, without_iv_;
    std::int64_t period_us_;
    std::array<axg_board_record, AXG_BOARD_RECORDS> records_{};
    std::uint32_t seen_ = 0;
};

inline CapFault cap_fault_of(Wrong wrong) {
    return wrong == Wrong::late      ? CapFault::late
           : wrong == Wrong::half    ? CapFault::half
           : wrong == Wrong::ignores ? CapFault::ignores
                                     : CapFault::none;
}

/// Which tool is in the spindle: it leaves so long after the first sample that names the next one,
/// and not once a stop has begun.
struct SpindleTool {
    std::uint16_t number = 1, next = 1;
    std::int64_t changes_us = INT64_MAX;

    void look(std::int64_t now_us, BoardState state) {
        if (state == BoardState::braking) {
            changes_us = INT64_MAX;
        } else if (now_us >= changes_us) {
            number = next;
            changes_us = INT64_MAX;
        }
    }
    [[nodiscard]] const SolidBox& solid() const { return number == 1 ? kLongTool : kShortTool; }
};

class ApproachRun {
  public:
    /// The scene's machine takes on what is drawn.
    ApproachRun(ApproachScene& scene, std::uint64_t seed, Wrong wrong, Aim aim)
        : scene_(scene),
          wrong_(wrong),
          dice_(seed),
          machine_(scene.loaded.machine),
          drawn_(draw_approach(dice_, machine_, aim)),
          of_board_(machine_),
          rules_(wrong, machine_.can.sample_us) {
        of_board_.can.permit_samples.most = static_cast<std::uint8_t>(
            std::min(15, machine_.can.permit_samples.most + (wrong == Wrong::one_more ? 1 : 0)));
        if (wrong == Wrong::aged || wrong == Wrong::aged_and_said) {
            draw_age();
        }
        drawn_.story.reacts_ticks = wrong == Wrong::reacts ? drawn_.reacts_ticks : 0;
        tool_ = {.number = drawn_.story.tool, .next = drawn_.story.next_tool};
        if (wrong == Wrong::frozen || wrong == Wrong::frozen_trusted) {
            frozen_.emplace(of_board_, ~seed);
            drawn_.faults.lost = 0;  // a lost sample may hide a freeze at twice the speed
            machine_.guard.reports_limits = wrong == Wrong::frozen_trusted;
        }
        if (wrong == Wrong::soft_stop) {
            for (Axis& axis : of_board_.axes) {
                axis.stopping_min *= 0.4;
            }
        }
        if (wrong == Wrong::ignored) {
            drawn_.faults = {.silence = Silence::from_beginning};
        }
    }

    ApproachOutcome play() {
        const CapPromise promise = machine_.guard.cap;
        std::optional<StopCertificate> certificate = make_stop_certificate(scene_.loaded);
        std::optional<SpeedAdvisory> advisory =
            promise != CapPromise::none ? SpeedAdvisory::create(machine_) : std::nullopt;
        GuardChain chain(machine_, scene_.engine->engine(), *scene_.containment_test,
                         {&*certificate, advisory ? &*advisory : nullptr});
        LazyMotion motion(of_board_, drawn_.approach,
                          wrong_ == Wrong::ignored ? CapPromise::none : promise, drawn_.story);
        const BoardOptions options = board_options(motion);
        MotionBoard board(of_board_, {drawn_.start.data(), 3}, std::ref(motion), options);
        board.watch(
            [&](std::int64_t now_us, std::span<const AxisMotion> axes) {
                judge(axes);  // with the tool of before, too
                tool_.look(now_us, board.state());
                judge(axes);
            },
            kWatchUs);
        DriveGuard guard(machine_, chain, options.hashes, drawn_.response_us, board.next_latch_us(),
                         INT64_MAX);
        WildLoop loop(board, bus_options(), guard.node(), drawn_.faults);
        spoil(board, loop);
        go(board, guard, chain, loop);
        judge(board.axes());
        out_.state = board.state();
        out_.stop = guard.stop();
        out_.breaches = board.cap_breaches();
        out_.samples = board.samples();
        out_.refused = board.permits().refused();
        out_.refused_cap = board.library().refused[AXG_BOARD_REFUSED_CAP];
        out_.uncovered = rules_.uncovered;
        out_.wire = loop.counts;
        return out_;
    }

  private:
    static constexpr std::int64_t kLongestUs = 300'000, kWaitUs = 60'000, kWatchUs = 200;

    /// A register one SYNC behind, always or now and then; or always two that follow each other.
    void draw_age() {
        const std::uint32_t period_us = machine_.can.sample_us;
        const double kind = dice_.in(0, 1);
        age_ = kind < 0.4   ? ValueAge{period_us, period_us}
               : kind < 0.7 ? ValueAge{0, period_us}
                            : ValueAge{2 * period_us, 2 * period_us};
        if (wrong_ == Wrong::aged_and_said) {
            machine_.can.latched_age = age_;
        }
    }
    BoardOptions board_options(LazyMotion& motion) const {
        BoardOptions options = promised_board(machine_, drawn_.seed);
        options.latched_age = age_;
        options.tool = drawn_.story.tool;
        options.cap_fault = cap_fault_of(wrong_);
        options.cap_smooth_s = static_cast<double>(drawn_.story.lazy_ticks) * kTickS;
        if (wrong_ == Wrong::late_stop) {
            options.reaction_us_max += 100'000;
        }
        if (wrong_ == Wrong::ignored) {
            lab::forget_dead_man(options);
            options.cap = CapPromise::none;
        } else if (options.cap == CapPromise::all_axes) {
            options.speed_share = &motion.share;
        } else if (options.cap == CapPromise::per_axis) {
            options.axis_shares = &motion.shares;
        }
        return options;
    }
    BusOptions bus_options() const {
        BusOptions bus;
        bus.permit_id = machine_.can.permit_id;
        bus.heartbeat_id = machine_.can.heartbeat_out_id;
        bus.period_us = machine_.can.sample_us;
        bus.seed = drawn_.seed + 1;
        return bus;
    }
    std::int64_t horizon_us(std::uint8_t n) const {
        return static_cast<std::int64_t>(std::ceil(free_seconds(machine_, n) * 1e6));
    }

    void judge(std::span<const AxisMotion> axes) {
        Positions at{};
        for (std::size_t i = 0; i < axes.size(); ++i) {
            at[i] = axes[i].position;
        }
        out_.rest_mm = gap_mm(tool_.solid(), at);
        out_.least_mm = std::min(out_.least_mm, out_.rest_mm);
        out_.touches = out_.touches || (out_.has_moved && out_.rest_mm <= 0);
    }
    /// What is wrong on the wire and in the board's library.
    void spoil(MotionBoard& board, WildLoop& loop) {
        loop.stop_id = machine_.can.stop_id;
        if (wrong_ == Wrong::one_more || wrong_ == Wrong::n_of_before) {
            loop.of_guard =
                OtherSamples(machine_.can.permit_id, of_board_.can.permit_samples.most, wrong_);
        } else if (wrong_ == Wrong::unacked && machine_.guard.cap != CapPromise::none) {
            early_.emplace(machine_.can);
            loop.of_guard = [this](CanFrame& frame) { early_->of_guard(frame); };
            loop.of_board = [this](CanFrame& frame) { early_->of_board(frame); };
        } else if (frozen_) {
            loop.of_board = [this](CanFrame& frame) { frozen_->of_board(frame); };
        }
        const PermitSamples range = machine_.can.permit_samples;
        const std::int64_t more_us = horizon_us(range.most) - horizon_us(range.least);
        const std::int64_t leaves_us =
            horizon_us(range.most) + (wrong_ == Wrong::tool_too_soon ? more_us : 0);
        loop.latches = [this, &board, leaves_us](const std::function<void()>& latch) {
            const std::int64_t latched_us = board.next_latch_us();
            const std::uint16_t before = board.tool();
            rules_.latch(board.library(), latch);
            if (board.tool() != before) {
                tool_.changes_us = latched_us + leaves_us;
            }
        };
    }
    void go(MotionBoard& board, DriveGuard& guard, GuardChain& chain, WildLoop& loop) {
        const std::int64_t buffer_us =
            std::int64_t{machine_.can.look_ahead_samples} * machine_.can.sample_us;
        const CapPromise promise = machine_.guard.cap;
        std::int64_t end_us = kBoardStartUs + kWaitUs + buffer_us;
        std::uint64_t breached_at = 0;
        while (!board.is_at_rest() && !out_.touches && board.next_latch_us() < end_us) {
            if (promise != CapPromise::none && dice_.chance(drawn_.raise)) {
                raise_order(dice_, promise, guard.result().cap_order, chain);
            }
            if (!loop.cycle()) {
                return;
            }
            const bool has_breach = board.cap_breaches() > 0;
            breached_at = breached_at == 0 && has_breach ? board.samples() : breached_at;
            if (out_.caught_after == 0 && has_breach &&
                guard.stop().reason == StopReason::left_cap) {
                out_.caught_after = board.samples() - breached_at + 1;
            }
            if (board.state() == BoardState::waiting && guard.stop().cause != GuardFault::none) {
                return;
            }
            if (board.state() != BoardState::waiting && !out_.has_moved) {
                out_.has_moved = true;
                end_us = board.next_latch_us() + kLongestUs + 2 * buffer_us;
            }
            if (frozen_ && out_.has_moved) {
                frozen_->look(board.axes());
                out_.is_frozen = frozen_->is_frozen();
            }
            out_.left_reach = out_.left_reach || guard.result().limit.kind == LimitKind::left_reach;
            out_.is_slowed =
                out_.is_slowed || (out_.has_moved && board.permits().speed_cap() < kCapRapid);
        }
    }

    ApproachScene& scene_;
    Wrong wrong_;
    Dice dice_;
    Machine& machine_;
    WildApproach drawn_;
    ValueAge age_;
    Machine of_board_;
    WithoutRules rules_;
    SpindleTool tool_;
    std::optional<EarlyAck> early_;
    std::optional<FrozenAxis> frozen_;
    ApproachOutcome out_;
};

}  // namespace axg::test
