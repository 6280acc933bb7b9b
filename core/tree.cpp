// SPDX-License-Identifier: Apache-2.0
#include "core/tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>

#include "core/assert.hpp"
#include "core/finite.hpp"

namespace axg {

namespace {

constexpr float kFarAway = 1.0e30F;  // centre of the boxes that pad a node: apart from everything
constexpr std::uint32_t kLeafGoal = 8;  // groups this small are not split further for their area

using Indices = std::span<std::uint32_t>;

struct Bounds {
    float low[3] = {std::numeric_limits<float>::max(), std::numeric_limits<float>::max(),
                    std::numeric_limits<float>::max()};
    float high[3] = {std::numeric_limits<float>::lowest(), std::numeric_limits<float>::lowest(),
                     std::numeric_limits<float>::lowest()};

    void add(const Bounds& other) noexcept {
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], other.low[k]);
            high[k] = std::max(high[k], other.high[k]);
        }
    }
    [[nodiscard]] double half_area() const noexcept {
        const double x = double(high[0]) - low[0], y = double(high[1]) - low[1],
                     z = double(high[2]) - low[2];
        return x * y + y * z + z * x;
    }
};

Bounds bounds_of(const Triangle& t) noexcept {
    Bounds b;
    const auto take = [&b](const Vec3f& v) {
        const float p[3] = {v.x, v.y, v.z};
        for (int k = 0; k < 3; ++k) {
            b.low[k] = std::min(b.low[k], p[k]);
            b.high[k] = std::max(b.high[k], p[k]);
        }
    };
    take(t.a);
    take(t.b);
    take(t.c);
    return b;
}

float rounded_up(double d) noexcept {
    const float f = static_cast<float>(d);
    return static_cast<double>(f) < d ? std::nextafter(f, std::numeric_limits<float>::max()) : f;
}

/// a - b, or the next double above it where the subtraction lost something (Knuth's two-sum tells).
double difference_up(double a, double b) noexcept {
    const double d = a - b;
    const double minus_b = d - a;
    const double lost = (a - (d - minus_b)) + (-b - minus_b);
    return lost > 0 ? std::nextafter(d, std::numeric_limits<double>::infinity()) : d;
}

Box box_of(const Bounds& b) noexcept {
    Box box{};
    for (int k = 0; k < 3; ++k) {
        box.c[k] = static_cast<float>(0.5 * (double(b.low[k]) + double(b.high[k])));
        const double c = box.c[k];
        box.h[k] = rounded_up(std::max(difference_up(b.high[k], c), difference_up(c, b.low[k])));
    }
    return box;
}

struct Group {
    Indices items;
    Bounds bounds;
};

class Builder {
  public:
    Builder(std::span<const Triangle> triangles, bool medians_only)
        : triangles_(triangles), medians_only_(medians_only), bounds_(triangles.size()) {
        std::transform(triangles.begin(), triangles.end(), bounds_.begin(), bounds_of);
    }

    TreeData build() {
        std::vector<std::uint32_t> order(triangles_.size());
        std::iota(order.begin(), order.end(), 0U);
        data_.nodes.emplace_back();
        fill_node(0, order, 1);
        return std::move(data_);
    }

  private:
    [[nodiscard]] Bounds bounds_of_items(Indices items) const {
        Bounds b;
        for (const std::uint32_t i : items) {
            b.add(bounds_[i]);
        }
        return b;
    }

    void sort_along(Indices items, int axis) const {
        std::sort(items.begin(), items.end(), [&](std::uint32_t a, std::uint32_t b) {
            const double ca = double(bounds_[a].low[axis]) + double(bounds_[a].high[axis]);
            const double cb = double(bounds_[b].low[axis]) + double(bounds_[b].high[axis]);
            return ca != cb ? ca < cb : a < b;
        });
    }

    struct Cut {
        double cost = std::numeric_limits<double>::infinity();
        int axis = 0;
        std::size_t at = 0;
    };

    /// The cheapest cut of `items`, each side at least `least` items.
    [[nodiscard]] Cut best_cut(Indices items, std::size_t least) {
        Cut best;
        for (int axis = 0; axis < 3; ++axis) {
            sort_along(items, axis);
            above_.resize(items.size());
            Bounds b;
            for (std::size_t i = items.size(); i-- > 1;) {
                b.add(bounds_[items[i]]);
                above_[i] = b.half_area();
            }
            Bounds below;
            for (std::size_t i = 1; i < items.size(); ++i) {
                below.add(bounds_[items[i - 1]]);
                if (i < least || items.size() - i < least) {
                    continue;
                }
                const double cost = below.half_area() * static_cast<double>(i) +
                                    above_[i] * static_cast<double>(items.size() - i);
                if (cost < best.cost) {
                    best = {cost, axis, i};
                }
            }
        }
        return best;
    }

    [[nodiscard]] std::size_t cut(Indices items, std::size_t least) {
        if (medians_only_) {
            const Bounds b = bounds_of_items(items);
            int axis = 0;
            for (int k = 1; k < 3; ++k) {
                if (b.high[k] - b.low[k] > b.high[axis] - b.low[axis]) {
                    axis = k;
                }
            }
            sort_along(items, axis);
            return items.size() / 2;
        }
        const Cut best = best_cut(items, least);
        sort_along(items, best.axis);
        return best.at;
    }

    /// At most 32 groups. First everything that would not fit below a child is cut, then the
    /// largest areas.
    [[nodiscard]] std::vector<Group> split(Indices items) {
        std::size_t fits = kNodeWidth;  // what one child can hold on the fewest further levels
        while (fits * kNodeWidth < items.size()) {
            fits *= kNodeWidth;
        }
        std::vector<Group> groups{{items, bounds_of_items(items)}};
        while (groups.size() < kNodeWidth) {
            const auto weight = [fits](const Group& g) {
                const auto n = static_cast<double>(g.items.size());
                return g.items.size() > fits ? 1e30 * n : g.bounds.half_area() * n;
            };
            std::size_t pick = groups.size();
            for (std::size_t i = 0; i < groups.size(); ++i) {
                const bool large = groups[i].items.size() > kLeafGoal;
                if (large && (pick == groups.size() || weight(groups[i]) > weight(groups[pick]))) {
                    pick = i;
                }
            }
            if (pick == groups.size()) {
                break;
            }
            const Indices whole = groups[pick].items;
            const std::size_t least =
                whole.size() > fits ? std::max<std::size_t>(1, whole.size() / 8) : 1;
            const std::size_t at = cut(whole, least);
            groups[pick] = {whole.first(at), bounds_of_items(whole.first(at))};
            groups.push_back({whole.subspan(at), bounds_of_items(whole.subspan(at))});
        }
        return groups;
    }

    void set_child(TreeNode& node, std::uint32_t i, const Box& box) const noexcept {
        for (int k = 0; k < 3; ++k) {
            node.c[k][i] = box.c[k];
            node.h[k][i] = box.h[k];
        }
    }

    void fill_node(std::uint32_t index, Indices items, std::uint32_t depth) {
        data_.depth = std::max(data_.depth, depth);
        TreeNode node{};
        for (int k = 0; k < 3; ++k) {
            std::fill_n(node.c[k], kNodeWidth, kFarAway);
        }
        node.box = box_of(bounds_of_items(items));
        node.leaf = kNoLeaf;
        if (items.size() <= kNodeWidth) {
            fill_leaf(node, items);
            data_.nodes[index] = node;
            return;
        }
        const std::vector<Group> groups = split(items);
        node.count = static_cast<std::uint32_t>(groups.size());
        node.first_child = static_cast<std::uint32_t>(data_.nodes.size());
        data_.nodes.resize(data_.nodes.size() + groups.size());
        for (std::uint32_t i = 0; i < node.count; ++i) {
            set_child(node, i, box_of(groups[i].bounds));
        }
        data_.nodes[index] = node;
        for (std::uint32_t i = 0; i < node.count; ++i) {
            fill_node(node.first_child + i, groups[i].items, depth + 1);
        }
    }

    void fill_leaf(TreeNode& node, Indices items) {
        std::sort(items.begin(), items.end());
        TreeLeaf leaf{};
        node.count = static_cast<std::uint32_t>(items.size());
        node.leaf = static_cast<std::uint32_t>(data_.leaves.size());
        for (std::uint32_t i = 0; i < kNodeWidth; ++i) {
            const std::uint32_t item = items[i < node.count ? i : 0];
            const Triangle& t = triangles_[item];
            if (i < node.count) {
                set_child(node, i, box_of(bounds_[item]));
            }
            leaf.triangle[i] = item;
            const float v[9] = {t.a.x, t.a.y, t.a.z, t.b.x, t.b.y, t.b.z, t.c.x, t.c.y, t.c.z};
            for (int k = 0; k < 9; ++k) {
                leaf.v[k][i] = v[k];
            }
        }
        data_.leaves.push_back(leaf);
    }

    std::span<const Triangle> triangles_;
    bool medians_only_;
    std::vector<Bounds> bounds_;
    std::vector<double> above_;
    TreeData data_;
};

}  // namespace

float reach_of(const Mesh& mesh) noexcept {
    float reach = 0;
    for (const Triangle& t : mesh.triangles) {
        for (const Vec3f& v : {t.a, t.b, t.c}) {
            reach = std::max({reach, std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
        }
    }
    return reach;
}

bool has_usable_triangles(const Mesh& mesh) noexcept {
    const auto fits = [](float x) { return is_finite(x) && std::fabs(x) <= kCoordinateMmMax; };
    const auto is_inside = [&fits](const Vec3f& v) { return fits(v.x) && fits(v.y) && fits(v.z); };
    return !mesh.triangles.empty() &&
           std::all_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const Triangle& t) {
               return is_inside(t.a) && is_inside(t.b) && is_inside(t.c);
           });
}

TreeData build_tree(std::span<const Triangle> triangles) {
    AXG_ASSERT(!triangles.empty() && triangles.size() <= kTrianglesMax);
    TreeData data = Builder(triangles, false).build();
    if (data.depth >
        kTreeDepthMax) {  // a geometric chain: halves are never deeper than five levels
        data = Builder(triangles, true).build();
    }
    AXG_ASSERT(data.depth <= kTreeDepthMax);
    return data;
}

}  // namespace axg
