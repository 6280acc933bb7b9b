// SPDX-License-Identifier: Apache-2.0
// Any bytes: the reader of cases ends with a fault at an offset within them, or with as many cases
// as names, which any method can judge.
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "hil_replay/lab/cases/tritri_file.hpp"
#include "hil_replay/lab/methods/method.hpp"
#include "tests/fuzz/targets.hpp"

int axg::fuzz::tritri(const std::uint8_t* data, std::size_t size) {
    using namespace axg::lab;
    TritriFile file;
    const std::string fault = parse_tritri({reinterpret_cast<const char*>(data), size}, file);
    if (!fault.empty()) {
        if (std::stoul(fault) > size) {
            std::abort();
        }
        return 0;
    }
    const std::size_t count = file.holds_meshes() ? file.mesh_cases.size() : file.pairs.size();
    if (count != file.ids.size()) {
        std::abort();
    }
    for (const Method& method : methods()) {
        if (judge(method, file.pairs, true).verdicts.size() != file.pairs.size()) {
            std::abort();
        }
    }
    return 0;
}
