// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/certcheck/certificate.hpp"

#include <algorithm>

#include "hil_replay/certcheck/stop_reach.hpp"

namespace axg::certcheck {

Certificate::Certificate(const Model& model, Sections& sections, const Digest& model_sum)
    : axes_(model.axes.size()) {
    read_head(sections.open("HEAD"), model);
    read_references(sections.open("REFS"), model_sum);
    read_lines(sections.open("LINE"));
    read_path(sections.open("PATH"), model);
    reach_.resize(axes_);
    for (std::size_t axis = 0; model.is_independent && axis < axes_; ++axis) {
        for (int speed = 0; speed < 256; ++speed) {
            reach_[axis][static_cast<std::size_t>(speed)] =
                stop_reach(model, model.axes[axis], following[axis], speed);
        }
    }
}

void Certificate::read_head(ByteReader in, const Model& model) {
    in.require(in.number<std::uint32_t>() == 1, "the format is not 1");
    version = in.text();
    if ((in.within<std::uint8_t>(0, 1, "no such promise") == 0) != model.is_independent) {
        throw Refusal{10, in.place() + ": the promise is not the model's"};
    }
    is_partial = in.within<std::uint8_t>(0, 1, "partial: expected 0 or 1") == 1;
    in.require(in.number<std::uint32_t>() == axes_, "the number of axes is not the model's");
    for (const Axis& axis : model.axes) {
        delta.push_back(in.number<std::int64_t>());
        following.push_back(in.number<std::int64_t>());
        in.require(
            delta.back() >= 0 && delta.back() <= kPositionMax && following.back() <= kPositionMax,
            "delta or f is out of range");
        if (following.back() < axis.following) {
            throw Refusal{10, in.place() + ": f of axis " + axis.name + " is below the model's"};
        }
    }
    in.end();
}

void Certificate::read_references(ByteReader in, const Digest& model_sum) {
    const std::array<const char*, 4> names{"model", "machine", "program", "arguments"};
    in.require(in.number<std::uint32_t>() == names.size(), "expected four references");
    for (const char* name : names) {
        in.require(in.text() == name, ("expected the reference " + std::string(name)).c_str());
        Digest sum;
        std::ranges::copy(in.take(sum.size()), sum.begin());
        references.emplace_back(name, sum);
    }
    if (references[0].second != model_sum) {
        throw Refusal{10, in.place() + ": the certificate belongs to another model"};
    }
    in.end();
}

void Certificate::read_lines(ByteReader in) {
    Lines lines{0, 0};
    while (in.left() > 0) {
        const std::uint64_t count = in.varint();
        in.require(count > 0 && count <= (std::uint64_t{1} << 40), "no such count of segments");
        const std::int64_t step = in.zigzag();
        in.require(std::abs(step) <= kPositionMax, "a line is out of range");
        lines.end += count;
        lines.line += step;
        in.require(
            lines.line >= 0 && lines.line <= kPositionMax && lines.end <= (std::uint64_t{1} << 40),
            "a line is out of range");
        lines_.push_back(lines);
    }
}

void Certificate::read_path(ByteReader in, const Model& model) {
    const auto runs = in.number<std::uint32_t>();
    for (std::uint32_t run = 0; run < runs; ++run) {
        const auto tool = in.number<std::int32_t>();
        in.require(tool >= -1 && tool < static_cast<int>(model.tools.size()), "no such tool");
        const std::uint64_t segments = in.varint(), first = in.varint(), last = in.varint();
        in.require(first <= segments && last <= segments, "first or last exceeds the segments");
        in.require(segments <= in.left() && tool_.size() + segments <= in.left(),
                   "the section ends too early");
        run_first_.push_back(tool_.size());
        tool_.resize(tool_.size() + segments, tool);
        std::fill_n(tool_.end() - static_cast<std::int64_t>(segments), first, kEveryTool);
        std::fill_n(tool_.end() - static_cast<std::int64_t>(last), last, kEveryTool);
    }
    in.require(!tool_.empty() && !lines_.empty() && lines_.back().end == tool_.size(),
               "LINE has another number of segments than PATH, or there is none");
    std::vector<std::int64_t> at(axes_);
    for (std::size_t i = 0; i <= tool_.size(); ++i) {
        for (std::int64_t& position : at) {
            const std::int64_t step = in.zigzag();
            in.require(std::abs(step) <= 2 * kPositionMax, "a position is out of range");
            position += step;
            in.require(std::abs(position) <= kPositionMax, "a position is out of range");
        }
        nodes_.insert(nodes_.end(), at.begin(), at.end());
    }
    if (model.is_independent) {
        const auto speeds = in.take(2 * axes_ * tool_.size());
        speeds_.assign(speeds.begin(), speeds.end());
    }
    in.end();
}

AxisBox Certificate::tube(std::uint64_t first, std::uint64_t last) const {
    AxisBox box;
    box.low.fill(std::numeric_limits<std::int64_t>::max());
    box.high.fill(std::numeric_limits<std::int64_t>::min());
    for (std::uint64_t i = first / kParts; i * kParts < last; ++i) {
        const std::int64_t from = first > i * kParts ? first - i * kParts : 0;
        const std::int64_t to = std::min<std::uint64_t>(last - i * kParts, kParts);
        for (std::size_t axis = 0; axis < axes_; ++axis) {
            const std::int64_t start = nodes_[i * axes_ + axis];
            const std::int64_t way = nodes_[(i + 1) * axes_ + axis] - start;
            // Shifts of negative numbers round down (C++20).
            const std::int64_t least = std::min(way * from, way * to) >> 8;
            const std::int64_t most = -(-std::max(way * from, way * to) >> 8);
            std::int64_t up = delta[axis] + following[axis], down = up;
            if (!speeds_.empty()) {
                up += reach_[axis][speeds_[(i * axes_ + axis) * 2]];
                down += reach_[axis][speeds_[(i * axes_ + axis) * 2 + 1]];
            }
            box.low[axis] = std::min(box.low[axis], start + least - down);
            box.high[axis] = std::max(box.high[axis], start + most + up);
        }
    }
    return box;
}

std::string Certificate::place(std::uint64_t segment) const {
    const auto run = std::ranges::upper_bound(run_first_, segment) - run_first_.begin() - 1;
    const auto lines = std::ranges::upper_bound(lines_, segment, {}, &Lines::end);
    return "run " + std::to_string(run) + ", segment " + std::to_string(segment) + " (line " +
           std::to_string(lines->line) + ")";
}

}  // namespace axg::certcheck
