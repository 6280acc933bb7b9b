// SPDX-License-Identifier: Apache-2.0
// Writes the black box to disk after a stop: whole or not at all, and no more files than the limit
// allows. Called only by the logger; slow.
#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include "firmware_if/guard/black_box.hpp"
#include "firmware_if/setup/loaded_machine.hpp"

namespace axg {

struct BlackBoxFolder {
    std::string folder, bus;
    std::uint32_t dumps_max = 8;  // the oldest are removed; 0: none is written
};

/// The header of a dump of this run, without its times.
[[nodiscard]] BlackBoxHeader black_box_header(const LoadedMachine& loaded, bool is_stoppable,
                                              bool accepts_local);

/// The records of `box`, to DIR/BUS-YYYYMMDDTHHMMSSZ.axgbox. Empty: the reason is in `fault`.
[[nodiscard]] std::string write_black_box(const BlackBox& black_box, const BlackBoxHeader& header,
                                          const BlackBoxFolder& folder, std::string& fault);

/// Writes half a second after a stop, so that the dump contains the board's reaction.
class BlackBoxDump {
  public:
    BlackBoxDump(const BlackBox& black_box, const BlackBoxHeader& header, BlackBoxFolder folder)
        : black_box_(black_box), header_(header), folder_(std::move(folder)) {}

    void on_note(const LiveNote& note) noexcept;
    /// Writes a dump that is due, and prints its path or the fault on stderr.
    void serve(std::int64_t now_us);
    /// For the end of the process: also writes a dump that is not due yet.
    void finish(std::int64_t now_us);
    /// The newest; empty: none was written.
    [[nodiscard]] const std::string& path() const noexcept { return path_; }

  private:
    const BlackBox& black_box_;
    BlackBoxHeader header_;
    BlackBoxFolder folder_;
    std::string path_;
    bool is_due_ = false;
    std::int64_t due_us_ = 0;
};

}  // namespace axg
