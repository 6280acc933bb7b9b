// SPDX-License-Identifier: Apache-2.0
// Holes are joined to the outer loop by their shortest free bridge; then the best-shaped ear is
// cut, again and again.
#include "config/machines/generator/triangulate.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace axg::generator {
namespace {

using Loop = std::vector<std::uint32_t>;
using Points = std::vector<Point>;

constexpr double kFlat = 1e-9;  // mm2, against corners given in mm: three corners on one line

double turn(Point a, Point b, Point c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

double distance(Point a, Point b) {
    return std::sqrt((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y));
}

/// p on the open segment ab?
bool is_inside_segment(Point a, Point b, Point p) {
    return std::fabs(turn(a, b, p)) <= kFlat && p != a && p != b &&
           (p.x - a.x) * (p.x - b.x) + (p.y - a.y) * (p.y - b.y) < 0;
}

bool cross(Point a, Point b, Point c, Point d) {
    const double c_side = turn(a, b, c), d_side = turn(a, b, d);
    const double a_side = turn(c, d, a), b_side = turn(c, d, b);
    return ((c_side > kFlat && d_side < -kFlat) || (c_side < -kFlat && d_side > kFlat)) &&
           ((a_side > kFlat && b_side < -kFlat) || (a_side < -kFlat && b_side > kFlat));
}

/// Does the segment leave the loop's corner i into its inside (to the left of its edges)?
bool is_in_cone(const Points& p, const Loop& loop, std::size_t i, Point to) {
    const std::size_t n = loop.size();
    const Point before = p[loop[(i + n - 1) % n]], here = p[loop[i]], after = p[loop[(i + 1) % n]];
    if (turn(before, here, after) >= 0) {
        return turn(here, to, before) > kFlat && turn(to, here, after) > kFlat;
    }
    return !(turn(here, to, after) >= -kFlat && turn(to, here, before) >= -kFlat);
}

/// Does no edge of the loop cross the segment, and no corner lie inside it?
bool is_free(const Points& p, const Loop& loop, Point a, Point b) {
    for (std::size_t k = 0; k < loop.size(); ++k) {
        const Point c = p[loop[k]], d = p[loop[(k + 1) % loop.size()]];
        if (cross(a, b, c, d) || is_inside_segment(a, b, c) || is_inside_segment(c, d, a) ||
            is_inside_segment(c, d, b)) {
            return false;
        }
    }
    return true;
}

struct Bridge {
    std::size_t hole = 0, from = 0,
                to = 0;  // corner `from` of the outline, corner `to` of the hole
    double length = -1;
};

Bridge shortest_bridge(const Points& p, const Loop& outline, const std::vector<Loop>& holes) {
    Bridge best;
    for (std::size_t h = 0; h < holes.size(); ++h) {
        for (std::size_t i = 0; i < outline.size(); ++i) {
            for (std::size_t k = 0; k < holes[h].size(); ++k) {
                const Point a = p[outline[i]], b = p[holes[h][k]];
                const double length = distance(a, b);
                const bool is_shorter = best.length < 0 || length < best.length;
                if (!is_shorter || !is_in_cone(p, outline, i, b) ||
                    !is_in_cone(p, holes[h], k, a) || !is_free(p, outline, a, b) ||
                    !std::all_of(holes.begin(), holes.end(),
                                 [&](const Loop& hole) { return is_free(p, hole, a, b); })) {
                    continue;
                }
                best = {h, i, k, length};
            }
        }
    }
    return best;
}

/// Cuts along the bridge: out to the hole, around it, and back.
void join(Loop& outline, const Loop& hole, const Bridge& bridge) {
    Loop detour;
    for (std::size_t k = 0; k <= hole.size(); ++k) {
        detour.push_back(hole[(bridge.to + k) % hole.size()]);
    }
    detour.push_back(outline[bridge.from]);
    outline.insert(outline.begin() + static_cast<std::ptrdiff_t>(bridge.from) + 1, detour.begin(),
                   detour.end());
}

bool is_ear(const Points& p, const Loop& loop, std::size_t i) {
    const std::size_t n = loop.size(), before = (i + n - 1) % n, after = (i + 1) % n;
    const Point a = p[loop[before]], b = p[loop[i]], c = p[loop[after]];
    if (turn(a, b, c) <= kFlat) {
        return false;
    }
    if (n == 3) {
        return true;
    }
    for (const std::uint32_t k : loop) {
        const Point q = p[k];
        if (q != a && q != b && q != c && turn(a, b, q) >= -kFlat && turn(b, c, q) >= -kFlat &&
            turn(c, a, q) >= -kFlat) {
            return false;
        }
    }
    return is_in_cone(p, loop, before, c) && is_in_cone(p, loop, after, a) &&
           is_free(p, loop, a, c);
}

double quality(Point a, Point b, Point c) {
    const double longest = std::max({distance(a, b), distance(b, c), distance(c, a)});
    return turn(a, b, c) / (longest * longest);
}

}  // namespace

std::vector<std::array<std::uint32_t, 3>> triangulate(const Points& point,
                                                      const std::vector<Loop>& loops) {
    Loop outline = loops.front();
    std::vector<Loop> holes(loops.begin() + 1, loops.end());
    while (!holes.empty()) {
        const Bridge bridge = shortest_bridge(point, outline, holes);
        if (bridge.length < 0) {
            return {};
        }
        join(outline, holes[bridge.hole], bridge);
        holes.erase(holes.begin() + static_cast<std::ptrdiff_t>(bridge.hole));
    }
    std::vector<std::array<std::uint32_t, 3>> triangles;
    while (outline.size() >= 3) {
        std::size_t best = outline.size();
        double best_quality = 0;
        for (std::size_t i = 0; i < outline.size(); ++i) {
            const std::size_t n = outline.size();
            const double shape = quality(point[outline[(i + n - 1) % n]], point[outline[i]],
                                         point[outline[(i + 1) % n]]);
            if (shape > best_quality && is_ear(point, outline, i)) {
                best = i;
                best_quality = shape;
            }
        }
        if (best == outline.size()) {
            return {};
        }
        const std::size_t n = outline.size();
        triangles.push_back({outline[(best + n - 1) % n], outline[best], outline[(best + 1) % n]});
        outline.erase(outline.begin() + static_cast<std::ptrdiff_t>(best));
    }
    return triangles;
}

}  // namespace axg::generator
