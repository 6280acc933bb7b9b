// SPDX-License-Identifier: Apache-2.0
// The closed loop's motion board on a real bus: latches and sends in real time, hears axguardd,
// moves while it is permitted, brakes when it is not. Every approach goes for a pose in which the
// machine touches itself; where the axes truly were is judged by CGAL afterwards.
//   live_board MACHINE MESH_ROOT BUS SEED
// A line on stdin begins an approach; when the axes rest, a line of JSON on stdout says what came
// of it. Ends with stdin.
#include <poll.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "config/machine/effective_text.hpp"
#include "firmware_if/can/socket_can.hpp"
#include "firmware_if/guard/live_guard.hpp"
#include "firmware_if/protocol/handshake.hpp"
#include "hil_replay/board/approach_driver.hpp"
#include "hil_replay/drive/drive_run.hpp"
#include "tests/oracle/contact_scene.hpp"

namespace axg::test {
namespace {

constexpr std::int64_t kWatchUs = 250, kLongestUs = 10'000'000;
constexpr std::int64_t kLatchJitterUs = 50;  // more than a sample's instant is off
constexpr double kWatchedMm = 8;
constexpr double kClearMm = 30;  // at the start: room for a permit of ten periods

struct Seen {
    std::int64_t time_us;
    Positions position;
};

/// Frames of the board onto the bus, the guard's into the board, by this machine's clock.
class LiveBus {
  public:
    LiveBus(const LoadedMachine& loaded, SocketCan& wire)
        : can_(loaded.machine.can),
          hashes_(configuration_hashes(loaded.machine, loaded.meshes)),
          wire_(wire) {}

    /// The board's instants are so much earlier than those of this clock.
    std::int64_t later_us = 0;
    std::uint64_t sends_failed = 0;

    void send(const CanFrame& frame) {
        sends_failed += wire_.send(frame) == SendStatus::ok ? 0U : 1U;
    }
    /// What came while no board was there: an earlier guard's stop would end the next approach.
    void forget() {
        for (CanArrival arrival; wire_.read(arrival) == ReadStatus::frame;) {
        }
    }
    /// Hears until the board's next latch.
    void hear(MotionBoard& board) {
        const std::int64_t until_us = board.next_latch_us() + later_us;
        for (std::int64_t now_us = monotonic_us(); now_us < until_us; now_us = monotonic_us()) {
            pollfd wait{.fd = wire_.descriptor(), .events = POLLIN, .revents = 0};
            const std::int64_t left_us = until_us - now_us;
            const timespec timeout{.tv_sec = 0, .tv_nsec = std::min(left_us, 500'000L) * 1000};
            ppoll(&wait, 1, &timeout, nullptr);
            drain(board);
        }
        drain(board);
    }

  private:
    void drain(MotionBoard& board) {
        CanArrival arrival;
        while (wire_.read(arrival) == ReadStatus::frame) {
            if (arrival.is_own) {
                continue;
            }
            HashFrame hash;
            if (can_.hashes_out_id != 0 && arrival.frame.id == can_.hashes_out_id &&
                decode_hash(arrival.frame, hash)) {
                hash.hash = hashes_.of[hash.part];
                send(encode_hash(can_.hashes_in_id, hash, 0));
                continue;
            }
            // What came while this program slept came before the latch that follows it.
            arrival.frame.time_us =
                std::max(arrival.frame.time_us - later_us,
                         board.next_latch_us() - can_.sample_us + kLatchJitterUs);
            board.on_frame(arrival.frame);
        }
    }

    const CanLayout& can_;
    ConfigurationHashes hashes_;
    SocketCan& wire_;
};

/// A start that is clear of everything, and a pose beyond contact to make for.
struct Way {
    Positions start{}, target{};
};
Way draw_way(Random& random, ContactScene& scene) {
    Way way;
    Judgement judged;
    do {
        way.target = random_pose(random, scene.machine());
    } while (!scene.judge.judge(scene.of(way.target), 1).touches);
    do {
        way.start = random_pose(random, scene.machine());
        judged = scene.judge.judge(scene.of(way.start), kClearMm);
    } while (judged.touches || judged.clear_mm < kClearMm);
    return way;
}

/// Judges wherever the axes may be too near; in between no point can have moved that far.
nlohmann::json judge(ContactScene& scene, const std::vector<Seen>& seen) {
    Judgement last;
    const Positions* at = nullptr;
    bool touches = false, too_near = false;
    for (const Seen& one : seen) {
        double moved_mm = 0;
        for (std::size_t i = 0; at != nullptr && i < scene.machine().axes.size(); ++i) {
            const bool is_rotary = scene.machine().axes[i].kind == AxisKind::rotary;
            moved_mm +=
                std::abs(one.position[i] - (*at)[i]) * (is_rotary ? scene.judge.reach_mm() : 1.0);
        }
        if (at != nullptr && moved_mm < last.clear_mm) {
            continue;
        }
        at = &one.position;
        last = scene.judge.judge(scene.of(one.position), kWatchedMm);
        touches = touches || last.touches;
        too_near = too_near || last.too_near;
    }
    return {{"touches", touches}, {"too_near", too_near}};
}

nlohmann::json approach(Random& random, ContactScene& scene, LiveBus& live) {
    const Machine& machine = scene.machine();
    const Way way = draw_way(random, scene);
    Approach wanted;
    wanted.target = way.target;
    for (double& share : wanted.speed_share) {
        share = random() % 2 == 0 ? 1 : between(random, 0.1, 1);
    }
    MotionBoard board(machine, scene.of(way.start), make_approach(machine, wanted),
                      promised_board(machine, random()));
    std::vector<Seen> seen;
    board.watch(
        [&seen](std::int64_t time_us, std::span<const AxisMotion> axes) {
            Seen one{.time_us = time_us, .position = {}};
            for (std::size_t i = 0; i < axes.size(); ++i) {
                one.position[i] = axes[i].position;
            }
            seen.push_back(one);
        },
        kWatchUs);
    live.forget();
    live.later_us = monotonic_us() + 10'000 - board.next_latch_us();
    BusOptions wire;
    wire.period_us = machine.can.sample_us;
    CanBus bus(wire);
    std::int64_t late_us_max = 0;
    while (!board.is_at_rest() && board.next_latch_us() - kBoardStartUs < kLongestUs) {
        live.hear(board);
        late_us_max = std::max(late_us_max, monotonic_us() - live.later_us - board.next_latch_us());
        if (!board.latch(bus)) {
            return {{"fault", "the positions do not fit the frames"}};
        }
        CanBus::Delivery delivery;
        while (bus.next(board.next_latch_us(), delivery)) {
            live.send(delivery.frame);
        }
    }
    nlohmann::json out = judge(scene, seen);
    out["state"] = to_text(board.state());
    out["why"] = to_text(board.stop().why);
    out["moved"] = board.moving_since_us() != INT64_MIN;
    out["samples"] = board.samples();
    out["permits"] = board.permits().permits();
    out["judged"] = seen.size();
    out["late_us_max"] = late_us_max;
    out["sends_failed"] = live.sends_failed;
    return out;
}

int run(const std::string& file, const std::string& root, const std::string& bus,
        std::uint64_t seed) {
    LoadedMachine loaded;
    if (!load(file, root, loaded, stderr)) {
        return 3;
    }
    ContactScene scene(std::move(loaded));
    SocketOptions options;
    options.interface = bus;
    options.ids.count = live_ids(scene.machine(), options.ids.id);
    options.is_fd = scene.machine().can.format == CanFormat::fd;
    std::string fault;
    std::optional<SocketCan> wire = SocketCan::open(options, fault);
    if (!wire) {
        std::fprintf(stderr, "%s\n", fault.c_str());
        return 12;
    }
    LiveBus live(scene.loaded, *wire);
    Random random(seed);
    for (std::string line; std::getline(std::cin, line);) {
        std::cout << approach(random, scene, live).dump() << std::endl;
    }
    return 0;
}

}  // namespace
}  // namespace axg::test

int main(int count, char** words) {
    if (count != 5) {
        std::fprintf(stderr, "usage: live_board MACHINE MESH_ROOT BUS SEED\n");
        return 2;
    }
    return axg::test::run(words[1], words[2], words[3], std::strtoull(words[4], nullptr, 10));
}
