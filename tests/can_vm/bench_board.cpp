// SPDX-License-Identifier: Apache-2.0
// The board on a bench (tests/support/bench_board.hpp) on a CAN interface, in real time.
//   bench_board MACHINE MESH_ROOT BUS [BROKEN]
// BROKEN: the number of a broken rule, 0 none. The person is stdin: a line "arm" arms the board, a
// line "jog" in a jog. Ends with stdin.
#include <poll.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "config/machine/effective_text.hpp"
#include "firmware_if/can/socket_can.hpp"
#include "firmware_if/setup/loaded_machine.hpp"
#include "firmware_if/system/live_socket.hpp"
#include "tests/support/bench_board.hpp"

namespace axg::test {
namespace {

/// What the person wants; both end when the board has done it.
struct Person {
    std::string typed;
    bool wants_arming = false, wants_jog = false, is_gone = false;
};

void listen_to(Person& person) {
    char text[64];
    const ssize_t count = ::read(STDIN_FILENO, text, sizeof text);
    person.is_gone = count <= 0;
    person.typed.append(text, count > 0 ? static_cast<std::size_t>(count) : 0);
    for (auto end = person.typed.find('\n'); end != std::string::npos;
         end = person.typed.find('\n')) {
        person.wants_jog = person.typed.substr(0, end) == "jog";
        person.wants_arming = true;
        person.typed.erase(0, end + 1);
    }
}

void latch(BenchBoard& board, SocketCan& wire) {
    for (const CanFrame& frame : board.latch()) {
        (void)wire.send(frame);
    }
}

void hear_all(BenchBoard& board, SocketCan& wire, std::int64_t later_us) {
    CanArrival arrival;
    while (wire.read(arrival) == ReadStatus::frame) {
        CanFrame frame = arrival.frame;
        if (arrival.is_own || frame.error || frame.extended) {
            continue;
        }
        frame.time_us -= later_us;
        while (board.next_latch_us() <= frame.time_us) {  // its timer latches, late or not
            latch(board, wire);
        }
        for (const CanFrame& answer : board.hear(frame)) {
            (void)wire.send(answer);
        }
    }
}

int play(const Machine& machine, const BenchOptions& options, SocketCan& wire) {
    BenchBoard board(machine, options);
    Person person;
    wire.forget();
    const std::int64_t later_us = monotonic_us() - board.next_latch_us() + machine.can.sample_us;
    while (!person.is_gone) {
        const std::int64_t left_us = board.next_latch_us() + later_us - monotonic_us();
        if (left_us > 0) {
            pollfd wait[2]{{wire.descriptor(), POLLIN, 0}, {STDIN_FILENO, POLLIN, 0}};
            const timespec timeout{.tv_sec = 0, .tv_nsec = left_us * 1000};
            ppoll(wait, 2, &timeout, nullptr);
            if (wait[1].revents != 0) {
                listen_to(person);
            }
            hear_all(board, wire, later_us);
            continue;
        }
        person.wants_arming = person.wants_arming && !board.arm(person.wants_jog);
        latch(board, wire);
    }
    return 0;
}

int run(int count, char** words) {
    LoadedMachine loaded;
    if (!load(words[1], words[2], loaded, stderr)) {
        return 3;
    }
    std::string fault;
    std::optional<SocketCan> wire = open_live_socket(loaded.machine, words[3], 0, fault);
    if (!wire) {
        std::fprintf(stderr, "%s\n", fault.c_str());
        return 12;
    }
    BenchOptions options;
    options.hashes = configuration_hashes(loaded.machine, loaded.meshes);
    options.broken = static_cast<Broken>(count > 4 ? std::atoi(words[4]) : 0);
    return play(loaded.machine, options, *wire);
}

}  // namespace
}  // namespace axg::test

int main(int count, char** words) {
    if (count < 4) {
        std::fprintf(stderr, "usage: bench_board MACHINE MESH_ROOT BUS [BROKEN]\n");
        return 2;
    }
    return axg::test::run(count, words);
}
