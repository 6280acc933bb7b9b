// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/certify/prove_program.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include "hil_replay/certify/block_prover.hpp"

namespace axg {
namespace {

constexpr std::uint64_t kBlockSegments = 4096;
constexpr auto kProgressEvery = std::chrono::milliseconds(100);

/// A part of a task that one thread proves by itself.
struct Block {
    std::uint32_t task = 0;
    SegmentRange segments;
    std::vector<ProvenStretch> stretches{};
    std::vector<OpenStretch> open{};
    std::uint64_t boxes = 0, questions = 0;
};

std::vector<Block> blocks_of(const CertifyTasks& tasks, const ChordPath& path) {
    std::vector<Block> out;
    for (std::uint32_t task = 0; task < tasks.tasks.size(); ++task) {
        for (const SegmentRange& piece : pieces_of(path, tasks.tasks[task].tool)) {
            for (std::uint64_t first = piece.first; first < piece.end;) {
                const std::uint64_t end =
                    std::min(piece.end, (first / kBlockSegments + 1) * kBlockSegments);
                out.push_back({.task = task, .segments = {first, end}});
                first = end;
            }
        }
    }
    return out;
}

struct Provers {
    std::vector<CpuEngine> engines;
    std::vector<BlockProver> provers;
};

/// Proves all blocks; their order in time does not matter, for none sees another.
void run_blocks(Provers& provers, const CertifyTasks& tasks, const ProveOptions& options,
                std::vector<Block>& blocks) {
    std::atomic<std::size_t> next{0}, done{0};
    const auto work = [&](BlockProver& prover) {
        for (std::size_t i = next++; i < blocks.size(); i = next++) {
            Block& block = blocks[i];
            const std::uint64_t boxes = prover.boxes(), questions = prover.questions();
            prover.prove(tasks.tasks[block.task], block.task, block.segments, block.stretches,
                         block.open);
            block.boxes = prover.boxes() - boxes;
            block.questions = prover.questions() - questions;
            ++done;
        }
    };
    std::vector<std::jthread> threads;
    for (BlockProver& prover : provers.provers) {
        threads.emplace_back([&work, &prover] { work(prover); });
    }
    while (options.progress && done < blocks.size()) {
        options.progress(static_cast<double>(done) / static_cast<double>(blocks.size()));
        std::this_thread::sleep_for(kProgressEvery);
    }
}

AxisPositions position_of(const Machine& machine, const ChordPath& path, std::uint64_t node) {
    AxisPositions out{};
    for (std::uint32_t i = 0; i < path.axis_count; ++i) {
        out[i] = static_cast<double>(path.node(node, i)) * unit_of(machine.axes[i].kind);
    }
    return out;
}

/// The containment tests of one task: at the beginning of each proven row of stretches.
class RowJudge {
  public:
    RowJudge(const Machine& machine, const ChordPath& path, const CertifyTask& task,
             std::uint32_t place, const BlockProver& prover, Engine engine,
             const ContainmentTest& containment)
        : machine_(machine),
          path_(path),
          task_(task),
          place_(place),
          prover_(prover),
          engine_(engine),
          containment_(containment) {}

    /// Makes holes of the rows in which one body may be inside the other.
    std::vector<ProvenStretch> judge(const std::vector<SegmentRange>& pieces,
                                     std::vector<ProvenStretch> stretches,
                                     std::vector<OpenStretch>& open) const {
        std::vector<ProvenStretch> out;
        std::size_t piece = 0;
        for (std::size_t i = 0; i < stretches.size();) {
            while (stretches[i].at.begin >= pieces[piece].end * kPartsOfSegment) {
                ++piece;
            }
            if (stretches[i].is_hole) {
                out.push_back(std::move(stretches[i++]));
                continue;
            }
            std::size_t end = i;
            while (end < stretches.size() && !stretches[end].is_hole &&
                   stretches[end].at.begin < pieces[piece].end * kPartsOfSegment) {
                ++end;
            }
            const PathInterval row{stretches[i].at.begin, stretches[end - 1].at.end};
            if (is_outside(row.first_segment())) {
                std::move(stretches.begin() + static_cast<std::ptrdiff_t>(i),
                          stretches.begin() + static_cast<std::ptrdiff_t>(end),
                          std::back_inserter(out));
            } else {
                out.push_back({.at = row, .is_hole = true});
                open.push_back(inside(row));
            }
            i = end;
        }
        return out;
    }

  private:
    [[nodiscard]] bool is_outside(std::uint64_t node) const {
        const Query query =
            prover_.query_at(task_, position_of(machine_, path_, node), task_.task.margin_mm);
        QueryResult result;
        engine_({&query, 1}, {&result, 1});
        const ContainmentResult found = containment_.test(apart_pose(query, result));
        return found.status == QueryStatus::ok && found.containment == Containment::none;
    }

    [[nodiscard]] OpenStretch inside(const PathInterval& row) const {
        OpenStretch out;
        out.task = place_;
        out.first = row.first_segment();
        out.end = row.end_segment();
        out.reason = OpenReason::inside;
        for (std::uint32_t i = 0; i < path_.axis_count; ++i) {
            out.box.low[i] = out.box.high[i] = path_.node(out.first, i);
        }
        return out;
    }

    const Machine& machine_;
    const ChordPath& path_;
    const CertifyTask& task_;
    std::uint32_t place_;
    const BlockProver& prover_;
    Engine engine_;
    const ContainmentTest& containment_;
};

}  // namespace

std::vector<SegmentRange> pieces_of(const ChordPath& path, std::uint32_t tool) {
    std::vector<SegmentRange> out;
    const auto add = [&out](std::uint64_t first, std::uint64_t end) {
        if (first < end && !out.empty() && out.back().end == first) {
            out.back().end = end;
        } else if (first < end) {
            out.push_back({first, end});
        }
    };
    std::uint64_t begin = 0;
    for (const PathRun& run : path.runs) {
        const std::uint64_t end = begin + run.segments;
        if (tool == kNoIndex || tool == run.tool || run.first + run.last >= run.segments) {
            add(begin, end);
        } else {
            add(begin, begin + run.first);
            add(end - run.last, end);
        }
        begin = end;
    }
    return out;
}

ProgramProof prove_program(const LoadedMachine& loaded, const CertifyTasks& tasks,
                           const ChordPath& path, CpuEngine& engine,
                           const ContainmentTest& containment, const ProveOptions& options) {
    const Machine& machine = loaded.machine;
    const Tube tube(machine, path);
    Provers provers;
    provers.engines.reserve(options.threads);
    for (std::uint32_t i = 0; i < std::max(options.threads, 1U); ++i) {
        std::optional<CpuEngine> own = CpuEngine::over_trees(engine.trees(), machine.capacities);
        if (!own) {
            return {};
        }
        provers.engines.push_back(std::move(*own));
        provers.provers.emplace_back(machine, path, tube, provers.engines.back().engine(),
                                     engine.trees());
    }
    std::vector<Block> blocks = blocks_of(tasks, path);
    run_blocks(provers, tasks, options, blocks);

    ProgramProof out;
    out.tasks.resize(tasks.tasks.size());
    for (Block& block : blocks) {
        std::vector<ProvenStretch>& to = out.tasks[block.task];
        std::move(block.stretches.begin(), block.stretches.end(), std::back_inserter(to));
        for (const OpenStretch& open : block.open) {
            add_open(path, open, out.open);
        }
        out.boxes += block.boxes;
        out.questions += block.questions;
    }
    for (std::uint32_t i = 0; i < out.tasks.size(); ++i) {
        const CertifyTask& task = tasks.tasks[i];
        const RowJudge judge(machine, path, task, i, provers.provers.front(), engine.engine(),
                             containment);
        out.tasks[i] = judge.judge(pieces_of(path, task.tool), std::move(out.tasks[i]), out.open);
    }
    return out;
}

}  // namespace axg
