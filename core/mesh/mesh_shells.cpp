// SPDX-License-Identifier: Apache-2.0
#include "core/mesh/mesh_shells.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/sincos.hpp"

namespace axg {
namespace {

constexpr std::uint64_t kAnglesMax = 1U << 24;

struct Shell {
    std::uint32_t first = 0, count = 0;          // in Shells::order
    std::uint32_t probe = MeshReport::kNoFacet;  // its largest facet
    double probe_area = 0;
    double volume = 0;
    bool is_closed = true;
    Vec3d low, high;
};

struct Shells {
    std::vector<Shell> shell;
    std::vector<std::uint32_t> order;  // facets, part by part
};

Vec3d centre(const Triangle& t) {
    return (1.0 / 3.0) * (widen(t.a) + widen(t.b) + widen(t.c));
}

void include(Shell& s, const Triangle& t) {
    for (const Vec3f corner : {t.a, t.b, t.c}) {
        const Vec3d p = widen(corner);
        s.low = {std::min(s.low.x, p.x), std::min(s.low.y, p.y), std::min(s.low.z, p.z)};
        s.high = {std::max(s.high.x, p.x), std::max(s.high.y, p.y), std::max(s.high.z, p.z)};
    }
}

Shells gather(const LabelledFacets& in) {
    Shells out;
    const auto count = static_cast<std::uint32_t>(in.facets.size());
    std::vector<std::uint32_t> index(count, MeshReport::kNoFacet);  // of the part with that label
    for (std::uint32_t i = 0; i < count; ++i) {
        std::uint32_t& mine = index[in.shell[i]];
        if (mine == MeshReport::kNoFacet) {
            mine = static_cast<std::uint32_t>(out.shell.size());
            out.shell.push_back({});
            out.shell.back().low = out.shell.back().high = widen(in.facets[i].a);
        }
        ++out.shell[mine].count;
    }
    std::uint32_t next = 0;
    for (Shell& s : out.shell) {
        s.first = next;
        next += s.count;
        s.count = 0;
    }
    out.order.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        Shell& s = out.shell[index[in.shell[i]]];
        out.order[s.first + s.count++] = i;
        const Triangle& t = in.facets[i];
        // The first corner of the part as origin: small terms, small rounding.
        const Vec3d origin = widen(in.facets[out.order[s.first]].a);
        const Vec3d a = widen(t.a) - origin, b = widen(t.b) - origin, c = widen(t.c) - origin;
        s.volume += dot(a, cross(b, c)) / 6.0;
        const Vec3d normal = cross(b - a, c - a);
        if (in.is_flat[i] == 0 && dot(normal, normal) > s.probe_area) {
            s.probe_area = dot(normal, normal);
            s.probe = i;
        }
        s.is_closed = s.is_closed && in.has_bad_edge[i] == 0;
        include(s, t);
    }
    return out;
}

/// Angle of (x, y) in (-pi, pi], to 1e-12; 0 at the origin. Written out: libm differs between
/// processors.
double angle_of(double y, double x) {
    const double low = std::fmin(std::fabs(x), std::fabs(y));
    const double high = std::fmax(std::fabs(x), std::fabs(y));
    if (high == 0) {
        return 0;
    }
    double t = low / high;
    for (int halving = 0; halving < 3; ++halving) {
        t = t / (1.0 + std::sqrt(1.0 + t * t));
    }
    const double z = t * t;  // below 0.0098: the first term left out is below 1e-13
    double angle =
        8.0 * t * (1.0 - z * (1.0 / 3 - z * (1.0 / 5 - z * (1.0 / 7 - z * (1.0 / 9 - z / 11)))));
    angle = std::fabs(y) > std::fabs(x) ? kPi / 2 - angle : angle;
    angle = x < 0 ? kPi - angle : angle;
    return y < 0 ? -angle : angle;
}

/// Signed solid angle of a facet seen from p. Source: van Oosterom and Strackee, 1983.
double solid_angle(const Triangle& t, Vec3d p) {
    const Vec3d a = widen(t.a) - p, b = widen(t.b) - p, c = widen(t.c) - p;
    const double la = std::sqrt(dot(a, a)), lb = std::sqrt(dot(b, b)), lc = std::sqrt(dot(c, c));
    const double below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
    return 2.0 * angle_of(dot(a, cross(b, c)), below);
}

bool is_in_box(const Shell& s, Vec3d p) {
    return s.low.x <= p.x && p.x <= s.high.x && s.low.y <= p.y && p.y <= s.high.y &&
           s.low.z <= p.z && p.z <= s.high.z;
}

/// How often the other closed parts wind around part `self`; false when the work limit is reached.
bool winding_around(const Shells& shells, std::span<const Triangle> facets, std::size_t self,
                    std::uint64_t& angles_left, double& winding) {
    const Vec3d p = centre(facets[shells.shell[self].probe]);
    winding = 0;
    for (std::size_t i = 0; i < shells.shell.size(); ++i) {
        const Shell& s = shells.shell[i];
        const std::uint64_t cost = is_in_box(s, p) ? s.count : 1;
        if (angles_left < cost) {
            return false;
        }
        angles_left -= cost;
        if (i == self || !s.is_closed || cost == 1) {
            continue;  // seen from outside its box a closed part has no angle
        }
        for (std::uint32_t k = 0; k < s.count; ++k) {
            winding += solid_angle(facets[shells.order[s.first + k]], p) / (4.0 * kPi);
        }
    }
    return true;
}

}  // namespace

void judge_shells(const LabelledFacets& labelled, MeshReport& report) {
    const Shells shells = gather(labelled);
    std::uint64_t angles_left = kAnglesMax;
    for (std::size_t i = 0; i < shells.shell.size(); ++i) {
        const Shell& s = shells.shell[i];
        if (s.probe == MeshReport::kNoFacet) {
            continue;  // facets without area only
        }
        ++report.shells;
        if (!s.is_closed) {
            ++report.open_shells;
            continue;  // no inside, no volume
        }
        report.volume_mm3 += s.volume;
        const Vec3d size = s.high - s.low;
        if (std::fabs(s.volume) <= 1e-12 * size.x * size.y * size.z) {
            ++report.flat_shells;
            continue;
        }
        double winding = 0;
        if (!winding_around(shells, labelled.facets, i, angles_left, winding)) {
            report.shells_complete = false;
        }
        // A winding number of a half means a point on another part's surface: solids in contact, or
        // a cavity that reaches the wall.
        if (s.volume < 0 && winding < 0.4) {
            ++report.inverted_shells;
            report.first_inverted = std::min(report.first_inverted, s.probe);
        } else if (s.volume < 0) {
            ++report.cavities;
        } else if (winding > 0.6) {
            ++report.nested_shells;
            report.first_nested = std::min(report.first_nested, s.probe);
        }
    }
}

}  // namespace axg
