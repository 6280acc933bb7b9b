// SPDX-License-Identifier: Apache-2.0
// One program for all targets: fuzzer TARGET [libFuzzer's options and folders]. Without a target it
// prints their names, which is how tests/tools/fuzz.sh finds them.
#include <array>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "tests/fuzz/targets.hpp"

namespace {

using Run = int (*)(const std::uint8_t* data, std::size_t size);

struct Target {
    std::string_view name;
    Run run;
};

constexpr std::array kTargets{
    Target{"black_box", &axg::fuzz::black_box},
    Target{"board", &axg::fuzz::board},
    Target{"candump", &axg::fuzz::candump},
    Target{"certcheck", &axg::fuzz::certcheck},
    Target{"compiled", &axg::fuzz::compiled},
    Target{"dbc", &axg::fuzz::dbc},
    Target{"eds", &axg::fuzz::eds},
    Target{"frame", &axg::fuzz::frame},
    Target{"gcode", &axg::fuzz::gcode},
    Target{"machine_file", &axg::fuzz::machine_file},
    Target{"stl", &axg::fuzz::stl},
    Target{"tool_table", &axg::fuzz::tool_table},
    Target{"tritri", &axg::fuzz::tritri},
    Target{"urdf", &axg::fuzz::urdf},
    Target{"vector_asc", &axg::fuzz::vector_asc},
};

Run chosen = nullptr;

// Where libFuzzer starts itself again (-merge, -fork) it leaves out a word that is none of its own.
constexpr const char* kVariable = "AXG_FUZZ_TARGET";

bool choose(std::string_view name) {
    for (const Target& target : kTargets) {
        if (target.name == name) {
            chosen = target.run;
            setenv(kVariable, target.name.data(), 1);
        }
    }
    return chosen != nullptr;
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
    if (*argc > 1 && choose((*argv)[1])) {
        (*argv)[1] = (*argv)[0];
        ++*argv;
        --*argc;
        return 0;
    }
    const char* const inherited = std::getenv(kVariable);
    if (inherited != nullptr && choose(inherited)) {
        return 0;
    }
    for (const Target& target : kTargets) {
        std::printf("%s\n", target.name.data());
    }
    std::exit(*argc > 1 ? 2 : 0);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return chosen(data, size);
}
