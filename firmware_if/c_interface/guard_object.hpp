// SPDX-License-Identifier: Apache-2.0
// What an axg_guard is.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "firmware_if/axguard.h"
#include "firmware_if/c_interface/sample_frames.hpp"
#include "firmware_if/explain/stop_desk.hpp"
#include "firmware_if/guard/guard_node.hpp"
#include "firmware_if/guard/host_wire.hpp"
#include "firmware_if/live/live_service.hpp"
#include "firmware_if/setup/choose_engine.hpp"
#include "firmware_if/setup/guard_parts.hpp"
#include "firmware_if/setup/loaded_machine.hpp"

/// Members in the order in which they are made: each needs those above it.
struct axg_guard {
    axg_guard(axg::LoadedMachine&& machine, const axg_options& wanted);
    /// Whether there was memory for everything that the machine and the options require.
    [[nodiscard]] bool has_all() const noexcept { return parts.fault().empty(); }

    axg::LoadedMachine loaded;
    std::vector<std::string> pairs;  // names
    axg::GuardParts parts;
    std::string words;  // the fault, if a part is missing
    std::optional<axg::ChosenEngine> chosen;
    std::optional<axg::GuardChain> chain;
    std::optional<axg::StopDesk> desk;
    std::optional<axg::StatusLine> line;
    std::unique_ptr<axg::LiveService> service;  // null: axg_guard_show was not called
    bool is_stoppable;
    std::string file;               // name of the machine file
    std::int32_t program_line = 0;  // of the last axg_guard_explain
    axg::LatchCell forgotten{};     // in the place of a latch that outlives the guard
    axg::LatchCell* latch = &forgotten;
    axg::LiveOptions options;
    // The last of each kind of note.
    axg::ReceiverFault input_fault = axg::ReceiverFault::none;
    std::uint32_t input_frame = 0;
    const char* refused = "";
    const char* bus_fault = "";
    std::atomic<bool> has_query{false};
    axg::SampleFrames samples;
    std::uint32_t version;  // of the header that the host was compiled with
    axg::LiveResult last;   // the newest of a sample
    std::uint64_t evaluated = 0;
    axg::HostWire wire;
    axg::LiveQueues queues;
    axg::SpscQueue<axg::LiveResult, 64> undated;  // not dated yet
    std::optional<axg::GuardNode> guard;          // from the start on
};
