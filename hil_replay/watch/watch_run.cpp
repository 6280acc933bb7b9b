// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/watch/watch_run.hpp"

#include <poll.h>

#include <algorithm>
#include <utility>

#include "config/machine/effective_text.hpp"
#include "hil_replay/watch/bus_view.hpp"
#include "hil_replay/watch/status_reader.hpp"
#include "hil_replay/watch/watch_state.hpp"

namespace axg {

void run_watch(const LoadedMachine& loaded, WatchSources sources, HttpServer& server,
               const std::function<bool()>& is_ended) {
    const std::string configuration = configuration_hash(loaded.machine, loaded.meshes);
    BusView view(loaded.machine, configuration_hashes(loaded.machine, loaded.meshes));
    const bool reads_status = !sources.status_path.empty();
    const StatusReader reader(sources.status_path);
    std::uint64_t number = 0;
    for (std::int64_t due_us = monotonic_us(); !is_ended();) {
        due_us = std::max(due_us + kPageEveryUs, monotonic_us());
        if (sources.bus) {
            sources.bus->read_until(due_us,
                                    [&view](const CanFrame& frame) { view.on_frame(frame); });
        } else {
            poll(nullptr, 0, static_cast<int>(kPageEveryUs / 1000));
        }
        // After the end of a trace the page keeps its last state.
        const std::optional<std::int64_t> end_us =
            sources.bus && !reads_status ? sources.bus->end_us() : std::nullopt;
        const std::int64_t now_us = end_us.value_or(monotonic_us());
        view.on_time(now_us);
        StatusReader::Reading status = reader.last();
        WatchInput input{.machine = loaded.machine,
                         .configuration = configuration,
                         .reads_status = reads_status,
                         .status = std::move(status.line),
                         .status_us = status.time_us,
                         .status_fault = status.fault,
                         .now_us = now_us,
                         .number = ++number};
        if (sources.bus) {
            input.bus = &view.state();
            input.bus_name = sources.bus->name();
            input.bus_fault = sources.bus->fault();
        }
        if (sources.traces) {
            sources.traces->is_over = end_us.has_value();
            input.traces = &*sources.traces;
        }
        server.publish(watch_json(input));
    }
}

}  // namespace axg
