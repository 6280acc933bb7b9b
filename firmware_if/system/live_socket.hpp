// SPDX-License-Identifier: Apache-2.0
// The socket of a machine's bus: every id of its machine file, flexible frames where it has them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/machine/machine.hpp"
#include "firmware_if/can/socket_can.hpp"

namespace axg {

/// @param interface  "can0"
/// @param receive_buffer_bytes  0: the system's
/// @return  empty: `fault` has the failure and the next step
[[nodiscard]] std::optional<SocketCan> open_live_socket(const Machine& machine,
                                                        const std::string& interface,
                                                        std::int32_t receive_buffer_bytes,
                                                        std::string& fault);

}  // namespace axg
