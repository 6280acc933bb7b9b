// SPDX-License-Identifier: Apache-2.0
// The probe as this build compiles everything but the lane kernels.
#include "tests/parity/contraction_probe.hpp"

#if defined(__aarch64__)
#include "core/collision/lanes_neon.hpp"
#endif

namespace axg::test {

Probe probe_baseline(const ProbeInput& in) {
    Probe out;
    probe_scalars(in, out);
#if defined(__aarch64__)
    probe_lanes<lanes::Float4>(in, out);
#endif
    return out;
}

}  // namespace axg::test
