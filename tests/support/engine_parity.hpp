// SPDX-License-Identifier: Apache-2.0
// What two engines must agree on, field by field (core/collision/engine.hpp, "What engines agree
// on").
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "core/collision/engine.hpp"

namespace axg::test {

inline bool is_overflow(const QueryResult& a) {
    return axg::is_overflow(a.status);
}

inline bool equal_bits(double x, double y) {
    return __builtin_bit_cast(std::uint64_t, x) == __builtin_bit_cast(std::uint64_t, y);
}

inline bool equal_counts(const QueryResult& x, const QueryResult& y) {
    return x.touching == y.touching && x.node_pairs == y.node_pairs &&
           x.triangle_pairs == y.triangle_pairs && x.rechecks == y.rechecks;
}

/// Empty where two engines' results agree as they must, or what differs. Both engines have the same
/// capacities a query.
inline std::string difference(QueryKind kind, const QueryResult& x, const QueryResult& y) {
    const auto refused = [](const QueryResult& a) { return a.status == QueryStatus::bad_query; };
    if (refused(x) || refused(y)) {
        return x.status == y.status ? "" : "only one refused the question";
    }
    if (kind == QueryKind::clearance) {
        if (is_overflow(x) || is_overflow(y)) {
            return "";  // work differs, and so do the queries that are too much
        }
        if (x.status != y.status || x.proof != y.proof) {
            return "status or proof";
        }
        return equal_bits(x.clearance_mm, y.clearance_mm) ? "" : "clearance_mm";
    }
    if (x.proof != y.proof) {
        return "proof";
    }
    if (x.proof == Proof::far || (kind == QueryKind::touching && !is_overflow(x))) {
        return x.status == y.status && equal_counts(x, y) ? "" : "status or counts";
    }
    if (kind == QueryKind::touching && is_overflow(x) != is_overflow(y)) {
        return "overflow";
    }
    return "";
}

inline std::string text_of(const QueryResult& a) {
    return "status " + std::to_string(static_cast<int>(a.status)) + " proof " +
           std::to_string(static_cast<int>(a.proof)) + " touching " + std::to_string(a.touching) +
           " clearance " + std::to_string(a.clearance_mm) + " nearest " +
           std::to_string(a.nearest.a) + "/" + std::to_string(a.nearest.b) + " work " +
           std::to_string(a.node_pairs) + "/" + std::to_string(a.triangle_pairs) + "/" +
           std::to_string(a.rechecks);
}

}  // namespace axg::test
