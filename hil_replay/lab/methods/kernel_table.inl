// SPDX-License-Identifier: Apache-2.0
// The batches of the plain methods. A unit that offers them includes this after kernels.inl.

namespace axg::lab::AXG_LAB_UNIT {

/// A method without distances: the verdict is separated or intersecting.
template <class T, Verdict (*kJudge)(const Pair<T>&)>
static void decide(const Pair<T>* pairs, std::size_t count, Verdict* verdicts, double*) {
    for (std::size_t i = 0; i < count; ++i) {
        verdicts[i] = kJudge(pairs[i]);
    }
}

template <class T>
AXG_LAB_FUNCTION Measured<T> pqp_distance(const Pair<T>& p) {
    return {root(pqp_square(p)), true};
}

/// A method that gives a distance: 1 um and less is a hit.
template <class T, Measured<T> (*kMeasure)(const Pair<T>&)>
static void measure(const Pair<T>* pairs, std::size_t count, Verdict* verdicts,
                    double* distances_mm) {
    for (std::size_t i = 0; i < count; ++i) {
        const Measured<T> m = kMeasure(pairs[i]);
        verdicts[i] = m.converged ? verdict_of(m.mm > T(1e-3)) : Verdict::undecided;
        if (distances_mm != nullptr) {
            distances_mm[i] = static_cast<double>(m.mm);
        }
    }
}

#define AXG_LAB_DECIDES(name, function) \
    { name, &decide<float, &function<float>>, &decide<double, &function<double>> }
#define AXG_LAB_MEASURES(name, function) \
    { name, &measure<float, &function<float>>, &measure<double, &function<double>> }

static constexpr Kernel kTable[] = {
    AXG_LAB_DECIDES("sat17", sat17),
    AXG_LAB_DECIDES("sat11", sat11),
    AXG_LAB_DECIDES("paper-6-11", paper_6_11),
    AXG_LAB_DECIDES("sat17-normalised-eps", sat17_normalised_eps),
    AXG_LAB_DECIDES("moller", moller),
    AXG_LAB_DECIDES("held", held),
    AXG_LAB_DECIDES("guigue-devillers", guigue_devillers),
    AXG_LAB_DECIDES("shen", shen),
    AXG_LAB_DECIDES("tropp", tropp),
    AXG_LAB_DECIDES("six-segment", six_segment),
    AXG_LAB_MEASURES("pqp-distance", pqp_distance),
    AXG_LAB_MEASURES("gjk", gjk_distance),
    AXG_LAB_DECIDES("sphere", sphere),
    AXG_LAB_DECIDES("aabb", aabb),
    AXG_LAB_DECIDES("obb", obb),
    AXG_LAB_DECIDES("18-dop", dop18),
};

#undef AXG_LAB_DECIDES
#undef AXG_LAB_MEASURES

}  // namespace axg::lab::AXG_LAB_UNIT
