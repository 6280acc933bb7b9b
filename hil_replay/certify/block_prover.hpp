// SPDX-License-Identifier: Apache-2.0
// Proves one pair over a row of segments: the part of prove_program that a thread does.
#pragma once

#include <optional>

#include "hil_replay/certify/prove_program.hpp"
#include "hil_replay/certify/witness_walk.hpp"

namespace axg {

// Beyond what a proof needs, for the rounding of whoever checks it.
inline constexpr double kSlackMm = 0x1p-10;

class BlockProver {
  public:
    /// All must outlive it. Each thread has its own engine, over the same trees.
    BlockProver(const Machine& machine, const ChordPath& path, const Tube& tube, Engine engine,
                std::span<const Tree> trees)
        : machine_(machine), path_(path), tube_(tube), engine_(engine), trees_(trees) {}

    /// Adds the stretches of these segments, and those that stay open.
    void prove(const CertifyTask& task, std::uint32_t place, const SegmentRange& segments,
               std::vector<ProvenStretch>& out, std::vector<OpenStretch>& open);

    /// The position as a query about this pair.
    [[nodiscard]] Query query_at(const CertifyTask& task, const AxisPositions& position,
                                 double r_mm) const noexcept;
    [[nodiscard]] std::uint64_t questions() const noexcept { return questions_; }
    [[nodiscard]] std::uint64_t boxes() const noexcept { return boxes_; }

  private:
    /// A box, and the query that proves it.
    struct Question {
        Query query;
        std::uint32_t widest_axis = kNoIndex;
        double motion_mm = 0;
        bool is_within = false;
    };
    [[nodiscard]] Question question(const UnitBox& box) const noexcept;
    [[nodiscard]] bool is_far(const Query& query) noexcept;
    bool prove_box(const UnitBox& box, Question& asked, std::string& tree);
    bool prove_witness(const Query& query, std::string& tree);
    void prove_range(const SegmentRange& segments);
    bool prove_segment(std::uint64_t segment);
    bool prove_parts(const UnitBox& box, std::string& tree);
    [[nodiscard]] bool is_chord_long(const PathInterval& part, const Question& whole) const;
    void leave_open(std::uint64_t segment);

    const Machine& machine_;
    const ChordPath& path_;
    const Tube& tube_;
    Engine engine_;
    std::span<const Tree> trees_;
    WitnessWalk walk_;

    const CertifyTask* task_ = nullptr;
    std::uint32_t place_ = 0;
    Directions before_;  // of the proven box before; empty: none
    std::vector<ProvenStretch>* out_ = nullptr;
    std::vector<OpenStretch>* open_ = nullptr;
    std::uint32_t left_ = 0;  // questions that the segment may still ask
    std::uint64_t questions_ = 0, boxes_ = 0;
};

/// Joins an open segment to the one before it, where line, pair and reason are the same.
void add_open(const ChordPath& path, const OpenStretch& next, std::vector<OpenStretch>& open);

}  // namespace axg
