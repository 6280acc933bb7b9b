// SPDX-License-Identifier: Apache-2.0
// Preloaded into user-mode Linux, which is a program on the host, for two things.
// Registers: it keeps 2696 bytes of a guest thread's (AVX-512); a processor with more state (AMX:
// 11008 bytes) refuses so short a write, and the guest panics at its first process. The rest is
// filled in from the thread itself; the header that says which parts count is the guest's, so what
// is filled in has no effect.
// Clock: the guest's is a quarter of the processor time that the guest had, and of its sleeps what
// it asked for. A busy host makes it slow, never late, and a guest whose system calls take 15 us
// has time for them. Its timers are the host's and may end early by that clock: the guest then sets
// them anew, as it does with those of any hardware. Source: arch/x86/um/ptrace_64.c and
// arch/um/os-Linux/{time,skas/process}.c of Linux 6.1; ptrace(2), PTRACE_SETREGSET;
// clock_getcpuclockid(3).
#include <dlfcn.h>
#include <elf.h>
#include <linux/ptrace.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <utility>

// Not by the C library's header: its enumeration may not stand before variable arguments.
extern "C" long ptrace(int request, ...) noexcept {
    alignas(64) static char full[1 << 16];
    std::va_list words;
    va_start(words, request);
    const pid_t thread = va_arg(words, pid_t);
    void* const address = va_arg(words, void*);
    void* data = va_arg(words, void*);
    va_end(words);

    iovec whole{full, sizeof full};
    if (request == PTRACE_SETREGSET && reinterpret_cast<long>(address) == NT_X86_XSTATE) {
        const auto* const part = static_cast<const iovec*>(data);
        if (syscall(SYS_ptrace, PTRACE_GETREGSET, thread, address, &whole) == 0 &&
            whole.iov_len > part->iov_len) {
            std::memcpy(full, part->iov_base, part->iov_len);
            data = &whole;
        }
    }
    const bool peeks =
        request == PTRACE_PEEKTEXT || request == PTRACE_PEEKDATA || request == PTRACE_PEEKUSR;
    if (!peeks) {
        return syscall(SYS_ptrace, request, thread, address, data);
    }
    long word = 0;  // the system call writes it, the function returns it
    if (syscall(SYS_ptrace, request, thread, address, &word) < 0) {
        return -1;
    }
    errno = 0;
    return word;
}

namespace {

constexpr std::int64_t kSpeed = 4;

std::int64_t ns_of(const timespec& time) {
    return time.tv_sec * std::int64_t{1'000'000'000} + time.tv_nsec;
}

timespec time_of(std::int64_t ns) {
    return {.tv_sec = ns / 1'000'000'000, .tv_nsec = ns % 1'000'000'000};
}

int set_timer(timer_t timer, int flags, const itimerspec& wanted, itimerspec* before) {
    static auto* const next =
        reinterpret_cast<decltype(&timer_settime)>(dlsym(RTLD_NEXT, "timer_settime"));
    return next(timer, flags, &wanted, before);
}

/// By the host. 0: there is no such clock, its process has ended.
std::int64_t host_ns(clockid_t clock) {
    timespec time{};
    return syscall(SYS_clock_gettime, clock, &time) == 0 ? ns_of(time) : 0;
}

/// Runs the programs of the guest, each in a process that the guest's kernel waits for.
struct Child {
    pid_t pid = 0;
    clockid_t clock = 0;
    std::int64_t seen_ns = 0;
};

// One thread of the host runs all of the guest's kernel. Its signal handlers read the clock too, in
// the middle of any of these: so there are only sums that grow.
std::array<Child, 4096> children;
Child* running = nullptr;  // is waited for
std::int64_t children_ns = 0, slept_ns = 0, newest_ns = 0;
std::int64_t asleep_since_ns = 0, sleep_most_ns = 0;  // 0: awake
std::int64_t timer_ends_ns = INT64_MAX, timer_every_ns = 0;
timer_t the_timer = nullptr;

void count(Child& child) {
    const std::int64_t before = child.seen_ns;
    const std::int64_t now = host_ns(child.clock);
    if (now > before && child.seen_ns == before) {  // else a signal's handler counted it
        child.seen_ns = now;
        children_ns += now - before;
    }
}

std::int64_t read_clock() {
    if (running != nullptr) {
        count(*running);
    }
    if (const std::int64_t since_ns = std::exchange(asleep_since_ns, 0); since_ns != 0) {
        // Whoever reads it is awake.
        slept_ns += std::min(host_ns(CLOCK_MONOTONIC) - since_ns, sleep_most_ns);
    }
    const std::int64_t processor_ns = host_ns(CLOCK_PROCESS_CPUTIME_ID) + children_ns;
    newest_ns = std::max(newest_ns, processor_ns / kSpeed + slept_ns);
    return newest_ns;
}

}  // namespace

extern "C" int clock_gettime(clockid_t clock, timespec* time) noexcept {
    if (clock != CLOCK_MONOTONIC) {
        return static_cast<int>(syscall(SYS_clock_gettime, clock, time));
    }
    *time = time_of(read_clock());
    return 0;
}

// Until it sleeps the guest works, and its time passes more slowly than the host's.
extern "C" int timer_settime(timer_t timer, int flags, const itimerspec* wanted,
                             itimerspec* before) noexcept {
    const std::int64_t first = ns_of(wanted->it_value);
    the_timer = timer;
    timer_ends_ns = first == 0 ? INT64_MAX : read_clock() + first;
    timer_every_ns = ns_of(wanted->it_interval);
    const itimerspec slower{.it_interval = {}, .it_value = time_of(first * kSpeed)};
    return set_timer(timer, flags, timer_every_ns > 0 ? *wanted : slower, before);
}

extern "C" int sigsuspend(const sigset_t* mask) {
    constexpr std::size_t kernel_mask_bytes = 8;
    const std::int64_t now = read_clock();
    sleep_most_ns = timer_every_ns;
    if (timer_every_ns == 0 && timer_ends_ns != INT64_MAX) {
        sleep_most_ns = std::max<std::int64_t>(1, timer_ends_ns - now);
        set_timer(the_timer, 0, {.it_interval = {}, .it_value = time_of(sleep_most_ns)}, nullptr);
    }
    asleep_since_ns = host_ns(CLOCK_MONOTONIC);
    const long result = syscall(SYS_rt_sigsuspend, mask, kernel_mask_bytes);
    read_clock();
    return static_cast<int>(result);
}

extern "C" pid_t waitpid(pid_t pid, int* status, int options) {
    Child& child = children[static_cast<std::size_t>(pid) % children.size()];
    if (pid > 0 && child.pid != pid) {
        child = {.pid = pid};
        if (clock_getcpuclockid(pid, &child.clock) == 0) {
            child.seen_ns = host_ns(child.clock);
        }
    }
    running = pid > 0 ? &child : nullptr;
    const pid_t result = static_cast<pid_t>(syscall(SYS_wait4, pid, status, options, nullptr));
    read_clock();
    running = nullptr;
    if (result == pid && status != nullptr && !WIFSTOPPED(*status)) {
        child.pid = 0;  // its number may be another one's now
    }
    return result;
}
