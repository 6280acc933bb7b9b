// SPDX-License-Identifier: Apache-2.0
// The probe as core/collision/traverse_avx512.cpp is compiled.
#include "tests/parity/contraction_probe.hpp"

#include "core/collision/lanes_avx512.hpp"

namespace axg::test {

Probe probe_avx512(const ProbeInput& in) {
    Probe out;
    probe_scalars(in, out);
    probe_lanes<lanes::Float16>(in, out);
    return out;
}

}  // namespace axg::test
