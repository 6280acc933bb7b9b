// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/page/pair_clearances.hpp"

#include <algorithm>

namespace axg {

PairClearances::PairClearances(const LoadedMachine& loaded, Engine engine, double within_mm)
    : machine_(loaded.machine),
      triangles_(loaded),
      engine_(engine),
      within_mm_(within_mm),
      mm_(machine_.pairs.size()) {}

PageClearances PairClearances::at(const AxisSnapshot& snapshot) {
    std::fill(mm_.begin(), mm_.end(), kNotNear);
    PageClearances out{.mm = mm_};
    plan_contact(machine_, snapshot, plan_);
    double least_mm = within_mm_;
    for (std::uint32_t i = 0; plan_.status == PlanStatus::ok && i < plan_.count; ++i) {
        Question question = plan_.questions[i];
        question.ask = Ask::clearance;
        question.r_mm = within_mm_;
        Answer answer;
        engine_({&question, 1}, {&answer, 1});
        const bool is_known = answer.status == AnswerStatus::ok;
        if (is_known && answer.clearance_mm >= within_mm_) {
            continue;
        }
        mm_[plan_.pair[i]] = answer.clearance_mm;  // not known: 0, and no triangles to show
        if (is_known && answer.clearance_mm < least_mm) {
            least_mm = answer.clearance_mm;
            out.pair = plan_.pair[i];
            out.triangles = triangles_.of(question, answer.nearest);
        }
    }
    return out;
}

}  // namespace axg
