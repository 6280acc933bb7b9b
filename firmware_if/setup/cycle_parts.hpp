// SPDX-License-Identifier: Apache-2.0
// Parts of a guard's chain other than engine and containment test: certificate, and the advisories
// of the permit.
#pragma once

#include <optional>

#include "core/certificate/stop_certificate.hpp"
#include "core/guard/chain_parts.hpp"
#include "core/guard/margin_advisory.hpp"
#include "core/guard/speed_advisory.hpp"
#include "firmware_if/setup/loaded_machine.hpp"

namespace axg {

class CycleParts {
  public:
    /// `loaded` must outlive it.
    /// @param is_stoppable  false: contact mode, which has neither certificate nor speed cap
    CycleParts(const LoadedMachine& loaded, bool is_stoppable)
        : CycleParts(loaded, is_stoppable, loaded.machine.guard.speed_cap) {}
    CycleParts(const LoadedMachine& loaded, bool is_stoppable, bool wants_cap);

    /// False: memory ran out (kNoMemoryForProofs).
    [[nodiscard]] bool has_memory() const noexcept { return has_memory_; }
    /// For a GuardChain.
    [[nodiscard]] ChainParts chain() noexcept {
        return {stop_certificate(), speed_advisory(), margin_advisory()};
    }
    // Null: there is none.
    [[nodiscard]] StopCertificate* stop_certificate() noexcept { return at(stop_certificate_); }
    [[nodiscard]] SpeedAdvisory* speed_advisory() noexcept { return at(speed_advisory_); }
    [[nodiscard]] MarginAdvisory* margin_advisory() noexcept { return at(margin_advisory_); }

  private:
    template <class Part>
    [[nodiscard]] static Part* at(std::optional<Part>& part) noexcept {
        return part ? &*part : nullptr;
    }

    std::optional<StopCertificate> stop_certificate_;
    std::optional<SpeedAdvisory> speed_advisory_;
    std::optional<MarginAdvisory> margin_advisory_;
    bool has_memory_;
};

}  // namespace axg
