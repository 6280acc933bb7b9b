// SPDX-License-Identifier: Apache-2.0
// The probe with contraction allowed: it would notice.
#include "tests/parity/contraction_probe.hpp"

#if defined(__aarch64__)
#include "core/collision/lanes_neon.hpp"
using Lanes = axg::lanes::Float4;
#else
#include "core/collision/lanes_avx2.hpp"
using Lanes = axg::lanes::Float8;
#endif

namespace axg::test {

Probe probe_on(const ProbeInput& in) {
    Probe out;
    probe_scalars(in, out);
    probe_lanes<Lanes>(in, out);
    return out;
}

}  // namespace axg::test
