// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/axguardd/live_threads.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <pthread.h>
#include <sys/eventfd.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string_view>

#include "firmware_if/axguardd/format_note.hpp"
#include "firmware_if/cli/limit_text.hpp"
#include "firmware_if/guard/live_engine.hpp"
#include "firmware_if/live/status_server.hpp"
#include "firmware_if/system/real_time.hpp"
#include "firmware_if/system/service_notify.hpp"
#include "firmware_if/system/suspend_watch.hpp"

namespace axg {
namespace {

constexpr std::size_t kStackBytes = 512 * 1024;  // locked in memory, so not the usual 8 MiB
constexpr std::size_t kThreads = 4;
constexpr int kLogPeriodMs = 20;
constexpr int kStatusNice = 10;
constexpr std::int64_t kLimitLogUs = 1'000'000;  // a broken limit makes a line a second at most

struct BrokenLimit {
    StopReason reason = StopReason::none;
    LimitFact fact{};
};

struct Shared {
    const Machine& machine;
    GuardChain& chain;
    SocketCan& wire;
    LatchCell& latch;
    const ThreadOptions& options;
    LiveQueues& queues;
    BlackBoxQueue& records;
    BlackBox& black_box;
    BlackBoxDump& dump;
    int wake_bus = -1, wake_engine = -1;
    std::atomic<bool> is_ending{false}, wants_arm{false}, wants_reset{false};
    std::atomic<std::uint32_t> backlog_drops{0};  // frames lost before any socket saw them
    std::atomic<std::uint32_t> period{0};         // of the guard: its cycle goes on
    ViewExchange metrics{};                       // with the logger
    ViewExchange status{};                        // with the status thread
    SpscQueue<BrokenLimit, 4> limits{};           // broken ones, to the logger
    // The logger's: no line of the same reason before.
    StopReason limit_reason = StopReason::none;
    std::int64_t limit_due_us = 0;
    ServiceNotify service{};  // the logger's, but at the end
    LiveEnd end{};
};

void wake(int descriptor) noexcept {
    const std::uint64_t one = 1;
    // The counter cannot be full: each wake-up empties it.
    [[maybe_unused]] const ssize_t written = write(descriptor, &one, sizeof one);
}

/// Waits for it, however long; a wake-up before counts.
void await(int descriptor) noexcept {
    std::uint64_t count = 0;
    while (read(descriptor, &count, sizeof count) < 0 && errno == EINTR) {
    }
}

void log_refusal(const char* who, const std::string& refusal) {
    if (!refusal.empty()) {
        std::fprintf(stderr, "axguardd: %s: %s\n", who, refusal.c_str());
    }
}

void prepare(const char* who, int priority, int cpu) {
    log_refusal(who, stay_on_cpu(cpu));
    log_refusal(who, priority > 0 ? take_priority(priority) : std::string());
}

/// Sleeps until a frame, a result, a person, or `until_us`.
void wait_at_bus(const Shared& shared, std::int64_t until_us) noexcept {
    std::array<pollfd, 2> waits{{{.fd = shared.wire.descriptor(), .events = POLLIN, .revents = 0},
                                 {.fd = shared.wake_bus, .events = POLLIN, .revents = 0}}};
    const std::int64_t left_us = std::max<std::int64_t>(0, until_us - monotonic_us());
    const timespec timeout{.tv_sec = left_us / 1'000'000, .tv_nsec = left_us % 1'000'000 * 1000};
    ppoll(waits.data(), waits.size(), &timeout, nullptr);
    if ((waits[1].revents & POLLIN) != 0) {
        await(shared.wake_bus);
    }
}

LiveView view_of(const Shared& shared, const GuardNode& guard, std::int64_t now_us) noexcept {
    return {.phase = guard.guard().phase,
            .cause = guard.guard().cause,
            .counters = guard.counters(),
            .input = guard.receiver().counters(),
            .frames_dropped = shared.wire.frames_dropped(),
            .time_us = now_us,
            .phase_us = guard.phase_us(),
            .reason = guard.reason(),
            .pair = guard.pair(),
            .stop_query = guard.stop_query(),
            .withheld = guard.withheld(),
            .stands = guard.stands(now_us),
            .is_confirmed = guard.guard().is_confirmed,
            .has_session = guard.has_said_session(),
            .admission = shared.options.admission,
            .compares_hashes = shared.options.compares_hashes};
}

/// Publishes the turn to the logger and the status thread.
void show(Shared& shared, const GuardNode& guard, std::int64_t now_us) noexcept {
    shared.period.store(guard.guard().period);
    const auto view = [&] { return view_of(shared, guard, now_us); };
    answer(shared.metrics, view);
    shared.options.desk->set_stop(guard);
    answer(shared.status, view);
}

void* run_bus(void* argument) {
    Shared& shared = *static_cast<Shared*>(argument);
    prepare("bus thread", shared.options.bus_priority, shared.options.bus_cpu);
    shared.wire.forget();
    LiveOptions options = shared.options.guard;
    options.black_box = &shared.records;
    GuardNode guard(shared.machine, options, shared.wire, shared.queues, shared.latch,
                    monotonic_us());
    wake(shared.wake_engine);  // it has a query: the self-test
    std::uint32_t drops = 0;
    SuspendWatch sleep;
    while (!shared.is_ending.load() && !guard.is_wire_gone()) {
        wait_at_bus(shared, guard.next_due_us());
        if (sleep.has_slept()) {
            guard.report(GuardFault::gap, monotonic_us());
        }
        guard.turn(monotonic_us());
        show(shared, guard, monotonic_us());
        if (guard.has_submitted()) {
            wake(shared.wake_engine);
        }
        const std::uint32_t seen = shared.backlog_drops.load();
        if (seen != drops) {
            drops = seen;
            guard.report(GuardFault::input_noise, monotonic_us());
        }
        if (shared.wants_reset.exchange(false)) {
            guard.reset(monotonic_us());
            wake(shared.wake_engine);
        }
        if (shared.wants_arm.exchange(false)) {
            guard.arm(monotonic_us());
        }
    }
    guard.end();
    shared.end.guard = guard.guard();
    shared.end.reason = guard.reason();
    shared.end.counters = guard.counters();
    shared.end.input = guard.receiver().counters();
    shared.end.frames_dropped = shared.wire.frames_dropped();
    shared.end.is_wire_gone = guard.is_wire_gone();
    if (guard.is_wire_gone()) {
        kill(getpid(), SIGTERM);  // the main thread waits for signals
    }
    return nullptr;
}

void* run_engine(void* argument) {
    Shared& shared = *static_cast<Shared*>(argument);
    prepare("engine thread", shared.options.engine_priority, shared.options.engine_cpu);
    const LiveEngine live{shared.machine, shared.chain};
    StopReason said = StopReason::none;  // of the last result, if it has a limit
    while (!shared.is_ending.load()) {
        await(shared.wake_engine);
        run_queries(live, shared.queues, [&](LiveResult live_result) {
            live_result.done_us = monotonic_us();
            const StopReason reason = live_result.result.reason;
            if (has_limit(reason) && reason != said) {  // full: lines enough wait for the logger
                [[maybe_unused]] const bool is_noted =
                    shared.limits.push({reason, live_result.result.limit});
            }
            said = has_limit(reason) ? reason : StopReason::none;
            // Full only if the bus thread is blocked: then no thread can use a result.
            [[maybe_unused]] const bool is_pushed = shared.queues.results.push(live_result);
            wake(shared.wake_bus);
            // The permit or the stop is on its way.
            shared.options.desk->note(live_result, shared.chain);
        });
    }
    return nullptr;
}

/// Frames that the kernel dropped before any socket saw them: second column, one line a processor.
std::uint32_t read_backlog_drops(int file) noexcept {
    std::array<char, 8192> text{};
    const ssize_t size = pread(file, text.data(), text.size() - 1, 0);
    std::uint32_t drops = 0;
    const char* line = text.data();
    while (size > 0 && line != nullptr && *line != '\0') {
        char* end = nullptr;
        std::strtoul(line, &end, 16);
        drops += static_cast<std::uint32_t>(std::strtoul(end, nullptr, 16));
        line = std::strchr(line, '\n');
        line += line != nullptr ? 1 : 0;
    }
    return drops;
}

/// Logs broken limits, which do not fit into the note of the same stop.
void write_limits(Shared& shared) {
    std::array<char, 400> line{};
    BrokenLimit broken;
    while (shared.limits.pop(broken)) {
        const std::int64_t now_us = monotonic_us();
        if (broken.reason == shared.limit_reason && now_us < shared.limit_due_us) {
            continue;
        }
        shared.limit_reason = broken.reason;
        shared.limit_due_us = now_us + kLimitLogUs;
        const auto head =
            fmt::format_to_n(line.data(), line.size() - 1, "{}.{:06} {}: ", now_us / 1'000'000,
                             now_us % 1'000'000, to_text(broken.reason));
        std::size_t size = static_cast<std::size_t>(head.out - line.data());
        size += format_limit(broken.fact, broken.reason, shared.machine,
                             std::span(line).subspan(size, line.size() - 1 - size));
        line[size++] = '\n';
        [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, line.data(), size);
    }
}

/// Sets the status that the service manager shows.
void set_status(Shared& shared, std::string_view words) {
    std::array<char, 400> text{};
    const auto end =
        fmt::format_to_n(text.data(), text.size(), "{}{}", words,
                         shared.options.compares_hashes ? "" : "; hashes are not compared");
    shared.service.status({text.data(), static_cast<std::size_t>(end.out - text.data())});
}

void write_notes(Shared& shared) {
    BlackBoxEntry record;
    while (shared.records.pop(record)) {
        shared.black_box.add(record);
    }
    std::array<char, 400> line{};
    LiveNote note;
    while (shared.queues.notes.pop(note)) {
        const std::size_t size = format_note(note, shared.machine, line);
        [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, line.data(), size);
        const bool is_phase = note.kind == LiveNote::Kind::phase;
        if (is_phase || note.kind == LiveNote::Kind::withheld ||
            note.kind == LiveNote::Kind::motion) {
            // Without the line's end, and without its time.
            const std::string_view words(line.data(), size - 1);
            set_status(shared, words.substr(words.find(' ') + 1));
        }
        if (is_phase) {
            keep_latch(shared.latch);
        }
        shared.dump.on_note(note);
    }
    write_limits(shared);
    shared.dump.serve(monotonic_us());
}

void* run_logger(void* argument) {
    Shared& shared = *static_cast<Shared*>(argument);
    const int drops = open("/proc/self/net/softnet_stat", O_RDONLY | O_CLOEXEC);
    const std::uint32_t first = drops < 0 ? 0 : read_backlog_drops(drops);
    MetricsWriter metrics(shared.options.bus, shared.options.metrics_file);
    while (!shared.is_ending.load()) {
        write_notes(shared);
        shared.service.work(shared.period.load(), monotonic_us());
        metrics.work(shared.metrics, monotonic_us());
        if (drops >= 0) {
            shared.backlog_drops.store(read_backlog_drops(drops) - first);
        }
        poll(nullptr, 0, kLogPeriodMs);
    }
    if (drops >= 0) {
        close(drops);
    }
    return nullptr;
}

void* run_status(void* argument) {
    Shared& shared = *static_cast<Shared*>(argument);
    setpriority(PRIO_PROCESS, 0, kStatusNice);  // of this thread alone, on Linux
    StopLog log;
    serve_status({.socket = shared.options.status_socket,
                  .line = shared.options.status_line,
                  .desk = shared.options.desk,
                  .log = &log},
                 shared.status, shared.is_ending);
    return nullptr;
}

sigset_t watched_signals() noexcept {
    sigset_t signals;
    sigemptyset(&signals);
    for (const int signal : {SIGTERM, SIGINT, SIGUSR1, SIGUSR2}) {
        sigaddset(&signals, signal);
    }
    return signals;
}

/// Returns when a signal ends the program.
void serve_signals(Shared& shared) {
    const sigset_t signals = watched_signals();
    for (;;) {
        int signal = 0;
        if (sigwait(&signals, &signal) != 0 || signal == SIGTERM || signal == SIGINT) {
            return;
        }
        (signal == SIGUSR1 ? shared.wants_arm : shared.wants_reset).store(true);
        wake(shared.wake_bus);
    }
}

/// False: the thread could not be created.
bool start(pthread_t& thread, void* (*run)(void*), Shared& shared) {
    pthread_attr_t attributes;
    pthread_attr_init(&attributes);
    pthread_attr_setstacksize(&attributes, kStackBytes);
    const int error = pthread_create(&thread, &attributes, run, &shared);
    pthread_attr_destroy(&attributes);
    return error == 0;
}

}  // namespace

std::size_t live_bytes(const Machine& machine) noexcept {
    return black_box_bytes(machine) + sizeof(BlackBoxQueue) + sizeof(LiveQueues) +
           kThreads * kStackBytes;
}

LiveEnd run_live(const Machine& machine, GuardChain& chain, SocketCan& wire, LatchCell& latch,
                 const ThreadOptions& options) {
    const auto queues = std::make_unique<LiveQueues>();
    const auto records = std::make_unique<BlackBoxQueue>();
    BlackBox black_box(black_box_bytes(machine));
    BlackBoxDump dump(black_box, options.black_box, options.dumps);
    Shared shared{.machine = machine,
                  .chain = chain,
                  .wire = wire,
                  .latch = latch,
                  .options = options,
                  .queues = *queues,
                  .records = *records,
                  .black_box = black_box,
                  .dump = dump};
    const sigset_t signals = watched_signals();
    pthread_sigmask(SIG_BLOCK, &signals, nullptr);
    shared.wake_bus = eventfd(0, EFD_CLOEXEC);
    shared.wake_engine = eventfd(0, EFD_CLOEXEC);
    if (shared.wake_bus < 0 || shared.wake_engine < 0) {
        shared.end.fault = std::string("out of file descriptors: ") + std::strerror(errno);
        return shared.end;
    }
    log_refusal("memory", lock_memory());
    std::array<pthread_t, kThreads> threads{};
    constexpr std::array kRuns{&run_engine, &run_logger, &run_bus, &run_status};
    std::size_t count = 0;
    while (count < kThreads && start(threads[count], kRuns[count], shared)) {
        ++count;
    }
    if (count == kThreads) {
        serve_signals(shared);
    } else {
        shared.end.fault = "cannot start a thread. Close other programs, or see ulimit -u.";
    }
    shared.is_ending.store(true);
    wake(shared.wake_bus);
    wake(shared.wake_engine);
    for (std::size_t i = 0; i < count; ++i) {
        pthread_join(threads[i], nullptr);
    }
    shared.service.stopping();
    write_notes(shared);
    dump.finish(monotonic_us());
    shared.end.dump = dump.path();
    keep_latch(latch);
    close(shared.wake_bus);
    close(shared.wake_engine);
    return shared.end;
}

}  // namespace axg
