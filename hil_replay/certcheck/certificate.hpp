// SPDX-License-Identifier: Apache-2.0
// The claim of a certificate: the path with its runs, and the tube around it. Its proofs are read
// by the checker.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hil_replay/certcheck/model.hpp"
#include "hil_replay/certcheck/sections.hpp"

namespace axg::certcheck {

constexpr std::int64_t kParts = 256;  // places of a segment
constexpr int kEveryTool = -2;

/// Positions of the axes in units, bounds included.
struct AxisBox {
    std::array<std::int64_t, kAxesMax> low, high;
};

class Certificate {
  public:
    /// Reads all up to the first PAIR, which `sections` then opens next.
    /// @throws Refusal
    Certificate(const Model& model, Sections& sections, const Digest& model_sum);

    /// Hull of the tube over the path from `first` to `last`, in parts of segments; first < last.
    [[nodiscard]] AxisBox tube(std::uint64_t first, std::uint64_t last) const;
    [[nodiscard]] std::uint64_t segments() const { return tool_.size(); }
    [[nodiscard]] std::size_t runs() const { return run_first_.size(); }
    /// A task with this tool, or with none, counts in this segment.
    [[nodiscard]] bool counts(int tool, std::uint64_t segment) const {
        return tool < 0 || tool_[segment] == tool || tool_[segment] == kEveryTool;
    }
    [[nodiscard]] std::span<const std::int64_t> node(std::uint64_t index) const {
        return std::span(nodes_).subspan(index * axes_, axes_);
    }
    /// Segments whose run has this place in the list of tools; -1: none, kEveryTool: all count.
    [[nodiscard]] std::uint64_t segments_with(int tool) const {
        return static_cast<std::uint64_t>(std::ranges::count(tool_, tool));
    }
    /// "run 1, segment 17 (line 42)".
    [[nodiscard]] std::string place(std::uint64_t segment) const;

    std::string version;
    bool is_partial = false;
    std::vector<std::int64_t> delta, following;  // of each axis, units
    std::vector<std::pair<std::string, Digest>> references;

  private:
    void read_head(ByteReader in, const Model& model);
    void read_references(ByteReader in, const Digest& model_sum);
    void read_lines(ByteReader in);
    void read_path(ByteReader in, const Model& model);

    std::size_t axes_;
    std::vector<std::int64_t> nodes_;                   // all axes of node 0, of node 1, ...
    std::vector<std::uint8_t> speeds_;                  // up, down of each axis of each segment
    std::vector<std::array<std::int64_t, 256>> reach_;  // of each axis, by the byte of its speed
    std::vector<std::int32_t> tool_;                    // of each segment
    std::vector<std::uint64_t> run_first_;              // segments
    struct Lines {
        std::uint64_t end;  // segment
        std::int64_t line;
    };
    std::vector<Lines> lines_;
};

}  // namespace axg::certcheck
