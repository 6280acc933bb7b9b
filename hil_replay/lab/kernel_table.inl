// SPDX-License-Identifier: Apache-2.0
// The batches of the plain methods: after kernels.inl, in the units that offer them.

namespace axg::lab::AXG_LAB_UNIT {

/// A method that says yes or no.
template <class T, Verdict (*kJudge)(const Pair<T>&)>
static void decide(const Pair<T>* pairs, std::size_t count, Verdict* verdicts, double*) {
    for (std::size_t i = 0; i < count; ++i) {
        verdicts[i] = kJudge(pairs[i]);
    }
}

static constexpr Kernel kTable[] = {
    {"sat17", &decide<float, &sat17<float>>, &decide<double, &sat17<double>>},
};

}  // namespace axg::lab::AXG_LAB_UNIT
