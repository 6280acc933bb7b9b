// SPDX-License-Identifier: Apache-2.0
// What is fuzzed: each takes any bytes, must end, and aborts where a claim of its file does not
// hold. Returns 0, as libFuzzer wants it.
#pragma once

#include <cstddef>
#include <cstdint>

namespace axg::fuzz {

[[nodiscard]] int black_box(const std::uint8_t* data, std::size_t size);
[[nodiscard]] int board(const std::uint8_t* data, std::size_t size);
[[nodiscard]] int candump(const std::uint8_t* data, std::size_t size);
[[nodiscard]] int certcheck(const std::uint8_t* data, std::size_t size);
[[nodiscard]] int compiled(const std::uint8_t* data, std::size_t size);
[[nodiscard]] int dbc(const std::uint8_t* data, std::size_t size);
[[nodiscard]] int eds(const std::uint8_t* data, std::size_t size);
[[nodiscard]] int frame(const std::uint8_t* data, std::size_t size);
[[nodiscard]] int gcode(const std::uint8_t* data, std::size_t size);
[[nodiscard]] int machine_file(const std::uint8_t* data, std::size_t size);
[[nodiscard]] int stl(const std::uint8_t* data, std::size_t size);
[[nodiscard]] int tool_table(const std::uint8_t* data, std::size_t size);
[[nodiscard]] int tritri(const std::uint8_t* data, std::size_t size);
[[nodiscard]] int urdf(const std::uint8_t* data, std::size_t size);
[[nodiscard]] int vector_asc(const std::uint8_t* data, std::size_t size);

}  // namespace axg::fuzz
