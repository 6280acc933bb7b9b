// SPDX-License-Identifier: Apache-2.0
// A machine with its engine at positions for measurements: random, at first contact, or at quarter
// turns where faces touch flat.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/certificate/pair_queries.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "firmware_if/setup/surface_list.hpp"
#include "hil_replay/lab/cases/draw.hpp"

namespace axg::chart {

class PosedMachine {
  public:
    PosedMachine(LoadedMachine loaded, CpuEngine engine)
        : loaded_(std::move(loaded)),
          surfaces_(surface_list(loaded_).engines),
          engine_(std::move(engine)) {}
    PosedMachine(const PosedMachine&) = delete;  // it points into itself
    PosedMachine& operator=(const PosedMachine&) = delete;

    /// Reads MACHINE and makes an engine with `capacities`. Null on failure, see `fault`.
    [[nodiscard]] static std::unique_ptr<PosedMachine> load(const std::string& file,
                                                            const Capacities& capacities,
                                                            std::string& fault);

    [[nodiscard]] const Machine& machine() const noexcept { return loaded_.machine; }
    /// The surface with this mesh number in queries.
    [[nodiscard]] const Mesh& mesh(std::uint32_t index) const noexcept { return *surfaces_[index]; }
    [[nodiscard]] CpuEngine& engine() noexcept { return engine_; }
    /// The cycle's queries at `snapshot`; valid until the next call.
    [[nodiscard]] PairQueries& pair_queries(const AxisSnapshot& snapshot);
    [[nodiscard]] std::string pair_name(std::uint32_t pair) const;

    [[nodiscard]] AxisSnapshot anywhere(lab::Draw& draw) const;
    /// Rotary axes at quarter turns, linear ones at whole millimetres; 0 if that leaves the travel.
    [[nodiscard]] AxisSnapshot square(lab::Draw& draw) const;
    /// Whether every checked pair is proven apart.
    [[nodiscard]] bool is_clear(const AxisSnapshot& snapshot);
    /// Moves from a clear position along a linear axis to the last double that is clear. Empty:
    /// the start is not clear, or the travel ends before a contact.
    [[nodiscard]] std::optional<AxisSnapshot> last_clear(AxisSnapshot snapshot, std::size_t axis,
                                                         bool upwards);
    [[nodiscard]] std::size_t some_linear_axis(lab::Draw& draw) const;
    /// Within travel; an endless axis within one turn.
    [[nodiscard]] double within_travel(std::size_t axis, double position) const;
    /// "X 1, Y 2": mm and degrees with 9 significant digits, to move there again.
    [[nodiscard]] std::string format_position(const AxisSnapshot& snapshot) const;

  private:
    LoadedMachine loaded_;
    std::vector<const Mesh*> surfaces_;
    CpuEngine engine_;
    PairQueries pair_queries_;
};

}  // namespace axg::chart
