// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/live/live_service.hpp"

#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>

#include <csignal>
#include <exception>

#include "firmware_if/can/socket_can.hpp"

namespace axg {
namespace {

constexpr int kLogPeriodMs = 20;
constexpr int kServiceNice = 10;

class SignalsBlocked {
  public:
    SignalsBlocked() {
        sigset_t all;
        sigfillset(&all);
        pthread_sigmask(SIG_SETMASK, &all, &before_);
    }
    ~SignalsBlocked() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
    SignalsBlocked(const SignalsBlocked&) = delete;
    SignalsBlocked& operator=(const SignalsBlocked&) = delete;

  private:
    sigset_t before_{};
};

/// A thread begins with the policy of its maker, whose cycles it must not delay.
void leave_real_time() noexcept {
    const sched_param none{};
    pthread_setschedparam(pthread_self(), SCHED_OTHER, &none);
    setpriority(PRIO_PROCESS, 0, kServiceNice);  // of this thread alone, on Linux
}

}  // namespace

LiveService::LiveService(const Machine& machine, const StatusLine& line, StopDesk& desk,
                         const LiveServiceOptions& options, std::string& fault)
    : line_(line),
      desk_(desk),
      writer_(options.name, options.metrics_file),
      records_(std::make_unique<BlackBoxQueue>()),
      black_box_(black_box_bytes(machine)),
      dump_(black_box_, options.black_box, options.dumps) {
    if (!options.status_socket.empty()) {
        socket_ = StatusSocket::open(options.status_socket, fault);
    }
}

LiveService::~LiveService() {
    is_ending_.store(true);
    for (std::thread* const thread : {&logger_, &server_}) {
        if (thread->joinable()) {
            thread->join();
        }
    }
    take_records();
    dump_.finish(now_us_.load());
}

void LiveService::start() {
    const SignalsBlocked blocked;  // a thread begins with those of its maker
    logger_ = std::thread([this] { run_logger(); });
    if (socket_.is_open() && socket_.listen()) {
        server_ = std::thread([this] {
            leave_real_time();
            serve_status({.socket = &socket_, .line = &line_, .desk = &desk_}, status_, is_ending_);
        });
    }
}

void LiveService::note(const LiveNote& note) noexcept {
    if (note.kind != LiveNote::Kind::phase) {
        return;
    }
    if (note.phase == GuardPhase::stopped && was_armed_) {
        // Full only if the logger was held for 64 stops: one of them has a dump.
        [[maybe_unused]] const bool is_pushed = notes_.push(note);
    }
    was_armed_ = note.phase == GuardPhase::armed;
}

void LiveService::take_records() {
    BlackBoxEntry record;
    while (records_->pop(record)) {
        black_box_.add(record);
    }
    LiveNote note;
    while (notes_.pop(note)) {
        dump_.on_note(note);
    }
}

void LiveService::run_logger() {
    leave_real_time();
    while (!is_ending_.load()) {
        try {
            take_records();
            dump_.serve(now_us_.load(std::memory_order_relaxed));
            writer_.work(metrics_, monotonic_us());
        } catch (const std::exception&) {
            // No memory, or a folder that cannot be read: a dump or metrics are lost, not the host.
        }
        poll(nullptr, 0, kLogPeriodMs);
    }
}

}  // namespace axg
