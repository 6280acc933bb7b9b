// SPDX-License-Identifier: Apache-2.0
// Preloaded into axguardd: of one kind of call, the n-th fails, as it does where memory,
// descriptors or threads have run out. AXG_FAIL_CALL="memory 17"; kinds: memory, descriptor,
// thread. Without a number none fails; at the end AXG_FAIL_COUNTS gets how many of each kind there
// were, and whether one failed. Counted from main on: what the loader and the runtimes of C++ and
// CUDA do before it is not axguardd's, and the last of these ends in a fault without memory.
#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>

// What the C library's own names stand for, under names that are not replaced here.
extern "C" {
void* __libc_malloc(std::size_t bytes);
void* __libc_calloc(std::size_t count, std::size_t bytes);
void* __libc_realloc(void* old, std::size_t bytes);
void* __libc_memalign(std::size_t alignment, std::size_t bytes);
}

namespace {

enum Kind { memory, descriptor, thread, kinds };
constexpr const char* kNames[kinds] = {"memory", "descriptor", "thread"};

std::atomic<bool> is_counting{false};
std::atomic<long> count[kinds];
std::atomic<long> failed{0};
long fail_at[kinds] = {};

/// Whether this call is the one.
bool fails(Kind kind) {
    if (!is_counting.load() || ++count[kind] != fail_at[kind]) {
        return false;
    }
    ++failed;
    return true;
}

template <class Function>
Function* next(const char* name) {
    return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

__attribute__((constructor)) void begin() {
    const char* words = std::getenv("AXG_FAIL_CALL");
    char name[16] = {};
    long at = 0;
    if (words != nullptr && std::sscanf(words, "%15s %ld", name, &at) == 2) {
        for (int kind = 0; kind < kinds; ++kind) {
            fail_at[kind] = std::strcmp(name, kNames[kind]) == 0 ? at : 0;
        }
    }
}

using Main = int(int, char**, char**);
Main* program = nullptr;

int counted_main(int words, char** word, char** environment) {
    is_counting = true;
    return program(words, word, environment);
}

__attribute__((destructor)) void end() {
    is_counting = false;
    const char* path = std::getenv("AXG_FAIL_COUNTS");
    std::FILE* file = path != nullptr ? std::fopen(path, "w") : nullptr;
    if (file == nullptr) {
        return;
    }
    for (int kind = 0; kind < kinds; ++kind) {
        std::fprintf(file, "%s %ld\n", kNames[kind], count[kind].load());
    }
    std::fprintf(file, "failed %ld\n", failed.load());
    std::fclose(file);
}

void* nothing() {
    errno = ENOMEM;
    return nullptr;
}

/// For calls that answer with a descriptor.
int no_descriptor() {
    errno = EMFILE;
    return -1;
}

mode_t mode_of(int flags, std::va_list words) {
    return (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(words, mode_t) : 0;
}

}  // namespace

extern "C" {

int __libc_start_main(Main* entry, int words, char** word, void (*init)(), void (*fini)(),
                      void (*rtld_fini)(), void* stack_end) {
    using Start = int(Main*, int, char**, void (*)(), void (*)(), void (*)(), void*);
    program = entry;
    return next<Start>("__libc_start_main")(counted_main, words, word, init, fini, rtld_fini,
                                            stack_end);
}

void* malloc(std::size_t bytes) noexcept {
    return fails(memory) ? nothing() : __libc_malloc(bytes);
}
void* calloc(std::size_t number, std::size_t bytes) noexcept {
    return fails(memory) ? nothing() : __libc_calloc(number, bytes);
}
void* realloc(void* old, std::size_t bytes) noexcept {
    return fails(memory) ? nothing() : __libc_realloc(old, bytes);
}
void* aligned_alloc(std::size_t alignment, std::size_t bytes) noexcept {
    return fails(memory) ? nothing() : __libc_memalign(alignment, bytes);
}
void* memalign(std::size_t alignment, std::size_t bytes) noexcept {
    return fails(memory) ? nothing() : __libc_memalign(alignment, bytes);
}
int posix_memalign(void** out, std::size_t alignment, std::size_t bytes) noexcept {
    *out = fails(memory) ? nullptr : __libc_memalign(alignment, bytes);
    return *out != nullptr ? 0 : ENOMEM;
}

void* mmap(void* at, std::size_t bytes, int access, int flags, int file, off_t offset) noexcept {
    using Map = void*(void*, std::size_t, int, int, int, off_t);
    if (fails(memory)) {
        errno = ENOMEM;
        return MAP_FAILED;
    }
    return next<Map>("mmap")(at, bytes, access, flags, file, offset);
}

int open(const char* path, int flags, ...) {
    std::va_list words;
    va_start(words, flags);
    const mode_t mode = mode_of(flags, words);
    va_end(words);
    return fails(descriptor) ? no_descriptor()
                             : next<int(const char*, int, ...)>("open")(path, flags, mode);
}
int openat(int folder, const char* path, int flags, ...) {
    std::va_list words;
    va_start(words, flags);
    const mode_t mode = mode_of(flags, words);
    va_end(words);
    return fails(descriptor)
               ? no_descriptor()
               : next<int(int, const char*, int, ...)>("openat")(folder, path, flags, mode);
}
std::FILE* fopen(const char* path, const char* mode) {
    if (fails(descriptor)) {
        (void)no_descriptor();
        return nullptr;
    }
    return next<std::FILE*(const char*, const char*)>("fopen")(path, mode);
}
std::FILE* fopen64(const char* path, const char* mode) {
    if (fails(descriptor)) {
        (void)no_descriptor();
        return nullptr;
    }
    return next<std::FILE*(const char*, const char*)>("fopen64")(path, mode);
}
int socket(int domain, int type, int protocol) noexcept {
    return fails(descriptor) ? no_descriptor()
                             : next<int(int, int, int)>("socket")(domain, type, protocol);
}
int eventfd(unsigned value, int flags) noexcept {
    return fails(descriptor) ? no_descriptor() : next<int(unsigned, int)>("eventfd")(value, flags);
}
int pthread_create(pthread_t* id, const pthread_attr_t* attributes, void* (*start)(void*),
                   void* argument) noexcept {
    using Create = int(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
    return fails(thread) ? EAGAIN : next<Create>("pthread_create")(id, attributes, start, argument);
}

}  // extern "C"
