// SPDX-License-Identifier: Apache-2.0
#include "core/collision/tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>

#include "core/base/assert.hpp"
#include "core/base/finite.hpp"

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

/// a - b, or the next double above it if the subtraction rounded down (by Knuth's two-sum).
double difference_up(double a, double b) noexcept {
    const double d = a - b;
    const double minus_b = d - a;
    const double lost = (a - (d - minus_b)) + (-b - minus_b);
    return lost > 0 ? std::nextafter(d, std::numeric_limits<double>::infinity()) : d;
}

Aabb box_of(const Bounds& b) noexcept {
    Aabb box{};
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

class Grouper {
  public:
    Grouper(std::span<const Triangle> triangles, bool medians_only)
        : medians_only_(medians_only), bounds_(triangles.size()) {
        std::transform(triangles.begin(), triangles.end(), bounds_.begin(), bounds_of);
    }

    TreeShape group() {
        std::vector<std::uint32_t> order(bounds_.size());
        std::iota(order.begin(), order.end(), 0U);
        add_node(order);
        return std::move(shape_);
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

    /// At most 32 groups. First cuts the groups that would not fit below a child, then those with
    /// the largest areas.
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

    void add_node(Indices items) {
        if (items.size() <= kNodeWidth) {
            std::sort(items.begin(), items.end());
            shape_.nodes.push_back(static_cast<std::uint8_t>(kLeafMark | items.size()));
            shape_.triangles.insert(shape_.triangles.end(), items.begin(), items.end());
            return;
        }
        const std::vector<Group> groups = split(items);
        shape_.nodes.push_back(static_cast<std::uint8_t>(groups.size()));
        for (const Group& group : groups) {
            add_node(group.items);
        }
    }

    bool medians_only_;
    std::vector<Bounds> bounds_;
    std::vector<double> above_;
    TreeShape shape_;
};

/// Follows a shape from node to node, and writes the boxes from the leaves up.
class Raiser {
  public:
    Raiser(const TreeShape& shape, std::span<const Triangle> triangles, std::span<TreeNode> nodes,
           std::span<TreeLeaf> leaves) noexcept
        : shape_(shape), triangles_(triangles), nodes_(nodes), leaves_(leaves) {}

    void raise_all() noexcept {
        (void)raise_node(0);
        AXG_ASSERT(read_ == nodes_.size() && next_leaf_ == leaves_.size());
    }

  private:
    static void set_child(TreeNode& node, std::uint32_t i, const Aabb& box) noexcept {
        for (int k = 0; k < 3; ++k) {
            node.c[k][i] = box.c[k];
            node.h[k][i] = box.h[k];
        }
    }

    Bounds raise_node(std::uint32_t index) noexcept {
        const std::uint8_t code = shape_.nodes[read_++];
        TreeNode& node = nodes_[index];
        node = TreeNode{};
        for (int k = 0; k < 3; ++k) {
            std::fill_n(node.c[k], kNodeWidth, kFarAway);
        }
        node.leaf = kNoLeaf;
        Bounds bounds;
        if ((code & kLeafMark) != 0) {
            node.count = code - kLeafMark;
            bounds = raise_leaf(node);
        } else {
            node.count = code;
            node.first_child = next_node_;
            next_node_ += node.count;
            AXG_ASSERT(next_node_ <= nodes_.size());
            for (std::uint32_t i = 0; i < node.count; ++i) {
                const Bounds child = raise_node(node.first_child + i);
                set_child(node, i, box_of(child));
                bounds.add(child);
            }
        }
        node.box = box_of(bounds);
        return bounds;
    }

    Bounds raise_leaf(TreeNode& node) noexcept {
        node.leaf = next_leaf_++;
        TreeLeaf& leaf = leaves_[node.leaf];
        const std::span<const std::uint32_t> items =
            std::span(shape_.triangles).subspan(next_triangle_, node.count);
        next_triangle_ += node.count;
        Bounds bounds;
        for (std::uint32_t i = 0; i < kNodeWidth; ++i) {
            const std::uint32_t item = items[i < node.count ? i : 0];
            const Triangle& t = triangles_[item];
            if (i < node.count) {
                const Bounds one = bounds_of(t);
                set_child(node, i, box_of(one));
                bounds.add(one);
            }
            leaf.triangle[i] = item;
            const float v[9] = {t.a.x, t.a.y, t.a.z, t.b.x, t.b.y, t.b.z, t.c.x, t.c.y, t.c.z};
            for (int k = 0; k < 9; ++k) {
                leaf.v[k][i] = v[k];
            }
        }
        node.more = corners_of(leaf).count == 0 ? kMoreForVertices : 0;
        return bounds;
    }

    const TreeShape& shape_;
    std::span<const Triangle> triangles_;
    std::span<TreeNode> nodes_;
    std::span<TreeLeaf> leaves_;
    std::size_t read_ = 0, next_triangle_ = 0;
    std::uint32_t next_node_ = 1, next_leaf_ = 0;
};

/// Tree levels of a shape; 0: its nodes are no tree, or one that is too deep.
std::uint32_t depth_of(const std::vector<std::uint8_t>& nodes) noexcept {
    std::array<std::uint32_t, kTreeDepthMax> open{1};  // children still to come, on each level
    std::uint32_t tree_level = 1, depth = 0;
    for (const std::uint8_t code : nodes) {
        while (tree_level != 0 && open[tree_level - 1] == 0) {
            --tree_level;
        }
        const std::uint32_t count = code & ~kLeafMark;
        const bool is_leaf = (code & kLeafMark) != 0;
        if (tree_level == 0 || count == 0 || count > kNodeWidth ||
            (!is_leaf && tree_level == kTreeDepthMax)) {
            return 0;
        }
        --open[tree_level - 1];
        depth = std::max(depth, tree_level);
        if (!is_leaf) {
            open[tree_level++] = count;
        }
    }
    const bool is_whole = std::all_of(open.begin(), open.begin() + tree_level,
                                      [](std::uint32_t n) { return n == 0; });
    return is_whole ? depth : 0;
}

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

TreeShape group_triangles(std::span<const Triangle> triangles) {
    AXG_ASSERT(!triangles.empty() && triangles.size() <= kTrianglesMax);
    TreeShape shape = Grouper(triangles, false).group();
    if (depth_of(shape.nodes) ==
        0) {  // a geometric chain: halves are never deeper than five levels
        shape = Grouper(triangles, true).group();
    }
    AXG_ASSERT(depth_of(shape.nodes) != 0);
    return shape;
}

TreeShape shape_of(const Mesh& mesh) {
    return mesh.shape.triangles.size() == mesh.triangles.size() ? mesh.shape
                                                                : group_triangles(mesh.triangles);
}

bool is_sound(const TreeShape& shape, std::size_t triangle_count) {
    if (depth_of(shape.nodes) == 0 || shape.triangles.size() != triangle_count) {
        return false;
    }
    std::size_t held = 0;
    for (const std::uint8_t code : shape.nodes) {
        held += (code & kLeafMark) != 0 ? code - kLeafMark : 0;
    }
    std::vector<std::uint8_t> is_held(triangle_count, 0);
    for (const std::uint32_t triangle : shape.triangles) {
        if (triangle >= triangle_count || is_held[triangle] != 0) {
            return false;
        }
        is_held[triangle] = 1;
    }
    return held == triangle_count;
}

TreeSize size_of(const TreeShape& shape) noexcept {
    const auto leaves = std::count_if(shape.nodes.begin(), shape.nodes.end(),
                                      [](std::uint8_t code) { return (code & kLeafMark) != 0; });
    return {shape.nodes.size(), static_cast<std::size_t>(leaves), depth_of(shape.nodes)};
}

void raise_tree(const TreeShape& shape, std::span<const Triangle> triangles,
                std::span<TreeNode> nodes, std::span<TreeLeaf> leaves) noexcept {
    AXG_ASSERT(shape.triangles.size() == triangles.size());
    Raiser(shape, triangles, nodes, leaves).raise_all();
}

namespace {

TreeData tree_of(const TreeShape& shape, std::span<const Triangle> triangles) {
    const TreeSize size = size_of(shape);
    TreeData tree{std::vector<TreeNode>(size.nodes), std::vector<TreeLeaf>(size.leaves),
                  size.depth};
    raise_tree(shape, triangles, tree.nodes, tree.leaves);
    return tree;
}

}  // namespace

TreeData build_tree(std::span<const Triangle> triangles) {
    return tree_of(group_triangles(triangles), triangles);
}

TreeData build_tree(const Mesh& mesh) {
    return tree_of(shape_of(mesh), mesh.triangles);
}

namespace {

void put(LeafCorners& corners, unsigned at, const float (&p)[3]) noexcept {
    for (unsigned k = 0; k < 3; ++k) {
        corners.v[k][at] = p[k];
    }
}

/// Compares bit by bit, so that -0 is not 0. Returns count if p is not listed.
unsigned find(const LeafCorners& corners, const float (&p)[3]) noexcept {
    const auto bits = [](float x) { return __builtin_bit_cast(std::uint32_t, x); };
    for (unsigned at = 0; at < corners.count; ++at) {
        if (bits(corners.v[0][at]) == bits(p[0]) && bits(corners.v[1][at]) == bits(p[1]) &&
            bits(corners.v[2][at]) == bits(p[2])) {
            return at;
        }
    }
    return corners.count;
}

}  // namespace

LeafCorners corners_of(const TreeLeaf& leaf) noexcept {
    LeafCorners corners{};
    for (unsigned triangle = 0; triangle < kNodeWidth; ++triangle) {
        for (unsigned vertex = 0; vertex < 3; ++vertex) {
            const float p[3] = {leaf.v[3 * vertex][triangle], leaf.v[3 * vertex + 1][triangle],
                                leaf.v[3 * vertex + 2][triangle]};
            const unsigned at = find(corners, p);
            if (at == kNodeWidth) {
                return {};
            }
            if (at == corners.count) {
                put(corners, corners.count++, p);
            }
            corners.at[vertex][triangle] = static_cast<std::uint8_t>(at);
        }
    }
    const float first[3] = {corners.v[0][0], corners.v[1][0], corners.v[2][0]};
    for (unsigned at = corners.count; at < kNodeWidth; ++at) {
        put(corners, at, first);
    }
    return corners;
}

}  // namespace axg
