// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/certcheck/check_task.hpp"

#include <utility>

namespace axg::certcheck {
namespace {

constexpr int kCutsMax = 24;
constexpr std::uint8_t kHole = 255, kCut = 128, kDirectionsMax = 64;

}  // namespace

TaskCheck::TaskCheck(const Model& model, const Certificate& certificate, std::size_t index)
    : model_(model),
      certificate_(certificate),
      task_(model.tasks[index]),
      index_(index),
      linkage_(model, task_) {}

std::string TaskCheck::name() const {
    const auto body = [&](std::size_t side) {
        return model_.bodies[static_cast<std::size_t>(task_.body[side])].name;
    };
    return "pair " + std::to_string(index_) + " (" + body(0) + ", " + body(1) +
           (task_.tool < 0 ? "" : ", " + model_.tools[static_cast<std::size_t>(task_.tool)]) + ")";
}

void TaskCheck::refuse(std::uint64_t segment, const std::string& why) const {
    throw Refusal{10,
                  in_.place() + ": " + name() + ", " + certificate_.place(segment) + ": " + why};
}

void TaskCheck::run(ByteReader in, std::map<std::uint32_t, Parts>& parts, Tally& tally) {
    in_ = std::move(in);
    in_.require(in_.number<std::uint32_t>() == index_, "the tasks are not in the model's order");
    for (std::size_t side = 0; side < 2; ++side) {
        const std::uint32_t whole = task_.whole[side];
        if (!parts.contains(whole)) {
            parts.emplace(whole, parts_of(model_.surfaces[whole].tree.triangles()));
        }
        parts_[side] = &parts.at(whole);
    }
    std::uint64_t first = 0;
    while (first < certificate_.segments()) {
        std::uint64_t last = first;
        while (last < certificate_.segments() && certificate_.counts(task_.tool, last)) {
            ++last;
        }
        if (last > first) {
            check_piece(first, last, tally);
        }
        first = last + 1;  // segment `last` does not count
    }
    in_.end();
}

/// Segments [first, last) in a row: stretches cover them exactly. The tube of stretches in a row is
/// connected, so containment there is what it is at their first node.
void TaskCheck::check_piece(std::uint64_t first, std::uint64_t last, Tally& tally) {
    std::uint64_t at = first * kParts;
    bool follows_proven = false;
    while (at < last * kParts) {
        const std::uint64_t parts = in_.varint(), segment = at / kParts;
        in_.require(parts > 0 && parts <= last * kParts - at, "a stretch leaves its piece");
        const auto head = in_.number<std::uint8_t>();
        if (head == kHole) {
            in_.require(at % kParts == 0 && parts % kParts == 0, "a hole of no whole segments");
            if (!certificate_.is_partial) {
                refuse(segment, "a hole, and the certificate is not marked as partial");
            }
            for (std::uint64_t i = segment; i < (at + parts) / kParts; ++i) {
                tally.is_hole[i] = true;
            }
        } else {
            const AxisBox box = certificate_.tube(at, at + parts);
            check_within(box, segment);
            check_tree(box, head, segment, tally);
            if (!follows_proven) {
                check_enclosure(segment);
                ++tally.places;
            }
        }
        follows_proven = head != kHole;
        at += parts;
    }
}

void TaskCheck::check_within(const AxisBox& box, std::uint64_t segment) const {
    for (std::size_t i = 0; i < model_.axes.size(); ++i) {
        const Axis& axis = model_.axes[i];
        const double most = static_cast<double>(std::max(-box.low[i], box.high[i])) * axis.unit;
        if (most > axis.within) {
            refuse(segment, "axis " + axis.name + " gets beyond what its errors are stated for");
        }
    }
}

/// Boxes in the order of the file: a box is cut into its lower and its upper half, or proven.
void TaskCheck::check_tree(const AxisBox& whole, std::uint8_t head, std::uint64_t segment,
                           Tally& tally) {
    struct Open {
        AxisBox box;
        int cuts;
    };
    std::vector<Open> open{{whole, 0}};
    while (!open.empty()) {
        const auto [box, cuts] = open.back();
        open.pop_back();
        if (head < kCut) {
            read_directions(head);
            check_box(box, segment);
            ++tally.boxes;
        } else {
            const std::size_t axis = head - kCut;
            in_.require(axis < model_.axes.size() && cuts < kCutsMax, "no such cut");
            AxisBox lower = box, upper = box;
            lower.high[axis] = upper.low[axis] =
                box.low[axis] + (box.high[axis] - box.low[axis]) / 2;
            open.push_back({upper, cuts + 1});
            open.push_back({lower, cuts + 1});
        }
        if (!open.empty()) {
            head = in_.number<std::uint8_t>();
        }
    }
}

void TaskCheck::read_directions(std::uint8_t count) {
    in_.require(count <= kDirectionsMax && (count > 0 || !directions_.empty()),
                "no such count of directions");
    if (count == 0) {
        return;
    }
    directions_.resize(count);
    for (Direction& direction : directions_) {
        for (float& value : direction) {
            value = static_cast<float>(
                in_.within<float>(-1e9, 1e9, "a direction is not finite, or too long"));
        }
    }
}

void TaskCheck::check_box(const AxisBox& box, std::uint64_t segment) {
    std::array<double, kAxesMax> centre{}, half{};
    for (std::size_t i = 0; i < model_.axes.size(); ++i) {  // below 2^47: exact
        centre[i] = static_cast<double>(box.low[i] + box.high[i]) / 2;
        half[i] = static_cast<double>(box.high[i] - box.low[i]) / 2;
    }
    linkage_.place(centre);
    const Interval needed = Interval(task_.margin) + task_.error + linkage_.motion(half);
    const std::string why = not_separated(
        {model_.surfaces[task_.surface[0]].tree, linkage_.pose(0)},
        {model_.surfaces[task_.surface[1]].tree, linkage_.pose(1)}, directions_, needed.high);
    if (!why.empty()) {
        refuse(segment, why);
    }
}

void TaskCheck::check_enclosure(std::uint64_t segment) {
    std::array<double, kAxesMax> at{};
    const auto node = certificate_.node(segment);
    std::copy(node.begin(), node.end(), at.begin());
    linkage_.place(at);
    for (std::size_t side = 0; side < 2; ++side) {
        if (!is_outside(*parts_[side], linkage_.pose(side), *parts_[1 - side],
                        linkage_.pose(1 - side))) {
            refuse(segment, "a part of one body is not surely outside the other at its first node");
        }
    }
}

}  // namespace axg::certcheck
