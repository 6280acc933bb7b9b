// SPDX-License-Identifier: Apache-2.0
#include "core/worst_case/tree_maker.hpp"

namespace axg {
namespace {

std::array<float, 9> moved(const float (&shape)[9], float x, float y, float z) {
    std::array<float, 9> v{};
    for (unsigned k = 0; k < 9; ++k) {
        v[k] = shape[k] + (k % 3 == 0 ? x : k % 3 == 1 ? y : z);
    }
    return v;
}

/// Corners of a square for leaves of which no two triangles are near: a's on one diagonal, b's on
/// the other. Tiny triangles, 5 mm apart.
std::array<float, 9> on_diagonal(std::uint32_t t, bool is_a, float z = 0) {
    constexpr float kTiny[9] = {0, 0, 0, 0.25F, 0, 0, 0, 0.25F, 0};
    const float side = t % 2 == 0 ? -2.5F : 2.5F;
    return moved(kTiny, side, is_a ? side : -side, z);
}

}  // namespace

void make_leaf_pair(TreeMaker& a, std::uint32_t node_a, TreeMaker& b, std::uint32_t node_b,
                    std::uint32_t slot, const LeafRecipe& recipe) {
    a.make_leaf(node_a, slot, recipe.a, [&recipe](std::uint32_t t) {
        return recipe.none_near      ? on_diagonal(t, true)
               : t < recipe.touching ? moved(kBeside, 0, 0, 0)
                                     : moved(kCorner, 0, 0, 0);
    });
    b.make_leaf(node_b, slot, recipe.b, [&recipe](std::uint32_t t) {
        return recipe.none_near ? on_diagonal(t, false) : moved(kOther, 0, 0, 0);
    });
}

void make_full_leaf_of_a(TreeMaker& a, std::uint32_t node, std::uint32_t slot,
                         const LeafRecipe& recipe) {
    constexpr float kAsideA = -8;
    a.make_leaf(node, slot, kChildren, [&recipe](std::uint32_t t) {
        const std::uint32_t rank = t % 8 * 4 + t / 8;  // 0, 8, 16, 24, 1, ... are the first
        return recipe.none_near         ? on_diagonal(t, true)
               : rank >= recipe.a       ? moved(kCorner, kAsideA, kAsideA, kAsideA)
               : rank < recipe.touching ? moved(kBeside, 0, 0, 0)
                                        : moved(kCorner, 0, 0, 0);
    });
}

void make_full_leaf_of_b(TreeMaker& b, std::uint32_t node, std::uint32_t slot,
                         const LeafRecipe& recipe) {
    constexpr float kAsideB = 3, kAbove = 6;
    b.make_leaf(node, slot, kChildren, [&recipe](std::uint32_t t) {
        if (recipe.none_near) {
            const std::uint32_t corner = recipe.b == 1 ? 0 : t;
            return on_diagonal(corner, false, t < recipe.b ? 0 : kAbove);
        }
        return t < recipe.b ? moved(kOther, 0, 0, 0) : moved(kOther, kAsideB, kAsideB, kAsideB);
    });
}

void make_apart(TreeMaker& a, std::uint32_t first_a, TreeMaker& b, std::uint32_t first_b,
                std::uint32_t slot) {
    a.make_leaf(first_a + slot, slot, kChildren,
                [](std::uint32_t) { return moved(kOther, 0, 0, 13); });
    b.make_leaf(first_b + slot, slot, kChildren,
                [](std::uint32_t) { return moved(kOther, 0, 0, 0); });
}

void make_alone(TreeMaker& b, std::uint32_t first_b, std::uint32_t slot) {
    b.make_leaf(first_b + slot, slot, kChildren,
                [](std::uint32_t) { return moved(kOther, 0, 0, 0); });
}

void make_stacked(TreeMaker& tree, std::uint32_t node) {
    tree.make_leaf(node, 0, kChildren, [](std::uint32_t) { return moved(kOther, 0, 0, 0); });
}

}  // namespace axg
