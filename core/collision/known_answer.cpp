// SPDX-License-Identifier: Apache-2.0
#include "core/collision/known_answer.hpp"

namespace axg {

namespace {
constexpr double kKnownAnswerFarMm = 10.0, kKnownAnswerNearMm = 0.25;

bool is_near_right(const QueryResult& near) noexcept {
    return near.proof == Proof::not_proven &&
           (near.status == QueryStatus::ok || is_overflow(near.status));
}

}  // namespace

Mesh known_answer_mesh() {
    const Vec3f o{0, 0, 0}, x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
    return {"known answer", {{o, y, x}, {o, x, z}, {o, z, y}, {x, y, z}}};
}

Query known_answer_query(std::uint32_t mesh, bool is_near) noexcept {
    Query q;
    q.mesh_a = q.mesh_b = mesh;
    q.pose.t[0] = is_near ? kKnownAnswerNearMm : kKnownAnswerFarMm;
    return q;
}

std::uint16_t known_answer_signature(const QueryResult& far, const QueryResult& near) noexcept {
    const bool right =
        far.status == QueryStatus::ok && far.proof == Proof::far && is_near_right(near);
    return right ? kKnownAnswerSignature : 0;
}

bool is_batch_lost(const QueryResult& far, const QueryResult& near) noexcept {
    return far.proof == Proof::not_proven && is_overflow(far.status) && is_near_right(near);
}

}  // namespace axg
