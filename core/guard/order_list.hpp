// SPDX-License-Identifier: Apache-2.0
// Which orders of a cap a search tries, the one first that costs least now. Of a board that keeps
// single axes within a cap, those that hardly move are bound first, for that costs nothing while
// they do not start. Pure. Source: docs/reference/board.md, "Which order".
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/guard/cap_control.hpp"

namespace axg {

inline constexpr std::uint32_t kOrdersTried = 14;
inline constexpr double kIdleUse = 0.25;  // 1/250 of rapid: an axis that is slower does not move
inline constexpr double kAnyGrowth = kCapRapid;

struct OrderTried {
    CapOrder order{};
    bool binds_fastest = false;
    double room = 0;    // so many times as fast as now the axes that it binds may get
    double growth = 1;  // and so many times as fast all may get by it, which are slowed down now
};

struct OrderList {
    std::array<OrderTried, kOrdersTried> of{};
    std::uint32_t count = 0;
    bool is_slowed = false;  // an axis moves that `order` binds
};

/// @param uses  [axes] how fast each is now, 1/250 of its largest speed
/// @param order  what was ordered last; it is in the list unless it binds nothing
/// @param is_per_axis  an order may bind some axes alone, else it binds all
[[nodiscard]] OrderList list_orders(std::span<const double> uses, const CapOrder& order,
                                    bool is_per_axis) noexcept;

}  // namespace axg
