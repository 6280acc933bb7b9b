// SPDX-License-Identifier: Apache-2.0
#include "core/collision/canary.hpp"

namespace axg {

namespace {
constexpr double kCanaryFarMm = 10.0, kCanaryNearMm = 0.25;

bool is_overflow(AnswerStatus status) noexcept {
    return status == AnswerStatus::too_many_node_pairs ||
           status == AnswerStatus::too_many_triangle_pairs ||
           status == AnswerStatus::too_many_rechecks;
}

bool is_near_right(const Answer& near) noexcept {
    return near.proof == Proof::not_proven &&
           (near.status == AnswerStatus::ok || is_overflow(near.status));
}

}  // namespace

Mesh canary_mesh() {
    const Vec3f o{0, 0, 0}, x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
    return {"canary", {{o, y, x}, {o, x, z}, {o, z, y}, {x, y, z}}};
}

Question canary_question(std::uint32_t mesh, bool is_near) noexcept {
    Question q;
    q.mesh_a = q.mesh_b = mesh;
    q.pose.t[0] = is_near ? kCanaryNearMm : kCanaryFarMm;
    return q;
}

std::uint16_t canary_signature(const Answer& far, const Answer& near) noexcept {
    const bool right =
        far.status == AnswerStatus::ok && far.proof == Proof::far && is_near_right(near);
    return right ? kCanarySignature : 0;
}

bool is_batch_lost(const Answer& far, const Answer& near) noexcept {
    return far.proof == Proof::not_proven && is_overflow(far.status) && is_near_right(near);
}

}  // namespace axg
