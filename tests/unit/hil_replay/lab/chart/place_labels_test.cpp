// SPDX-License-Identifier: Apache-2.0
// Words beside the marks of a picture: where there is room, none lies on another, on a mark, or
// outside; and where the words end up is the same every time.
#include <gtest/gtest.h>

#include <cstdlib>
#include <vector>

#include "hil_replay/lab/cases/draw.hpp"
#include "tests/support/seed.hpp"
#ifdef AXG_EXACT  // the chart is built with the exact judge alone
#include "hil_replay/lab/chart/place_labels.hpp"

namespace axg::chart {
namespace {

constexpr double kMark = 5;

bool overlap(const LabelBox& a, const LabelBox& b) {
    return a.left < b.right && b.left < a.right && a.bottom < b.top && b.bottom < a.top;
}

LabelBox words_of(const Label& l) {
    return {l.text_left, l.text_mid - l.height / 2, l.text_left + l.width,
            l.text_mid + l.height / 2};
}

std::vector<Label> some_labels(lab::Draw& draw, std::uint32_t count) {
    std::vector<Label> labels;
    for (std::uint32_t i = 0; i < count; ++i) {
        labels.push_back({.x = draw.between(200, 800),
                          .y = draw.between(100, 500),
                          .width = draw.between(40, 160),
                          .height = 14});
    }
    return labels;
}

TEST(PlaceLabels, NothingLiesOnAnythingWhereThereIsRoom) {
    lab::Draw draw(test::printed_seed(3));
    const LabelBox frame{0, 0, 1000, 600};
    const std::vector<LabelBox> taken = {{700, 450, 1000, 600}};
    for (int round = 0; round < 50; ++round) {
        std::vector<Label> labels = some_labels(draw, 12);
        place_labels(labels, frame, kMark, taken);
        for (std::size_t i = 0; i < labels.size(); ++i) {
            const LabelBox box = words_of(labels[i]);
            EXPECT_TRUE(box.left >= 0 && box.right <= 1000 && box.bottom >= 0 && box.top <= 600);
            EXPECT_FALSE(overlap(box, taken[0])) << round << ", " << i;
            for (std::size_t j = 0; j < labels.size(); ++j) {
                const Label& other = labels[j];
                EXPECT_FALSE(overlap(
                    box, {other.x - kMark, other.y - kMark, other.x + kMark, other.y + kMark}))
                    << round << ", " << i << " on mark " << j;
                EXPECT_FALSE(i != j && overlap(box, words_of(other)))
                    << round << ", " << i << " on words " << j;
            }
        }
    }
}

TEST(PlaceLabels, AFreeMarkHasItsWordsBesideIt) {
    std::vector<Label> labels = {{.x = 500, .y = 300, .width = 100, .height = 14}};
    place_labels(labels, {0, 0, 1000, 600}, kMark, {});
    EXPECT_FALSE(labels[0].is_away);
    EXPECT_NEAR(labels[0].text_left, 500 + kMark, 10);
    EXPECT_NEAR(labels[0].text_mid, 300, 1);
}

TEST(PlaceLabels, CrowdedOutMeansAwayWithALine) {
    std::vector<Label> labels(8, {.x = 500, .y = 300, .width = 120, .height = 14});
    place_labels(labels, {0, 0, 1000, 600}, kMark, {});
    unsigned away = 0;
    for (std::size_t i = 0; i < labels.size(); ++i) {
        away += labels[i].is_away ? 1 : 0;
        for (std::size_t j = 0; j < i; ++j) {
            EXPECT_FALSE(overlap(words_of(labels[i]), words_of(labels[j])));
        }
    }
    EXPECT_GT(away, 0U);
}

}  // namespace
}  // namespace axg::chart
#else
TEST(PlaceLabels, NeedsTheChart) {
    GTEST_SKIP() << "this build has no GMP, and so no chart";
}
#endif
