// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/board/axis_cap_keeper.hpp"

#include <algorithm>
#include <cmath>

namespace axg {

namespace {

std::size_t group_of(std::size_t axis) noexcept {
    return std::min<std::size_t>(axis, AXG_BOARD_CAP_GROUPS - 1);
}

std::uint8_t counts_of(double share) noexcept {
    const double counts = std::ceil(share * kSpeedCapRapid - kCapCounts);
    return static_cast<std::uint8_t>(std::clamp(counts, 0.0, double{kSpeedCapRapid}));
}

}  // namespace

double share_in_stop(const Axis& axis, const AxisMotion& now) noexcept {
    const double a = now.acceleration, v = now.speed;
    const double more = v * a > 0 ? 0.5 * a * a / axis.jerk_max : 0;
    return (std::abs(v) + more) / axis.speed_max;
}

AxisCapKeeper::AxisCapKeeper(const Machine& machine, AxisShares& shares, const CapKeeping& keeping)
    : machine_(&machine), shares_(&shares), keeping_(keeping) {
    const double period_s = machine.can.sample_us * 1e-6;
    Shares all{};
    needed_.resize(2 + static_cast<std::size_t>(std::ceil(keeping.smooth_s / period_s)), all);
    all.fill(1);
    late_.resize(static_cast<std::size_t>(kCapLateUs / machine.can.sample_us) + 1, all);
    shares = {};
}

bool AxisCapKeeper::note(std::span<const AxisMotion> axes) noexcept {
    bool is_kept = true;
    for (std::size_t i = 0; i < axes.size(); ++i) {
        const double share = share_in_stop(machine_->axes[i], axes[i]);
        fastest_[i] = std::max(fastest_[i], share);
        is_kept = is_kept && share * kSpeedCapRapid <= kept_[group_of(i)] + kCapCounts;
    }
    return is_kept;
}

AxisCapKeeper::Shares AxisCapKeeper::largest_of(const std::vector<Shares>& of) noexcept {
    Shares largest{};
    for (const Shares& one : of) {
        for (std::size_t i = 0; i < one.size(); ++i) {
            largest[i] = std::max(largest[i], one[i]);
        }
    }
    return largest;
}

/// Returns the shares for the motion: `wanted`, unless the board has a fault.
AxisCapKeeper::Shares AxisCapKeeper::obeyed(const Shares& wanted) noexcept {
    late_[slot_ % late_.size()] = wanted;
    Shares told = keeping_.fault == CapFault::late ? largest_of(late_) : wanted;
    for (double& share : told) {
        share = keeping_.fault == CapFault::half      ? std::min(1.0, 2 * share)
                : keeping_.fault == CapFault::ignores ? 1
                                                      : share;
    }
    return told;
}

void AxisCapKeeper::keep(PermitWatch& watch, double most, std::int64_t now_us) {
    needed_[slot_ % needed_.size()] = shares_->needed;
    shares_->needed = {};
    const Shares needed = largest_of(needed_);
    const CapGroups ordered = watch.ordered_caps(now_us);
    CapGroups wanted = ordered;
    for (std::size_t i = 0; keeping_.fault == CapFault::none && i < machine_->axes.size(); ++i) {
        std::uint8_t& cap = wanted[group_of(i)];
        cap = std::max(cap, counts_of(std::max(fastest_[i], needed[i])));
    }
    kept_ = watch.keep_caps(wanted, now_us);
    Shares shares{};
    for (std::size_t i = 0; i < machine_->axes.size(); ++i) {
        const std::size_t group = group_of(i);
        shares[i] = kCapShare * std::min(kept_[group], ordered[group]) / kSpeedCapRapid;
    }
    shares = obeyed(shares);
    for (std::size_t i = 0; i < machine_->axes.size(); ++i) {
        shares_->wanted[i] = std::min(shares[i], most);
    }
    ++slot_;
    fastest_ = {};
}

std::uint8_t AxisCapKeeper::least_kept() const noexcept {
    return *std::min_element(kept_.begin(), kept_.end());
}

}  // namespace axg
