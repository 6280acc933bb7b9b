// SPDX-License-Identifier: Apache-2.0
// From the instant at which a stop is due until a person arms: an axis gets no farther than its
// limits allow, and stays where it came to rest. Every axis, at a steady speed or not.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/machine/machine.hpp"
#include "firmware_if/board_test/board_cases.hpp"
#include "firmware_if/board_test/case_judge.hpp"
#include "firmware_if/board_test/motion_record.hpp"

namespace axg {

struct RestFault {
    Watched rule = Watched::braking;  // or resume
    std::string words;
};

class RestWatch {
  public:
    explicit RestWatch(const Machine& machine) noexcept : machine_(machine) {}

    /// The stop is due `seconds` after this sample; braking begins `free_s` later at the latest.
    /// @param judged  axes whose stopping distance another part judges
    void begin(std::uint64_t sample, double seconds, double free_s,
               const std::vector<SteadyAxis>& judged);
    void end() noexcept { axes_.clear(); }
    [[nodiscard]] bool is_on() const noexcept { return !axes_.empty(); }

    /// After each sample. The first fault of each rule; the watch goes on.
    [[nodiscard]] std::optional<RestFault> on_sample(const MotionRecord& record);

  private:
    struct WatchedAxis {
        bool is_bounded = false;
        double low = 0, high = 0;  // that the stop may reach
        double place = 0;          // where it was last seen to stay
        std::uint64_t since = 0;
        bool is_at_rest = false;
    };
    void bound(WatchedAxis& watched, std::uint32_t axis, const MotionRecord& record) const;

    const Machine& machine_;
    std::vector<WatchedAxis> axes_;
    std::uint64_t cut_ = 0;  // the last sample before the stop was due
    double free_s_ = 0;
    bool is_cut_ = false, has_gone_far_ = false, has_resumed_ = false;
};

}  // namespace axg
