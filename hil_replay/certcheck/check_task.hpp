// SPDX-License-Identifier: Apache-2.0
// One task of a model: its PAIR section read and judged.
#pragma once

#include <map>

#include "hil_replay/certcheck/certificate.hpp"
#include "hil_replay/certcheck/enclosure.hpp"
#include "hil_replay/certcheck/linkage.hpp"
#include "hil_replay/certcheck/separation.hpp"

namespace axg::certcheck {

struct Tally {
    std::uint64_t boxes = 0, places = 0;  // places: containment judged
    std::vector<bool> is_hole;            // of each segment, for any task
};

class TaskCheck {
  public:
    TaskCheck(const Model& model, const Certificate& certificate, std::size_t index);
    /// @throws Refusal where the section does not prove all pieces of the task
    void run(ByteReader in, std::map<std::uint32_t, Parts>& parts, Tally& tally);
    [[nodiscard]] std::string name() const;

  private:
    void check_piece(std::uint64_t first, std::uint64_t last, Tally& tally);
    void check_within(const AxisBox& box, std::uint64_t segment) const;
    void check_tree(const AxisBox& whole, std::uint8_t head, std::uint64_t segment, Tally& tally);
    void check_box(const AxisBox& box, std::uint64_t segment);
    void check_enclosure(std::uint64_t segment);
    void read_directions(std::uint8_t count);
    [[noreturn]] void refuse(std::uint64_t segment, const std::string& why) const;

    const Model& model_;
    const Certificate& certificate_;
    const Task& task_;
    std::size_t index_;
    Linkage linkage_;
    std::array<const Parts*, 2> parts_{};
    ByteReader in_;
    std::vector<Direction> directions_;
};

}  // namespace axg::certcheck
