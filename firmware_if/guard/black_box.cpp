// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/guard/black_box.hpp"

#include <algorithm>

#include "firmware_if/protocol/axis_frames.hpp"

namespace axg {

std::size_t black_box_bytes(const Machine& machine) noexcept {
    const AxisFrameSet set = make_frame_set(machine);
    // Records of a period: the board's frames including SYNC and the look-ahead path, two guard
    // frames both as sent and as echo, a snapshot and its result, and turns without other records.
    constexpr std::size_t kFrameBytes = 45, kResultBytes = 80, kTurns = 4;
    const std::size_t data_bytes =
        *std::max_element(set.frame_bytes.begin(), set.frame_bytes.end());
    const std::size_t period_bytes =
        (set.frame_count + 1) * (kFrameBytes + data_bytes) + 5 * (kFrameBytes + 8) + kResultBytes +
        machine.axes.size() * 8 + kResultBytes + kTurns * kBlackBoxRecordBytesMin;
    const std::size_t periods = static_cast<std::size_t>(kBlackBoxUs / machine.can.sample_us) + 1;
    return std::max(periods * period_bytes / 4 * 5, 4 * kBlackBoxRecordBytesMax);
}

void BlackBox::drop_oldest() noexcept {
    const std::size_t low = bytes_[begin_], high = bytes_[(begin_ + 1) % bytes_.size()];
    const std::size_t size = low | (high << 8U);
    begin_ = (begin_ + size) % bytes_.size();
    used_ -= size;
}

void BlackBox::add(const BlackBoxEntry& entry) noexcept {
    std::array<std::uint8_t, kBlackBoxRecordBytesMax> record;
    const std::size_t size = encode_black_box_record(entry, sequence_++, record);
    while (bytes_.size() - used_ < size) {
        drop_oldest();
    }
    const std::size_t end = (begin_ + used_) % bytes_.size();
    const std::size_t first = std::min(size, bytes_.size() - end);
    std::copy_n(record.begin(), first, bytes_.begin() + static_cast<std::ptrdiff_t>(end));
    std::copy_n(record.begin() + static_cast<std::ptrdiff_t>(first), size - first, bytes_.begin());
    used_ += size;
}

std::array<std::span<const std::uint8_t>, 2> BlackBox::records() const noexcept {
    const std::size_t first = std::min(used_, bytes_.size() - begin_);
    return {std::span(bytes_).subspan(begin_, first), std::span(bytes_).first(used_ - first)};
}

}  // namespace axg
