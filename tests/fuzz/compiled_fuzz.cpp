// SPDX-License-Identifier: Apache-2.0
// Any bytes as a compiled machine, or any bytes of a sound one changed: it is read or refused; an
// engine and containment test can be made of what was read, and it compiles to a file that reads
// the same. The last byte of an input says which; the sums are looked at in every fourth kind
// alone, so that the fuzzer reaches what lies behind them.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "config/machine/effective_text.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "tests/fuzz/targets.hpp"
#include "tests/support/small_compiled.hpp"

namespace {

/// Three bytes a change: where, and what.
std::string changed(const std::uint8_t* data, std::size_t size) {
    static const std::string sound = axg::compile_machine(axg::test::small_compiled());
    std::string bytes = sound;
    for (std::size_t i = 0; i + 2 < size; i += 3) {
        const std::size_t at = (static_cast<std::size_t>(data[i]) << 8U | data[i + 1]);
        bytes[at % bytes.size()] = static_cast<char>(data[i + 2]);
    }
    return bytes;
}

}  // namespace

int axg::fuzz::compiled(const std::uint8_t* data, std::size_t size) {
    if (size == 0) {
        return 0;
    }
    const std::uint8_t kind = data[--size] % 4;
    const std::string bytes =
        kind < 2 ? changed(data, size) : std::string(reinterpret_cast<const char*>(data), size);
    const axg::Sums sums = kind == 3 ? axg::Sums::checked : axg::Sums::ignored;
    axg::CompiledMachine read;
    if (!axg::parse_compiled(bytes, "fuzz.axg", read, sums).empty()) {
        return 0;
    }
    std::optional<axg::CpuEngine> engine = axg::make_engine(read);
    if (engine && !axg::make_containment_test(read, *engine)) {
        std::abort();
    }
    axg::CompiledMachine again;
    if (!axg::parse_compiled(axg::compile_machine(read), "fuzz.axg", again).empty() ||
        axg::effective_text(again.machine) != axg::effective_text(read.machine)) {
        std::abort();
    }
    return 0;
}
