// SPDX-License-Identifier: Apache-2.0
// Parts of a guard's chain other than engine and containment test. Whoever makes a chain passes
// them on unread, so that a further one changes no program.
#pragma once

namespace axg {

class MarginAdvisory;
class SpeedAdvisory;
class StopCertificate;

/// Each must outlive the chain.
struct ChainParts {
    StopCertificate* stop_certificate = nullptr;  // null: contact mode, each pose by its margins
    SpeedAdvisory* speed_advisory = nullptr;      // null, or no certificate: no speed cap
    MarginAdvisory* margin_advisory = nullptr;    // null: no clearance levels
};

}  // namespace axg
