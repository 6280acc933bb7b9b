// SPDX-License-Identifier: Apache-2.0
// Which signals of a DBC file are in which frames of their message: multiplexing by one M, and
// extended multiplexing by SG_MUL_VAL_.
// Source: Vector's "DBC File Format Documentation" 1.0.5, as for dbc.hpp.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "config/can/dbc.hpp"

namespace axg {

/// One SG_MUL_VAL_: the multiplexor of a signal, and its values in the order of the file.
struct DbcPages {
    std::string_view signal, multiplexor;
    std::vector<SignalSelector::Range> values;
};

/// Gives each multiplexed signal its multiplexor and values, or a reason in DbcSignal::refused.
/// Without SG_MUL_VAL_ a page is of the message's only multiplexor. Beside a second one it has
/// none: it would be read in frames of another page.
/// @param lines  those of the message
void apply_pages(DbcMessage& message, const std::vector<DbcPages>& lines);

}  // namespace axg
