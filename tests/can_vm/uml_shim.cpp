// SPDX-License-Identifier: Apache-2.0
// Preloaded into user-mode Linux, which is a program on the host. It keeps 2696 bytes of a guest
// thread's registers (AVX-512); a processor with more state (AMX: 11008 bytes) refuses so short a
// write, and the guest panics at its first process. The rest is filled in from the thread itself;
// the header that says which parts count is the guest's, so what is filled in has no effect.
// Source: arch/x86/um/ptrace_64.c of Linux 6.1; ptrace(2), PTRACE_SETREGSET.
#include <elf.h>
#include <linux/ptrace.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <cerrno>
#include <cstdarg>
#include <cstring>

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
